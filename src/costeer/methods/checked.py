"""Whether the loop can run a method: judged once, before anything is simulated.

A method is run for one step in plain Python, so that what is wrong with it is said in
its own words and not in those of a compiler.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from costeer.base.described import value_at
from costeer.controller.signals import Assistance, Request
from costeer.methods.conditions import CONDITIONS, Condition
from costeer.methods.interface import Method, Tunable
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.road import adjacent_side, cruising_lane, lane_centre
from costeer.records.columns import METHOD_PREFIX, Column
from costeer.sensing.measurement import Measurement

# Any, in this file: a method, its parameters and its state are of whoever made them.
_NAME = re.compile(r"[a-z][a-z0-9-]{0,39}")
_DT = 1.0 / 60.0
_WHOLE = "a whole number"


def checked_method(method: Any) -> Method[Any, Any]:
    """The method, if the loop can run it.

    Raises:
        ValueError: Naming what is missing or wrong.
    """
    if not isinstance(method, Method):
        raise ValueError(
            f"{method!r} is no method; make one with costeer.Method(name=..., ...)"
        )
    for part in ("columns", "tunables"):
        given = getattr(method, part)
        if not isinstance(given, tuple):
            raise ValueError(
                f"{part} of method {method.name!r} are {_short(given)}; give a tuple"
            )
    return _checked(method)


@cache
def _checked(method: Method[Any, Any]) -> Method[Any, Any]:
    """`checked_method` of what is a method, judged once."""
    if not (isinstance(method.name, str) and _NAME.fullmatch(method.name)):
        raise ValueError(
            f"a method is called {method.name!r}; give it a name of small letters, "
            "digits and hyphens, as my-method"
        )
    for part in ("parameters", "initial_state", "step"):
        if not callable(getattr(method, part)):
            raise ValueError(
                f"method '{method.name}' has no {part} function; it is "
                f"{getattr(method, part)!r}"
            )
    for part in ("version", "source"):
        if not isinstance(getattr(method, part), str):
            raise ValueError(
                f"{part} of method '{method.name}' is {_short(getattr(method, part))}; "
                "give text"
            )
    if not isinstance(method.assists, bool):
        raise ValueError(
            f"assists of method '{method.name}' is {method.assists!r}; give True or "
            "False"
        )
    _check_columns(method)
    _check_tunables(method)
    parameters = _checked_parameters(method)
    _check_step(method, parameters)
    return method


def kinds_of(value: Any, prefix: str = "") -> dict[str, str]:
    """What each number of a nested named tuple is, by its dotted name.

    Raises:
        ValueError: If something is no number, flag or array of numbers.
    """
    if hasattr(value, "_fields"):
        parts = [
            kinds_of(getattr(value, name), f"{prefix}.{name}" if prefix else name)
            for name in value._fields
        ]
        return {name: kind for part in parts for name, kind in part.items()}
    if isinstance(value, bool | np.bool_):
        return {prefix: "a flag"}
    if isinstance(value, int | np.integer):
        return {prefix: _WHOLE}
    if isinstance(value, float):
        return {prefix: "a number"}
    if isinstance(value, np.ndarray) and value.dtype.kind == "f":
        return {prefix: f"an array of shape {value.shape}"}
    raise ValueError(f"{prefix or 'the whole'} is {value!r}")


def _checked_parameters(method: Method[Any, Any]) -> Any:
    """Usual parameters of a method, which can be packed and hold its tunables.

    Raises:
        ValueError: Naming what cannot.
    """
    given = parameters_of(
        method, CONDITIONS[1], CarParameters(), ColumnParameters(), RoadParameters()
    )
    kinds = _checked_kinds(method, "parameters", given)
    whole = [name for name, kind in kinds.items() if kind == _WHOLE]
    if whole:
        raise ValueError(
            f"parameter {whole[0]} of method '{method.name}' is a whole number and "
            "could be set to nothing between; write it as 3.0 instead of 3"
        )
    for name in kinds:
        value = value_at(given, name)
        if kinds[name] == "a number" and not math.isfinite(value):
            raise ValueError(
                f"parameter {name} of method '{method.name}' is {value}; give a number "
                "that is finite"
            )
    for tunable in method.tunables:
        if tunable.leaf not in kinds:
            raise ValueError(
                f"tunable '{tunable.name}' of method '{method.name}' lies at "
                f"'{tunable.leaf}', which is none of {', '.join(kinds)}"
            )
    return given


def _short(value: Any) -> str:
    """What a value is, in a line."""
    text = repr(value)
    return text if len(text) < 60 else f"{text[:50]}... ({type(value).__name__})"


def _checked_kinds(method: Method[Any, Any], what: str, given: Any) -> dict[str, str]:
    """The kinds in a named tuple of a method.

    Raises:
        ValueError: If it is none, or holds something else.
    """
    if not hasattr(given, "_fields"):
        raise ValueError(
            f"{what} of method '{method.name}' are {_short(given)}; give a named "
            "tuple of numbers, flags and arrays of floats"
        )
    try:
        return kinds_of(given)
    except ValueError as error:
        raise ValueError(
            f"{what} of method '{method.name}' are no named tuple of numbers, flags "
            f"and arrays of floats: {error}"
        ) from error


def parameters_of(
    method: Method[Any, Any],
    condition: Condition,
    car: CarParameters,
    column: ColumnParameters,
    road: RoadParameters,
) -> Any:
    """A method's parameters under a condition, for a car, column and road.

    Raises:
        ValueError: If its function breaks.
    """
    return _called(
        method,
        "parameters",
        "condition, car, column, road",
        method.parameters,
        *(condition, car, column, road),
    )


def _called(
    method: Method[Any, Any],
    part: str,
    takes: str,
    function: Callable[..., Any],
    *arguments: Any,
) -> Any:
    """What a function of a method gives.

    Raises:
        ValueError: If it breaks.
    """
    try:
        return function(*arguments)
    except Exception as error:  # whatever somebody else's code raises
        raise ValueError(
            f"{part} of method '{method.name}' broke: {type(error).__name__}: "
            f"{error}; it is called with {takes}"
        ) from error


def standing_start(road: RoadParameters) -> Measurement:
    """A car at 20 m/s in the middle of its lane."""
    lane = cruising_lane(road)
    zeros: dict[str, Any] = dict.fromkeys(Measurement._fields, 0.0)
    return Measurement(**zeros)._replace(
        lateral_position=lane_centre(road, lane),
        longitudinal_velocity=20.0,
        head_yaw_valid=True,
        lane=lane,
        side=adjacent_side(road, lane),
        distance_to_adjacent_lane=road.lane_width / 2.0,
    )


def _check_step(method: Method[Any, Any], parameters: Any) -> None:
    """Refuse a method whose step gives something else than state and assistance.

    Raises:
        ValueError: Saying what it gives.
    """
    measurement = standing_start(RoadParameters())
    state = _called(
        method,
        "initial_state",
        "parameters, lane",
        method.initial_state,
        parameters,
        measurement.lane,
    )
    before = _checked_kinds(method, "states", state)
    answer = _called(
        method,
        "step",
        "parameters, state, measurement, request, dt",
        method.step,
        *(parameters, state, measurement, Request(), _DT),
    )
    name = f"step of method '{method.name}'"
    if not (isinstance(answer, tuple) and len(answer) == 2):
        raise ValueError(
            f"{name} gives {_short(answer)}; give the new state and assistance"
        )
    after = _checked_kinds(method, "states", answer[0])
    for place in {**before, **after}:
        if before.get(place) != after.get(place):
            raise ValueError(
                f"{name} makes {place} of the state {after.get(place, 'nothing')}, it "
                f"was {before.get(place, 'nothing')}; write a number that is to be a "
                "float as 0.0, and keep the shape of an array"
            )
    _check_assistance(name, answer[1])
    torque = answer[1].applied_torque
    if not method.assists and torque != 0.0:
        raise ValueError(
            f"{name} asks for {torque:g} N·m although assists is False; set assists to "
            "True, or ask for none"
        )


def _check_assistance(name: str, given: Any) -> None:
    """Refuse what is no assistance, or lacks a number where one is expected.

    Raises:
        ValueError: Naming it.
    """
    if not isinstance(given, Assistance):
        raise ValueError(
            f"{name} gives {_short(given)} as its assistance; give "
            "Assistance(applied_torque=torque)"
        )
    try:
        found = kinds_of(given)
    except ValueError as error:
        raise ValueError(f"{name} gives no assistance of numbers: {error}") from error
    for place, kind in kinds_of(Assistance()).items():
        said = found.get(place, "missing")
        if said != kind and not (said == _WHOLE and kind == "a number"):
            raise ValueError(f"{name} gives {place} as {said}; give {kind}")


def _check_columns(method: Method[Any, Any]) -> None:
    """Refuse columns that could be taken for costeer's own.

    Raises:
        ValueError: Naming them.
    """
    for column in method.columns:
        if not (isinstance(column, Column) and isinstance(column.name, str)):
            raise ValueError(
                f"columns of method '{method.name}' hold {_short(column)}; give "
                "costeer.records.columns.Column(name, unit, kind, ...)"
            )
        if not column.name.startswith(METHOD_PREFIX):
            raise ValueError(
                f"column '{column.name}' of method '{method.name}' must begin with "
                f"{METHOD_PREFIX}, so that it is not taken for one of costeer's own"
            )


def _check_tunables(method: Method[Any, Any]) -> None:
    """Refuse what nobody could move.

    Raises:
        ValueError: Naming it.
    """
    names = []
    for tunable in method.tunables:
        if not isinstance(tunable, Tunable):
            raise ValueError(
                f"tunables of method '{method.name}' hold {_short(tunable)}; give "
                "costeer.methods.interface.Tunable(name, ...)"
            )
        if not -math.inf < tunable.low < tunable.high < math.inf:
            raise ValueError(
                f"tunable '{tunable.name}' of method '{method.name}' goes from "
                f"{tunable.low} to {tunable.high}; give the smaller number first"
            )
        names.append(tunable.name)
    if len(names) != len(set(names)):
        raise ValueError(f"method '{method.name}' has two tunables of one name")
