"""From the tracker's angle to the head yaw that the network knows, per participant.

A tracker fits a mean face, so its angle is too small or too large by a fifth, and its
camera does not stand straight ahead. Three looks mend both: ahead, left, right.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from costeer.base.files import write_text
from costeer.devices.head.source import FULL_YAW, HeadDescription, HeadReading
from costeer.devices.home import home_folder

FORMAT_VERSION = 1
_FOLDER = "heads"
_PSEUDONYM = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,39}")


class LookParameters(NamedTuple):
    """Where the participant's nose points in the three looks.

    Attributes:
        left_yaw: At the left mirror [rad]. Source: assumed, 30 deg: the head's part
            of a look at a mirror is 20 to 30 deg, the eyes do the rest, and webcams
            measure well up to there.
        right_yaw: At the right mirror [rad]. Source: assumed, as on the left; a desk
            simulator has its mirrors, or two marks, where one puts them.
    """

    left_yaw: float = math.radians(30.0)
    right_yaw: float = math.radians(-30.0)


class FitParameters(NamedTuple):
    """Which calibrations are refused.

    Attributes:
        least_gain: Smallest gain [-]. Source: assumed; 1.0 to 1.3 on rendered faces.
        largest_gain: Largest gain [-]. Source: assumed.
        largest_misfit: Largest distance of a look from the line [rad]. Source:
            assumed, 6 deg; a third of the looks' usual difference is a mistake.
    """

    least_gain: float = 0.5
    largest_gain: float = 2.0
    largest_misfit: float = math.radians(6.0)


class Look(NamedTuple):
    """One look of the calibration.

    Attributes:
        head_yaw: Where the nose pointed, positive to the left [rad].
        tracked_yaw: What the tracker said [rad].
    """

    head_yaw: float
    tracked_yaw: float


class HeadCalibration(NamedTuple):
    """How a participant's head is tracked; picklable.

    Attributes:
        participant: Pseudonym; empty for nobody in particular.
        tracker: Which one it was made with.
        offset: Head yaw where the tracker says zero [rad].
        gain: Head yaw over the tracker's [-].
        misfit: Largest distance of a look from the line [rad].
    """

    participant: str
    tracker: HeadDescription
    offset: float = 0.0
    gain: float = 1.0
    misfit: float = 0.0


def fit_calibration(
    parameters: FitParameters,
    participant: str,
    tracker: HeadDescription,
    looks: Sequence[Look],
) -> HeadCalibration:
    """Straight line through the looks, least squares.

    Args:
        parameters: Which results are refused.
        participant: Pseudonym.
        tracker: Which one the looks were measured with.
        looks: Two or more; three as a rule.

    Raises:
        ValueError: If the looks do not lie on a sensible line.
    """
    check_pseudonym(participant)
    wanted = np.array([look.head_yaw for look in looks])
    tracked = np.array([look.tracked_yaw for look in looks])
    if not np.all(np.isfinite(tracked)) or np.ptp(tracked) < math.radians(5.0):
        raise ValueError(
            "the tracker saw the head turn less than 5 deg; turn the whole head, the "
            "nose towards each mirror, and try again"
        )
    gain, offset = (float(number) for number in np.polyfit(tracked, wanted, 1))
    misfit = float(np.max(np.abs(offset + gain * tracked - wanted)))
    _check_line(parameters, gain, misfit)
    return HeadCalibration(participant, tracker, offset, gain, misfit)


def _check_line(parameters: FitParameters, gain: float, misfit: float) -> None:
    """Refuse a line that no head and tracker have.

    Raises:
        ValueError: If it is one.
    """
    if gain < 0.0:
        raise ValueError(
            "the tracker counts right as positive, or left and right were mixed up; "
            "look again, or give --mirrored"
        )
    if not parameters.least_gain <= gain <= parameters.largest_gain:
        raise ValueError(
            f"the head turned {gain:.2f} times as far as the tracker says, outside "
            f"{parameters.least_gain:g} to {parameters.largest_gain:g}; check the "
            "angles of the mirrors and the tracker's unit, and try again"
        )
    if misfit > parameters.largest_misfit:
        raise ValueError(
            f"a look is {math.degrees(misfit):.1f} deg off the line through all three; "
            "keep the head still in each look and try again"
        )


def calibrated(calibration: HeadCalibration, reading: HeadReading) -> HeadReading:
    """A tracker's reading [rad] as the network knows it: yaw in [-1, 1] [-]."""
    yaw = (calibration.offset + calibration.gain * reading.head_yaw) / FULL_YAW
    return HeadReading(
        time=reading.time,
        head_yaw=min(1.0, max(-1.0, yaw)) if math.isfinite(yaw) else 0.0,
        valid=bool(reading.valid and math.isfinite(yaw)),
    )


