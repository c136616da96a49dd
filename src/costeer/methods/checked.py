"""Whether the loop can run a method: judged once, before anything is simulated.

A method is run for one step in plain Python, so that what is wrong with it is said in
its own words and not in those of a compiler.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from costeer.base.judged import (
    called,
    check_like,
    check_parts,
    checked_answer,
    checked_kinds,
    checked_numbers,
    short,
)
from costeer.controller.signals import Assistance, Request
from costeer.methods.conditions import CONDITIONS, Condition
from costeer.methods.interface import Method, Tunable, usual_parameters
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.records.columns import METHOD_PREFIX, Column
from costeer.sensing.measurement import standing_start

# Any, in this file: a method, its parameters and its state are of whoever made them.
_DT = 1.0 / 60.0


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
                f"{part} of method {method.name!r} are {short(given)}; give a tuple"
            )
    return _checked(method)


@cache
def _checked(method: Method[Any, Any]) -> Method[Any, Any]:
    """`checked_method` of what is a method, judged once."""
    check_parts(method, "method", ("parameters", "initial_state", "step"))
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


def _checked_parameters(method: Method[Any, Any]) -> Any:
    """Usual parameters of a method, which can be packed and hold its tunables.

    Raises:
        ValueError: Naming what cannot.
    """
    given = parameters_of(
        method, CONDITIONS[1], CarParameters(), ColumnParameters(), RoadParameters()
    )
    kinds = checked_numbers(f"method '{method.name}'", given)
    for tunable in method.tunables:
        if tunable.leaf not in kinds:
            raise ValueError(
                f"tunable '{tunable.name}' of method '{method.name}' lies at "
                f"'{tunable.leaf}', which is none of {', '.join(kinds)}"
            )
    return given


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
    return called(
        f"method '{method.name}'",
        "parameters",
        "condition, car, column, road",
        method.parameters,
        *(condition, car, column, road),
    )


def _check_step(method: Method[Any, Any], parameters: Any) -> None:
    """Refuse a method whose step gives something else than state and assistance.

    Raises:
        ValueError: Saying what it gives.
    """
    measurement, whose = standing_start(RoadParameters()), f"method '{method.name}'"
    start = (parameters, measurement.lane)
    state = called(
        whose, "initial_state", "parameters, lane", method.initial_state, *start
    )
    checked_kinds(whose, "states", state)
    takes = "parameters, state, measurement, request, dt"
    given = (parameters, state, measurement, Request(), _DT)
    answer = called(whose, "step", takes, method.step, *given)
    name = f"step of {whose}"
    assistance = checked_answer(name, state, answer, "assistance")
    way_out = "Assistance(applied_torque=torque)"
    check_like(name, assistance, Assistance(), way_out)
    torque = assistance.applied_torque
    if not method.assists and torque != 0.0:
        raise ValueError(
            f"{name} asks for {torque:g} N·m although assists is False; set assists to "
            "True, or ask for none"
        )


@cache
def hears_triggers(method: Method[Any, Any]) -> bool:
    """Whether a method does anything about a trigger or an indicator.

    It is asked, not read: with and without both for four seconds, in a car that runs
    straight. Who hears neither cannot be told a false, late or missing one.
    """
    measurement = standing_start(RoadParameters())
    asked = Request(crossing_probability=1.0, indicator=measurement.side)
    parameters = usual_parameters(method)

    def after(request: Request) -> str:
        state = method.initial_state(parameters, measurement.lane)
        assistance = Assistance()
        for _ in range(_TRIED_STEPS):
            state, assistance = method.step(
                parameters, state, measurement, request, _DT
            )
        # As text: not a number is then equal to itself.
        return repr((assistance.target.lane, assistance.applied_torque))

    return after(asked) != after(Request())


_TRIED_STEPS = 240
"""Four seconds: the longest that a rule for indicators waits, and some more."""


def _check_columns(method: Method[Any, Any]) -> None:
    """Refuse columns that could be taken for costeer's own.

    Raises:
        ValueError: Naming them.
    """
    for column in method.columns:
        if not (isinstance(column, Column) and isinstance(column.name, str)):
            raise ValueError(
                f"columns of method '{method.name}' hold {short(column)}; give "
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
                f"tunables of method '{method.name}' hold {short(tunable)}; give "
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
