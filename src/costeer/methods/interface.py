"""What a method of assistance is: parameters, a state, and one step.

The loop calls nothing else. A method sees measurements, never the driver or the plant;
it may compose stages of the paper's controller or bring a law of its own. Its functions
are pure and marked `compiled`, so that every engine runs them.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from typing import Any, Generic, NamedTuple, TypeVar

from costeer.base.array import Real
from costeer.base.packing import leaf_names, packed
from costeer.base.plugins import source_hash
from costeer.controller.signals import Assistance, Request
from costeer.methods.conditions import CONDITIONS, Condition
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.records.columns import METHOD_PREFIX, Column
from costeer.sensing.measurement import Measurement

P = TypeVar("P")
S = TypeVar("S")

_NAME = re.compile(r"[a-z][a-z0-9-]{0,39}")


class Rule(NamedTuple, Generic[P, S]):
    """The functions of a method that the loop calls, as compiled code takes them.

    Attributes:
        initial_state: From the parameters and the lane that the car starts in.
        step: Parameters, state, measurement, request and dt to the new state and the
            assistance.
    """

    initial_state: Callable[[P, Real], S]
    step: Callable[[P, S, Measurement, Request, Real], tuple[S, Assistance]]


class Tunable(NamedTuple):
    """One number of a method that an experimenter may change while a person drives.

    Attributes:
        name: Short, as pages and records say it.
        leaf: Dotted place in the parameters of the method.
        unit: SI, "-" if there is none.
        low: Smallest value.
        high: Largest value.
        label: For people.
    """

    name: str
    leaf: str
    unit: str
    low: Real
    high: Real
    label: str


class Method(NamedTuple, Generic[P, S]):
    """One way to assist.

    Attributes:
        name: On the command line and in records: small letters, digits, hyphens.
        version: Changes with the law.
        source: Publication it follows.
        parameters: From the condition of a trial and the nominal car, column and road
            to the method's parameters: named tuples of floats, arrays and flags.
        initial_state: From the parameters and the lane that the car starts in.
        step: One control step.
        assists: Whether it ever gives a torque; if not, the guidance columns of a
            record are empty.
        columns: What it adds to a record: names that begin with `method_`, sources in
            its state, as `method.integral`.
        tunables: What an experimenter may move during a drive.

    Example:
        >>> from typing import NamedTuple
        >>> import costeer
        >>> from costeer.controller.signals import NO_ASSISTANCE
        >>> class Damping(NamedTuple):
        ...     gain: float = 0.5
        >>> class Memory(NamedTuple):
        ...     steps: float = 0.0
        >>> @costeer.compiled
        ... def initial_state(parameters, lane):
        ...     return Memory()
        >>> @costeer.compiled
        ... def step(parameters, state, measurement, request, dt):
        ...     torque = -parameters.gain * measurement.steering_wheel_rate
        ...     steps = Memory(steps=state.steps + 1.0)
        ...     return steps, NO_ASSISTANCE._replace(applied_torque=torque)
        >>> damping = costeer.Method(
        ...     name="damping",
        ...     version="1",
        ...     source="an example",
        ...     parameters=lambda condition, car, column, road: Damping(),
        ...     initial_state=initial_state,
        ...     step=step,
        ... )
        >>> damping
        <costeer method damping 1>
        >>> quick = {"length": 100, "intention": "off", "engine": "python"}
        >>> costeer.simulate("strong-rapid", method=damping, **quick).metadata["method"]
        'damping'
    """

    name: str
    version: str
    source: str
    parameters: Callable[
        [Condition, CarParameters, ColumnParameters, RoadParameters], P
    ]
    initial_state: Callable[[P, Real], S]
    step: Callable[[P, S, Measurement, Request, Real], tuple[S, Assistance]]
    assists: bool = True
    columns: tuple[Column, ...] = ()
    tunables: tuple[Tunable, ...] = ()

    def __repr__(self) -> str:
        """Name and version; functions say nothing."""
        return f"<costeer method {self.name} {self.version}>"


def rule_of(method: Method[P, S]) -> Rule[P, S]:
    """What the loop calls of a method."""
    return Rule(initial_state=method.initial_state, step=method.step)


_COMPILED: dict[tuple[Any, ...], Any] = {}


def compiled_once(make: Callable[[Method[P, S]], Any], method: Method[P, S]) -> Any:
    """What `make` compiles for a method, made once for all that share its rule.

    `manual` runs the paper's controller in the shadow: it needs no code of its own.
    """
    key = (make, rule_of(method), method.columns)
    if key not in _COMPILED:
        _COMPILED[key] = make(method)
    return _COMPILED[key]


def method_sources(method: Method[P, S]) -> str:
    """Hash of all that decides what a method computes, outside costeer."""
    return source_hash((method.parameters, method.initial_state, method.step))


def usual_parameters(method: Method[P, S]) -> P:
    """Parameters of a method with nothing out of the ordinary."""
    return method.parameters(
        CONDITIONS[1], CarParameters(), ColumnParameters(), RoadParameters()
    )


def checked_method(method: Any) -> Method[Any, Any]:  # Any: of whoever made it
    """The method, if the loop can run it.

    Raises:
        ValueError: Naming what is missing or wrong.
    """
    if not isinstance(method, Method):
        raise ValueError(
            f"{method!r} is no method; make one with costeer.Method(name=..., ...)"
        )
    try:
        return _checked(method)
    except TypeError as error:
        raise ValueError(
            f"method {method.name!r} cannot be kept: {error}; give columns and "
            "tunables as tuples"
        ) from error


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
    _check_parameters(method)
    _check_columns(method)
    return method


def _check_parameters(method: Method[P, S]) -> None:
    """Refuse parameters that cannot be packed, and tunables that are none of them.

    Raises:
        ValueError: Naming them.
    """
    try:
        given: Any = usual_parameters(method)  # Any: of the method's own kind
    except (TypeError, ArithmeticError, LookupError, AttributeError) as error:
        raise ValueError(
            f"method '{method.name}' makes no parameters: {type(error).__name__}: "
            f"{error}; its function takes condition, car, column and road"
        ) from error
    try:
        packed(given)
        leaves = leaf_names(given) if isinstance(given, tuple) else []
    except (TypeError, ValueError, AttributeError) as error:
        raise ValueError(
            f"parameters of method '{method.name}' are no named tuple of numbers: "
            f"{error}"
        ) from error
    if not hasattr(given, "_fields"):
        raise ValueError(
            f"parameters of method '{method.name}' are {given!r}; give a named tuple"
        )
    for tunable in method.tunables:
        if tunable.leaf not in leaves:
            raise ValueError(
                f"tunable '{tunable.name}' of method '{method.name}' lies at "
                f"'{tunable.leaf}', which is none of {', '.join(leaves)}"
            )


def _check_columns(method: Method[P, S]) -> None:
    """Refuse columns that could be taken for costeer's own.

    Raises:
        ValueError: Naming them.
    """
    for column in method.columns:
        if not column.name.startswith(METHOD_PREFIX):
            raise ValueError(
                f"column '{column.name}' of method '{method.name}' must begin with "
                f"{METHOD_PREFIX}, so that it is not taken for one of costeer's own"
            )