def check_pseudonym(participant: str) -> None:
    """Refuse what could not be a file's name, or might be a person's.

    Raises:
        ValueError: If it is not 1 to 40 letters, digits, `-` and `_`.
    """
    if not _PSEUDONYM.fullmatch(participant):
        raise ValueError(
            f"participant {participant!r} is no pseudonym; give 1 to 40 letters, "
            "digits, - and _, as P01"
        )


def calibration_file(participant: str, folder: Path | None = None) -> Path:
    """Where a participant's calibration lies.

    Args:
        participant: Pseudonym.
        folder: The user's; that of `home_folder` if None.

    Raises:
        ValueError: If the pseudonym is none.
    """
    check_pseudonym(participant)
    return (folder or home_folder()) / _FOLDER / f"{participant}.json"


def save_calibration(calibration: HeadCalibration, folder: Path | None = None) -> Path:
    """Write a calibration in one piece over an older one; return the file.

    Raises:
        OSError: If it cannot be written.
    """
    path = calibration_file(calibration.participant, folder)
    path.parent.mkdir(parents=True, exist_ok=True)
    content = {
        "version": FORMAT_VERSION,
        **calibration._asdict(),
        "tracker": calibration.tracker._asdict(),
    }
    write_text(path, json.dumps(content, indent=1) + "\n")
    return path


def load_calibration(participant: str, folder: Path | None = None) -> HeadCalibration:
    """Read a participant's calibration.

    Raises:
        ValueError: If there is none, or the file is not one.
    """
    path = calibration_file(participant, folder)
    if not path.is_file():
        raise ValueError(
            f"the head of participant {participant} is not calibrated; run: costeer "
            f"head calibrate --participant {participant}"
        )
    try:
        found = _parsed(json.loads(path.read_text(encoding="utf-8")))
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise ValueError(
            f"{path} is not a calibration of this costeer ({error}); run: costeer head "
            f"calibrate --participant {participant}"
        ) from error
    if found.participant != participant:
        raise ValueError(
            f"{path} is of participant {found.participant}, not of {participant}; run: "
            f"costeer head calibrate --participant {participant}"
        )
    return found


def _parsed(content: dict[str, Any]) -> HeadCalibration:  # Any: JSON
    """The calibration in a file.

    Raises:
        ValueError: If a number is not finite, or the version is another.
    """
    version = content.pop("version")
    if version != FORMAT_VERSION:
        raise ValueError(f"its version is {version}")
    tracker = HeadDescription(**content.pop("tracker"))
    found = HeadCalibration(tracker=tracker, **content)
    numbers = [float(n) for n in (found.offset, found.gain, found.misfit)]
    if not all(map(math.isfinite, numbers)):
        raise ValueError("its numbers are not finite")
    usual = FitParameters()
    if not usual.least_gain <= found.gain <= usual.largest_gain:
        raise ValueError(
            f"its gain is {found.gain:g}, outside {usual.least_gain:g} to "
            f"{usual.largest_gain:g}"
        )
    if abs(found.offset) > math.pi / 2.0:
        raise ValueError(f"its offset is {math.degrees(found.offset):g} deg")
    return HeadCalibration(found.participant, tracker, *numbers)
