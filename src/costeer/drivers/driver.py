"""A virtual driver: eyes, decision, head, foot and hands in one step at 60 Hz."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.drivers import (
    correcting,
    decision,
    evasion,
    gaze,
    indicating,
    learning,
    longitudinal,
    reliance,
    tolerance,
    tracking,
    vision,
)
from costeer.drivers.arm import ArmCommand, wanted_torque
from costeer.drivers.correcting import CorrectingState
from costeer.drivers.decision import DecisionState, Draws
from costeer.drivers.evasion import Evasion, EvasionState
from costeer.drivers.gaze import GazeDraws, GazeState
from costeer.drivers.interface import (
    Action,
    DriverNoise,
    Knowledge,
    Perception,
    Plan,
    leader_in,
    unless,
)
from costeer.drivers.longitudinal import LongitudinalState
from costeer.drivers.overtaking import Surroundings
from costeer.drivers.reliance import RelianceState
from costeer.drivers.tolerance import ToleranceState
from costeer.drivers.tracking import TrackingState
from costeer.drivers.vision import VisionNoise, VisionState
from costeer.drivers.whole import DriverParameters as DriverParameters
from costeer.drivers.whole import DriverState as DriverState
from costeer.drivers.whole import initial_state as initial_state
from costeer.plant.parameters import holding_stiffness
from costeer.plant.road import cruising_lane
from costeer.sensing.measurement import Measurement

SLOWEST_SEEN = 5.0
"""A driver who is slower sees as at this speed, and steers by less the slower [m/s]:
nobody winds the wheel of a car that hardly moves. Source: assumed."""


@compiled
def decide(
    parameters: DriverParameters,
    state: DriverState,
    knowledge: Knowledge,
    perception: Perception,
    noise: DriverNoise,
    dt: Real,
) -> DecisionState:
    """Overtake, return or go on."""
    draws = Draws(
        duration_normal=noise.change_duration,
        preparation_normal=noise.preparation_time,
        glance_uniform=noise.look_uniform,
        abandoned_uniform=noise.abandoned_uniform,
    )
    beside, out = perception.around, knowledge.road.overtaking_side
    around = Surroundings(
        measurement=perception.measurement,
        leader=perception.leader,
        wanted_speed=parameters.longitudinal.preferred_speed
        + state.longitudinal.speed_wander,
        outer=xp.select(out > 0.0, beside.left, beside.right),
        home=xp.select(out > 0.0, beside.right, beside.left),
        asked=beside.wanted_side * out,
    )
    return decision.step(parameters.decision, state.decision, around, draws, dt)


@compiled
def look(
    parameters: DriverParameters,
    state: DriverState,
    decided: DecisionState,
    direction: Real,
    noise: DriverNoise,
    dt: Real,
) -> GazeState:
    """Turn the head."""
    draws = GazeDraws(
        start_uniform=noise.glance_uniform,
        side_uniform=noise.glance_side_uniform,
        amplitude_normal=noise.glance_amplitude,
        drift_normal=noise.head_drift,
    )
    return gaze.step(parameters.gaze, state.gaze, decided, direction, draws, dt)


@compiled
def aim(
    parameters: DriverParameters,
    state: DriverState,
    knowledge: Knowledge,
    measurement: Measurement,
    decided: DecisionState,
    noise: DriverNoise,
    dt: Real,
) -> tuple[TrackingState, CorrectingState]:
    """Let the aim wander; plan the own path when steering starts, or anew."""
    wandered = tracking.wander(parameters.tracking, state.tracking, noise.wander, dt)
    road = knowledge.road
    steered = decision.steered_to(
        decided, decision.direction(decided, road.overtaking_side)
    )
    own = parameters.correcting, state.correcting, wandered, measurement
    plan = correcting.step(*own, decided, steered, dt)
    out = (decided.phase == decision.CHANGING) | (decided.phase == decision.PASSING)
    away = xp.select(out, road.overtaking_side, 0.0)
    lane = cruising_lane(road) + away
    lasts = xp.select(plan.due, plan.duration, decided.change_duration)
    given = parameters.tracking, road, measurement, lane, lasts
    path = xp.when(decided.started | plan.due, tracking.planned, given, wandered.path)
    return wandered._replace(path=path), plan


@compiled
def swerve(
    parameters: DriverParameters,
    knowledge: Knowledge,
    measurement: Measurement,
    aimed: TrackingState,
    evading: Evasion,
) -> TrackingState:
    """The aim in an emergency: beside the obstacle, and back into a lane after it."""
    duration = parameters.decision.change_duration
    home = parameters.tracking, knowledge.road, measurement, measurement.lane, duration
    path = xp.when(evading.ends, tracking.planned, home, aimed.path)
    away = measurement, evading.target, parameters.evasion.duration
    path = xp.when(evading.steers, tracking.path_to, away, path)
    return aimed._replace(path=path)


class Sight(NamedTuple):
    """What the eyes make of a step.

    Attributes:
        eyes: Their state.
        asked: Steering-wheel angle that is seen to be needed [rad].
        planned: Angle ahead of it, for the own path's curvature [rad].
        share: Of both that a driver of a slow car takes [-].
    """

    eyes: VisionState
    asked: Real
    planned: Real
    share: Real


@compiled
def see(
    parameters: DriverParameters,
    state: DriverState,
    knowledge: Knowledge,
    measurement: Measurement,
    aimed: TrackingState,
    noise: DriverNoise,
    dt: Real,
) -> Sight:
    """Turn what is seen into the steering-wheel angle that it needs."""
    eyes = parameters.vision
    speed = xp.maximum(measurement.longitudinal_velocity, SLOWEST_SEEN)
    near_distance = xp.minimum(speed * eyes.near_time, eyes.sight)
    wanted = tracking.aim(
        aimed,
        knowledge.alignment,
        measurement.longitudinal_position,
        near_distance,
        xp.minimum(speed * eyes.anticipation_time, eyes.sight),
    )
    seen, asked = vision.step(
        eyes,
        state.vision,
        vision.far_angle(measurement, wanted.far_slope, wanted.far_turn),
        vision.near_angle(measurement, wanted.near_position, near_distance),
        speed,
        VisionNoise(near=noise.near, motor=noise.motor),
        dt,
    )
    moves = xp.minimum(measurement.longitudinal_velocity / SLOWEST_SEEN, 1.0)
    return Sight(
        eyes=seen,
        asked=asked,
        planned=vision.planned_angle(eyes, knowledge.car, speed, wanted.far_curvature),
        share=xp.maximum(moves, 0.0),
    )


@compiled
def intend(
    parameters: DriverParameters,
    state: DriverState,
    sight: Sight,
    watches: Flag,
    dt: Real,
) -> tuple[ToleranceState, Real]:
    """The steering-wheel angle that the hands go to [rad]: what is not let go."""
    own = parameters.tolerance, state.tolerance
    kept = tolerance.step(*own, sight.asked, watches, dt)
    eyes = parameters.vision, sight.eyes
    return kept, vision.performed(*eyes, kept.intended, sight.planned) * sight.share


@compiled
def feel(
    parameters: DriverParameters,
    state: DriverState,
    knowledge: Knowledge,
    perception: Perception,
    intended_angle: Real,
    leading: Flag,
    dt: Real,
) -> tuple[RelianceState, ArmCommand]:
    """Judge the guidance by the hands; return their state and the arm's command."""
    measurement = perception.measurement
    stiffness = holding_stiffness(
        knowledge.car,
        knowledge.column,
        xp.maximum(measurement.longitudinal_velocity, 1.0),
    )
    relaxed = ArmCommand(
        intended_angle=intended_angle,
        holding_stiffness=stiffness,
        stiffening=1.0,
        guidance=0.0,
        reliance=0.0,
    )
    wanted = wanted_torque(parameters.arm, relaxed, measurement.steering_wheel_angle)
    own = learning.experienced(parameters.learning, state.learning, parameters.reliance)
    hands = reliance.step(
        own, state.reliance, perception.guidance_torque, wanted, leading, dt
    )
    return hands, ArmCommand(
        intended_angle=intended_angle,
        holding_stiffness=stiffness,
        stiffening=hands.stiffening,
        guidance=hands.felt_guidance,
        reliance=own.reliance,
    )


