"""Will the car cross the lane line within 3 s: trigger and lock (Sec. II-B)."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.controller.signals import Intention
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import lane_centre
from costeer.sensing.measurement import Measurement


class InferenceParameters(NamedTuple):
    """When a probability becomes a trigger.

    Attributes:
        threshold: Positive from this crossing probability on [-]. Source: paper,
            sigmoid output, 0.5.
        trigger_samples: Positives in a row that make a trigger [-]. Source: assumed,
            3 samples are 50 ms: one outlier is no trigger.
        lock_duration: Longest lock after the end of a path [s]. Source: assumed, the
            car comes to rest in the lane within it.
        settled_duration: The lock ends when the car has been settled so long [s].
            Source: assumed.
        settled_offset: Largest distance from the lane's centre of a settled car [m].
            Source: assumed, three times the human SDLP is not reached at random.
        settled_yaw: Largest yaw angle of a settled car [rad]. Source: assumed, 0.5
            deg ends a lane change in the paper's measures.
    """

    threshold: Real = 0.5
    trigger_samples: Real = 3.0
    lock_duration: Real = 3.0
    settled_duration: Real = 0.5
    settled_offset: Real = 0.3
    settled_yaw: Real = 0.008726646259971648


class Debouncing(Protocol):
    """What of the parameters does not depend on where a verdict comes from."""

    @property
    def trigger_samples(self) -> Real: ...  # noqa: D102
    @property
    def lock_duration(self) -> Real: ...  # noqa: D102
    @property
    def settled_duration(self) -> Real: ...  # noqa: D102
    @property
    def settled_offset(self) -> Real: ...  # noqa: D102
    @property
    def settled_yaw(self) -> Real: ...  # noqa: D102


class InferenceState(NamedTuple):
    """What the trigger remembers.

    Attributes:
        num_positive: Positives in a row [-].
        locked: No trigger while true.
        time_locked: Since the lock began [s].
        time_settled: Since the car has been settled [s].
    """

    num_positive: Real
    locked: Flag
    time_locked: Real
    time_settled: Real


@compiled
def initial_state() -> InferenceState:
    """Nothing seen, not locked."""
    return InferenceState(
        num_positive=0.0, locked=False, time_locked=0.0, time_settled=0.0
    )


@compiled
def settled(
    parameters: Debouncing, road: RoadParameters, measurement: Measurement
) -> Flag:
    """Whether the car runs straight near the centre of its lane."""
    centre = lane_centre(road, measurement.lane)
    offset = measurement.lateral_position - centre
    near = (offset < parameters.settled_offset) & (offset > -parameters.settled_offset)
    yaw = measurement.yaw_angle
    straight = (yaw < parameters.settled_yaw) & (yaw > -parameters.settled_yaw)
    return near & straight


@compiled
def lock(
    parameters: Debouncing,
    state: InferenceState,
    is_settled: Flag,
    path_ended: Flag,
    dt: Real,
) -> InferenceState:
    """The lock after one step: set by the end of a path, lifted by rest or time.

    Args:
        parameters: How long.
        state: Before the step.
        is_settled: Of the car now.
        path_ended: Whether a path came to its end at the step before.
        dt: Control step [s].
    """
    time_locked = xp.select(path_ended, 0.0, state.time_locked + dt)
    time_settled = xp.select(
        is_settled & xp.logical_not(path_ended), state.time_settled + dt, 0.0
    )
    released = (time_settled >= parameters.settled_duration) | (
        time_locked >= parameters.lock_duration
    )
    return InferenceState(
        num_positive=state.num_positive,
        locked=(state.locked | path_ended) & xp.logical_not(released),
        time_locked=time_locked,
        time_settled=time_settled,
    )


@compiled
def debounce(
    parameters: Debouncing,
    state: InferenceState,
    road: RoadParameters,
    measurement: Measurement,
    positive: Flag,
    path_ended: Flag,
    dt: Real,
) -> tuple[InferenceState, Intention]:
    """Count positives while nothing locks; return the state and the intention.

    Args:
        parameters: Samples, lock.
        state: Of the trigger.
        road: Lanes, for the settled car.
        measurement: Lane, side and rest of the car.
        positive: Whether this sample speaks for a crossing.
        path_ended: Whether a path came to its end at the step before.
        dt: Control step [s].
    """
    is_settled = settled(parameters, road, measurement)
    state = lock(parameters, state, is_settled, path_ended, dt)
    counted = positive & xp.logical_not(state.locked)
    num_positive = xp.select(counted, state.num_positive + 1.0, 0.0)
    new_state = state._replace(num_positive=num_positive)
    detected = num_positive >= parameters.trigger_samples
    return new_state, Intention(detected=detected, side=measurement.side)


@compiled
def step(
    parameters: InferenceParameters,
    state: InferenceState,
    road: RoadParameters,
    measurement: Measurement,
    crossing_probability: Real,
    path_ended: Flag,
    dt: Real,
) -> tuple[InferenceState, Intention]:
    """Debounce the network's verdict; return the state and the driver's intention.

    Args:
        parameters: Threshold, samples, lock.
        state: Of the trigger.
        road: Lanes, for the settled car.
        measurement: Lane, side and rest of the car.
        crossing_probability: NaN (no verdict) is no positive [-].
        path_ended: Whether a path came to its end at the step before.
        dt: Control step [s].
    """
    positive = crossing_probability >= parameters.threshold
    return debounce(parameters, state, road, measurement, positive, path_ended, dt)
