"""One control step of the closed loop: sense, infer, control, drive, move.

The order fixes the delays: the driver and the controller see the same sample; the
torque computed from it acts one control step later; the head is seen where it was at
the end of the step before.
"""

from __future__ import annotations

import math
from typing import Any, Generic, NamedTuple, TypeVar

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled, inlined, repeat
from costeer.controller.signals import Request
from costeer.drivers import arm
from costeer.drivers.arm import ArmCommand, ArmParameters, ArmState
from costeer.drivers.interface import (
    Action,
    DriverLaw,
    DriverNoise,
    Knowledge,
    Perception,
    Plan,
    as_leader,
)
from costeer.loop.events import place_of, with_car
from costeer.loop.half_step import (
    ControlState,
    Sample,
    Seat,
    half_step,
    initial_control,
)
from costeer.loop.mistakes import loses_head
from costeer.loop.parameters import DT, LoopParameters
from costeer.methods.interface import Rule
from costeer.plant import world
from costeer.plant.alignment import bend_at
from costeer.plant.outlook import NOBODY, has_cars, neighbours
from costeer.plant.parameters import CarParameters, ColumnParameters
from costeer.plant.place import NOWHERE, Place
from costeer.plant.road import cruising_lane, lane_centre
from costeer.plant.stretches import stretch_at
from costeer.plant.vehicle import drive_command
from costeer.plant.world import Inputs, WorldState
from costeer.sensing.measurement import Measurement
from costeer.sensing.sensors import (
    HeadTracker,
    TrackerNoise,
    initial_tracker,
    measure,
    track_head,
)

P = TypeVar("P")
S = TypeVar("S")


class Rules(NamedTuple, Generic[P, S]):
    """The functions of the two who share the wheel.

    Attributes:
        method: Of the assistance.
        driver: Of who holds the wheel.
    """

    method: Rule[P, S]
    driver: DriverLaw[Any, Any]


class LoopState(NamedTuple, Generic[S]):
    """World, driver, method and what passes between them.

    Attributes:
        world: Car and column.
        control: Method, leader, torque command and time.
        driver: Who holds the wheel; what it remembers is its own.
        arm: Of that driver.
        plan: That the driver had at the step before.
        head: What the tracker says of the head.
    """

    world: WorldState
    control: ControlState[S]
    driver: Any
    arm: ArmState
    plan: Plan
    head: HeadTracker


@compiled
def initial_state(
    rules: Rules[Any, S], parameters: LoopParameters[Any]
) -> LoopState[S]:
    """The car in the cruising lane, driver relaxed, controller keeping that lane."""
    lane = cruising_lane(parameters.road)
    centre = lane_centre(parameters.road, lane)
    offset = parameters.start.lateral_offset
    return LoopState(
        world=world.initial_state(
            parameters.car, centre + offset, parameters.start.speed
        ),
        control=initial_control(rules.method, parameters),
        driver=rules.driver.initial_state(parameters.driver, centre),
        arm=arm.initial_state(),
        plan=Plan(),
        head=initial_tracker(),
    )


@compiled
def seen_head(
    parameters: LoopParameters[Any], position: Real, head: HeadTracker
) -> HeadTracker:
    """What the tracker says at a position along the road [m], if it is not lost."""
    stretch, lasts = stretch_at(parameters.stretches, position)
    lost = lasts & (stretch.head_lost > 0.5)
    lost = lost | loses_head(parameters.mistakes)
    return head._replace(valid=head.valid & xp.logical_not(lost))


@compiled
def sense(parameters: LoopParameters[Any], state: LoopState[S]) -> Measurement:
    """This step's sample of everything that is measured."""
    position = state.world.vehicle.longitudinal_position
    return measure(
        parameters.car,
        parameters.road,
        state.world,
        state.arm.torque,
        seen_head(parameters, position, state.head),
        bend_at(parameters.alignment, position),
    )


class PlantMotion(NamedTuple):
    """What the plant steps carry on: world, arms, sum of the muscles' torque [N·m]."""

    world: WorldState
    arm: ArmState
    muscles: Real


class PlantHeld(NamedTuple):
    """What is held over the plant steps of a control step."""

    car: CarParameters
    column: ColumnParameters
    arm: ArmParameters
    command: ArmCommand
    torque_command: Real
    drive_command: Real
    dt: Real
    place: Place


@compiled
def plant_step(motion: PlantMotion, held: PlantHeld) -> PlantMotion:
    """Arms and world one plant step later."""
    angle = motion.world.column.steering_wheel_angle
    moved_arm = arm.step(held.arm, motion.arm, held.command, angle, held.dt)
    muscles = arm.muscle_torque(held.arm, moved_arm, held.command, angle)
    inputs = Inputs(
        driver_torque=muscles,
        torque_command=held.torque_command,
        drive_command=held.drive_command,
        place=held.place,
    )
    moved = world.step(held.car, held.column, motion.world, inputs, held.dt)
    return PlantMotion(world=moved, arm=moved_arm, muscles=motion.muscles + muscles)


