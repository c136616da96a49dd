"""Linear analysis of the closed loop without hands: eigenvalues and margins.

The loop is vehicle, column, motor lag, one control step of latency and the zero-order
hold at 60 Hz. Its matrices are central differences of the very functions that the
simulation runs, so there is no second derivation to go wrong; the vehicle's block is
checked against the textbook's (tests/loop/test_linear.py). Dry friction has no slope
at rest: it is left out, and its compensation is either left out too or taken with
its slope at zero, where it more than doubles the guidance. The truth lies between.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.controller import step as controller
from costeer.controller import trajectory
from costeer.controller.step import ControllerParameters
from costeer.loop.parameters import DT, LoopParameters
from costeer.plant import world
from costeer.plant.parameters import ColumnParameters
from costeer.plant.road import cruising_lane, lane_centre
from costeer.plant.steering import ColumnState
from costeer.plant.vehicle import VehicleState, resistance
from costeer.plant.world import Inputs, WorldState
from costeer.sensing.sensors import initial_tracker, measure

STATES = (
    "lateral_position",
    "yaw_angle",
    "lateral_velocity",
    "yaw_rate",
    "steering_wheel_angle",
    "steering_wheel_rate",
    "motor_torque",
)
"""What the linear plant remembers; the torque command in its delay comes on top."""

_STEP = 1e-6
_SMALLEST_MARGIN = 1e-2
_LARGEST_MARGIN = 1e3
_MARGIN_STEP = 1.03
_NUM_FREQUENCIES = 4000

Vector: TypeAlias = NDArray[np.float64]
Spectrum: TypeAlias = NDArray[np.complex128]


class LinearLoop(NamedTuple):
    """One control step about straight driving in the middle of the lane.

    With x the states: x' = transition x + command u and tau_hapi = feedback x, where u
    is K_h times the tau_hapi of the control step before.

    Attributes:
        transition: Shape `(state, state)`.
        command: Effect of the torque command, shape `(state,)`.
        feedback: Guidance torque before the gain, shape `(state,)`.
    """

    transition: Vector
    command: Vector
    feedback: Vector


def _without_friction(column: ColumnParameters) -> ColumnParameters:
    """The column with nothing that has no slope at rest."""
    return column._replace(friction=0.0)


def _world(
    parameters: LoopParameters[ControllerParameters], states: Vector
) -> WorldState:
    """The world in the given deviation from straight driving."""
    car, speed = parameters.car, parameters.start.speed
    centre = lane_centre(parameters.road, cruising_lane(parameters.road))
    y, yaw, sideways, yaw_rate, angle, rate, torque = states.tolist()
    return WorldState(
        vehicle=VehicleState(
            longitudinal_position=0.0,
            lateral_position=centre + y,
            yaw_angle=yaw,
            longitudinal_velocity=speed,
            lateral_velocity=sideways,
            yaw_rate=yaw_rate,
            drive=resistance(car, speed),
        ),
        column=ColumnState(angle, rate, torque),
    )


def _deviation(
    parameters: LoopParameters[ControllerParameters], state: WorldState
) -> Vector:
    """The inverse of `_world`."""
    centre = lane_centre(parameters.road, cruising_lane(parameters.road))
    vehicle = state.vehicle
    return np.array(
        [
            vehicle.lateral_position - centre,
            vehicle.yaw_angle,
            vehicle.lateral_velocity,
            vehicle.yaw_rate,
            *state.column,
        ]
    )


def _moved(
    parameters: LoopParameters[ControllerParameters], states: Vector, command: Real
) -> Vector:
    """States one control step later, without dry friction."""
    column = _without_friction(parameters.column)
    state = _world(parameters, states)
    inputs = Inputs(0.0, command, state.vehicle.drive)
    for _ in range(parameters.plant_steps):
        state = world.step(
            parameters.car, column, state, inputs, DT / parameters.plant_steps
        )
    return _deviation(parameters, state)


def _instructed(
    parameters: LoopParameters[ControllerParameters], states: Vector, compensated: bool
) -> Vector:
    """Guidance torque before the gain in lane keeping, shape `(1,)` [N·m]."""
    method, road = parameters.controller, parameters.road
    if not compensated:
        method = method._replace(column=_without_friction(method.column))
    measurement = measure(
        parameters.car, road, _world(parameters, states), 0.0, initial_tracker()
    )
    keeping = trajectory.initial_state(road, cruising_lane(road))
    target = trajectory.target(keeping, road, measurement)
    _, torques = controller.instruct(method, target, measurement)
    return np.array([torques.instructed_torque])


def _derivative(function: Callable[[Vector], Vector], size: int) -> Vector:
    """Matrix of central differences about zero, shape `(output, input)`."""
    steps = _STEP * np.eye(size)
    columns = [(function(s) - function(-s)) / (2.0 * _STEP) for s in steps]
    return np.transpose(columns)


def linear_loop(
    parameters: LoopParameters[ControllerParameters], compensated: bool = False
) -> LinearLoop:
    """Linearise vehicle, column, motor and lane-keeping guidance.

    Args:
        parameters: Of a trial; its driver is left out.
        compensated: Take the friction compensation with its slope at zero; left out
            if false.
    """
    size, at_rest = len(STATES), np.zeros(len(STATES))
    return LinearLoop(
        transition=_derivative(lambda x: _moved(parameters, x, 0.0), size),
        command=_derivative(lambda u: _moved(parameters, at_rest, float(u[0])), 1)[
            :, 0
        ],
        feedback=_derivative(lambda x: _instructed(parameters, x, compensated), size)[
            0
        ],
    )


def closed_loop(loop: LinearLoop, gain: Real, extra_delay: int = 0) -> Vector:
    """Matrix of one control step with the loop closed.

    Args:
        loop: Linear plant and guidance.
        gain: K_h times the strength factor [-].
        extra_delay: Control steps of latency beyond the one that there is.
    """
    size = len(loop.command)
    matrix = np.zeros((size + 1 + extra_delay, size + 1 + extra_delay))
    matrix[:size, :size] = loop.transition
    matrix[:size, size] = loop.command
    for k in range(extra_delay):
        matrix[size + k, size + k + 1] = 1.0
    matrix[-1, :size] = gain * loop.feedback
    return matrix


def poles(loop: LinearLoop, gain: Real) -> Spectrum:
    """Eigenvalues of the closed loop as rates [1/s], slowest to decay first."""
    values = np.linalg.eigvals(closed_loop(loop, gain)).astype(np.complex128)
    lasting = values[values != 0.0]  # what is gone after one step has no rate
    rates = np.asarray(np.log(lasting) / DT, dtype=np.complex128)
    return rates[np.argsort(-rates.real)]


def largest_modulus(loop: LinearLoop, gain: Real, extra_delay: int = 0) -> Real:
    """Largest eigenvalue modulus of one control step; stable below 1."""
    values = np.linalg.eigvals(closed_loop(loop, gain, extra_delay))
    return float(np.abs(values).max())


def damping_ratio(loop: LinearLoop, gain: Real) -> Real:
    """Smallest damping ratio of all oscillations, 1 if there is none [-]."""
    rates = poles(loop, gain)
    swinging = rates[rates.imag > 0.0]
    return float((-swinging.real / np.abs(swinging)).min(initial=1.0))


def gain_margin(loop: LinearLoop, gain: Real) -> Real:
    """Factor by which the guidance may grow before the loop is unstable [-].

    Below 1 for a loop that is unstable as it is; infinite beyond 1000.
    """
    low = high = _SMALLEST_MARGIN
    while largest_modulus(loop, gain * high) < 1.0:
        low, high = high, high * _MARGIN_STEP
        if high > _LARGEST_MARGIN:
            return math.inf
    for _ in range(30):
        middle = math.sqrt(low * high)
        if largest_modulus(loop, gain * middle) >= 1.0:
            high = middle
        else:
            low = middle
    return low


def loop_gain(loop: LinearLoop, gain: Real, frequencies: Vector) -> Spectrum:
    """Open loop from torque command to torque command, one latency step included.

    Args:
        loop: Linear plant and guidance.
        gain: K_h times the strength factor [-].
        frequencies: Shape `(frequency,)` [rad/s].

    Returns:
        Shape `(frequency,)`; the closed loop is on the brink where it is 1.
    """
    shift = np.exp(1j * frequencies * DT)
    unit = np.eye(len(loop.command))
    matrices = shift[:, None, None] * unit - loop.transition
    answers = np.linalg.solve(matrices, loop.command[:, None])[..., 0]
    response: Spectrum = gain * (answers @ loop.feedback) / shift
    return response


def delay_margin(loop: LinearLoop, gain: Real) -> Real:
    """Latency that a stable loop bears on top of its own [s]; 0 if it is unstable."""
    if largest_modulus(loop, gain) >= 1.0:
        return 0.0
    frequencies = np.geomspace(1e-2, math.pi / DT, _NUM_FREQUENCIES)
    response = loop_gain(loop, gain, frequencies)
    size = np.log(np.abs(response))
    crossing = np.flatnonzero(size[:-1] * size[1:] < 0.0)
    share = size[crossing] / (size[crossing] - size[crossing + 1])
    angle = np.unwrap(np.angle(response))
    phase = angle[crossing] + share * (angle[crossing + 1] - angle[crossing])
    step = frequencies[crossing + 1] - frequencies[crossing]
    frequency = frequencies[crossing] + share * step
    return float((np.mod(phase, 2.0 * math.pi) / frequency).min(initial=math.inf))
