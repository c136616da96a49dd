"""One control step of a trial with its verdict, and the steps that fill its rows.

The same source runs in three engines: compiled by Numba or as plain Python
(loop/rollout.py), and traced by JAX (loop/jax_rollout.py).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numba.extending import overload
from numpy.typing import NDArray

from costeer.base import array as xp
from costeer.base import lanes
from costeer.base.array import Flag, Real, compiled, inlined
from costeer.base.packing import unpack
from costeer.controller.signals import Request
from costeer.drivers.interface import DriverNoise
from costeer.intention.bracket import advance
from costeer.intention.features import IntentionSample, beyond_bend, facing
from costeer.intention.starts import BracketState, BracketWeights
from costeer.loop.endings import has_stopped, still
from costeer.loop.events import has_collided
from costeer.loop.half_step import Sample
from costeer.loop.mistakes import POSITIVE
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.rows import LoopRule
from costeer.loop.step import (
    LoopState,
    Rules,
    own_duration,
    planned_to_cross,
    sense,
    step,
)
from costeer.plant.alignment import line_curvature
from costeer.plant.fleet import num_cars, write_cars
from costeer.plant.parameters import CarParameters, RoadParameters
from costeer.plant.road import lane_exists
from costeer.sensing.measurement import Measurement, facing_beyond

S = TypeVar("S")

INTENTION_OFF = 0
INTENTION_SCRIPTED = 1
INTENTION_NETWORK = 2
INTENTION_GIVEN = 3

REQUEST_DURATION = 0.1
"""How long a requested lane change stays requested [s]."""

PREDICTION_HORIZON = 3.0
"""g of Eq. (2): the network predicts a crossing within this time [s]."""

_NOISE = DriverNoise(*([0.0] * len(DriverNoise._fields)))


class Script(NamedTuple):
    """Where the crossing probability comes from.

    Attributes:
        intention: `INTENTION_OFF`, `INTENTION_SCRIPTED`, `INTENTION_NETWORK`, or
            `INTENTION_GIVEN` by a predictor outside the loop.
        horizon: A scripted verdict is positive when the driver's own plan crosses the
            line within this time [s].
        trigger_times: When a lane change is requested, shape `(request,)` [s].
        probability: The verdict that is given, NaN for none [-].
        side: That it is about, -1 right, +1 left; 0: the usual one [-].
    """

    intention: int
    horizon: Real
    trigger_times: NDArray[np.float64]
    probability: Real = math.nan
    side: Real = 0.0


class Network(NamedTuple):
    """The intention network of a trial.

    Attributes:
        weights: As the kernel takes them; their band says in which form it runs.
        memory: Its windows, changed in place.
        beyond: The same for the lane on the other side, where there may be one.
    """

    weights: BracketWeights
    memory: BracketState
    beyond: BracketState


class Verdict(NamedTuple):
    """What is said of the next seconds.

    Attributes:
        probability: Of a crossing; NaN for no verdict [-].
        side: To which it leads, -1 right, +1 left; 0: the usual one [-].
    """

    probability: Real
    side: Real


NO_VERDICT = Verdict(math.nan, 0.0)
"""Where nobody is asked."""


@compiled
def likelier(
    road: RoadParameters, lane: Real, side: Real, usual: Real, other: Real
) -> Verdict:
    """The verdict of two: on the usual side unless the other one says yes, and louder.

    Args:
        road: Its lanes.
        lane: That the car is in [-].
        side: The usual one, -1 right or +1 left [-].
        usual: Crossing probability to that side [-].
        other: To the other side; counts only where there is a lane [-].
    """
    louder = (other >= POSITIVE) & xp.logical_not(usual >= other)
    counts = lane_exists(road, lane - side) & louder
    return Verdict(xp.select(counts, other, usual), xp.select(counts, -side, side))


@compiled
def intention_sample(car: CarParameters, measurement: Measurement) -> IntentionSample:
    """Eq. (1): the six signals, mirrored so that the adjacent lane is on the right.

    What the road's bend asks for is taken off. Of a head that the tracker has lost the
    network is told so.
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
    bend = line_curvature(measurement.road_curvature, measurement.lateral_position)
    return facing(beyond_bend(car, sample, bend), measurement.side)


def probability_of(
    weights: BracketWeights, memory: BracketState, sample: IntentionSample
) -> Real:
    """What the network says of a sample, NaN before its window is full [-].

    Args:
        weights: Of the network.
        memory: Changed in place; of eight trials, arrays with an axis of lanes first.
        sample: Facing right.
    """
    return advance(weights, memory, sample)


