"""What `costeer wheel` does: the list, the calibration with its user, the test."""

from __future__ import annotations

import math
import sys
import time
from contextlib import closing
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import typer

from costeer.cli.console import note, print_table

if TYPE_CHECKING:
    from collections.abc import Iterator

    from costeer.devices.wheels.calibration import WheelCalibration
    from costeer.devices.wheels.interface import Wheel, WheelDescription
    from costeer.devices.wheels.pedals import ShowsAxes
    from costeer.devices.wheels.selftest import Procedure, Reference, StoredAndFound

Result = TypeVar("Result")

PEDAL_TIME = 4.0
"""In which a pedal must be pressed [s]."""

WAKE_TIME = 30.0
"""In which a wheel must be turned that is not awake [s]."""

_WAKE = "Turn the wheel by 10 degrees and back."
_WARNING = (
    "The wheel will turn by itself for about {seconds:.0f} seconds, by half a turn at "
    "most. Take ties and sleeves away and keep the power switch in reach."
)


class Chosen(NamedTuple):
    """The wheel that the command is about.

    Attributes:
        description: Of the device.
        simulated: Whether it is not there; then it needs no clock and no user.
    """

    description: WheelDescription
    simulated: bool


def show_wheels(can: str) -> None:
    """Print the wheels that are plugged in and whether each is calibrated.

    Args:
        can: Bus of a SENSO-Wheel; empty if there is none.
    """
    from costeer.devices.wheels.registry import found_wheels
    from costeer.devices.wheels.store import calibration_path, stored_calibrations

    stored = stored_calibrations()
    known = {each.identity for each in stored.calibrations}
    found = found_wheels(can)
    rows = [
        (
            str(number),
            each.name,
            each.kind,
            each.identity,
            "yes" if each.identity in known else "no",
        )
        for number, each in enumerate(found, start=1)
    ]
    if rows:
        print_table(("number", "wheel", "by", "identity", "calibrated"), rows)
    else:
        typer.echo("No steering wheel with force feedback is plugged in.")
    absent = known - {each.identity for each in found}
    for identity in sorted(absent):
        typer.echo(f"not plugged in: {identity}, {calibration_path(identity)}")
    for words in stored.damaged:
        note(f"costeer: {words}")


def chosen(number: int | None, can: str, simulated: bool) -> Chosen:
    """Find the wheel that the options name.

    Raises:
        ValueError: If there is none, or no such number.
        ModuleNotFoundError: If the package for wheels is not installed.
    """
    from costeer.devices.wheels.registry import found_wheels
    from costeer.devices.wheels.simulated import simulated_description

    if simulated:
        return Chosen(simulated_description(), simulated=True)
    found = found_wheels(can)
    if not found:
        raise ValueError(
            "no steering wheel with force feedback is plugged in; see that it has "
            "power and its driver, or try --simulated"
        )
    if (number or 1) > len(found):
        raise ValueError(
            f"--device is {number}, but there are {len(found)}; see: costeer wheel list"
        )
    return Chosen(found[(number or 1) - 1], simulated=False)


def known(
    chosen: Chosen,
    peak_torque: float | None,
    weight: tuple[float, float] | None,
    lock_to_lock: float | None,
    turns: bool,
) -> Reference:
    """Put together what the user knows of the wheel.

    Args:
        chosen: The wheel.
        peak_torque: At full command [N·m]; None takes that of the table.
        weight: Mass [kg] and radius [m] of a weight; None if there is none.
        lock_to_lock: Range [rad]; None takes the device's.
        turns: Whether the user will turn it.

    Raises:
        ValueError: If nothing tells the scale of the torque.
    """
    from costeer.devices.wheels.references import Weight, known_peak_torque
    from costeer.devices.wheels.selftest import Reference

    if chosen.simulated and (weight or lock_to_lock):
        raise ValueError(
            "nobody turns a simulated wheel or hangs a weight on it; give "
            "--peak-torque or nothing"
        )
    peak = peak_torque or known_peak_torque(chosen.description.identity)
    if weight is not None:
        peak = None
    elif chosen.simulated:
        peak = peak or _simulated_peak()
    elif peak is None:
        raise ValueError(
            f"the peak torque of {chosen.description.name} is not in the table; give "
            "--peak-torque NM, or --weight KG --radius M"
        )
    return Reference(
        peak_torque=peak,
        weight=None if weight is None else Weight(*weight),
        lock_to_lock=lock_to_lock,
        turns=turns and not chosen.simulated,
    )


