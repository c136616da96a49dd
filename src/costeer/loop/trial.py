"""One trial from its setup to its record."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from importlib import metadata as distribution
from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.base.described import value_at
from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import AnyDriver, DriverModel, driver_sources
from costeer.drivers.population import POPULATIONS, USUAL, VIRTUAL
from costeer.drivers.registry import HANDS_OFF
from costeer.intention.predictors.chosen import ChosenPredictor
from costeer.intention.predictors.interface import Predictor
from costeer.loop.endings import outcome_of
from costeer.loop.network import idle_network as idle_network
from costeer.loop.network import network_form, trial_network
from costeer.loop.network import shipped_network as shipped_network
from costeer.loop.network import trial_predictor as trial_predictor
from costeer.loop.noise import driver_noise
from costeer.loop.outside import Outlook, Verdicts, outside_rollout
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.rollout import begun, rollout, row_width
from costeer.loop.scenario import (
    INTENTIONS,
    TrialSetup,
    is_assisted,
    loop_parameters,
    trial_condition,
    trial_driver_model,
    trial_method,
    trial_mistakes,
)
from costeer.loop.tick import Script
from costeer.methods.interface import Method, method_sources
from costeer.plant.fleet import num_cars
from costeer.records import metadata as kinds
from costeer.records.cars import car_columns
from costeer.records.columns import TrialRecord, with_method_columns
from costeer.records.row import ROW_COLUMNS, record_columns
from costeer.scenarios import mistakes
from costeer.scenarios.reading import scenario_named
from costeer.scenarios.world import sizes_of

SLOWEST_SHARE = 0.5
"""A trial ends at the latest when a car at this share of its speed would arrive [-]."""

LIKELY_SHARE = 0.97
"""Hardly anybody on a road without other cars is slower than this share of the speed
that he prefers [-]. Decides what a trial costs, and nothing else."""


def simulate_trial(setup: TrialSetup, engine: str = "numba") -> TrialRecord:
    """Run one trial.

    Args:
        setup: What the trial is.
        engine: "numba", "python" or "jax"; all give the same numbers. JAX runs no
            network.

    Returns:
        Its record; the same setup and version give the same record.

    Raises:
        ValueError: If the setup cannot be run or the engine is not known.
        OSError: If a file of the predictor's numbers cannot be read.
        ModuleNotFoundError: If the engine is not installed.
    """
    parameters, predictor = loop_parameters(setup), trial_predictor(setup)
    rows = _driven(setup, parameters, predictor, engine)
    return record_of(setup, parameters, predictor, rows)


def record_of(
    setup: TrialSetup,
    parameters: LoopParameters[Any],
    predictor: ChosenPredictor | None,
    rows: NDArray[np.float64],
) -> TrialRecord:
    """The record of a trial that was run.

    Args:
        setup: Of the trial.
        parameters: Of the trial.
        predictor: That was asked.
        rows: Of the loop, shape `(time, column)`.

    Raises:
        ValueError: If the car has left the numbers.
    """
    method = trial_method(setup)
    _refuse_broken(setup, rows)
    added = (*method.columns, *car_columns(num_cars(parameters.fleet)))
    columns = record_columns(rows, is_assisted(setup), with_method_columns(added))
    about = trial_metadata(setup, parameters, predictor)
    about["torque_faults"] = int(np.count_nonzero(columns["torque_fault"]))
    about["outcome"] = outcome_of(rows, setup.length)
    return TrialRecord(about, columns, added)


def _driven(
    setup: TrialSetup,
    parameters: LoopParameters[Any],
    predictor: ChosenPredictor | None,
    engine: str,
) -> NDArray[np.float64]:
    """Rows of a trial, run with random numbers for no longer than it is likely to last.

    More random numbers begin with the same ones: where they ran out, the trial is run
    again with all that it may need.
    """
    alone = not num_cars(parameters.fleet) and engine != "jax"
    slowest = slowest_steps(setup)
    for steps in (likely_steps(setup, parameters), slowest) if alone else (slowest,):
        noise = driver_noise(setup.seed, setup.participant, setup.condition, steps)
        rows = _run(setup, parameters, predictor, noise, engine)
        if len(rows) < steps:
            break
    return rows


def slowest_steps(setup: TrialSetup) -> int:
    """Control steps after which a trial ends wherever the car is."""
    return _steps_at(setup, SLOWEST_SHARE * setup.speed)


def likely_steps(setup: TrialSetup, parameters: LoopParameters[Any]) -> int:
    """Control steps within which a trial has likely ended."""
    driver, speed = parameters.driver, setup.speed
    if isinstance(driver, DriverParameters):
        speed = driver.longitudinal.preferred_speed
    speed = max(LIKELY_SHARE * speed, SLOWEST_SHARE * setup.speed)
    return _steps_at(setup, speed)


def _steps_at(setup: TrialSetup, speed: Real) -> int:
    return int(np.ceil(setup.length / speed / DT))


def trial_script(setup: TrialSetup) -> Script:
    """Where the crossing probability of a trial comes from."""
    return Script(
        intention=INTENTIONS[setup.intention],
        horizon=setup.prediction_horizon,
        trigger_times=np.array(sorted(setup.trigger_times), dtype=np.float64),
    )


def _run(
    setup: TrialSetup,
    parameters: LoopParameters[Any],
    predictor: ChosenPredictor | None,
    noise: NDArray[np.float64],
    engine: str,
) -> NDArray[np.float64]:
    """Rows of a trial, until it ends or its random numbers do."""
    script = trial_script(setup)
    method, driver = trial_method(setup), trial_driver_model(setup)
    network = trial_network(setup, parameters, predictor)
    if predictor is None or predictor.judge is None or engine == "jax":
        return rollout(method, parameters, script, network, noise, engine, driver)
    judge, name = predictor.judge, predictor.name
    return outside_rollout(
        begun(method, parameters, network, engine, driver=driver),
        script,
        Outlook(lambda: Verdicts(judge, name).after, parameters.car, parameters.road),
        noise,
        parameters.road,
        row_width(method, parameters),
    )


def _refuse_broken(setup: TrialSetup, rows: NDArray[np.float64]) -> None:
    """Refuse a drive whose car has left the numbers.

    Raises:
        ValueError: Saying when, and what was set.
    """
    broken = ~np.isfinite(rows[:, ROW_COLUMNS.index("lateral_position")])
    if broken.any():
        when = rows[broken.argmax(), ROW_COLUMNS.index("time")]
        told = ", ".join(f"{name}={value:g}" for name, value in setup.parameters)
        raise ValueError(
            f"after {when:.2f} s the car's position is no number: the loop cannot "
            f"drive with these values ({told or 'none is set by name'}); set them "
            "nearer to the usual ones"
        )


def trial_metadata(
    setup: TrialSetup,
    parameters: LoopParameters[Any],
    predictor: ChosenPredictor | None,
) -> dict[str, object]:
    """The record's description of the trial, spec section 6."""
    # Road and cars follow from the scenario and the seed, which stand in the setup.
    told = parameters._replace(alignment=(), fleet=(), stretches=())  # type: ignore[arg-type]
    configuration = json.loads(json.dumps(_as_dict(told)))
    configuration["setup"] = _as_dict(setup)
    configuration["setup"]["scenario"] = _as_dict(scenario_named(setup.scenario))
    configuration["setup"]["guided_before"] = _learnt_from(setup, parameters.driver)
    text = json.dumps(configuration, sort_keys=True)
    condition, method = trial_condition(setup), trial_method(setup)
    driver = trial_driver_model(setup)
    return {
        "version": _version("costeer"),
        "seed": setup.seed,
        "participant": setup.participant,
        "condition": setup.condition,
        "strength_factor": condition.strength_factor if method.assists else 0.0,
        "change_duration": condition.change_duration,
        "method": method.name,
        "method_version": method.version,
        "method_source_hash": method_sources(method),
        "car": setup.car if isinstance(setup.car, str) else "own",
        "speed": setup.speed,
        "scenario": scenario_metadata(setup),
        "mistakes": [mistakes.as_told(each) for each in trial_mistakes(setup)],
        "other_cars": sizes_of(scenario_named(setup.scenario), parameters.fleet),
        "driver": _driver_text(setup, driver),
        "driver_source_hash": driver_sources(driver),
        "predictor": None if predictor is None else predictor.name,
        "intention_model_hash": None if predictor is None else predictor.hash,
        "network_form": network_form(setup, parameters, predictor),
        **_thresholds(parameters),
        "configuration": configuration,
        "configuration_hash": hashlib.sha256(text.encode()).hexdigest(),
        "driver_torque_source": "simulated",
        "git_revision": git_revision(),
        "driver_kind": kinds.HANDS_OFF if setup.driver == HANDS_OFF else kinds.VIRTUAL,
        "record_version": kinds.RECORD_VERSION,
    }


