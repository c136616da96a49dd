"""Trials, studies and records, with the options of the commands of these names.

Objects, names and files do alike where something is plugged in.
"""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from costeer.api.recordings import File, by_name
from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import DriverModel
from costeer.drivers.learning import PRACTICE
from costeer.intention.predictors.chosen import Judge
from costeer.intention.predictors.interface import Predictor
from costeer.intention.predictors.registry import OURS
from costeer.loop.inputs import car_of, driver_of
from costeer.loop.overrides import METHOD, parameter_list
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.tick import PREDICTION_HORIZON
from costeer.loop.trial import simulate_trial
from costeer.methods.conditions import CONDITION_NAMES, parse_conditions
from costeer.methods.registry import AnyMethod
from costeer.plant.parameters import CarParameters
from costeer.records.columns import TrialRecord
from costeer.scale.shard import WHOLE, parse_shard
from costeer.scenarios.definition import Scenario
from costeer.scenarios.reading import chosen
from costeer.scenarios.unmet import unmet
from costeer.study.configuration import StudySettings
from costeer.study.run import Scale, StudyOutcome, full_report, run_study
from costeer.training.thresholds import with_threshold

if TYPE_CHECKING:
    from pandas import DataFrame

Drivers: TypeAlias = File | DriverParameters | DriverModel[Any, Any]

SUGGESTED_SPEED = 70.0 / 3.6
"""About 70 km/h, Sec. III-B [m/s]."""


def simulate(
    condition: str = "strong-normal",
    *,
    scenario: File | Scenario = "expressway",
    mistakes: Iterable[str] = (),
    length: float | None = None,
    seed: int = 1,
    participant: int = 1,
    intention: str = "network",
    method: File | AnyMethod = "ibhs",
    driver: Drivers = "virtual",
    parameters: Mapping[str, float] | None = None,
    predictor: File | Predictor | Judge = OURS,
    weights: File | None = None,
    exact_network: bool = False,
    car: File | CarParameters = "default",
    speed: float | None = None,
    strength_factor: float = math.nan,
    change_duration: float = math.nan,
    trigger_times: Iterable[float] = (),
    events: bool = True,
    initial_offset: float = 0.0,
    plant_steps: int = 8,
    prediction_horizon: float = PREDICTION_HORIZON,
    follows_plan: bool = False,
    abandoned_share: float = 0.0,
    wander_factor: float = 1.0,
    guided_before: float = PRACTICE,
    engine: str = "numba",
) -> TrialRecord:
    """Simulate one trial.

    Args:
        condition: Of Table IV, as "weak-gentle" or "manual"; another name needs a
            `strength_factor`.
        scenario: Road, other cars and events: a name of `costeer scenario list`, a
            file "NAME.yaml", or a `costeer.Scenario`.
        mistakes: Made on purpose, besides those of the scenario: names of `costeer
            scenario mistakes`, with = a size, as "late-trigger=0.8".
        length: Of the course; that of the scenario's road if None [m].
        seed: Of the population and of all noise.
        participant: Number of the driver in the population.
        intention: "network", "scripted" (the driver's own plan) or "off".
        method: A method, its name, "module:object" or "file.py".
        driver: "virtual" or another population, "hands-off", a driver, or the file of
            one, "NAME.yaml"; a driver model, its file or place; a record,
            "NAME.parquet", whose hands are replayed.
        parameters: Dotted names and numbers; `costeer.parameters()` lists them.
        predictor: Of crossings: its name or place, a `Predictor`, or a function from
            the last window, shape `(180, 6)`, to a probability.
        weights: File of the predictor's numbers, .npz or .onnx.
        exact_network: Take every verdict of the network from its exact window, even if
            it has passed the check of its cheaper form.
        car: "default", "compact", "large", parameters, or the file of one.
        speed: That the trial starts with and the driver prefers; the scenario's if
            None [m/s].
        strength_factor: On K_h of a condition of your own [-].
        change_duration: Of the system's lane changes in such a condition [s].
        trigger_times: When the system starts a lane change by itself [s].
        events: Whether leaders appear.
        initial_offset: From the lane's centre at the start [m].
        plant_steps: Plant steps in a control step.
        prediction_horizon: Of the scripted intention [s].
        follows_plan: The system changes lanes just as this driver plans to.
        abandoned_share: Share of lane changes that the driver gives up [-].
        wander_factor: On the driver's wander in the lane [-].
        guided_before: Driving with guidance before this trial, from which a virtual
            driver has learnt; by itself that of the practice [s].
        engine: "numba", "python" (slow, and can be debugged) or "jax".

    Returns:
        The record; the same arguments give the same bytes.

    Raises:
        ValueError: If a value cannot be, saying which, what can, and what may be meant.
        OSError: If a file cannot be read.

    Example:
        >>> import costeer
        >>> firm = {"guidance.lateral_error_gain": 3.0}
        >>> record = costeer.simulate("strong-rapid", length=300, parameters=firm)
        >>> record.columns["applied_torque"].shape == record.columns["time"].shape
        True
    """
    given = locals()
    course = chosen(by_name(scenario), length, speed)
    given |= {
        "scenario": course.scenario,
        "length": course.length,
        "speed": course.speed,
        "driver": driver_of(by_name(driver)),
        "car": _car(car),
        "method": by_name(method),
        "predictor": by_name(predictor),
        "weights": None if weights is None else os.fspath(weights),
        "parameters": _values(parameters, predictor, weights, method),
        "mistakes": (mistakes,) if isinstance(mistakes, str) else tuple(mistakes),
        "trigger_times": tuple(trigger_times),
    }
    setup = TrialSetup(**{name: given[name] for name in TrialSetup._fields})
    record = simulate_trial(setup, engine)
    for each in (*course.notes, *unmet(record)):
        warnings.warn(each, stacklevel=2)
    return record