def _simulated_peak() -> float:
    from costeer.devices.wheels.simulated import SimulatedWheelParameters

    return SimulatedWheelParameters().torque_curve[-1][1]


def calibrate(chosen: Chosen, reference: Reference, pedals: bool) -> None:
    """Calibrate a wheel with its user, keep and print what came out.

    Args:
        chosen: The wheel.
        reference: What the user knows of it.
        pedals: Whether the user presses the pedals.

    Raises:
        ValueError: If the wheel did what it should not.
        OSError: If it is lost, or the file cannot be written.
    """
    from costeer.devices.wheels import excitation, selftest
    from costeer.devices.wheels.store import save_calibration

    pushes = excitation.DEFAULTS
    _warn(chosen, pushes.duration)
    raw = _uncalibrated(chosen)
    with closing(_opened(chosen, raw)) as wheel:
        _wake(wheel)
        raw = _with_pedals(wheel, raw) if pedals and not chosen.simulated else raw
        dt = 1.0 / selftest.reading_rate(wheel)
        result = _run(chosen, wheel, selftest.calibrate(raw, reference, dt, pushes))
    path = save_calibration(result.calibration)
    _show(result.calibration)
    typer.echo(f"The calibration explains {result.explained:.1%} of the movement.")
    for words in result.notes:
        note(f"costeer: {words}")
    typer.echo(path)


def check(chosen: Chosen) -> None:
    """Push a wheel, print what it does beside its calibration.

    Raises:
        ValueError: If it is not calibrated, or does not do what its calibration says.
        OSError: If it is lost.
    """
    from costeer.devices.wheels import selftest
    from costeer.devices.wheels.store import CALIBRATE, load_calibration

    stored = load_calibration(chosen.description)
    pushes = selftest.TEST_PUSHES
    _warn(chosen, pushes.duration)
    with closing(_opened(chosen, selftest.opened_for_test(stored))) as wheel:
        _wake(wheel)
        dt = 1.0 / selftest.reading_rate(wheel)
        found = _run(chosen, wheel, selftest.compare(stored, dt, pushes))
    wrong = [each.name for each in found if not selftest.agrees(each)]
    print_table(
        ("value", "stored", "found", "may differ by", "unit", ""),
        [_row(each, "" if each.name not in wrong else "differs") for each in found],
    )
    if wrong:
        raise ValueError(
            f"the wheel does not do what its calibration says: {', '.join(wrong)}; if "
            f"nobody held it, {CALIBRATE}"
        )


def _row(comparison: StoredAndFound, remark: str) -> tuple[str, ...]:
    numbers = (comparison.stored, comparison.found, comparison.allowed)
    shown = [f"{number:.3g}" for number in numbers]
    return (comparison.name, *shown, comparison.unit, remark)


def _warn(chosen: Chosen, seconds: float) -> None:
    """Say what will happen, and wait until the user agrees."""
    if chosen.simulated:
        return
    note(_WARNING.format(seconds=seconds + 10.0))
    note("Press Enter to begin.")
    if not sys.stdin.readline():
        raise ValueError("nobody pressed Enter; run it in a terminal")


