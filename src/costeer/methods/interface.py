"""What a method of assistance is: parameters, a state, and one step.

The loop calls nothing else. A method sees measurements, never the driver or the plant;
it may compose stages of the paper's controller or bring a law of its own. Its functions
are pure and marked `compiled`, so that every engine runs them.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable
from functools import cache
from typing import Any, Generic, NamedTuple, TypeVar

from costeer.base.array import Real
from costeer.base.packing import layout_of
from costeer.base.sources import source_hash
from costeer.controller.signals import Assistance, Request
from costeer.methods.conditions import CONDITIONS, Condition
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.records.columns import Column
from costeer.sensing.measurement import Measurement

P = TypeVar("P")
S = TypeVar("S")


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
        >>> from costeer.controller.signals import Assistance
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
        ...     return steps, Assistance(applied_torque=torque)
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
_COMPILING = threading.RLock()


def compiled_once(
    make: Callable[[Method[P, S]], Any], method: Method[P, S], *others: Hashable
) -> Any:  # Any: a compiled function of Numba
    """What `make` compiles for a method, made once for all that share its rule.

    Args:
        make: Called with the method; a partial is known by its function.
        method: Whose functions are compiled.
        *others: What else decides the machine code.

    `manual` runs the paper's controller in the shadow: it needs no code of its own.
    """
    key = (
        getattr(make, "func", make),
        rule_of(method),
        method.columns,
        _layout(method),
        *others,
    )
    with _COMPILING:  # threads drive the trials of a study
        if key not in _COMPILED:
            _COMPILED[key] = make(method)
        return _COMPILED[key]


@cache
def _layout(method: Method[P, S]) -> tuple[tuple[str, str], ...]:
    """How the parameters of a method lie in compiled code."""
    return layout_of(usual_parameters(method))


def method_sources(method: Method[P, S]) -> str:
    """Hash of all that decides what a method computes, outside costeer."""
    return source_hash((method.parameters, method.initial_state, method.step))


def usual_parameters(method: Method[P, S]) -> P:
    """Parameters of a method with nothing out of the ordinary."""
    return method.parameters(
        CONDITIONS[1], CarParameters(), ColumnParameters(), RoadParameters()
    )
