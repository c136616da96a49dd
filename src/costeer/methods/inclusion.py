"""Inclusion of the driver's intent in the plan: Nakade et al. 2023.

What the driver's own torque asks for, and keeps asking for, first shifts the reference
a little (admittance), and then changes the plan itself: a path to the lane that it
points to, or back out of a lane change that it works against. The structure is
published (Communications Engineering); the numbers are ours.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.controller import actuation, hands, trajectory
from costeer.controller import step as controller
from costeer.controller.actuation import ActuationParameters, ActuationState
from costeer.controller.guidance import GuidanceParameters
from costeer.controller.hands import HandsParameters, HandsState
from costeer.controller.preview import PreviewParameters
from costeer.controller.signals import (
    LANE_CHANGING,
    LANE_KEEPING,
    Assistance,
    Preview,
    Request,
)
from costeer.controller.trajectory import TrajectoryParameters, TrajectoryState
from costeer.methods.ibhs import like_ibhs, shared_tunables
from costeer.methods.interface import Method, Tunable
from costeer.methods.lanes import LaneParameters, with_followed_lane
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.road import lane_exists
from costeer.records.columns import Column
from costeer.sensing.measurement import Measurement


class IntentParameters(NamedTuple):
    """What a torque that persists comes to.

    Attributes:
        memory: Time in which the integral forgets [s]. Source: ours.
        admittance: Shift of the reference over the integral [m/(N·m·s)]. Source: ours.
        shift_limit: Largest shift of the reference [m]. Source: ours.
        threshold: Integral that changes the plan [N·m·s]. Source: ours, one false
            change in 20 km of manual driving, benchmarks/rival_thresholds.py.
    """

    memory: Real = 2.0
    admittance: Real = 0.2
    shift_limit: Real = 0.3
    threshold: Real = 0.58


class InclusionParameters(NamedTuple):
    """Guidance whose plan follows the driver's torque.

    Attributes:
        car: Nominal car [SI units]. Source: plant/parameters.py.
        column: Nominal column [SI units]. Source: plant/parameters.py.
        road: Lanes [SI units]. Source: plant/parameters.py.
        hands: Relaxed arms [SI units]. Source: controller/hands.py.
        intent: What a torque comes to [SI units]. Source: Nakade et al. 2023; ours.
        lanes: When the followed lane changes [SI units]. Source: methods/lanes.py.
        trajectory: Duration of a lane change [SI units]. Source: Eq. (3).
        preview: Preview time [SI units]. Source: Fig. 4.
        guidance: Gains [SI units]. Source: Eq. (5).
        actuation: Strength and limits [SI units]. Source: Eq. (6), Table IV.
    """

    car: CarParameters = CarParameters()
    column: ColumnParameters = ColumnParameters()
    road: RoadParameters = RoadParameters()
    hands: HandsParameters = HandsParameters()
    intent: IntentParameters = IntentParameters()
    lanes: LaneParameters = LaneParameters()
    trajectory: TrajectoryParameters = TrajectoryParameters()
    preview: PreviewParameters = PreviewParameters()
    guidance: GuidanceParameters = GuidanceParameters()
    actuation: ActuationParameters = ActuationParameters()


class IntentState(NamedTuple):
    """What the driver's torque has come to.

    Attributes:
        hands: The wheel at the step before.
        integral: Of the driver's own torque, left positive [N·m·s].
        needed: What the plan of the step before needs of the driver [N·m].
    """

    hands: HandsState
    integral: Real
    needed: Real


class InclusionState(NamedTuple):
    """What the method remembers.

    Attributes:
        intent: What the driver's torque has come to.
        trajectory: Mode and plan.
        origin: Lane that the last change began in [-].
        actuation: Last torque.
    """

    intent: IntentState
    trajectory: TrajectoryState
    origin: Real
    actuation: ActuationState


class Choice(NamedTuple):
    """A change of the plan.

    Attributes:
        begins: Whether one begins.
        lane: That it leads to [-].
    """

    begins: Flag
    lane: Real


@compiled
def initial_state(parameters: InclusionParameters, lane: Real) -> InclusionState:
    """Follow the lane that the car starts in; nothing has been asked for."""
    return InclusionState(
        intent=IntentState(hands=hands.initial_state(), integral=0.0, needed=0.0),
        trajectory=trajectory.initial_state(parameters.road, lane),
        origin=lane,
        actuation=actuation.initial_state(),
    )


@compiled
def leaky_integral(
    parameters: IntentParameters, integral: Real, torque: Real, dt: Real
) -> Real:
    """Integral of a torque that forgets; a lost sample adds nothing [N·m·s].

    Args:
        parameters: Memory.
        integral: Before the step [N·m·s].
        torque: Of the driver's own [N·m].
        dt: Control step [s].
    """
    known = xp.select(xp.isfinite(torque), torque, 0.0)
    return integral + dt * (known - integral / parameters.memory)


@compiled
def feel(
    parameters: InclusionParameters,
    state: InclusionState,
    measurement: Measurement,
    dt: Real,
) -> tuple[HandsState, Real]:
    """Hands, and the integral of what the driver does of his own [N·m·s].

    Of the measured torque not his own are: what relaxed arms give, and what the plan
    needs and guidance of less than full strength leaves to him. While a path runs only
    a torque against it counts.
    """
    intent = state.intent
    seen, torque = hands.step(parameters.hands, intent.hands, measurement, dt)
    own = torque - intent.needed
    integral = leaky_integral(parameters.intent, intent.integral, own, dt)
    direction = direction_of(state)
    against = direction * xp.minimum(direction * integral, 0.0)
    changing = state.trajectory.mode == LANE_CHANGING
    return seen, xp.select(changing, against, integral)


@compiled
def direction_of(state: InclusionState) -> Real:
    """Side that the last change leads to, -1 right, +1 left, 0 before any [-]."""
    return xp.clip(state.trajectory.lane - state.origin, -1.0, 1.0)


@compiled
def choose(
    parameters: InclusionParameters,
    state: InclusionState,
    measurement: Measurement,
    request: Request,
    integral: Real,
) -> Choice:
    """The change of plan that the driver's torque calls for.

    Args:
        parameters: Threshold and road.
        state: With the plan.
        measurement: Side of a change that a script asks for.
        request: Perhaps of a script.
        integral: Of the driver's own torque [N·m·s].
    """
    keeping = state.trajectory.mode == LANE_KEEPING
    pushed = xp.absolute(integral) > parameters.intent.threshold
    asked = keeping & request.requested & xp.logical_not(pushed)
    pushed_side = xp.select(integral > 0.0, 1.0, -1.0)
    side = xp.select(asked, measurement.side, pushed_side)
    lane = xp.select(keeping, state.trajectory.lane + side, state.origin)
    known = trajectory.is_known(measurement)
    wanted = known & (pushed | asked) & lane_exists(parameters.road, lane)
    return Choice(begins=wanted, lane=lane)


@compiled
def replanned(
    parameters: InclusionParameters,
    state: TrajectoryState,
    measurement: Measurement,
    request: Request,
    choice: Choice,
) -> TrajectoryState:
    """The plan after this step: a new path, the running one, or its end.

    Args:
        parameters: Duration of a path and road.
        state: Plan of the step before.
        measurement: Where the car is.
        request: Perhaps with another duration.
        choice: Of a new path.
    """
    travelled = measurement.longitudinal_position - state.path.start
    changing = state.mode == LANE_CHANGING
    over = changing & (travelled >= state.path.length)
    ended = over & trajectory.is_known(measurement) & xp.logical_not(choice.begins)
    own = controller.lasting(parameters.trajectory, request)
    given = own, parameters.road, measurement, choice.lane
    kept = xp.select(ended, measurement.lane, state.lane)
    mode = xp.select(ended, LANE_KEEPING, state.mode)
    return TrajectoryState(
        mode=xp.select(choice.begins, LANE_CHANGING, mode),
        lane=xp.select(choice.begins, choice.lane, kept),
        path=xp.when(choice.begins, trajectory.plan_path, given, state.path),
        path_ended=ended,
    )


@compiled
def needed_torque(parameters: InclusionParameters, errors: Preview) -> Real:
    """What the planned motion needs and the guidance does not give [N·m]."""
    whole = (
        parameters.column.stiffness * errors.planned_steering_angle
        - parameters.car.aligning_stiffness * errors.planned_slip_angle
    )
    left = (1.0 - parameters.actuation.strength_factor) * whole
    return xp.select(xp.isfinite(left), left, 0.0)


@compiled
def step(
    parameters: InclusionParameters,
    state: InclusionState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[InclusionState, Assistance]:
    """Guidance along a plan that the driver's torque shifts and changes.

    Args:
        parameters: Of all stages.
        state: Of all stages.
        measurement: This step's sample.
        request: A change that is asked for begins a path, too; its duration counts.
        dt: Control step [s].
    """
    kept = with_followed_lane(parameters, state.trajectory, measurement)
    state = state._replace(trajectory=kept)
    seen, integral = feel(parameters, state, measurement, dt)
    choice = choose(parameters, state, measurement, request, integral)
    plan = replanned(parameters, kept, measurement, request, choice)
    turned = choice.begins & (kept.mode == LANE_CHANGING)
    integral = xp.select(choice.begins | plan.path_ended, 0.0, integral)
    limit = parameters.intent.shift_limit
    shift = xp.clip(parameters.intent.admittance * integral, -limit, limit)
    target = trajectory.target(plan, parameters.road, measurement)
    shifted = target._replace(lateral_position=target.lateral_position + shift)
    errors, torques = controller.instruct(parameters, shifted, measurement)
    felt = actuation.felt_instruction(torques, measurement.driver_torque)
    limited, torque = actuation.step(
        parameters.actuation, state.actuation, 1.0, felt, dt
    )
    intent = IntentState(
        hands=seen, integral=integral, needed=needed_torque(parameters, errors)
    )
    new_state = InclusionState(
        intent=intent,
        trajectory=plan,
        origin=xp.select(choice.begins, kept.lane, state.origin),
        actuation=limited,
    )
    return new_state, Assistance(
        applied_torque=torque,
        intention=choice.begins & xp.logical_not(turned),
        target=shifted,
        preview=errors,
        guidance=torques,
        replan=turned,
    )


METHOD = Method(
    name="inclusion",
    version="1",
    source="Nakade et al. 2023: intent that persists changes the plan; numbers ours",
    parameters=partial(like_ibhs, InclusionParameters),
    initial_state=initial_state,
    step=step,
    columns=(
        Column(
            "method_integral",
            "N·m·s",
            "float64",
            "leaky integral of the driver's own torque",
            "method.intent.integral",
            mirrored="flipped",
        ),
    ),
    tunables=(
        *(
            Tunable(leaf, f"intent.{leaf}", unit, low, high, label)
            for leaf, unit, low, high, label in (
                ("memory", "s", 0.2, 10.0, "memory of the driver's torque"),
                ("admittance", "m/(N·m·s)", 0.0, 1.0, "shift of the reference"),
                ("shift_limit", "m", 0.0, 1.0, "largest shift of the reference"),
                ("threshold", "N·m·s", 0.1, 10.0, "integral that changes the plan"),
            )
        ),
        *shared_tunables(InclusionParameters),
    ),
)