@compiled
def resolve(
    parameters: DriverParameters,
    state: DriverState,
    knowledge: Knowledge,
    perception: Perception,
    noise: DriverNoise,
    dt: Real,
) -> tuple[EvasionState, Evasion, DecisionState]:
    """See a danger, or else decide; who has met a danger begins to plan anew."""
    out = knowledge.road.overtaking_side
    intended = decision.direction(state.decision, out)
    steered = decision.steered_to(state.decision, intended)
    evaded, evading = evasion.step(
        parameters.evasion, state.evasion, perception, knowledge, steered, dt
    )
    decided = decide(parameters, state, knowledge, perception, noise, dt)
    is_home = perception.measurement.lane == cruising_lane(knowledge.road)
    calm = decision.resumed(state.decision, is_home)
    return evaded, evading, xp.select(evading.active | evading.ends, calm, decided)


@compiled
def brake(
    parameters: DriverParameters,
    state: DriverState,
    foot: LongitudinalState,
    evading: Evasion,
    measurement: Measurement,
    dt: Real,
) -> LongitudinalState:
    """The foot, on the brake in an emergency."""
    return longitudinal.braking_hard(
        parameters.longitudinal,
        foot,
        state.longitudinal.wanted_acceleration,
        xp.select(evading.brakes, parameters.evasion.braking, 0.0),
        measurement.longitudinal_velocity,
        dt,
    )


