"""What participants of a session drive with."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import metadata as distribution
from typing import Any, NamedTuple

from costeer.devices.head.calibration import HeadCalibration
from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.interface import WheelDescription
from costeer.loop.trial import git_revision
from costeer.runtime.setup import DriveSetup

# Any, in this file: of JSON.


class Devices(NamedTuple):
    """What participants drive with.

    Attributes:
        input: "keyboard", "gamepad" or "wheel".
        wheel: None for virtual hands.
        calibration: None for virtual hands.
        head: Makes the calibration of a participant's head; None without a tracker.
        checks: Looks at the devices: name, whether it is well, what to do.
        haste: Of rehearsals with virtual hands.
    """

    input: str = "keyboard"
    wheel: WheelDescription | None = None
    calibration: WheelCalibration | None = None
    head: Callable[[str], HeadCalibration | None] = lambda participant: None
    checks: Callable[[], list[tuple[str, bool, str]]] = list
    haste: float = 1.0


def facts_of(
    devices: Devices,
    setup: DriveSetup,
    checked: Sequence[dict[str, Any]],
    frame_rate: int | None,
) -> dict[str, Any]:
    """What a reader of the methods section asks of a drive.

    Args:
        devices: Of the lab.
        setup: Of the drive.
        checked: What the last look at the devices found.
        frame_rate: Of the page before the drive, None if it has told nothing [1/s].
    """
    calibration = devices.calibration
    return {
        "costeer": distribution.version("costeer"),
        "git_revision": git_revision(),
        "input": devices.input,
        "wheel": None if setup.wheel is None else setup.wheel.name,
        "wheel_calibration": None if calibration is None else calibration._asdict(),
        "head": None if setup.head is None else setup.head.tracker.kind,
        "checks": list(checked),
        "frame_rate": frame_rate,
    }
