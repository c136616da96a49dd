"""What a trial is asked to be, checked, and the parameters that follow from it."""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.base.array import Real
from costeer.controller.actuation import ActuationParameters
from costeer.controller.consistency import ConsistencyParameters
from costeer.controller.guidance import GuidanceParameters
from costeer.controller.step import ControllerParameters
from costeer.controller.trajectory import TrajectoryParameters
from costeer.drivers.driver import DriverParameters
from costeer.drivers.population import hands_off, participant_driver
from costeer.loop.rollout import (
    INTENTION_NETWORK,
    INTENTION_OFF,
    INTENTION_SCRIPTED,
    PREDICTION_HORIZON,
)
from costeer.loop.step import LoopParameters, StartParameters
from costeer.methods.registry import method_named
from costeer.plant.parameters import (
    CARS,
    CarParameters,
    ColumnParameters,
    RoadParameters,
)

INTENTIONS = {
    "off": INTENTION_OFF,
    "scripted": INTENTION_SCRIPTED,
    "network": INTENTION_NETWORK,
}
"""Where the crossing probability comes from, by name."""

DRIVERS = ("virtual", "hands-off")
"""Who holds the wheel."""

PILOT_SEED = 900_001
"""Seed of the pilot drivers that set the inconsistency threshold δ."""

SLIP_ANGLE_GAIN_SHARE = 0.45
"""K_alpha over the car's self-aligning stiffness [-]."""


class TrialSetup(NamedTuple):
    """One trial, in full: the same setup gives the same record.

    Attributes:
        participant: Number of the driver in the population.
        seed: Of the population and of all noise.
        condition: Name; it picks the noise and is written into the record.
        strength_factor: 1 strong, 0.4 weak, 0 without torque [-].
        change_duration: Of the system's lane changes [s]; NaN in manual.
        method: Name of the method.
        length: Of the course [m].
        speed: That the trial starts with and the driver prefers [m/s].
        car: Name of the car.
        driver: "virtual" or "hands-off".
        intention: "network", "scripted" (a perfect predictor of the driver's own
            plan) or "off".
        trigger_times: When the system starts a lane change whatever the driver wants
            [s].
        events: Whether leaders appear.
        initial_offset: From the lane's centre at the start [m].
        plant_steps: Plant steps in a control step.
        hold_time: Of the verdict of Table III [s].
        look_ahead: Take the path at the preview point, the other reading of Fig. 4.
        inconsistency_threshold: δ [W].
        prediction_horizon: Of the scripted intention, g of Eq. (2) [s].
        follows_plan: The system's lane changes begin and last as this driver plans
            each one; for pilot runs in which nobody disagrees.
        abandoned_share: Share of lane changes that the driver gives up on the way [-].
        wander_factor: The driver's wander in the lane is so much larger than that of
            the population [-].
    """

    participant: int = 1
    seed: int = 1
    condition: str = "manual"
    strength_factor: Real = 0.0
    change_duration: Real = 6.0
    method: str = "ibhs"
    length: Real = 8000.0
    speed: Real = 70.0 / 3.6
    car: str = "default"
    driver: str = "virtual"
    intention: str = "network"
    trigger_times: tuple[Real, ...] = ()
    events: bool = True
    initial_offset: Real = 0.0
    plant_steps: int = 8
    hold_time: Real = 0.0
    look_ahead: bool = False
    inconsistency_threshold: Real = ConsistencyParameters().inconsistency_threshold
    prediction_horizon: Real = PREDICTION_HORIZON
    follows_plan: bool = False
    abandoned_share: Real = 0.0
    wander_factor: Real = 1.0


SLOWEST = 12.0
"""Least speed of a trial [m/s]: below it some drivers cannot overtake."""

FASTEST = 31.0
"""Greatest speed of a trial [m/s]: the guidance is verified up to 110 km/h."""


class _Range(NamedTuple):
    """Smallest and largest value that is accepted, and the unit."""

    low: Real
    high: Real
    unit: str


_RANGES = {
    "strength_factor": _Range(0.0, 1.0, "-"),
    "length": _Range(100.0, 200_000.0, "m"),
    "speed": _Range(SLOWEST, FASTEST, "m/s"),
    "initial_offset": _Range(-1.5, 1.5, "m"),
    "hold_time": _Range(0.0, 10.0, "s"),
    "inconsistency_threshold": _Range(0.0, 100.0, "W"),
    "prediction_horizon": _Range(0.1, 10.0, "s"),
    "participant": _Range(0, 10_000_000, "-"),
    "seed": _Range(0, 2**63 - 1, "-"),
    "plant_steps": _Range(4, 64, "-"),
    "abandoned_share": _Range(0.0, 1.0, "-"),
    "wander_factor": _Range(0.0, 5.0, "-"),
}


