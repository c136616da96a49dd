"""Where the driver wants the car: lane, own lane-change path, slow wander of the aim.

Visual noise alone cannot give a human spread of lane position and a human steering
reversal rate together; a driver tolerates a slowly wandering position.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.base.bezier import Quintic, path_point, quintic
from costeer.plant.alignment import (
    Alignment,
    bend_at,
    line_curvature,
    road_offset,
    road_turn,
)
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import lane_centre
from costeer.sensing.measurement import Measurement


class TrackingParameters(NamedTuple):
    """Tolerance of lane position.

    Attributes:
        wander_deviation: Standard deviation of the wandering aim [m]. Source:
            assumed, gives a human spread of lane position.
        wander_frequency: Natural frequency of the wander [rad/s]. Source: assumed,
            as above.
        wander_damping: Damping ratio of the wander [-]. Source: assumed.
        lane_bias: Preferred place beside the lane's centre [m]. Source: assumed.
    """

    wander_deviation: Real = 0.17
    wander_frequency: Real = 0.35
    wander_damping: Real = 0.7
    lane_bias: Real = 0.0


class TrackingState(NamedTuple):
    """The aim.

    Attributes:
        path: Own lane-change path, flat once it has ended.
        wander: Of the aim from path or lane [m].
        wander_rate: Its time derivative [m/s].
    """

    path: Quintic
    wander: Real
    wander_rate: Real


class Aim(NamedTuple):
    """The wanted path where the driver looks.

    Attributes:
        near_position: Lateral position of the near point, from the tangent of the
            road at the car [m].
        far_slope: Direction of the path at the far point along the road [-].
        far_curvature: Its curvature there, that of the road with it [1/m].
        far_turn: How far the road turns until there [rad].
    """

    near_position: Real
    far_slope: Real
    far_curvature: Real
    far_turn: Real


@compiled
def initial_state(lateral_position: Real) -> TrackingState:
    """Aim at `lateral_position` [m], no wander."""
    path = quintic(0.0, 1.0, lateral_position, 0.0, 0.0, lateral_position)
    return TrackingState(path=path, wander=0.0, wander_rate=0.0)


@compiled
def planned(
    parameters: TrackingParameters,
    road: RoadParameters,
    measurement: Measurement,
    lane: Real,
    duration: Real,
) -> Quintic:
    """The driver's own path from the car to a lane, in `duration` [s].

    Args:
        parameters: Preferred place in the lane.
        road: Its lanes.
        measurement: Where the car is and points.
        lane: To change to [-].
        duration: That the driver plans [s].
    """
    return path_to(
        measurement, lane_centre(road, lane) + parameters.lane_bias, duration
    )


@compiled
def path_to(measurement: Measurement, position: Real, duration: Real) -> Quintic:
    """A path from the car to a line along the road.

    Args:
        measurement: Where the car is and points.
        position: Of the line across the road [m].
        duration: That is planned [s].
    """
    speed = xp.maximum(measurement.longitudinal_velocity, 1.0)
    bend = line_curvature(measurement.road_curvature, measurement.lateral_position)
    return quintic(
        measurement.longitudinal_position,
        speed * duration,
        measurement.lateral_position,
        xp.tan(measurement.yaw_angle),
        measurement.yaw_rate / speed - bend,
        position,
    )


@compiled
def wander(
    parameters: TrackingParameters, state: TrackingState, normal: Real, dt: Real
) -> TrackingState:
    """The aim's wander one step later: a noise-driven oscillator.

    Its standard deviation settles to `wander_deviation`; the input's intensity
    follows from the stationary variance q² / (4 ζ ω³).

    Args:
        parameters: Deviation, frequency, damping.
        state: Of the aim.
        normal: A draw from the standard normal distribution.
        dt: Control step [s].
    """
    frequency, damping = parameters.wander_frequency, parameters.wander_damping
    intensity = 2.0 * xp.sqrt(damping * frequency) * frequency
    kick = parameters.wander_deviation * intensity * xp.sqrt(dt) * normal
    pull = 2.0 * damping * state.wander_rate + frequency * state.wander
    rate = state.wander_rate - frequency * pull * dt + kick
    return TrackingState(
        path=state.path, wander=state.wander + dt * rate, wander_rate=rate
    )


@compiled
def aim(
    state: TrackingState,
    alignment: Alignment,
    longitudinal_position: Real,
    near_distance: Real,
    far_distance: Real,
) -> Aim:
    """The wanted path at the near and the far point.

    Args:
        state: Path and wander.
        alignment: How the road runs.
        longitudinal_position: Of the car [m].
        near_distance: To the near point [m].
        far_distance: To the far point [m].
    """
    near = path_point(state.path, longitudinal_position + near_distance)
    far = path_point(state.path, longitudinal_position + far_distance)
    beside = road_offset(alignment, longitudinal_position, near_distance)
    there = bend_at(alignment, longitudinal_position + far_distance)
    return Aim(
        near_position=near.lateral_position + state.wander + beside,
        far_slope=far.slope,
        far_curvature=far.curvature
        + line_curvature(there.curvature, far.lateral_position),
        far_turn=road_turn(alignment, longitudinal_position, far_distance),
    )