def _values(
    given: Mapping[str, float] | None,
    predictor: object,
    weights: File | None,
    method: object,
) -> tuple[tuple[str, float], ...]:
    """Parameters, with the threshold that adapted weights bring along."""
    return tuple(with_threshold(given or {}, predictor, weights, method).items())


def _car(car: File | CarParameters) -> str | CarParameters:
    """A car, or the one of that name or in that file."""
    return car if isinstance(car, CarParameters) else car_of(os.fspath(car))


def study(
    out: File,
    *,
    participants: int = 12,
    conditions: str | Iterable[str] = CONDITION_NAMES,
    seed: int = 1,
    method: File | AnyMethod = "ibhs",
    intention: str = "network",
    scenario: File | Scenario = "expressway",
    mistakes: Iterable[str] = (),
    length: float | None = None,
    speed: float | None = None,
    car: File | CarParameters = "default",
    predictor: File | Predictor | Judge = OURS,
    weights: File | None = None,
    exact_network: bool = False,
    drivers: Drivers | Sequence[Drivers] = (),
    driver: Drivers | None = None,
    parameters: Mapping[str, float] | None = None,
    jobs: int | None = None,
    report: bool = True,
    cluster: str = "",
    records: bool = True,
    shard: str = "",
) -> StudyOutcome:
    """Run the experiment in a folder, or finish one that was begun there.

    Args:
        out: Folder; docs/study.md says what it will hold.
        participants: How many virtual drivers.
        conditions: Names of conditions, "all", or several in a text with commas.
        seed: Of drivers, leaders and noise.
        method: Guidance of the assisted trials: a method, its name or place.
        intention: "network", or "scripted": the driver's decision is known.
        scenario: Road, other cars and events: a name of `costeer scenario list`, a
            file "NAME.yaml", or a `costeer.Scenario`.
        mistakes: Made on purpose, besides those of the scenario: names of `costeer
            scenario mistakes`, with = a size, as "late-trigger=0.8".
        length: Of the course; that of the scenario's road if None [m].
        speed: Suggested to the drivers; the scenario's if None [m/s].
        car: "default", "compact", "large", parameters, or the file of one.
        predictor: What reads the intention: its name or place, a `Predictor`, or a
            function as for `simulate`; it is called in several threads.
        weights: File of its numbers, .npz or .onnx.
        exact_network: As for `simulate`.
        drivers: A driver or the file of one, or several who take turns; none: the
            population.
        driver: One driver for all, by the name that `simulate` has for it.
        parameters: Dotted names and numbers; `costeer.parameters()` lists them.
        jobs: Trials at the same time; as many as processors if None. The results do
            not depend on it.
        report: Tests, figures and `report.html` after the tables.
        cluster: "local:N" for N processes here, or the address of a Dask or Ray
            scheduler; docs/scale.md.
        records: Whether trial records are kept, or their measures alone.
        shard: Part of the trials, "I/N"; `costeer.study.merge.merge_study` puts the
            parts together.

    Raises:
        ValueError: If a setting cannot be, or the folder is another study's.
        OSError: If a file cannot be read or written; finished trials are kept.

    Example:
        >>> import costeer, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     done = costeer.study(
        ...         folder + "/pilot",
        ...         participants=1,
        ...         conditions=["manual", "weak-gentle"],
        ...         length=500,
        ...         report=False,
        ...     )
        >>> done.num_trials
        2
    """
    given = locals()
    course = chosen(by_name(scenario), length, speed)
    given |= {
        "scenario": by_name(scenario),
        "length": course.length,
        "speed": course.speed,
        "conditions": _conditions(conditions),
        "method": by_name(method),
        "car": by_name(car),
        "predictor": by_name(predictor),
        "weights": "" if weights is None else by_name(weights),
        "drivers": _several(drivers, driver),
        "parameters": _values(parameters, predictor, weights, method),
        "mistakes": (mistakes,) if isinstance(mistakes, str) else tuple(mistakes),
    }
    settings = StudySettings(**{name: given[name] for name in StudySettings._fields})
    made = full_report if report else None
    part = parse_shard(shard, os.environ) if shard else WHOLE
    scale = Scale(cluster, records, part)
    return run_study(os.fspath(out), settings, jobs=jobs, report=made, scale=scale)


