"""What a drive is: the trial, who or what holds the wheel, and what must be there."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.devices.head.calibration import HeadCalibration
from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.interface import WheelDescription
from costeer.drivers.driver import DriverParameters
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.scenario import TrialSetup, loop_parameters, trial_method
from costeer.methods.conditions import Condition, condition
from costeer.methods.registry import AnyMethod, method_named

PLANT_STEPS = 16
"""Plant steps in a control step with a person: 960 Hz."""

PLANT_DT = DT / PLANT_STEPS
"""Plant step with a person [s]."""

INTENTION_SOURCES = ("network", "indicator", "off")
"""What starts a lane change: the network, the driver's indicator, or nothing."""

_LEADER_STREAM = 2


class DriveSetup(NamedTuple):
    """One drive; it can be sent to another process.

    Attributes:
        trial: Condition, car, course and speed.
        method: That assists where the condition does; in manual, none does.
        wheel: The device; None for virtual hands (keyboard, gamepad).
        calibration: Of the device; None for virtual hands.
        intention: One of `INTENTION_SOURCES`.
        keeps_speed: Whether the foot keeps the speed while no pedal is pressed.
        needs_page: Whether the drive pauses when no page looks on.
        head: Tracker and calibration of the head; None without one.
        participant: Pseudonym of who drives.
    """

    trial: TrialSetup
    method: str = "ibhs"
    wheel: WheelDescription | None = None
    calibration: WheelCalibration | None = None
    intention: str = "network"
    keeps_speed: bool = True
    needs_page: bool = True
    head: HeadCalibration | None = None
    participant: str = "1"


def check_drive(setup: DriveSetup) -> None:
    """Refuse a drive that cannot begin.

    Raises:
        ValueError: Naming the value and the way out.
    """
    loop_parameters(setup.trial)
    if setup.intention not in INTENTION_SOURCES:
        known = ", ".join(INTENTION_SOURCES)
        raise ValueError(
            f"intention '{setup.intention}' is not known; choose one of {known}"
        )
    if setup.wheel is not None and setup.calibration is None:
        raise ValueError(
            f"the wheel {setup.wheel.name} is not calibrated; run: costeer wheel "
            "calibrate"
        )


def drive_parameters(setup: DriveSetup) -> LoopParameters[Any]:
    """Parameters of the loop: the trial's, with arms of average people.

    Raises:
        ValueError: If the trial cannot be run.
    """
    trial = setup.trial._replace(plant_steps=PLANT_STEPS)
    return loop_parameters(trial)._replace(driver=DriverParameters())


def drive_method(setup: DriveSetup) -> AnyMethod:
    """The method whose functions the loop of a drive calls."""
    return trial_method(setup.trial)


def trial_setup(name: str, method: str, changed: TrialSetup) -> TrialSetup:
    """The trial under a condition and a method.

    Args:
        name: Of the condition.
        method: Name of the method; manual is its own.
        changed: Everything else.

    Raises:
        ValueError: If condition or method is not known.
    """
    chosen = condition(name)
    method_named(method)
    return changed._replace(
        condition=chosen.name,
        method="manual" if chosen.strength_factor == 0.0 else method,
    )


def strength_of(chosen: Condition, method: str) -> Real:
    """Strength factor of a condition; 0 with a method that does not assist [-]."""
    return chosen.strength_factor if method_named(method).assists else 0.0


def leader_draws(setup: DriveSetup) -> NDArray[np.float64]:
    """A draw in [0, 1) for each leader's speed, by seed and participant."""
    trial = setup.trial
    entropy = [trial.seed, _LEADER_STREAM, trial.participant]
    generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(entropy)))
    return generator.random(64)
