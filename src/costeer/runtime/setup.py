"""What a drive is: the trial, who or what holds the wheel, and what must be there."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.devices.head.calibration import HeadCalibration
from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.interface import WheelDescription
from costeer.devices.wheels.simulated import held_by
from costeer.drivers.driver import DriverParameters
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.scenario import TrialSetup, loop_parameters, trial_method
from costeer.loop.trial import trial_predictor
from costeer.methods.conditions import condition as condition_named
from costeer.methods.ibhs import IBHS
from costeer.methods.manual import MANUAL
from costeer.methods.registry import AnyMethod, method_named
from costeer.plant.fleet import num_cars
from costeer.records.cars import car_columns
from costeer.records.columns import Column
from costeer.runtime.frame import MOST_METHOD_COLUMNS

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
        trial: Condition, method, car, course and speed.
        wheel: The device; None for virtual hands (keyboard, gamepad).
        calibration: Of the device; None for virtual hands.
        intention: One of `INTENTION_SOURCES`.
        keeps_speed: Whether the foot keeps the speed while no pedal is pressed.
        needs_page: Whether the drive pauses when no page looks on.
        head: Tracker and calibration of the head; None without one.
        participant: Pseudonym of who drives.
        haste: Seconds of the trial in a second of the clock; 1 for people, more for
            rehearsals with virtual hands.
    """

    trial: TrialSetup
    wheel: WheelDescription | None = None
    calibration: WheelCalibration | None = None
    intention: str = "network"
    keeps_speed: bool = True
    needs_page: bool = True
    head: HeadCalibration | None = None
    participant: str = "1"
    haste: float = 1.0


def check_drive(setup: DriveSetup) -> None:
    """Refuse a drive that cannot begin.

    Raises:
        ValueError: Naming the value and the way out.
    """
    loop_parameters(setup.trial)
    offered_methods(setup)
    if (number := len(method_named(setup.trial.method).columns)) > MOST_METHOD_COLUMNS:
        raise ValueError(
            f"the method adds {number} columns; a drive takes up to "
            f"{MOST_METHOD_COLUMNS}"
        )
    if not isinstance(setup.trial.predictor, str):
        raise ValueError(
            "a drive runs in processes of its own; give its predictor by its name, as "
            "module:object or as a file"
        )
    trial_predictor(setup.trial._replace(intention="network"))
    if setup.intention not in INTENTION_SOURCES:
        known = ", ".join(INTENTION_SOURCES)
        raise ValueError(
            f"intention '{setup.intention}' is not known; choose one of {known}"
        )
    if not 1.0 <= setup.haste <= 100.0:
        raise ValueError(f"haste is {setup.haste:g}; give 1 to 100")
    if setup.haste > 1.0 and not is_virtual(setup):
        raise ValueError("only virtual hands on a simulated wheel drive in haste")
    if setup.wheel is not None and setup.calibration is None:
        raise ValueError(
            f"the wheel {setup.wheel.name} is not calibrated; run: costeer wheel "
            "calibrate"
        )


def is_virtual(setup: DriveSetup) -> bool:
    """Whether a virtual driver's hands hold the wheel, and no person's."""
    return held_by(setup.wheel) == "virtual"


@lru_cache(maxsize=64)
def drive_parameters(setup: DriveSetup) -> LoopParameters[Any]:
    """Parameters of the loop: the trial's, with arms of average people.

    Raises:
        ValueError: If the trial cannot be run.
    """
    return loop_parameters(
        setup.trial._replace(
            plant_steps=PLANT_STEPS,
            driver=DriverParameters(),
        )
    )


def offered_methods(setup: DriveSetup) -> dict[str, str]:
    """Methods that an experimenter can choose from: name, and where each is.

    The method of the drive, the paper's, and none.

    Raises:
        ValueError: If the drive's method is an object that no other process can find.
    """
    place = setup.trial.method
    if not isinstance(place, str):
        raise ValueError(
            f"a drive runs in processes of its own; give method {place.name} by its "
            "name, as module:object or as a file"
        )
    return {method_named(each).name: each for each in (place, IBHS.name, MANUAL.name)}


def drive_method(setup: DriveSetup) -> AnyMethod:
    """The method whose functions the loop of a drive calls."""
    return trial_method(setup.trial)


def drive_columns(setup: DriveSetup) -> tuple[Column, ...]:
    """What the method of a drive adds to its record, and then its scenario.

    Those of the method are empty while another one runs.
    """
    own = (
        each._replace(nullable=each.kind in ("int8", "bool"))
        for each in method_named(setup.trial.method).columns
    )
    return (*own, *car_columns(num_cars(drive_parameters(setup).fleet)))


def under(setup: DriveSetup, condition: str, method: str) -> DriveSetup:
    """The drive under another condition and one of the methods on offer.

    Raises:
        ValueError: If one of them is not known.
    """
    places = offered_methods(setup)
    if method not in places:
        raise ValueError(
            f"method '{method}' is not known to this drive; choose one of "
            f"{', '.join(places)}"
        )
    trial = setup.trial._replace(
        condition=condition_named(condition).name, method=places[method]
    )
    return setup._replace(trial=trial)


def leader_draws(setup: DriveSetup) -> NDArray[np.float64]:
    """A draw in [0, 1) for each leader's speed, by seed and participant."""
    trial = setup.trial
    entropy = [trial.seed, _LEADER_STREAM, trial.participant]
    generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(entropy)))
    return generator.random(64)
