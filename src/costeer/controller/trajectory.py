"""Assistance mode and target: lane centre or Bezier path (Eq. (3), Fig. 3)."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.base.bezier import Quintic, path_point, quintic
from costeer.controller.signals import (
    LANE_CHANGING,
    LANE_KEEPING,
    Intention,
    Target,
)
from costeer.plant.alignment import line_curvature
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import lane_centre
from costeer.sensing.measurement import Measurement

_SLOWEST = 1.0
"""Paths are planned as if the car were at least this fast [m/s]."""


class TrajectoryParameters(NamedTuple):
    """How a lane change is planned.

    Attributes:
        change_duration: ΔT_LC [s]. Source: paper, rapid 4, normal 6, gentle 8.
    """

    change_duration: Real = 6.0


class TrajectoryState(NamedTuple):
    """The plan that is followed.

    Attributes:
        mode: `LANE_KEEPING` or `LANE_CHANGING` [-].
        lane: That the plan ends in; latched, a line that is crossed without a
            trigger does not move it [-].
        path: Of the last lane change.
        path_ended: Whether it came to its end at the last step.
    """

    mode: Real
    lane: Real
    path: Quintic
    path_ended: Flag


@compiled
def initial_state(road: RoadParameters, lane: Real) -> TrajectoryState:
    """Lane keeping in `lane`."""
    centre = lane_centre(road, lane)
    return TrajectoryState(
        mode=LANE_KEEPING,
        lane=lane,
        path=quintic(0.0, 1.0, centre, 0.0, 0.0, centre),
        path_ended=False,
    )


@compiled
def plan_path(
    parameters: TrajectoryParameters,
    road: RoadParameters,
    measurement: Measurement,
    lane: Real,
) -> Quintic:
    """Path from the car to the centre of `lane`: Eq. (3).

    Its first three control points match the car's position, slope and curvature, its
    last three lie on the new lane's centre; it is V_x · change_duration long. On a
    curved road the path is one along and across the road: what the road turns by itself
    is taken off.
    """
    speed = xp.maximum(measurement.longitudinal_velocity, _SLOWEST)
    bend = line_curvature(measurement.road_curvature, measurement.lateral_position)
    return quintic(
        measurement.longitudinal_position,
        speed * parameters.change_duration,
        measurement.lateral_position,
        xp.tan(measurement.yaw_angle),
        measurement.yaw_rate / speed - bend,
        lane_centre(road, lane),
    )


@compiled
def is_known(measurement: Measurement) -> Flag:
    """Whether all that a plan is made of is finite: a lost sample changes no plan."""
    place = measurement.longitudinal_position + measurement.lateral_position
    bend = measurement.road_curvature + measurement.road_curvature_slope
    motion = measurement.longitudinal_velocity + measurement.yaw_rate + bend
    return xp.isfinite(
        place + motion + measurement.yaw_angle + measurement.lane + measurement.side
    )


@compiled
def choose_mode(
    parameters: TrajectoryParameters,
    state: TrajectoryState,
    road: RoadParameters,
    measurement: Measurement,
    intention: Intention,
    consistent: Flag,
    replan: Flag,
) -> TrajectoryState:
    """Mode and plan of this step.

    Args:
        parameters: Duration of a lane change.
        state: Plan of the step before.
        road: Its lanes.
        measurement: Where the car is.
        intention: Trigger and side.
        consistent: Verdict of the step before.
        replan: Whether the step before called for a new plan.
    """
    known = is_known(measurement)
    changing = state.mode == LANE_CHANGING
    travelled = measurement.longitudinal_position - state.path.start
    ended = known & changing & (travelled >= state.path.length)
    to_keeping = ended | (known & replan)
    keeping = to_keeping | xp.logical_not(changing)
    wanted = known & intention.detected & consistent
    started = keeping & wanted & xp.logical_not(to_keeping)
    kept_lane = xp.select(to_keeping, measurement.lane, state.lane)
    lane = xp.select(started, measurement.lane + intention.side, kept_lane)
    path = xp.when(
        started, plan_path, (parameters, road, measurement, lane), state.path
    )
    mode = xp.select(keeping, LANE_KEEPING, LANE_CHANGING)
    return TrajectoryState(
        mode=xp.select(started, LANE_CHANGING, mode),
        lane=lane,
        path=path,
        path_ended=ended & xp.logical_not(replan),
    )


@compiled
def target(
    state: TrajectoryState, road: RoadParameters, measurement: Measurement
) -> Target:
    """Planned motion at the car's place, position, slope and curvature closed form.

    kappa_d is the road's curvature plus that of the path along it.
    """
    point = path_point(state.path, measurement.longitudinal_position)
    changing = state.mode == LANE_CHANGING
    centre = lane_centre(road, state.lane)
    speed = measurement.longitudinal_velocity
    position = xp.select(changing, point.lateral_position, centre)
    bend = line_curvature(measurement.road_curvature, position)
    slope = xp.select(changing, point.curvature_slope, 0.0)
    return Target(
        mode=state.mode,
        lane=state.lane,
        lateral_position=position,
        heading=xp.select(changing, xp.atan(point.slope), 0.0),
        curvature=xp.select(changing, point.curvature, 0.0) + bend,
        curvature_rate=speed * (slope + measurement.road_curvature_slope),
        path=state.path,
    )


@compiled
def step(
    parameters: TrajectoryParameters,
    state: TrajectoryState,
    road: RoadParameters,
    measurement: Measurement,
    intention: Intention,
    consistent: Flag,
    replan: Flag,
) -> tuple[TrajectoryState, Target]:
    """Choose mode and plan; return the state and the target at the car."""
    new_state = choose_mode(
        parameters, state, road, measurement, intention, consistent, replan
    )
    return new_state, target(new_state, road, measurement)