def _learnt_from(setup: TrialSetup, driver: object) -> Real | None:
    """Guided driving that was learnt from [s]; None for who learns nothing."""
    if setup.driver == HANDS_OFF or not isinstance(driver, DriverParameters):
        return None
    return driver.learning.before if driver.learning.share > 0.0 else None


def scenario_metadata(setup: TrialSetup) -> dict[str, object]:
    """The scenario of a trial, whole: what a reader draws and judges by."""
    told: dict[str, object] = _as_dict(scenario_named(setup.scenario))
    return told


def _driver_text(setup: TrialSetup, driver: AnyDriver) -> str:
    """Who holds the wheel, in words."""
    if isinstance(setup.driver, DriverParameters):
        return "virtual, parameters of its own"
    if driver is VIRTUAL:
        who = setup.driver if isinstance(setup.driver, str) else setup.driver.name
        population = POPULATIONS.get(who, USUAL)
        return f"{who}, population {population.version}"
    return f"{driver.name} {driver.version}"


def _thresholds(parameters: LoopParameters[Any]) -> dict[str, object]:
    """What a reader looks for first; null where the method has no such thing."""
    places = {
        "inconsistency_threshold": "controller.consistency.inconsistency_threshold",
        "replan_gain": "controller.replanning.replan_gain",
        "torque_limit": "controller.actuation.torque_limit",
    }
    return {name: _number_at(parameters, place) for name, place in places.items()}


