"""A whole trial: the closed loop run from start to the end of the road.

The same tick runs in three engines: compiled by Numba (default), as plain Python, and
traced by JAX (loop/jax_rollout.py).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.base.entry import entry
from costeer.base.packing import packed, unpack
from costeer.drivers.decision import time_to_crossing
from costeer.drivers.driver import DriverNoise
from costeer.intention.features import IntentionSample, facing
from costeer.intention.wavefront import WavefrontState, WavefrontWeights, advance
from costeer.loop.rows import fill_row
from costeer.loop.step import (
    DT,
    LoopParameters,
    LoopState,
    Sample,
    initial_state,
    planned_to_cross,
    sense,
    step,
)
from costeer.records.row import ROW_COLUMNS
from costeer.sensing.measurement import Measurement

INTENTION_OFF = 0
INTENTION_SCRIPTED = 1
INTENTION_NETWORK = 2

REQUEST_DURATION = 0.1
"""How long a requested lane change stays requested [s]."""

PREDICTION_HORIZON = 3.0
"""g of Eq. (2): the network predicts a crossing within this time [s]."""

_LIKE = LoopParameters()
_NOISE = DriverNoise(*([0.0] * len(DriverNoise._fields)))


class Script(NamedTuple):
    """Where the crossing probability comes from.

    Attributes:
        intention: `INTENTION_OFF`, `INTENTION_SCRIPTED` or `INTENTION_NETWORK`.
        horizon: A scripted verdict is positive when the driver's own plan crosses the
            line within this time [s].
        trigger_times: When a lane change is requested, shape `(request,)` [s].
    """

    intention: int
    horizon: Real
    trigger_times: NDArray[np.float64]


@compiled
def intention_sample(measurement: Measurement) -> IntentionSample:
    """Eq. (1): the six signals, mirrored so that the adjacent lane is on the right.

    Of a head that the tracker has lost the network is told so.
    """
    seen = xp.select(measurement.head_yaw_valid, measurement.head_yaw, math.nan)
    sample = IntentionSample(
        head_yaw=seen,
        longitudinal_acceleration=measurement.longitudinal_acceleration,
        longitudinal_velocity=measurement.longitudinal_velocity,
        steering_wheel_angle=measurement.steering_wheel_angle,
        distance_to_adjacent_lane=measurement.distance_to_adjacent_lane,
        yaw_angle=measurement.yaw_angle,
    )
    return facing(sample, measurement.side)


@compiled
def scripted_probability(
    parameters: LoopParameters, state: LoopState, horizon: Real
) -> Real:
    """1 while the driver's own plan crosses the line within `horizon` [s], else 0.

    A system that follows the plan begins when the driver does, half the planned
    duration before the crossing.
    """
    plan = state.driver.decision
    begins = xp.select(
        parameters.follows_plan > 0.5, plan.change_duration / 2.0, horizon
    )
    return xp.select(planned_to_cross(time_to_crossing(plan), begins), 1.0, 0.0)


@compiled
def requested(trigger_times: NDArray[np.float64], time: Real) -> Flag:
    """Whether a lane change is requested at `time` [s]."""
    asked = False
    for i in range(len(trigger_times)):
        since = time - trigger_times[i] + 0.5 * DT
        asked = asked | ((since >= 0.0) & (since < REQUEST_DURATION))
    return asked


@compiled
def tick(
    parameters: LoopParameters,
    state: LoopState,
    script: Script,
    weights: WavefrontWeights,
    memory: WavefrontState,
    noise: DriverNoise,
) -> tuple[LoopState, Sample]:
    """One control step with its verdict and its sample."""
    measurement = sense(parameters, state)
    probability = math.nan
    if script.intention == INTENTION_SCRIPTED:
        probability = scripted_probability(parameters, state, script.horizon)
    if script.intention == INTENTION_NETWORK:
        probability = advance(weights, memory, intention_sample(measurement))
    asked = requested(script.trigger_times, state.time)
    return step(parameters, state, measurement, probability, asked, noise)


@compiled
def run(
    parameters: LoopParameters,
    script: Script,
    weights: WavefrontWeights,
    memory: WavefrontState,
    noise: NDArray[np.float64],
    rows: NDArray[np.float64],
) -> int:
    """Fill `rows` until the road or the noise ends; return how many were filled.

    Args:
        parameters: Of the trial.
        script: Where the crossing probability comes from.
        weights: Of the network.
        memory: Of the network, changed in place.
        noise: Random numbers, shape `(time, draw)`.
        rows: Filled in the order of `ROW_COLUMNS`, shape `(time, column)`.
    """
    state = initial_state(parameters)
    for k in range(len(noise)):
        drawn = unpack(_NOISE, noise[k])
        state, sample = tick(parameters, state, script, weights, memory, drawn)
        fill_row(rows[k], sample)
        if state.world.vehicle.longitudinal_position >= parameters.road.length:
            return k + 1
    return len(noise)


@entry
def _run_compiled(
    packed_parameters: NDArray[np.float64],
    script: Script,
    weights: WavefrontWeights,
    memory: WavefrontState,
    noise: NDArray[np.float64],
    rows: NDArray[np.float64],
) -> int:
    parameters = unpack(_LIKE, packed_parameters)
    return run(parameters, script, weights, memory, noise, rows)


def rollout(
    parameters: LoopParameters,
    script: Script,
    weights: WavefrontWeights,
    memory: WavefrontState,
    noise: NDArray[np.float64],
    engine: str,
) -> NDArray[np.float64]:
    """Run one trial.

    Args:
        parameters: Of the trial.
        script: Where the crossing probability comes from.
        weights: Of the network.
        memory: Of the network, changed in place.
        noise: Random numbers, shape `(time, draw)`.
        engine: "numba", "python" or "jax"; JAX runs no network.

    Returns:
        Rows in the order of `ROW_COLUMNS`, shape `(time, column)`.

    Raises:
        ValueError: If the engine is not known, or JAX is asked for the network.
        ModuleNotFoundError: If the engine is not installed.
    """
    if engine == "jax":
        from costeer.loop.jax_rollout import jax_rollout

        return jax_rollout(parameters, script, noise)
    rows = np.empty((len(noise), len(ROW_COLUMNS)))
    if engine == "numba":
        given = packed(parameters)
        count = _run_compiled(given, script, weights, memory, noise, rows)
    elif engine == "python":
        count = run(parameters, script, weights, memory, noise, rows)
    else:
        raise ValueError(f"engine '{engine}' is not known; choose numba, python or jax")
    return rows[:count]
