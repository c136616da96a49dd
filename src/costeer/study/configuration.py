"""What a study is: its settings, everything that determines its results, their hash.

Two runs with the same hash give the same bytes on the same machine. How many jobs
run at once and whether a report is written are not part of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from typing import Any, NamedTuple

from costeer.base.described import described
from costeer.base.entry import simulation_source
from costeer.controller.step import ControllerParameters
from costeer.drivers.checked import checked_driver
from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import DriverModel, driver_sources
from costeer.drivers.registry import driver_named
from costeer.intention.predictors.chosen import Judge, chosen_predictor
from costeer.intention.predictors.interface import Predictor
from costeer.intention.predictors.registry import OURS
from costeer.loop.inputs import Driver, car_of, driver_of
from costeer.loop.scenario import (
    TrialSetup,
    check_setup,
    check_study_seed,
    loop_parameters,
)
from costeer.loop.trial import trial_predictor
from costeer.methods.conditions import (
    CONDITION_NAMES,
    check_conditions,
)
from costeer.methods.interface import method_sources
from costeer.methods.registry import AnyMethod, method_named
from costeer.plant.parameters import CarParameters
from costeer.scenarios.definition import Scenario
from costeer.scenarios.reading import checked, scenario_named, scenario_of, shipped
from costeer.scenarios.writing import plain
from costeer.study.changes import PUBLISHED_SCENARIO
from costeer.study.design import Trial, guided_before, plan_trials
from costeer.study.plain import (
    plain_count,
    plain_number,
    plain_part,
    plain_text,
    plain_values,
)

MOST_PARTICIPANTS = 100_000
LARGEST_SEED = 2**63 - 1


class StudySettings(NamedTuple):
    """What the user of `costeer study` decides.

    Attributes:
        participants: How many virtual drivers. Source: Sec. III-A, twelve.
        conditions: Names of the conditions driven by each. Source: Table IV.
        seed: Of drivers, leaders and noise.
        method: Guidance of the assisted trials.
        intention: `network`, or `scripted`: the driver's decision is known.
        length: Of the course [m]. Source: Sec. III-B, 8 km.
        speed: Suggested to the driver [m/s]. Source: Sec. III-B, about 70 km/h.
        car: Name of the car, a YAML file of one, or its parameters.
        predictor: What reads the intention: its name, where it is, or itself.
        weights: File of its numbers; empty for those that ship.
        drivers: Drivers or their files, who take turns; none: the population.
        parameters: Dotted names of parameters and the values they are given.
        scenario: Road, other cars and events: a name, a YAML file, or itself.
        mistakes: Made on purpose besides those of the scenario, as `latency=0.05`.
        exact_network: The exact window gives every verdict, see `TrialSetup`.
    """

    participants: int = 12
    conditions: tuple[str, ...] = CONDITION_NAMES
    seed: int = 1
    method: str | AnyMethod = "ibhs"
    intention: str = "network"
    length: float = 8000.0
    speed: float = 70 / 3.6
    car: str | CarParameters = "default"
    predictor: str | Predictor | Judge = OURS
    weights: str = ""
    drivers: tuple[str | Driver, ...] = ()
    parameters: tuple[tuple[str, float], ...] = ()
    scenario: str | Scenario = PUBLISHED_SCENARIO
    mistakes: tuple[str, ...] = ()
    exact_network: bool = False


PUBLISHED_STUDY = StudySettings()
"""The experiment of Sec. III."""

INTENTIONS = ("network", "scripted")
"""Where a study's crossing probability comes from."""


def check_settings(settings: StudySettings) -> StudySettings:
    """Return the settings with conditions in the order of Table IV, in plain numbers.

    Raises:
        ValueError: Naming the first value out of range, the range and the way out.
    """
    known_settings = _checked_plan(_plain_settings(settings))
    for trial in plan_trials(1, known_settings.conditions):
        check_setup(trial_setup(known_settings, trial))
        loop_parameters(trial_setup(known_settings, trial))
    trial_predictor(
        trial_setup(known_settings, plan_trials(1, (CONDITION_NAMES[1],))[0])
    )
    return known_settings


def _plain_settings(settings: StudySettings) -> StudySettings:
    """The settings in Python's own numbers: 500 and 500.0 are the same study.

    Raises:
        ValueError: If one is of a kind that it cannot be.
    """
    return settings._replace(
        participants=plain_count(settings.participants),
        seed=plain_count(settings.seed),
        length=plain_number("length", settings.length, "m"),
        speed=plain_number("speed", settings.speed, "m/s"),
        weights=plain_text("weights", settings.weights),
        car=plain_part("car", settings.car, CarParameters),
        drivers=tuple(map(_plain_driver, settings.drivers)),
        mistakes=tuple(map(str, settings.mistakes)),
        parameters=plain_values(settings.parameters),
        scenario=_plain_scenario(settings.scenario),
    )


