"""What a method of assistance is: parameters, a state, and one step.

A method's `step(parameters, state, measurement, crossing_probability, requested, dt)`
returns its signals, the applied torque among them. A method composes controller
stages; it never sees the driver or the plant. `ibhs` and `manual` share one step, so
that the closed loop is compiled once (loop/step.py calls it); a method with a step of
its own brings a compiled loop of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from costeer.base.array import Flag, Real
from costeer.controller.signals import Signals
from costeer.controller.step import ControllerParameters, ControllerState
from costeer.plant.parameters import RoadParameters
from costeer.sensing.measurement import Measurement

Step = Callable[
    [ControllerParameters, ControllerState, Measurement, Real, Flag, Real],
    tuple[ControllerState, Signals],
]


class Method(NamedTuple):
    """One way to assist.

    Attributes:
        name: On the command line and in records.
        source: Publication it follows.
        assists: Whether it ever gives a torque; if not, the guidance columns of a
            record are empty.
        initial_state: From the road and the lane that the car starts in.
        step: One control step.
    """

    name: str
    source: str
    assists: bool
    initial_state: Callable[[RoadParameters, Real], ControllerState]
    step: Step
