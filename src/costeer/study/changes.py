"""In what two studies differ, and whether a user or a version made the difference."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

# Any: a setting as YAML gives it back.
Configuration = Mapping[str, Any]

_OPTIONS = {
    "participants",
    "conditions",
    "seed",
    "method",
    "method_name",
    "intention",
    "length",
    "speed",
    "car",
    "car_parameters",
    "predictor",
    "weights",
    "exact_network",
    "drivers",
    "driver_parameters",
    "parameters",
    "scenario",
    "scenario_content",
}
"""What a user chooses, and what the files hold that a user names."""

_CODE = {
    "method_source_hash": "the code of the method was edited",
    "method_version": "the method has another version",
    "intention_model_hash": "the predictor's code or numbers were changed",
}
"""What a user may have edited, and what comes with costeer as well."""

PUBLISHED_SCENARIO = "expressway"
"""The scenario of a study that names none."""

_VERSION = {"costeer_version", "simulation_source"}

_FOLLOWS = {
    "method_name": ("method",),
    "method_source_hash": ("method",),
    "method_version": ("method",),
    "intention_model_hash": ("predictor", "weights", "intention"),
    "car_parameters": ("car",),
    "driver_parameters": ("drivers",),
    "scenario_content": ("scenario",),
}
"""What need not be told where one of these settings is."""

_NOT_TOLD = {"order", "simulation_source"}
"""Follows from the others; says nothing to a reader."""


def refusal(there: Configuration, here: Configuration) -> str:
    """What the folder holds instead, the differences, and the way out.

    Args:
        there: Configuration of the study in the folder.
        here: Of the one that is wanted.
    """
    changed = _changed(there, here)
    told = differences(there, here)
    if changed & _OPTIONS or (changed & _CODE.keys() and not changed & _VERSION):
        return (
            f"another study: {told}. Choose another folder, or give the options and "
            "files of that study to resume it"
        )
    return (
        f"a study of another version of costeer: {told}. Choose another folder, or "
        "remove this one to run the study anew"
    )


def differences(there: Configuration, here: Configuration) -> str:
    """Name the settings in which two studies differ."""
    changed = _changed(there, here)
    told = [
        words
        for key in sorted(changed - _NOT_TOLD)
        if not changed & set(_FOLLOWS.get(key, ()))
        for words in _told(key, there.get(key), here.get(key))
    ]
    return "; ".join(told) or "it was simulated by other sources of costeer"


def _changed(there: Configuration, here: Configuration) -> set[str]:
    return {k for k in there.keys() | here.keys() if there.get(k) != here.get(k)}


def _told(key: str, there: Any, here: Any) -> list[str]:
    """One setting in words; of several values in it those that differ."""
    if key in _CODE:
        return [_CODE[key]]
    if key == "scenario":
        there, here = there or PUBLISHED_SCENARIO, here or PUBLISHED_SCENARIO
    if key == "scenario_content":
        edited = ", ".join(sorted(_changed(there or {}, here or {})))
        return [f"the scenario was edited ({edited})"]
    if key == "driver_parameters":
        pairs = enumerate(zip(there or (), here or (), strict=False), 1)
        return [w for n, pair in pairs for w in _values(f"driver {n}: ", *pair)]
    if isinstance(there, Mapping) and isinstance(here, Mapping):
        return _values("car." if key == "car_parameters" else "", there, here)
    if key == "speed":
        there, here = (f"{float(each) * 3.6:.6g} km/h" for each in (there, here))
    return [f"{key} is {there} there, {here} here"]


def _values(prefix: str, there: Configuration, here: Configuration) -> list[str]:
    """Numbers by name; one that is not set is as usual."""
    return [
        f"{prefix}{name} is {there.get(name, 'as usual')} there, "
        f"{here.get(name, 'as usual')} here"
        for name in sorted(_changed(there, here))
    ]
