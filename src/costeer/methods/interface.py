"""What a method of assistance is: parameters, a state, and one step.

The closed loop calls `step(parameters, state, measurement, crossing_probability,
requested, dt)` and takes the applied torque from the signals it returns. A method
composes controller stages; it never sees the driver or the plant.
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