@overload(probability_of, strict=False)
def _probability_of(weights: Any, memory: Any, sample: Any) -> Any:
    if not lanes.in_lanes(sample):
        return lambda weights, memory, sample: advance(weights, memory, sample)

    def of_each(weights: Any, memory: Any, sample: Any) -> Any:
        told = np.empty((1, lanes.WIDTH))
        for lane in range(lanes.WIDTH):
            own = BracketState(
                memory.hidden[lane],
                memory.ring[lane],
                memory.inputs[lane],
                memory.absent[lane],
                memory.counters[lane],
            )
            told[0, lane] = advance(weights, own, lanes.of_lane(sample, lane))
        return lanes.load(told, 0)

    return of_each


@compiled
def network_verdict(
    car: CarParameters,
    road: RoadParameters,
    network: Network,
    measurement: Measurement,
) -> Verdict:
    """What the network says: asked for each side where there may be lanes on both."""
    sample = intention_sample(car, measurement)
    usual = probability_of(network.weights, network.memory, sample)
    if road.num_lanes <= 2.0:
        return Verdict(usual, measurement.side)
    turned = facing_beyond(road, measurement)
    beyond = intention_sample(car, turned)
    other = probability_of(network.weights, network.beyond, beyond)
    return likelier(road, measurement.lane, measurement.side, usual, other)


@compiled
def scripted_probability(
    parameters: LoopParameters[Any], state: LoopState[S], horizon: Real
) -> Real:
    """1 while the driver's own plan crosses the line within `horizon` [s], else 0.

    A system that follows the plan begins when the driver does, half the planned
    duration before the crossing.
    """
    plan = state.plan
    begins = xp.select(
        parameters.follows_plan > 0.5, plan.change_duration / 2.0, horizon
    )
    return xp.select(planned_to_cross(plan.time_to_crossing, begins), 1.0, 0.0)


@compiled
def scripted_verdict(
    parameters: LoopParameters[Any], state: LoopState[S], horizon: Real
) -> Verdict:
    """What a system says that knows the driver's plan."""
    crosses = scripted_probability(parameters, state, horizon)
    return Verdict(crosses, state.plan.side)


@compiled
def requested(trigger_times: NDArray[np.float64], time: Real) -> Flag:
    """Whether a lane change is requested at `time` [s]."""
    asked = False
    for i in range(len(trigger_times)):
        since = time - trigger_times[i] + 0.5 * DT
        asked = asked | ((since >= 0.0) & (since < REQUEST_DURATION))
    return asked


@inlined
def tick(
    rules: Rules[Any, S],
    parameters: LoopParameters[Any],
    state: LoopState[S],
    script: Script,
    network: Network,
    noise: DriverNoise,
) -> tuple[LoopState[S], Sample[S]]:
    """One control step with its verdict and its sample."""
    measurement = sense(parameters, state)
    verdict = Verdict(script.probability, script.side)  # NaN unless it is given
    scripted = parameters, state, script.horizon
    verdict = xp.when(
        script.intention == INTENTION_SCRIPTED, scripted_verdict, scripted, verdict
    )
    asks = parameters.car, parameters.road, network, measurement
    verdict = xp.when(
        script.intention == INTENTION_NETWORK, network_verdict, asks, verdict
    )
    request = Request(
        crossing_probability=verdict.probability,
        requested=requested(script.trigger_times, state.control.time),
        change_duration=own_duration(parameters, state),
        side=verdict.side,
    )
    return step(rules, parameters, state, measurement, request, noise)


@compiled
def run(
    loop: LoopRule[Any, S],
    parameters: LoopParameters[Any],
    state: LoopState[S],
    script: Script,
    network: Network,
    noise: NDArray[np.float64],
    rows: NDArray[np.float64],
) -> tuple[LoopState[S], int]:
    """Fill `rows` until road or noise end, the car hits something or stands for good.

    Returns the state then, and how many rows were filled.

    Args:
        loop: The functions of the loop.
        parameters: Of the trial.
        state: At the beginning.
        script: Where the crossing probability comes from.
        network: Of the intention.
        noise: Random numbers, shape `(time, draw)`.
        rows: Filled in the order of `ROW_COLUMNS`, shape `(time, column)`.
    """
    standing = 0.0
    for k in range(len(noise)):
        drawn = unpack(_NOISE, noise[k])
        state, sample = tick(loop.rules, parameters, state, script, network, drawn)
        loop.fill(rows[k], sample)
        write_cars(rows[k], num_cars(parameters.fleet), sample.events.fleet)
        standing = still(standing, sample.measurement.longitudinal_velocity)
        if has_collided(sample.events) or has_stopped(standing):
            return state, k + 1
        if state.world.vehicle.longitudinal_position >= parameters.road.length:
            return state, k + 1
    return state, len(noise)
