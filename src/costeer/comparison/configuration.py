"""Everything that determines the results of a comparison, as plain values."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from costeer.base.entry import simulation_source
from costeer.comparison.design import ComparisonSettings, Plan, setup_of
from costeer.comparison.entrants import Course, Entrant
from costeer.loop.trial import trial_predictor
from costeer.methods.interface import method_sources
from costeer.methods.registry import method_named
from costeer.scenarios.reading import scenario_named, shipped
from costeer.scenarios.writing import plain


def comparison_configuration(
    settings: ComparisonSettings, plan: Plan
) -> dict[str, Any]:  # Any: values of YAML
    """What two runs must share to share a folder.

    Raises:
        ValueError: If a predictor or a method cannot be told.
        OSError: If its file cannot be read.
    """
    predictor = trial_predictor(setup_of(settings, plan.cells[-1], 1))
    return {
        "costeer_version": version("costeer"),
        "simulation_source": simulation_source(),
        "measure_source": measure_source(),
        "methods": {each.name: _method(each) for each in plan.entrants},
        "scenarios": {each.name: _course(each) for each in plan.courses},
        "mistakes": list(settings.mistakes),
        "participants": settings.participants,
        "seed": settings.seed,
        "condition": settings.condition,
        "intention": settings.intention,
        "intention_model_hash": None if predictor is None else predictor.hash,
        "keep_records": settings.keep_records,
        "left_out": [list(each) for each in plan.left_out],
    }


def _method(entrant: Entrant) -> dict[str, Any]:
    method = method_named(entrant.given)
    return {
        "version": method.version,
        "source_hash": method_sources(method),
        "publication": method.source,
        "given_as": entrant.given if isinstance(entrant.given, str) else "an object",
    }


def _course(course: Course) -> dict[str, Any]:
    told: dict[str, Any] = {"length": course.length, "speed": course.speed}
    if course.given not in shipped():
        told["content"] = plain(scenario_named(course.given))
    return told


@cache
def measure_source() -> str:
    """Hash of the files that decide what is measured: rows outlive records."""
    package = Path(__file__).parents[1]
    files = [*(package / "study").glob("*.py"), package / "comparison" / "measures.py"]
    digest = hashlib.sha256()
    for file in sorted(files):
        digest.update(file.relative_to(package).as_posix().encode())
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def differences(there: dict[str, Any], here: dict[str, Any]) -> str:
    """In what two comparisons differ, in words."""
    changed = [k for k in here if there.get(k) != here[k]]
    by_code = {
        "costeer_version": "the version of costeer",
        "simulation_source": "the sources of the simulation",
        "measure_source": "the sources of the measures",
        "intention_model_hash": "the predictor of the intention",
    }
    told = [by_code[key] for key in changed if key in by_code]
    for key in changed:
        if key in by_code or key == "left_out":
            continue
        was, now = there.get(key), here[key]
        if isinstance(was, dict) and isinstance(now, dict):
            told.append(_of_entries(key, was, now))
        else:
            told.append(f"{key} is {_words(was)} there, {_words(now)} here")
    return "; ".join(told)


def _of_entries(key: str, there: dict[str, Any], here: dict[str, Any]) -> str:
    if list(there) != list(here):
        return f"{key} are {_words(list(there))} there, {_words(list(here))} here"
    edited = [name for name in here if there[name] != here[name]]
    return f"{', '.join(edited)} (of the {key}) had other content"


def _words(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)
