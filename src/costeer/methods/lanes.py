"""What methods share that follow the lane the car is in: lane, target, torques."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.controller import step as controller
from costeer.controller import trajectory
from costeer.controller.signals import (
    LANE_KEEPING,
    Guidance,
    Intention,
    Preview,
    Request,
    Target,
)
from costeer.controller.step import Guiding
from costeer.controller.trajectory import TrajectoryParameters, TrajectoryState
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import lane_centre, lane_exists
from costeer.sensing.measurement import Measurement


class LaneParameters(NamedTuple):
    """When the followed lane changes with the car.

    Attributes:
        switch_distance: How far beyond the line the car is then [m]. Source: assumed,
            a wheel that touches the line does not switch it back and forth.
    """

    switch_distance: Real = 0.3


class Keeping(Guiding, Protocol):
    """Parameters of a method that keeps the lane that the car is in."""

    @property
    def road(self) -> RoadParameters: ...  # noqa: D102
    @property
    def lanes(self) -> LaneParameters: ...  # noqa: D102


class Changing(Keeping, Protocol):
    """Parameters of a method that also plans paths to another lane."""

    @property
    def trajectory(self) -> TrajectoryParameters: ...  # noqa: D102


@compiled
def lateral_velocity(measurement: Measurement) -> Real:
    """Velocity across the road, left positive [m/s]."""
    along = measurement.longitudinal_velocity * xp.sin(measurement.yaw_angle)
    return along + measurement.lateral_velocity * xp.cos(measurement.yaw_angle)


@compiled
def offset_from(road: RoadParameters, lane: Real, measurement: Measurement) -> Real:
    """How far the car is to the left of a lane's centre [m]."""
    return measurement.lateral_position - lane_centre(road, lane)


@compiled
def followed_lane(
    parameters: LaneParameters,
    road: RoadParameters,
    lane: Real,
    measurement: Measurement,
) -> Real:
    """The lane to follow: the next one once the car is well beyond the line [-].

    Args:
        parameters: How far beyond.
        road: Its lanes.
        lane: That was followed at the step before [-].
        measurement: Where the car is; a lost sample switches nothing.
    """
    offset = offset_from(road, lane, measurement)
    reach = road.lane_width / 2.0 + parameters.switch_distance
    left = xp.select(offset > reach, lane + 1.0, lane)
    beside = xp.select(offset < -reach, lane - 1.0, left)
    return xp.select(lane_exists(road, beside), beside, lane)


@compiled
def lane_target(road: RoadParameters, lane: Real, measurement: Measurement) -> Target:
    """The centre of a lane at the car's place."""
    return trajectory.target(trajectory.initial_state(road, lane), road, measurement)


@compiled
def keep(
    parameters: Keeping, lane: Real, measurement: Measurement
) -> tuple[Real, Target, Preview, Guidance]:
    """Followed lane, its centre, errors and the torques of Eqs. (4) and (5).

    Args:
        parameters: Lanes and guidance.
        lane: That was followed at the step before [-].
        measurement: This step's sample.
    """
    lane = followed_lane(parameters.lanes, parameters.road, lane, measurement)
    target = lane_target(parameters.road, lane, measurement)
    errors, torques = controller.instruct(parameters, target, measurement)
    return lane, target, errors, torques


@compiled
def with_followed_lane(
    parameters: Changing, state: TrajectoryState, measurement: Measurement
) -> TrajectoryState:
    """The plan, whose lane changes with the car as long as no path runs."""
    followed = followed_lane(parameters.lanes, parameters.road, state.lane, measurement)
    keeping = state.mode == LANE_KEEPING
    return state._replace(lane=xp.select(keeping, followed, state.lane))


@compiled
def change(
    parameters: Changing,
    state: TrajectoryState,
    measurement: Measurement,
    request: Request,
    intention: Intention,
) -> tuple[TrajectoryState, Target]:
    """Lane keeping, and a path as often as one is called for; nothing ends it early.

    Args:
        parameters: Lanes and duration of a path.
        state: Plan of the step before.
        measurement: This step's sample.
        request: Perhaps with another duration.
        intention: Whether a path begins, and to which side.
    """
    return trajectory.step(
        controller.lasting(parameters.trajectory, request),
        with_followed_lane(parameters, state, measurement),
        parameters.road,
        measurement,
        intention,
        consistent=True,
        replan=False,
    )