@compiled
def _felt_torque(
    parameters: LoopParameters[Any],
    before: WorldState,
    after: PlantMotion,
    action: Action,
) -> Real:
    """Mean torque between hands and wheel over a control step [N·m]."""
    old, new = before.column, after.world.column
    return arm.hand_torque(
        parameters.driver.arm,
        after.muscles / parameters.plant_steps,
        action.arm.stiffening,
        (new.steering_wheel_angle - old.steering_wheel_angle) / DT,
        (new.steering_wheel_rate - old.steering_wheel_rate) / DT,
    )


@compiled
def move(
    parameters: LoopParameters[Any],
    state: LoopState[S],
    action: Action,
    place: Place = NOWHERE,
) -> tuple[WorldState, ArmState]:
    """Run plant and arms through one control step.

    The arms move with the wheel, so their inertia and damping are part of the column
    while the hands hold it.

    Args:
        parameters: Of the trial.
        state: Of everything.
        action: Of the driver.
        place: What the road does to the car.
    """
    hands = parameters.driver.arm
    held = PlantHeld(
        car=parameters.car,
        column=arm.held_column(hands, parameters.column, action.arm.stiffening),
        arm=hands,
        command=action.arm,
        torque_command=state.control.torque_command,
        drive_command=drive_command(
            parameters.car, action.pedals.accelerator, action.pedals.brake
        ),
        dt=DT / parameters.plant_steps,
        place=place,
    )
    start = PlantMotion(world=state.world, arm=state.arm, muscles=0.0)
    motion = repeat(plant_step, parameters.plant_steps, start, held)
    moved = motion.arm
    return motion.world, moved._replace(
        torque=_felt_torque(parameters, state.world, motion, action)
    )


@inlined
def drive(
    law: DriverLaw[Any, Any],
    parameters: LoopParameters[Any],
    state: LoopState[S],
    measurement: Measurement,
    noise: DriverNoise,
) -> tuple[Any, Action]:
    """What the driver does at this step."""
    knowledge = Knowledge(
        car=parameters.car,
        column=parameters.column,
        road=parameters.road,
        alignment=parameters.alignment,
    )
    events = state.control.events
    stretch, lasts = stretch_at(parameters.stretches, measurement.longitudinal_position)
    given = parameters.fleet, events.fleet, parameters.road, measurement.lane
    around = xp.when(has_cars(parameters.fleet), neighbours, given, NOBODY)
    around = around._replace(wanted_side=xp.select(lasts, stretch.wanted_side, 0.0))
    ahead = as_leader(around.own.ahead, measurement)
    perception = Perception(
        measurement=measurement,
        leader=xp.select(events.leader.present, events.leader, ahead),
        guidance_torque=state.world.column.motor_torque,
        around=around,
    )
    return law.act(parameters.driver, state.driver, knowledge, perception, noise, DT)


@compiled
def own_duration(parameters: LoopParameters[Any], state: LoopState[S]) -> Real:
    """Duration that the driver plans if the system follows it, else NaN [s]."""
    own = state.plan.change_duration
    return xp.select(parameters.follows_plan > 0.5, own, math.nan)


@compiled
def _tracked(
    parameters: LoopParameters[Any],
    state: LoopState[S],
    head_yaw: Real,
    noise: DriverNoise,
) -> HeadTracker:
    """What the tracker says of a head that is turned by `head_yaw` [-]."""
    return track_head(
        parameters.sensors,
        state.head,
        head_yaw,
        TrackerNoise(normal=noise.head_tracker, uniform=noise.tracker_uniform),
        DT,
    )


@inlined
def step(
    rules: Rules[Any, S],
    parameters: LoopParameters[Any],
    state: LoopState[S],
    measurement: Measurement,
    request: Request,
    noise: DriverNoise,
) -> tuple[LoopState[S], Sample[S]]:
    """Close the loop for one control step, a driver model in the seat.

    Args:
        rules: The functions of method and driver.
        parameters: Of the trial.
        state: Of everything.
        measurement: This step's sample (`sense`).
        request: Verdict of the predictor and what is asked for from outside.
        noise: Random numbers of this step.
    """
    events = with_car(state.control.events, measurement)
    state = state._replace(control=state.control._replace(events=events))
    driver, action = drive(rules.driver, parameters, state, measurement, noise)
    seat = Seat(
        action=action,
        leader_uniform=noise.leader_uniform,
        motor_torque=state.world.column.motor_torque,
    )
    control, sample = half_step(
        rules.method, parameters, state.control, measurement, request, seat
    )
    place = place_of(parameters.road, parameters.stretches, sample.events, measurement)
    moved_world, moved_arm = move(parameters, state, action, place)
    return LoopState(
        world=moved_world,
        control=control,
        driver=driver,
        arm=moved_arm,
        plan=action.plan,
        head=_tracked(parameters, state, action.head_yaw, noise),
    ), sample


@compiled
def planned_to_cross(time_to_crossing: Real, horizon: Real) -> Flag:
    """Whether the driver's own plan crosses the line within `horizon` [s]."""
    return (time_to_crossing > 0.0) & (time_to_crossing <= horizon)