@compiled
def acted(
    parameters: DriverParameters,
    state: DriverState,
    knowledge: Knowledge,
    measurement: Measurement,
    command: ArmCommand,
) -> Action:
    """What the driver does until the next step, from the state after this one."""
    decided, wanted = state.decision, state.longitudinal.wanted_acceleration
    side = decision.direction(decided, knowledge.road.overtaking_side)
    return Action(
        arm=command,
        pedals=longitudinal.pedals(
            knowledge.car, wanted, measurement.longitudinal_velocity
        ),
        head_yaw=gaze.head_yaw(parameters.gaze, state.gaze),
        intention=side,
        at_home=decided.phase == decision.CRUISING,
        plan=Plan(
            change_duration=decided.change_duration,
            time_to_crossing=decision.time_to_crossing(decided),
            side=side,
        ),
        indicator=state.indicator.side,
    )


@compiled
def act(
    parameters: DriverParameters,
    state: DriverState,
    knowledge: Knowledge,
    perception: Perception,
    noise: DriverNoise,
    dt: Real,
) -> tuple[DriverState, Action]:
    """One control step of the whole driver.

    Args:
        parameters: Of this driver.
        state: Of this driver.
        knowledge: Car, wheel and road, known by experience.
        perception: What reaches eyes and hands.
        noise: Random numbers of this step.
        dt: Control step [s].
    """
    measurement = perception.measurement
    evaded, evading, decided = resolve(
        parameters, state, knowledge, perception, noise, dt
    )
    direction = decision.direction(decided, knowledge.road.overtaking_side)
    head = look(parameters, state, decided, direction, noise, dt)
    aimed, plan = aim(parameters, state, knowledge, measurement, decided, noise, dt)
    aimed = swerve(parameters, knowledge, measurement, aimed, evading)
    steered = decision.steered_to(decided, direction)
    sight = see(parameters, state, knowledge, measurement, aimed, noise, dt)
    watches = (steered != 0.0) | evading.active
    kept, intended = intend(parameters, state, sight, watches, dt)
    felt, goal = state.reliance.felt_guidance, aimed.path.y5
    led = reliance.leads(parameters.reliance, measurement, felt, goal, steered)
    hands, command = feel(parameters, state, knowledge, perception, intended, led, dt)
    disputes = hands.time_opposed > parameters.reliance.opposing_time
    known = parameters.learning, state.learning, hands.felt_guidance, disputes
    leaders = (
        unless(evading.unseen, perception.leader),
        unless(evading.unseen, leader_in(perception, steered)),
    )
    way = parameters.longitudinal, state.longitudinal, measurement, leaders, decided
    foot = longitudinal.step(*way, noise.speed, dt)
    foot = brake(parameters, state, foot, evading, measurement, dt)
    lever = parameters.indicator, state.indicator, decided, steered
    new_state = DriverState(
        vision=sight.eyes,
        reliance=hands,
        tracking=aimed,
        decision=decided,
        gaze=head,
        longitudinal=foot,
        evasion=evaded,
        indicator=indicating.step(*lever, noise.indicator_uniform, dt),
        correcting=plan,
        learning=learning.step(*known, dt),
        tolerance=kept,
    )
    return new_state, acted(parameters, new_state, knowledge, measurement, command)