def check_setup(setup: TrialSetup) -> None:
    """Refuse a setup that cannot be run.

    Raises:
        ValueError: Naming the value, the range and the way out.
    """
    for name, allowed in _RANGES.items():
        value = getattr(setup, name)
        if not allowed.low <= value <= allowed.high:
            raise ValueError(
                f"{name} is {value}; give a number from {allowed.low} to "
                f"{allowed.high} {allowed.unit}".removesuffix(" -")
                + (", or 70km/h on the command line" if name == "speed" else "")
            )
    _check_choice("car", setup.car, tuple(CARS))
    _check_choice("driver", setup.driver, DRIVERS)
    _check_choice("intention", setup.intention, tuple(INTENTIONS))
    method_named(setup.method)
    manual = setup.strength_factor == 0.0 and math.isnan(setup.change_duration)
    if not manual and not 1.0 <= setup.change_duration <= 30.0:
        raise ValueError(
            f"change_duration is {setup.change_duration}; give a number from 1 to 30 s"
        )
    for time in setup.trigger_times:
        if not (math.isfinite(time) and time >= 0.0):
            raise ValueError(
                f"trigger time {time} is not possible; give seconds from the start, "
                "0 or more"
            )


def check_study_seed(seed: int) -> None:
    """Refuse the pilot drivers as participants: δ was tuned on them.

    Raises:
        ValueError: If it is their seed.
    """
    if seed == PILOT_SEED:
        raise ValueError(
            f"seed {seed} is that of the pilot drivers, on whom the inconsistency "
            "threshold was set; give another seed"
        )


def _check_choice(name: str, value: str, choices: tuple[str, ...]) -> None:
    if value not in choices:
        known = ", ".join(choices)
        raise ValueError(f"{name} '{value}' is not known; choose one of {known}")


def is_assisted(setup: TrialSetup) -> bool:
    """Whether the guidance gives torque in this trial."""
    return method_named(setup.method).assists and setup.strength_factor > 0.0


def trial_driver(setup: TrialSetup) -> DriverParameters:
    """The driver of a trial, drawn from the population by seed and participant."""
    if setup.driver == "hands-off":
        return hands_off(setup.speed)
    drawn = participant_driver(setup.seed, setup.participant, setup.speed)
    aim, decides = drawn.tracking, drawn.decision
    wander = aim.wander_deviation * setup.wander_factor
    return drawn._replace(
        tracking=aim._replace(wander_deviation=wander),
        decision=decides._replace(abandoned_share=setup.abandoned_share),
    )


def controller_parameters(
    setup: TrialSetup, car: CarParameters
) -> ControllerParameters:
    """The controller of a trial; it knows the car's nominal parameters."""
    defaults = ControllerParameters()
    duration = setup.change_duration
    planned = 6.0 if math.isnan(duration) else duration
    strength = setup.strength_factor if is_assisted(setup) else 0.0
    gain = SLIP_ANGLE_GAIN_SHARE * car.aligning_stiffness
    return defaults._replace(
        car=car,
        trajectory=TrajectoryParameters(change_duration=planned),
        preview=defaults.preview._replace(look_ahead=setup.look_ahead),
        guidance=GuidanceParameters(slip_angle_gain=gain),
        consistency=ConsistencyParameters(
            inconsistency_threshold=setup.inconsistency_threshold,
            hold_time=setup.hold_time,
        ),
        actuation=ActuationParameters(strength_factor=strength),
    )


def loop_parameters(setup: TrialSetup) -> LoopParameters:
    """All parameters of a trial.

    Raises:
        ValueError: If the setup cannot be run.
    """
    check_setup(setup)
    car = CARS[setup.car]
    return LoopParameters(
        car=car,
        column=ColumnParameters(),
        road=RoadParameters(length=setup.length),
        controller=controller_parameters(setup, car),
        driver=trial_driver(setup),
        start=StartParameters(
            speed=setup.speed,
            lateral_offset=setup.initial_offset,
            events=1.0 if setup.events else 0.0,
        ),
        follows_plan=1.0 if setup.follows_plan else 0.0,
        plant_steps=setup.plant_steps,
    )