def _uncalibrated(chosen: Chosen) -> WheelCalibration:
    from costeer.devices.wheels.calibration import uncalibrated
    from costeer.devices.wheels.references import known_angle_sign

    kind, identity = chosen.description.kind, chosen.description.identity
    return uncalibrated(identity, angle_sign=known_angle_sign(kind))


def _opened(chosen: Chosen, calibration: WheelCalibration) -> Wheel:
    from costeer.devices.wheels.registry import open_wheel
    from costeer.devices.wheels.simulated import open_simulated

    if chosen.simulated:
        return open_simulated(chosen.description, calibration)
    return open_wheel(chosen.description, calibration)


def _run(chosen: Chosen, wheel: Wheel, procedure: Procedure[Result]) -> Result:
    """Run a procedure by the wall clock, a simulated wheel without one."""
    from costeer.devices.wheels.selftest import reading_rate, run_procedure
    from costeer.runtime.clock import Pacer

    wait = _no_wait if chosen.simulated else Pacer(1.0 / reading_rate(wheel)).wait
    return run_procedure(wheel, procedure, wait, note)


def _no_wait() -> float:
    """A simulated wheel is ready at once."""
    return 0.0


def _wake(wheel: Wheel) -> None:
    """Let the user turn a wheel that does not show its angle before.

    Raises:
        ValueError: If nobody does.
    """
    end = time.monotonic() + WAKE_TIME
    asked = False
    while not getattr(wheel, "is_awake", True):
        if not asked:
            note(_WAKE)
            asked = True
        if time.monotonic() > end:
            raise ValueError(
                f"nobody turned the wheel within {WAKE_TIME:.0f} s, and before that "
                "its angle is not known; run it again, and turn it when asked"
            )
        wheel.read()
        time.sleep(0.01)


def _with_pedals(wheel: Wheel, raw: WheelCalibration) -> WheelCalibration:
    """Let the user press the pedals; without an answer there are none."""
    from costeer.devices.wheels.pedals import ShowsAxes, pressed_axis

    if not isinstance(wheel, ShowsAxes) or len(wheel.axes()) < 2:
        return raw
    first = pressed_axis(_axes(wheel, "accelerator"))
    second = pressed_axis(_axes(wheel, "brake"), frozenset({first.number}))
    return raw._replace(
        accelerator_axis=first.number,
        accelerator_sign=first.sign,
        brake_axis=second.number,
        brake_sign=second.sign,
    )


def _axes(wheel: ShowsAxes, pedal: str) -> Iterator[tuple[float, ...]]:
    """What the axes are before a pedal is asked for, and for some seconds after."""
    yield wheel.axes()
    note(f"Press the {pedal} to the floor, then let it go.")
    end = time.monotonic() + PEDAL_TIME
    while time.monotonic() < end:
        yield wheel.axes()
        time.sleep(0.01)


def _show(calibration: WheelCalibration) -> None:
    """Print a calibration."""
    from costeer.devices.wheels.calibration import largest_torque

    rows = [
        ("angle grows", _side(calibration.angle_sign), ""),
        ("a positive command pushes", _side(calibration.torque_sign), ""),
        ("range", f"{math.degrees(calibration.full_range):.0f}", "deg"),
        ("largest torque", f"{largest_torque(calibration):.2f}", "N·m"),
        ("inertia", f"{calibration.inertia:.4f}", "kg·m²"),
        ("damping", f"{calibration.damping:.3f}", "N·m·s/rad"),
        ("friction", f"{calibration.friction:.3f}", "N·m"),
        ("latency", f"{1000.0 * calibration.latency:.1f}", "ms"),
        ("accelerator, brake", _axes_words(calibration), "axes"),
    ]
    print_table(("value", calibration.identity, "unit"), rows)


def _side(sign: float) -> str:
    return "left" if sign > 0.0 else "right"


def _axes_words(calibration: WheelCalibration) -> str:
    numbers = (calibration.accelerator_axis, calibration.brake_axis)
    return ", ".join("none" if number < 0 else str(number) for number in numbers)