def _conditions(given: str | Iterable[str]) -> tuple[str, ...]:
    """Names of conditions.

    Raises:
        ValueError: If they are none.
    """
    if isinstance(given, str):
        return parse_conditions(given)
    names = list(given) if isinstance(given, Iterable) else [given]
    if not all(isinstance(name, str) for name in names):
        raise ValueError(
            f"conditions is {given!r}; give names, as ['manual', 'weak-gentle']"
        )
    return parse_conditions(",".join(names))


def _several(
    drivers: Drivers | Sequence[Drivers], driver: Drivers | None
) -> tuple[str | DriverParameters | DriverModel[Any, Any], ...]:
    """The drivers of a study, whether one or several were given.

    Raises:
        ValueError: If both are given.
    """
    if driver is not None and drivers:
        raise ValueError("driver and drivers are given; give one of them")
    given: Any = drivers if driver is None else driver  # Any: checked by the study
    one = isinstance(given, str | os.PathLike | DriverParameters | DriverModel)
    several = given if isinstance(given, Iterable) and not one else (given,)
    return tuple(by_name(each) for each in several)


def parameters(
    method: File | AnyMethod = "ibhs",
    condition: str = "strong-normal",
    car: File | CarParameters = "default",
) -> DataFrame:
    """Every number that `parameters=` of `simulate` and `study` can set.

    Args:
        method: A method, its name or its place.
        condition: Of Table IV.
        car: Name of the car, its parameters, or the file of one.

    Returns:
        A row for each, by name: value, unit, low, high, what it is and its source.

    Raises:
        ValueError: If method, condition or car are not known.

    Example:
        >>> import costeer
        >>> row = costeer.parameters().loc["guidance.lateral_error_gain"]
        >>> row.unit
        'N·m/m'
    """
    import pandas as pd

    setup = TrialSetup(
        condition=condition,
        method=by_name(method),
        car=_car(car),
    )
    rows = {
        each.name.removeprefix(METHOD): {
            "value": float(each.value),
            "unit": each.unit,
            "low": each.allowed.low,
            "high": each.allowed.high,
            "meaning": each.meaning,
            "source": each.source,
        }
        for each in parameter_list(loop_parameters(setup))
    }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("name")
