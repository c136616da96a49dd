"""Lane changes by time to lane crossing: Tsoi, Mulder, Abbink 2010.

Lane keeping that takes a car which is about to cross the line for one whose driver
wants to: a path to the other lane begins then, and runs to its end. Nothing asks
whether the driver agrees, so a drift triggers as a lane change does.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.controller import actuation, inference, trajectory
from costeer.controller import step as controller
from costeer.controller.actuation import ActuationParameters, ActuationState
from costeer.controller.guidance import GuidanceParameters
from costeer.controller.inference import InferenceState
from costeer.controller.preview import PreviewParameters
from costeer.controller.signals import Assistance, Intention, Request
from costeer.controller.trajectory import TrajectoryParameters, TrajectoryState
from costeer.methods.ibhs import like_ibhs, shared_tunables
from costeer.methods.interface import Method, Tunable
from costeer.methods.lanes import LaneParameters, change, lateral_velocity
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.road import distance_to_adjacent_lane, lane_exists
from costeer.sensing.measurement import Measurement


class CrossingTimeParameters(NamedTuple):
    """When a time to lane crossing becomes a trigger.

    Attributes:
        crossing_time: Positive from this time to the line on [s]. Source: ours, one
            false trigger in 20 km of manual driving, benchmarks/rival_thresholds.py.
        trigger_samples: Positives in a row that make a trigger [-]. Source: as ibhs.
        lock_duration: Longest lock after the end of a path [s]. Source: as ibhs.
        settled_duration: The lock ends when the car has been settled so long [s].
            Source: as ibhs.
        settled_offset: Largest distance from the lane's centre of a settled car [m].
            Source: as ibhs.
        settled_yaw: Largest yaw angle of a settled car [rad]. Source: as ibhs.
    """

    crossing_time: Real = 5.3
    trigger_samples: Real = 3.0
    lock_duration: Real = 3.0
    settled_duration: Real = 0.5
    settled_offset: Real = 0.3
    settled_yaw: Real = 0.008726646259971648


class LaneCrossingTimeParameters(NamedTuple):
    """Lane keeping and paths that a time to lane crossing triggers.

    Attributes:
        car: Nominal car [SI units]. Source: plant/parameters.py.
        column: Nominal column [SI units]. Source: plant/parameters.py.
        road: Lanes [SI units]. Source: plant/parameters.py.
        trigger: On the time to the line [SI units]. Source: Tsoi et al. 2010.
        lanes: When the followed lane changes [SI units]. Source: methods/lanes.py.
        trajectory: Duration of a lane change [SI units]. Source: Eq. (3).
        preview: Preview time [SI units]. Source: Fig. 4.
        guidance: Gains [SI units]. Source: Eq. (5).
        actuation: Strength and limits [SI units]. Source: Eq. (6), Table IV.
    """

    car: CarParameters = CarParameters()
    column: ColumnParameters = ColumnParameters()
    road: RoadParameters = RoadParameters()
    trigger: CrossingTimeParameters = CrossingTimeParameters()
    lanes: LaneParameters = LaneParameters()
    trajectory: TrajectoryParameters = TrajectoryParameters()
    preview: PreviewParameters = PreviewParameters()
    guidance: GuidanceParameters = GuidanceParameters()
    actuation: ActuationParameters = ActuationParameters()


class LaneCrossingTimeState(NamedTuple):
    """What the method remembers.

    Attributes:
        trigger: Positives in a row and lock.
        trajectory: Mode and plan.
        actuation: Last torque.
    """

    trigger: InferenceState
    trajectory: TrajectoryState
    actuation: ActuationState


@compiled
def initial_state(
    parameters: LaneCrossingTimeParameters, lane: Real
) -> LaneCrossingTimeState:
    """Follow the lane that the car starts in."""
    return LaneCrossingTimeState(
        trigger=inference.initial_state(),
        trajectory=trajectory.initial_state(parameters.road, lane),
        actuation=actuation.initial_state(),
    )


@compiled
def side_of_travel(measurement: Measurement) -> Real:
    """Side that the car moves to, -1 right or +1 left, 0 if to neither [-]."""
    velocity = lateral_velocity(measurement)
    return xp.select(velocity > 0.0, 1.0, xp.select(velocity < 0.0, -1.0, 0.0))


@compiled
def is_crossing(
    parameters: CrossingTimeParameters,
    road: RoadParameters,
    measurement: Measurement,
    side: Real,
) -> Flag:
    """Whether the car reaches the line of a lane beside within the threshold.

    Distance over velocity is the time to lane crossing; it is asked without dividing.

    Args:
        parameters: Threshold.
        road: Its lanes.
        measurement: Place and motion of the car.
        side: That the car moves to [-].
    """
    distance = distance_to_adjacent_lane(
        road, measurement.lateral_position, measurement.lane, side
    )
    reach = parameters.crossing_time * side * lateral_velocity(measurement)
    beside = lane_exists(road, measurement.lane + side)
    return beside & (side != 0.0) & (distance <= reach)


@compiled
def step(
    parameters: LaneCrossingTimeParameters,
    state: LaneCrossingTimeState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[LaneCrossingTimeState, Assistance]:
    """Lane keeping, or a path that a short time to the line has begun.

    Args:
        parameters: Trigger, lanes, guidance, limits.
        state: Trigger, plan and last torque.
        measurement: This step's sample.
        request: A change that is asked for begins a path, too; its duration counts.
        dt: Control step [s].
    """
    road, side = parameters.road, side_of_travel(measurement)
    crossing = is_crossing(parameters.trigger, road, measurement, side)
    trigger, found = inference.debounce(
        parameters.trigger,
        state.trigger,
        road,
        measurement,
        crossing,
        state.trajectory.path_ended,
        dt,
    )
    intention = Intention(
        detected=found.detected | request.requested,
        side=xp.select(found.detected, side, measurement.side),
    )
    plan, target = change(parameters, state.trajectory, measurement, request, intention)
    errors, torques = controller.instruct(parameters, target, measurement)
    limited, torque = actuation.step(
        parameters.actuation, state.actuation, 1.0, torques.instructed_torque, dt
    )
    new_state = LaneCrossingTimeState(
        trigger=trigger, trajectory=plan, actuation=limited
    )
    return new_state, Assistance(
        applied_torque=torque,
        intention=intention.detected,
        target=target,
        preview=errors,
        guidance=torques,
    )


METHOD = Method(
    name="lane-crossing-time",
    version="1",
    source="Tsoi, Mulder, Abbink 2010: lane changes by time to lane crossing",
    parameters=partial(like_ibhs, LaneCrossingTimeParameters),
    initial_state=initial_state,
    step=step,
    tunables=(
        Tunable(
            "crossing_time",
            "trigger.crossing_time",
            "s",
            0.1,
            15.0,
            "time to lane crossing that triggers",
        ),
        *shared_tunables(LaneCrossingTimeParameters),
    ),
)