def _number_at(parameters: LoopParameters[Any], place: str) -> Real | None:
    """The number at a dotted place, if there is one."""
    try:
        value = value_at(parameters, place)
    except AttributeError:
        return None
    return value if isinstance(value, (bool, int, float)) else None


_version = cache(distribution.version)


@cache
def git_revision() -> str | None:
    """Revision of the sources that run, None outside a checkout."""
    import subprocess
    from pathlib import Path

    command = ["git", "rev-parse", "HEAD"]
    folder = Path(__file__).parents[3]
    if not (folder / ".git").exists():
        return None
    try:
        answer = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return None
    return answer.stdout.strip()


def _as_dict(value: Any) -> Any:  # Any: a tree of numbers, names and tuples
    """Nested named tuples as nested dictionaries; NaN, which JSON has not, as null."""
    if isinstance(value, Method | Predictor | DriverModel):
        return value.name
    if callable(value):
        return getattr(value, "__name__", type(value).__name__)
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return {name: _as_dict(getattr(value, name)) for name in value._fields}
    if isinstance(value, tuple):
        return [_as_dict(item) for item in value]
    if isinstance(value, float) and value != value:
        return None
    return value


def trial_duration(record: TrialRecord) -> Real:
    """How long a trial lasted [s]."""
    return float(len(record.columns["time"]) * DT)
