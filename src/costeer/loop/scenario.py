"""What a trial is asked to be, checked, and the parameters that follow from it."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from costeer.base.array import Real
from costeer.drivers.checked import drawn_parameters
from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import AnyDriver
from costeer.drivers.interface import Draw as DriverDraw
from costeer.drivers.learning import PRACTICE
from costeer.drivers.population import PILOT_SEED as PILOT_SEED
from costeer.drivers.population import (
    VIRTUAL,
    hands_off,
    participant_driver,
    population_of,
)
from costeer.drivers.population import check_study_seed as check_study_seed
from costeer.drivers.registry import HANDS_OFF, driver_named
from costeer.intention.predictors.chosen import Judge
from costeer.intention.predictors.interface import Predictor
from costeer.intention.predictors.registry import OURS
from costeer.loop.overrides import built, shared_values
from costeer.loop.parameters import LoopParameters, StartParameters
from costeer.loop.roads import check_lanes, check_road
from costeer.loop.tick import (
    INTENTION_NETWORK,
    INTENTION_OFF,
    INTENTION_SCRIPTED,
    PREDICTION_HORIZON,
)
from costeer.methods.conditions import Condition, completed
from costeer.methods.manual import MANUAL
from costeer.methods.registry import AnyMethod, method_named
from costeer.plant.parameters import (
    CARS,
    CarParameters,
    ColumnParameters,
)
from costeer.scenarios.definition import Scenario
from costeer.scenarios.mistakes import (
    Mistake,
    lacks_lane,
    parsed_mistakes,
    values_of,
    wrong_in,
)
from costeer.scenarios.reading import scenario_named
from costeer.scenarios.world import Draw, fleet_on, world_of

INTENTIONS = {
    "off": INTENTION_OFF,
    "scripted": INTENTION_SCRIPTED,
    "network": INTENTION_NETWORK,
}
"""Where the crossing probability comes from, by name."""


class TrialSetup(NamedTuple):
    """One trial, in full: the same setup gives the same record.

    Attributes:
        participant: Number of the driver in the population.
        seed: Of the population and of all noise.
        condition: Name; it picks the noise, is written into the record, and says what
            is NaN of the next two. Another name than those of Table IV needs a
            strength.
        strength_factor: 1 strong, 0.4 weak, 0 without torque; NaN: as the condition
            says [-].
        change_duration: Of the system's lane changes; NaN: as the condition says, in
            manual none [s].
        method: The method, its name, or where it is (`methods.registry`).
        length: Of the course [m].
        speed: That the trial starts with and the driver prefers [m/s].
        car: Name of the car, or its parameters.
        driver: "virtual" or another population of costeer's, "hands-off", the
            parameters of a virtual driver, or a driver model, its name or where it is
            (`drivers.registry`).
        intention: "network", "scripted" (a perfect predictor of the driver's own
            plan) or "off".
        predictor: What predicts a crossing where the intention is "network": the
            network itself ("gru"), another predictor by name or place, or a function
            of windows (`intention.predictors.chosen`).
        weights: File of the predictor's numbers; the shipped ones if None.
        exact_network: The exact window gives every verdict, even if the network has
            passed the check of its cheaper form (`loop.network`).
        trigger_times: When the system starts a lane change whatever the driver wants
            [s].
        events: Whether leaders appear.
        initial_offset: From the lane's centre at the start [m].
        plant_steps: Plant steps in a control step.
        prediction_horizon: Of the scripted intention, g of Eq. (2) [s].
        follows_plan: The system's lane changes begin and last as this driver plans
            each one; for pilot runs in which nobody disagrees.
        abandoned_share: Share of lane changes that the driver gives up on the way [-].
        wander_factor: The driver's wander in the lane is so much larger than that of
            the population [-].
        guided_before: Driving with guidance before this trial, from which a virtual
            driver has learnt [s]; by itself that of the practice.
        parameters: Dotted names of parameters and the values they are given, as
            `("guidance.lateral_error_gain", 3.0)`; see `costeer parameters`.
        scenario: Road, other cars and events: a name, a file or itself
            (`scenarios.reading`).
        mistakes: What goes wrong on purpose besides what the scenario says:
            `late-trigger` or `late-trigger=0.8` (`scenarios.mistakes`).
    """

    participant: int = 1
    seed: int = 1
    condition: str = "manual"
    strength_factor: Real = math.nan
    change_duration: Real = math.nan
    method: str | AnyMethod = "ibhs"
    length: Real = 8000.0
    speed: Real = 70.0 / 3.6
    car: str | CarParameters = "default"
    driver: str | DriverParameters | AnyDriver = "virtual"
    intention: str = "network"
    predictor: str | Predictor | Judge = OURS
    weights: str | None = None
    exact_network: bool = False
    trigger_times: tuple[Real, ...] = ()
    events: bool = True
    initial_offset: Real = 0.0
    plant_steps: int = 8
    prediction_horizon: Real = PREDICTION_HORIZON
    follows_plan: bool = False
    abandoned_share: Real = 0.0
    wander_factor: Real = 1.0
    guided_before: Real = PRACTICE
    parameters: tuple[tuple[str, Real], ...] = ()
    scenario: str | Scenario = "expressway"
    mistakes: tuple[str, ...] = ()


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
    "length": _Range(100.0, 200_000.0, "m"),
    "speed": _Range(SLOWEST, FASTEST, "m/s"),
    "initial_offset": _Range(-1.5, 1.5, "m"),
    "prediction_horizon": _Range(0.1, 10.0, "s"),
    "participant": _Range(1, 10_000_000, "-"),
    "seed": _Range(0, 2**63 - 1, "-"),
    "plant_steps": _Range(4, 64, "-"),
    "abandoned_share": _Range(0.0, 1.0, "-"),
    "wander_factor": _Range(0.0, 5.0, "-"),
    "guided_before": _Range(0.0, 1e6, "s"),
}


_WHOLE = ("participant", "seed", "plant_steps")


def check_setup(setup: TrialSetup) -> None:
    """Refuse a setup that cannot be run.

    Raises:
        ValueError: Naming the value, the range and the way out.
    """
    for name, allowed in _RANGES.items():
        value = getattr(setup, name)
        kind = int if name in _WHOLE else (int, float)
        if not isinstance(value, kind) or isinstance(value, bool):
            what = "a whole number" if name in _WHOLE else "a number"
            raise ValueError(f"{name} is {value!r}; give {what}")
        if not allowed.low <= value <= allowed.high:
            raise ValueError(_out_of_range(name, value, allowed))
    if not isinstance(setup.car, CarParameters):
        _check_choice("car", setup.car, tuple(CARS))
    trial_driver_model(setup)
    _check_choice("intention", setup.intention, tuple(INTENTIONS))
    trial_condition(setup)
    method_named(setup.method)
    for name in ("events", "exact_network"):
        if not isinstance(given := getattr(setup, name), bool):
            raise ValueError(f"{name} is {given!r}; give True or False")
    for time in setup.trigger_times:
        if not (math.isfinite(time) and time >= 0.0):
            raise ValueError(
                f"trigger time {time} is not possible; give seconds from the start, "
                "0 or more"
            )


def _out_of_range(name: str, value: Real, allowed: _Range) -> str:
    low, high, unit = allowed
    if name == "speed":
        return (
            f"speed is {value:.4g} m/s ({value * 3.6:.4g} km/h); give a number from "
            f"{low:g} to {high:g} m/s ({low * 3.6:.4g} to {high * 3.6:.4g} km/h), or "
            "70km/h on the command line"
        )
    told = f"{name} is {value}; give a number from {low} to {high} {unit}"
    return told.removesuffix(" -")


def _check_choice(name: str, value: str, choices: tuple[str, ...]) -> None:
    if value not in choices:
        known = ", ".join(choices)
        raise ValueError(f"{name} '{value}' is not known; choose one of {known}")


def trial_condition(setup: TrialSetup) -> Condition:
    """Strength and duration of a trial: as its condition says, or as it says itself.

    Raises:
        ValueError: If the condition is not known and no strength given, or a value is
            out of range.
    """
    return completed(setup.condition, setup.strength_factor, setup.change_duration)


def trial_method(setup: TrialSetup) -> AnyMethod:
    """The method of a trial; in a condition without strength nothing assists."""
    method = method_named(setup.method)
    return method if trial_condition(setup).strength_factor > 0.0 else MANUAL


def is_assisted(setup: TrialSetup) -> bool:
    """Whether the guidance gives torque in this trial."""
    return trial_method(setup).assists


def trial_car(setup: TrialSetup) -> CarParameters:
    """The car of a trial."""
    return CARS[setup.car] if isinstance(setup.car, str) else setup.car


def trial_driver_model(setup: TrialSetup) -> AnyDriver:
    """Who holds the wheel in a trial; all populations of costeer are one model.

    Raises:
        ValueError: If there is no such driver.
    """
    if isinstance(setup.driver, DriverParameters):
        return VIRTUAL
    model = driver_named(setup.driver)
    return VIRTUAL if population_of(model) else model


def trial_driver(setup: TrialSetup) -> Any:  # Any: parameters of the model's own
    """Parameters of a trial's driver, drawn by seed and participant.

    Raises:
        ValueError: If there is no such driver.
    """
    if isinstance(setup.driver, DriverParameters):
        return setup.driver
    if setup.driver == HANDS_OFF:
        return hands_off(setup.speed)
    model = driver_named(setup.driver)
    population = population_of(model)
    if population is None:
        _check_unused(setup, model)
        draw = DriverDraw(setup.seed, setup.participant, setup.speed, trial_car(setup))
        return drawn_parameters(model, draw)
    drawn = participant_driver(setup.seed, setup.participant, setup.speed, population)
    aim, decides, knows = drawn.tracking, drawn.decision, drawn.learning
    wander = aim.wander_deviation * setup.wander_factor
    return drawn._replace(
        learning=knows._replace(before=setup.guided_before),
        tracking=aim._replace(wander_deviation=wander),
        decision=decides._replace(abandoned_share=setup.abandoned_share),
    )


def _check_unused(setup: TrialSetup, model: AnyDriver) -> None:
    """Refuse what only a virtual driver has.

    Raises:
        ValueError: Naming it.
    """
    for name in ("abandoned_share", "wander_factor"):
        if getattr(setup, name) != TrialSetup._field_defaults[name]:
            raise ValueError(
                f"{name} is {getattr(setup, name)}; driver model '{model.name}' has no "
                "such thing, leave it out"
            )


def trial_mistakes(setup: TrialSetup) -> tuple[Mistake, ...]:
    """What goes wrong on purpose: of the scenario, and of the setup.

    Raises:
        ValueError: If one is not known, out of range, or stands twice.
    """
    scenario = scenario_named(setup.scenario)
    mistakes = scenario.mistakes + parsed_mistakes(setup.mistakes)
    impossible = (lacks_lane(each, scenario.road.lanes) for each in mistakes)
    for text in (*(told for _, told in wrong_in(mistakes)), *filter(None, impossible)):
        raise ValueError(text)
    return mistakes


def _wrong_values(setup: TrialSetup) -> dict[str, Real]:
    """What the mistakes set by name.

    Raises:
        ValueError: If the driver has no such parameter.
    """
    values = values_of(trial_mistakes(setup))
    virtual = trial_driver_model(setup) is VIRTUAL or setup.driver == HANDS_OFF
    for mistake in () if virtual else trial_mistakes(setup):
        if any(name.startswith("driver.") for name in values_of([mistake])):
            raise ValueError(
                f"mistake {mistake.kind} is one of costeer's virtual drivers; leave it "
                "out with another driver"
            )
    return values


def loop_parameters(setup: TrialSetup) -> LoopParameters[Any]:
    """All parameters of a trial.

    What the setup changes of car, column and road the method knows of; what it changes
    of the method itself comes last.

    Raises:
        ValueError: If the setup cannot be run.
    """
    check_setup(setup)
    scenario = scenario_named(setup.scenario, setup.speed)
    car = trial_car(setup)
    draw = Draw(setup.seed, setup.participant, setup.length, car)
    around = world_of(scenario, draw)
    world = LoopParameters(
        controller=0.0,
        car=car,
        column=ColumnParameters(),
        road=around.road,
        traffic=around.traffic,
        alignment=around.alignment,
        fleet=around.fleet,
        stretches=around.stretches,
        driver=trial_driver(setup),
        start=StartParameters(
            speed=setup.speed,
            lateral_offset=setup.initial_offset,
            events=1.0 if setup.events else 0.0,
        ),
        follows_plan=1.0 if setup.follows_plan else 0.0,
        plant_steps=setup.plant_steps,
    )
    chosen, driven = method_named(setup.method), trial_method(setup)
    condition = trial_condition(setup)
    values = _wrong_values(setup) | dict(setup.parameters)
    parameters = built(world, chosen, condition, values)
    check_road(parameters.road)
    check_lanes(parameters.road, scenario)
    if (parameters.car, parameters.road) != (car, around.road):
        draw = draw._replace(car=parameters.car)
        fleet = fleet_on(scenario, draw, parameters.road)
        world, parameters = (each._replace(fleet=fleet) for each in (world, parameters))
    if driven is chosen:
        return parameters
    # Manual driving has no parameters of a method from outside; the names are right.
    return built(world, driven, condition, shared_values(world, driven, values))
