"""The compiled control step at the boundary of real time: packed numbers in and out.

A loop that a wheel waits for hands over one flat array and gets one back: unboxing
deep tuples would cost more than the control step (docs/decisions/0002-engine.md).
Nothing here looks at a clock. The network's verdict comes in from outside.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.base.entry import entry
from costeer.base.packing import leaf_names, pack, packed, packed_size, unpack
from costeer.controller.signals import Request
from costeer.controller.step import ControllerParameters, initial_state, step
from costeer.sensing.measurement import Measurement


class ControlInput(NamedTuple):
    """What the controller is given at one step.

    Attributes:
        measurement: This step's sample.
        request: Verdict of the predictor and what is asked for from outside.
    """

    measurement: Measurement
    request: Request


class PackedController(NamedTuple):
    """Memory of one running controller, as `control_step` takes it.

    Attributes:
        parameters: Packed, shape `(parameter,)`.
        state: Packed, changed in place, shape `(state,)`.
        given: Room for a packed `ControlInput`, shape `(input,)`.
        signals: Room for a packed `Assistance`, shape `(signal,)`.
    """

    parameters: NDArray[np.float64]
    state: NDArray[np.float64]
    given: NDArray[np.float64]
    signals: NDArray[np.float64]


_PARAMETERS = ControllerParameters()
_ZEROS: dict[str, Any] = dict.fromkeys(Measurement._fields, 0.0)  # Any: one is a flag
_NOTHING_MEASURED = Measurement(**(_ZEROS | {"head_yaw_valid": False}))
_INPUT = ControlInput(_NOTHING_MEASURED, Request())
_, _SIGNALS = step(
    _PARAMETERS,
    initial_state(_PARAMETERS, 0.0),
    _NOTHING_MEASURED,
    Request(),
    1.0,
)

INPUT_NAMES = tuple(leaf_names(_INPUT))
"""Name of each number of a packed input, e.g. `measurement.yaw_rate`."""

SIGNAL_NAMES = tuple(leaf_names(_SIGNALS))
"""Name of each number of packed signals, e.g. `guidance.instructed_torque`."""


def packed_controller(parameters: ControllerParameters, lane: Real) -> PackedController:
    """Memory of a controller that starts by keeping `lane`."""
    return PackedController(
        parameters=packed(parameters),
        state=packed(initial_state(parameters, lane)),
        given=packed(_INPUT),
        signals=np.zeros(packed_size(_SIGNALS)),
    )


@entry
def control_step(
    parameters: NDArray[np.float64],
    state: NDArray[np.float64],
    given: NDArray[np.float64],
    signals: NDArray[np.float64],
    dt: float,
) -> None:
    """Run all stages of the controller once.

    Args:
        parameters: Of `PackedController`.
        state: Of `PackedController`, changed in place.
        given: This step's input, in the order of `INPUT_NAMES`.
        signals: Filled in the order of `SIGNAL_NAMES`.
        dt: Control step [s].
    """
    chosen = unpack(_PARAMETERS, parameters)
    like = initial_state(chosen, 0.0)
    measured = unpack(_INPUT, given)
    new_state, computed = step(
        chosen,
        unpack(like, state),
        measured.measurement,
        measured.request,
        dt,
    )
    pack(state, new_state)
    pack(signals, computed)
