"""The linear loop of driver and car about straight driving, for many drivers at once.

With a gain the guidance is in it too: driver and guidance hold one wheel. Its matrix is
made of central differences of the very functions of a control step, as in
validation/linear.py: no second derivation can go wrong. Noise and dry friction are left
out; the wander of the aim does not depend on the car and adds no eigenvalue to look
at. What a driver leaves to agreeing guidance has no slope at rest, so that here drivers
rely on none. Nor has what a driver lets go: here drivers follow what they see all the
time, which is the linear core of every population.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.controller import step as controller
from costeer.controller import trajectory
from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import NORMAL_DRAWS, DriverNoise, law_of
from costeer.drivers.population import VIRTUAL
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.rows import rules_of
from costeer.loop.step import LoopState, drive, initial_state, move, sense
from costeer.methods.manual import MANUAL
from costeer.plant.road import cruising_lane
from costeer.sensing.measurement import Measurement
from costeer.validation.swing import SLOWEST_SWING

Signal = NDArray[np.float64]
Spectrum = NDArray[np.complex128]

STATES = (
    "lateral_position",
    "yaw_angle",
    "lateral_velocity",
    "yaw_rate",
    "steering_wheel_angle",
    "steering_wheel_rate",
    "motor_torque",
    "torque_command",
    "seen",
    "lagged",
    "equilibrium",
    "felt",
    "reflex",
)
"""What car, wheel, motor, eyes and arms remember about straight driving."""

_STEP = 1e-6


def smooth(parameters: LoopParameters[Any]) -> LoopParameters[Any]:
    """The loop without dry friction, which has no slope at rest."""
    return parameters._replace(column=parameters.column._replace(friction=0.0))


def linear_core(driver: DriverParameters) -> DriverParameters:
    """The linear core of a driver, who relies on no guidance and lets nothing go."""
    return driver._replace(
        reliance=driver.reliance._replace(reliance=0.0),
        tolerance=driver.tolerance._replace(band=0.0),
    )


def quiet(num_steps: int) -> Signal:
    """Draws that move nothing, shape `(num_steps, draw)`."""
    noise = np.ones((num_steps, len(DriverNoise._fields)))
    noise[:, :NORMAL_DRAWS] = 0.0
    return noise


def _stacked(members: Sequence[Any]) -> Any:  # Any: a tree of numbers or of arrays
    """Named tuples of numbers as one of arrays of shape `(member, 1)`."""
    first = members[0]
    if isinstance(first, tuple):
        parts = [_stacked(part) for part in zip(*members, strict=True)]
        return type(first)(*parts)
    return np.array(members, dtype=np.float64)[:, None]


def _displaced(parameters: LoopParameters[Any], x: Signal) -> LoopState[Any]:
    """The loop displaced from straight driving by `x`, `(driver, run, state)`."""
    state = initial_state(rules_of(MANUAL), parameters)
    at = dict(zip(STATES, np.moveaxis(x, -1, 0), strict=True))
    vehicle, hands = state.world.vehicle, state.arm
    aim = vehicle.lateral_position + parameters.driver.tracking.lane_bias
    moved = vehicle._replace(
        lateral_position=aim + at["lateral_position"],
        **{name: at[name] for name in STATES[1:4]},
    )
    wheel = state.world.column._replace(**{name: at[name] for name in STATES[4:7]})
    command = state.control._replace(torque_command=at["torque_command"])
    eyes = state.driver.vision._replace(delayed=at["seen"], lagged=at["lagged"])
    arms = hands._replace(
        equilibrium=at["equilibrium"], delayed=at["felt"], reflex=at["reflex"]
    )
    return state._replace(
        control=command,
        world=state.world._replace(vehicle=moved, column=wheel),
        driver=state.driver._replace(vision=eyes),
        arm=arms,
    )


def instructed_torque(
    parameters: LoopParameters[Any], measurement: Measurement, aim: Real
) -> Real:
    """Guidance torque before the gain, where the driver's aim is the lane's centre.

    Args:
        parameters: Of a trial of the paper's method.
        measurement: This step's sample.
        aim: Distance of the driver's aim from the lane's centre [m].
    """
    road = parameters.road
    at = measurement._replace(lateral_position=measurement.lateral_position - aim)
    keeping = trajectory.initial_state(road, cruising_lane(road))
    target = trajectory.target(keeping, road, at)
    _, torques = controller.instruct(parameters.controller, target, at)
    return torques.instructed_torque


def _after_a_step(parameters: LoopParameters[Any], x: Signal, gain: Real) -> Signal:
    """`STATES` one control step after `x`, up to the place of the aim."""
    state = _displaced(parameters, x)
    noise = DriverNoise(*quiet(1)[0].tolist())
    measurement = sense(parameters, state)
    law = law_of(VIRTUAL)
    driver, action = drive(law, parameters, state, measurement, noise)
    command: Any = 0.0  # Any: a number, or an array of them
    if gain > 0.0:
        aim = parameters.driver.tracking.lane_bias
        command = gain * instructed_torque(parameters, measurement, aim)
    world, hands = move(parameters, state, action)
    vehicle, wheel, eyes = world.vehicle, world.column, driver.vision
    values = (
        *(getattr(vehicle, name) for name in STATES[:4]),
        *(getattr(wheel, name) for name in STATES[4:7]),
        command,
        *(eyes.delayed, eyes.lagged),
        *(hands.equilibrium, hands.delayed, hands.reflex),
    )
    return np.stack([np.broadcast_to(v, x.shape[:-1]) for v in values], axis=-1)


def transition(
    parameters: LoopParameters[Any],
    drivers: Sequence[DriverParameters],
    gain: Real = 0.0,
) -> Signal:
    """Matrix of one control step about straight driving for each driver.

    Of a driver who tolerates nothing: the band is 0, and what is seen is followed.

    Args:
        parameters: Of a trial, of the paper's method if there is a gain; its driver is
            left out.
        drivers: Who holds the wheel, of whom reliance and tolerance are left out.
        gain: K_h times the strength factor; 0 is manual driving [-].

    Returns:
        Shape `(driver, state, state)`, in the order of `STATES`.
    """
    every = smooth(parameters)._replace(
        driver=_stacked(list(map(linear_core, drivers)))
    )
    steps = _STEP * np.concatenate([np.eye(len(STATES)), -np.eye(len(STATES))])
    tried = np.broadcast_to(steps, (len(drivers), *steps.shape))
    ahead, back = np.split(_after_a_step(every, tried, gain), 2, axis=1)
    return np.swapaxes((ahead - back) / (2.0 * _STEP), 1, 2)


def poles(matrices: Signal) -> Spectrum:
    """Eigenvalues of control steps as rates [1/s], shape `(driver, state)`."""
    values = np.linalg.eigvals(matrices).astype(np.complex128)
    # What is gone after one step has no rate; this one is fast enough.
    lasting = np.where(np.abs(values) > 0.0, values, np.exp(-100.0))
    return np.asarray(np.log(lasting) / DT)


def least_damped(rates: Spectrum) -> tuple[Signal, Signal]:
    """Damping ratio [-] and frequency [rad/s] of the swing that lasts longest.

    Args:
        rates: Of the linear loop [1/s], shape `(driver, state)`.

    Returns:
        Shape `(driver,)` each; 1 and NaN without any swing.
    """
    size = np.maximum(np.abs(rates), np.finfo(np.float64).tiny)
    ratio = np.where(rates.imag > SLOWEST_SWING, -rates.real / size, 1.0)
    place = ratio.argmin(axis=1)[:, None]
    least = np.take_along_axis(ratio, place, axis=1)[:, 0]
    frequency = np.take_along_axis(size, place, axis=1)[:, 0]
    return least, np.where(least < 1.0, frequency, np.nan)
