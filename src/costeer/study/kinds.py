"""Whether what `study.yaml` says is of the kind that each setting has."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any, NamedTuple

# Any: whatever a file holds.
Holds = Callable[[Any], bool]


class Kind(NamedTuple):
    """What a setting may be.

    Attributes:
        words: The kind, for a message.
        holds: Whether a value is of it.
    """

    words: str
    holds: Holds


def _is_number(value: Any) -> bool:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and isfinite(value)


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _list_of(holds: Holds) -> Holds:
    return lambda value: isinstance(value, list) and all(map(holds, value))


def _values_of(holds: Holds) -> Holds:
    return lambda value: (
        isinstance(value, dict)
        and all(map(_is_text, value))
        and all(map(holds, value.values()))
    )


def _is_nested(value: Any) -> bool:
    """Whether it is a number, or parameters by name."""
    return _is_number(value) or _values_of(_is_nested)(value)


_COUNT = Kind("a whole number", _is_count)
_LENGTH = Kind("a number above 0", lambda value: _is_number(value) and value > 0)
_NUMBER = Kind("a number", _is_number)
_TEXT = Kind("a text", _is_text)
_TEXTS = Kind("a list of texts", _list_of(_is_text))
_NUMBERS = Kind("numbers by name", _values_of(_is_number))
_PARAMETERS = Kind("numbers by name", _values_of(_is_nested))

_KINDS = {
    "participants": _COUNT,
    "conditions": _TEXTS,
    "seed": _COUNT,
    "method": _TEXT,
    "intention": _TEXT,
    "length": _LENGTH,
    "speed": _LENGTH,
    "car": _TEXT,
    "predictor": _TEXT,
    "weights": _TEXT,
    "exact_network": Kind("true or false", lambda value: isinstance(value, bool)),
    "drivers": _TEXTS,
    "parameters": _NUMBERS,
    "scenario": _TEXT,
    "scenario_content": Kind("a scenario", lambda value: isinstance(value, dict)),
    "costeer_version": _TEXT,
    "simulation_source": _TEXT,
    "method_name": _TEXT,
    "method_version": _TEXT,
    "method_source_hash": _TEXT,
    "intention_model_hash": Kind("a text or null", lambda v: v is None or _is_text(v)),
    "car_parameters": Kind(
        "numbers by name or null", lambda v: v is None or _PARAMETERS.holds(v)
    ),
    "driver_parameters": Kind(
        "a list of drivers",
        _list_of(_values_of(lambda value: _is_text(value) or _is_nested(value))),
    ),
    "inconsistency_threshold": _NUMBER,
    "replan_gain": _NUMBER,
    "torque_limit": _NUMBER,
    "order": Kind("a list of lists of texts", _list_of(_TEXTS.holds)),
}
"""What each setting of a study is; others are not looked at."""


def wrong_kind(configuration: Mapping[Any, Any]) -> str:
    """Name the first setting that is of another kind; empty if there is none."""
    for name, kind in _KINDS.items():
        if name in configuration and not kind.holds(configuration[name]):
            return f"{name} is {_shortened(configuration[name])}, not {kind.words}"
    return ""


def _shortened(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
