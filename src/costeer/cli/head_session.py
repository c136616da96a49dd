"""What `costeer head` does: ask for three looks, or show what a tracker sees."""

from __future__ import annotations

import math
import sys
import time
from contextlib import closing
from typing import TYPE_CHECKING

import typer

from costeer.cli.console import note

if TYPE_CHECKING:
    from costeer.devices.head.calibration import HeadCalibration, Look, LookParameters
    from costeer.devices.head.source import HeadDescription, HeadReading, HeadSource

SHOWN_EVERY = 0.5
"""Time from one line of `costeer head test` to the next [s]."""


def calibrate(
    participant: str, tracker: HeadDescription, angles_deg: tuple[float, float]
) -> None:
    """Ask for the three looks, fit and store the calibration, print what came out.

    Args:
        participant: Pseudonym.
        tracker: Which one.
        angles_deg: Left and right mirror from straight ahead, both positive [deg].

    Raises:
        ValueError: If a look or the line through them is refused.
        OSError: If the tracker is not there, or the file cannot be written.
    """
    from costeer.devices.head.calibration import (
        FitParameters,
        LookParameters,
        check_pseudonym,
        fit_calibration,
        save_calibration,
    )
    from costeer.devices.head.registry import open_head

    check_pseudonym(participant)
    left, right = map(math.radians, angles_deg)
    with closing(open_head(tracker)) as source:
        looks = _looks(source, LookParameters(left_yaw=left, right_yaw=-right))
    found = fit_calibration(FitParameters(), participant, tracker, looks)
    path = save_calibration(found)
    typer.echo(
        f"{participant}: gain {found.gain:.2f}, offset "
        f"{math.degrees(found.offset):+.1f} deg, largest misfit "
        f"{math.degrees(found.misfit):.1f} deg"
    )
    typer.echo(path)


def _looks(source: HeadSource, parameters: LookParameters) -> list[Look]:
    """Straight ahead, left and right, each after a press of Enter."""
    from costeer.devices.head.calibration import Look
    from costeer.devices.head.looks import steady_yaw

    targets = {
        "straight ahead at the road": 0.0,
        "left, the nose at the left mirror": parameters.left_yaw,
        "right, the nose at the right mirror": parameters.right_yaw,
    }
    looks = []
    for words, yaw in targets.items():
        note(f"Turn the head {words}; press Enter and hold still for two seconds.")
        if not sys.stdin.readline():
            raise ValueError("nobody pressed Enter; run it in a terminal")
        looks.append(Look(head_yaw=yaw, tracked_yaw=steady_yaw(source)))
    return looks


def show_tracker(
    participant: str | None, tracker: HeadDescription | None, seconds: float
) -> None:
    """Print what the tracker sees, and at the end how often and how well.

    Args:
        participant: Whose calibration is used; the tracker's own angle if None.
        tracker: Which one; that of the calibration, or the first camera, if None.
        seconds: How long [s].

    Raises:
        ValueError: If the participant is not calibrated.
        OSError: If the tracker is not there.
    """
    from costeer.devices.head.registry import open_head

    calibration = _calibration(participant, tracker)
    with closing(open_head(calibration.tracker)) as source:
        readings = _watch(source, calibration, seconds)
    if len(readings) < 2:
        raise ValueError(
            f"the {calibration.tracker.kind} gave no two readings within {seconds:g} "
            "s; check that it is running, or give it more --seconds"
        )
    seen = sum(reading.valid for reading in readings)
    lasted = readings[-1].time - readings[0].time
    typer.echo(
        f"{(len(readings) - 1) / lasted:.1f} readings per second, "
        f"{100 * seen / len(readings):.0f} % valid"
    )


def _calibration(
    participant: str | None, tracker: HeadDescription | None
) -> HeadCalibration:
    """The participant's, or none for the tracker."""
    from costeer.devices.head.calibration import HeadCalibration, load_calibration
    from costeer.devices.head.source import HeadDescription

    if participant is None:
        return HeadCalibration("", tracker or HeadDescription("webcam", "0"))
    found = load_calibration(participant)
    if tracker is not None and tracker.kind != found.tracker.kind:
        raise ValueError(
            f"{participant} was calibrated with {found.tracker.kind}, not with "
            f"{tracker.kind}; leave the tracker out, or calibrate again"
        )
    if tracker is None or tracker == HeadDescription(*found.tracker[:2]):
        return found  # whatever else the tracker needs was told when it was calibrated
    return found._replace(tracker=tracker)


def _watch(
    source: HeadSource, calibration: HeadCalibration, seconds: float
) -> list[HeadReading]:
    """New readings within so many seconds; a line for some of them."""
    from costeer.devices.head.calibration import calibrated
    from costeer.devices.head.source import HeadLost

    readings: dict[float, HeadReading] = {}
    start = shown = time.perf_counter()
    while time.perf_counter() - start < seconds:
        try:
            reading = calibrated(calibration, source.read())
        except HeadLost as error:
            note(f"costeer: {error}")
            break
        if reading.time >= start:
            readings[reading.time] = reading
        if time.perf_counter() - shown >= SHOWN_EVERY:
            shown = time.perf_counter()
            _show(reading)
    return list(readings.values())


def _show(reading: HeadReading) -> None:
    """One line on where the head points."""
    yaw_deg = 90.0 * reading.head_yaw
    side = "left" if yaw_deg > 0.0 else "right"
    state = "valid" if reading.valid else "lost, last value"
    typer.echo(f"head yaw {yaw_deg:+6.1f} deg ({side}), {state}")