def _checked_plan(settings: StudySettings) -> StudySettings:
    """The settings, as far as they can be judged without what is plugged in.

    Raises:
        ValueError: Naming the first value out of range.
    """
    check_count("participants", settings.participants, 1, MOST_PARTICIPANTS)
    check_count("seed", settings.seed, 0, LARGEST_SEED)
    check_study_seed(settings.seed)
    if settings.intention not in INTENTIONS:
        known = ", ".join(INTENTIONS)
        raise ValueError(
            f"intention {settings.intention!r} is not known; choose one of {known}"
        )
    return settings._replace(conditions=check_conditions(settings.conditions))


def check_count(name: str, value: int, least: int, most: int) -> None:
    """Refuse a number that is not whole or not in the range."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"{name} must be a whole number, not {value!r}")
    if not least <= value <= most:
        raise ValueError(f"{name} is {value}; give a whole number {least} to {most}")


def trial_setup(settings: StudySettings, trial: Trial) -> TrialSetup:
    """Return how to simulate one trial of the study."""
    return TrialSetup(
        participant=trial.participant,
        seed=settings.seed,
        condition=trial.condition,
        method=settings.method,
        length=settings.length,
        speed=settings.speed,
        car=_car(settings.car),
        driver=_driver(settings.drivers, trial.participant),
        intention=settings.intention,
        predictor=settings.predictor,
        weights=settings.weights or None,
        exact_network=settings.exact_network,
        parameters=settings.parameters,
        scenario=settings.scenario,
        mistakes=settings.mistakes,
        guided_before=guided_before(
            trial, settings.conditions, settings.length / max(settings.speed, 1.0)
        ),
    )


def with_files_read(settings: StudySettings) -> StudySettings:
    """The settings with car, drivers and scenario as they are in their files now.

    Raises:
        ValueError: If a file holds what it cannot.
        OSError: If it cannot be read.
    """
    return settings._replace(
        car=_car(settings.car),
        drivers=tuple(map(driver_of, settings.drivers)),
        scenario=_read_scenario(settings.scenario),
    )


def _car(car: str | CarParameters) -> str | CarParameters:
    return car_of(car) if isinstance(car, str) else car


def _plain_driver(driver: str | Driver) -> str | Driver:
    """A driver model as it is, parameters in plain numbers.

    Raises:
        ValueError: If it is neither.
    """
    if isinstance(driver, DriverModel):
        return checked_driver(driver)
    return plain_part("driver", driver, DriverParameters)


def _plain_scenario(scenario: str | Scenario) -> str | Scenario:
    """A name or file as it is; a scenario if it can be.

    Raises:
        ValueError: If it is neither.
    """
    if isinstance(scenario, str):
        return scenario
    if not isinstance(scenario, Scenario):
        raise ValueError(
            f"scenario is {scenario!r}; give a name, a file NAME.yaml, or Scenario"
        )
    return checked(scenario)


def _read_scenario(scenario: str | Scenario) -> str | Scenario:
    """A scenario of a file as it is there now; a name of one that ships as it is."""
    return scenario if scenario in shipped() else scenario_named(scenario)


def _driver(drivers: tuple[str | Driver, ...], participant: int) -> str | Driver:
    """Who drives as a participant: of the population, or one driver after another."""
    if not drivers:
        return "virtual"
    return driver_of(drivers[(participant - 1) % len(drivers)])


def study_configuration(settings: StudySettings) -> dict[str, object]:
    """Return everything that determines the results, as plain JSON values.

    Raises:
        ValueError: If the shipped network is damaged.
        OSError: If it cannot be read.
    """
    method = method_named(settings.method)
    given = settings._asdict()
    if not settings.exact_network:
        del given["exact_network"]
    del given["scenario"], given["mistakes"]  # told below, if unusual
    given |= {
        "method": settings.method if isinstance(settings.method, str) else method.name,
        "conditions": list(settings.conditions),
        "car": _named(settings.car),
        "predictor": _predictor_name(settings.predictor),
        "drivers": [_named(each) for each in settings.drivers],
        "parameters": dict(settings.parameters),
    }
    return {
        "costeer_version": version("costeer"),
        "simulation_source": simulation_source(),
        **given,
        **_plugged_in(settings, method),
        **_scenario(settings),
        **_thresholds(),
        "order": driving_order(settings),
    }


def _scenario(settings: StudySettings) -> dict[str, object]:
    """The scenario by name or file, what is in it, and mistakes made besides."""
    told: dict[str, object] = {}
    if settings.mistakes:
        told["mistakes"] = list(settings.mistakes)
    if (given := settings.scenario) != PUBLISHED_SCENARIO:
        told["scenario"] = given if isinstance(given, str) else OWN
        told["scenario_content"] = plain(scenario_named(given))
    return told


def _named(part: str | CarParameters | Driver) -> str:
    """A name or file; of parameters only that they are, their values stand apart."""
    if isinstance(part, DriverModel):
        return part.name
    return part if isinstance(part, str) else OWN


def _predictor_name(predictor: str | Predictor | Judge) -> str:
    return predictor if isinstance(predictor, str) else chosen_predictor(predictor).name


OWN = "own"
"""A car or driver given as an object."""


def _plugged_in(settings: StudySettings, method: AnyMethod) -> dict[str, object]:
    """What came from outside costeer, so that its results can be told from others."""
    setup = trial_setup(settings, Trial(1, CONDITION_NAMES[1], 1))
    predictor = trial_predictor(setup)
    car = setup.car
    return {
        "method_name": method.name,
        "method_version": method.version,
        "method_source_hash": method_sources(method),
        "intention_model_hash": None if predictor is None else predictor.hash,
        "car_parameters": None if isinstance(car, str) else car._asdict(),
        "driver_parameters": [_told(driver_of(each)) for each in settings.drivers],
    }


def _told(driver: str | Driver) -> dict[str, object]:
    """What decides what a driver does: parameters, or a model's version and sources."""
    if isinstance(driver, str):
        return {"name": driver, "version": driver_named(driver).version}
    if isinstance(driver, DriverModel):
        return {
            "name": driver.name,
            "version": driver.version,
            "source_hash": driver_sources(driver),
        }
    return {each.name: each.value for each in described(driver)}


