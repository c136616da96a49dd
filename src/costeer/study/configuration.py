"""What a study is: its settings, everything that determines its results, their hash.

Two runs with the same hash give the same bytes on the same machine. How many jobs
run at once and whether a report is written are not part of it.
"""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from costeer import __version__
from costeer.base.entry import COMPILED_ROOMS
from costeer.controller.step import ControllerParameters
from costeer.intention.weights import load_weights
from costeer.loop.scenario import TrialSetup, check_setup, check_study_seed
from costeer.methods.conditions import (
    CONDITION_NAMES,
    MANUAL,
    check_conditions,
    condition,
)
from costeer.study.design import Trial, plan_trials

MOST_PARTICIPANTS = 9999
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
        car: Name of the car.
    """

    participants: int = 12
    conditions: tuple[str, ...] = CONDITION_NAMES
    seed: int = 1
    method: str = "ibhs"
    intention: str = "network"
    length: float = 8000.0
    speed: float = 70 / 3.6
    car: str = "default"


PUBLISHED_STUDY = StudySettings()
"""The experiment of Sec. III."""

INTENTIONS = ("network", "scripted")
"""Where a study's crossing probability comes from."""


def check_settings(settings: StudySettings) -> StudySettings:
    """Return the settings with conditions in the order of Table IV.

    Raises:
        ValueError: Naming the first value out of range, the range and the way out.
    """
    check_count("participants", settings.participants, 1, MOST_PARTICIPANTS)
    check_count("seed", settings.seed, 0, LARGEST_SEED)
    check_study_seed(settings.seed)
    if settings.intention not in INTENTIONS:
        known = ", ".join(INTENTIONS)
        raise ValueError(
            f"intention {settings.intention!r} is not known; choose one of {known}"
        )
    known_settings = StudySettings(
        **{**settings._asdict(), "conditions": check_conditions(settings.conditions)}
    )
    for trial in plan_trials(1, known_settings.conditions):
        check_setup(trial_setup(known_settings, trial))
    return known_settings


def check_count(name: str, value: int, least: int, most: int) -> None:
    """Refuse a number that is not whole or not in the range."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"{name} must be a whole number, not {value!r}")
    if not least <= value <= most:
        raise ValueError(f"{name} is {value}; give a whole number {least} to {most}")


def trial_setup(settings: StudySettings, trial: Trial) -> TrialSetup:
    """Return how to simulate one trial of the study."""
    chosen = condition(trial.condition)
    return TrialSetup(
        participant=trial.participant,
        seed=settings.seed,
        condition=chosen.name,
        strength_factor=chosen.strength_factor,
        change_duration=chosen.change_duration,
        method=MANUAL if chosen.name == MANUAL else settings.method,
        length=settings.length,
        speed=settings.speed,
        car=settings.car,
        intention=settings.intention,
    )


def study_configuration(settings: StudySettings) -> dict[str, object]:
    """Return everything that determines the results, as plain JSON values.

    Raises:
        ValueError: If the shipped network is damaged.
        OSError: If it cannot be read.
    """
    return {
        "costeer_version": __version__,
        "simulation_source": simulation_source(),
        **settings._asdict(),
        "conditions": list(settings.conditions),
        **_thresholds(),
        "intention_model_hash": _model_hash(settings.intention),
        "order": driving_order(settings),
    }


def _thresholds() -> dict[str, object]:
    """Name the thresholds of the guidance that a reader looks for first."""
    parameters = ControllerParameters()
    return {
        "inconsistency_threshold": parameters.consistency.inconsistency_threshold,
        "replan_gain": parameters.replanning.replan_gain,
        "torque_limit": parameters.actuation.torque_limit,
    }


def _model_hash(intention: str) -> str | None:
    """Hash of the network's weights; None where no network is asked."""
    return load_weights().hash if intention == "network" else None


def settings_of(configuration: dict[str, Any]) -> StudySettings:
    """Return the settings in a configuration that was read from a file.

    Raises:
        ValueError: If one is missing or out of range.
    """
    missing = [name for name in StudySettings._fields if name not in configuration]
    if missing:
        raise ValueError(f"the configuration lacks {', '.join(missing)}")
    chosen = {name: configuration[name] for name in StudySettings._fields}
    return check_settings(StudySettings(**chosen))


def driving_order(settings: StudySettings) -> list[list[str]]:
    """Return the conditions of each participant in the order driven."""
    order: list[list[str]] = [[] for _ in range(settings.participants)]
    for trial in plan_trials(settings.participants, settings.conditions):
        order[trial.participant - 1].append(trial.condition)
    return order


@cache
def simulation_source() -> str:
    """Return a hash of all files that decide what a simulated trial is.

    The version alone would let a study be finished with other equations than it was
    begun with, after an edit in a checkout.
    """
    package = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for room in COMPILED_ROOMS:
        for file in sorted((package / room).rglob("*")):
            if file.is_file() and file.suffix != ".pyc":
                digest.update(file.relative_to(package).as_posix().encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()[:16]