def differences(configuration: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """What a study has other than the published one: name, value, published value.

    Args:
        configuration: Of a study's folder.
    """
    told = []
    for name, usual in PUBLISHED_STUDY._asdict().items():
        value = configuration.get(name, usual)
        if name in ("seed", "participants") or _plain(value) == _plain(usual):
            continue
        if name == "parameters":
            told += [(each, f"{number:g}", "") for each, number in value.items()]
        else:
            told.append((name, _plain(value), _plain(usual)))
    return told


def _plain(value: object) -> str:
    """A setting in words; a list and a tuple of the same are the same."""
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {number:g}" for name, number in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(str, value))
    return f"{value:g}" if isinstance(value, float) else str(value)


def _thresholds() -> dict[str, object]:
    """Name the thresholds of the guidance that a reader looks for first."""
    parameters = ControllerParameters()
    return {
        "inconsistency_threshold": parameters.consistency.inconsistency_threshold,
        "replan_gain": parameters.replanning.replan_gain,
        "torque_limit": parameters.actuation.torque_limit,
    }


def settings_of(configuration: dict[str, Any]) -> StudySettings:
    """Return the settings in a configuration that was read from a file.

    Raises:
        ValueError: If one is missing or out of range.
    """
    usual = PUBLISHED_STUDY._asdict()
    missing = [name for name in _FIRST_SETTINGS if name not in configuration]
    if missing:
        raise ValueError(f"the configuration lacks {', '.join(missing)}")
    # Any: each setting has a type of its own.
    chosen: dict[str, Any] = {n: configuration.get(n, usual[n]) for n in usual}
    chosen |= {n: tuple(chosen[n]) for n in ("drivers", "mistakes")}
    if "scenario_content" in configuration:
        chosen["scenario"] = scenario_of(configuration["scenario_content"])
    chosen["parameters"] = tuple(dict(chosen["parameters"]).items())
    return _checked_plan(StudySettings(**chosen))


_FIRST_SETTINGS = StudySettings._fields[:8]
"""What every study has said, also before there were plug-ins."""


def driving_order(settings: StudySettings) -> list[list[str]]:
    """Return the conditions of each participant in the order driven."""
    order: list[list[str]] = [[] for _ in range(settings.participants)]
    for trial in plan_trials(settings.participants, settings.conditions):
        order[trial.participant - 1].append(trial.condition)
    return order
