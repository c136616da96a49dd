"""One control step of the closed loop: sense, infer, control, drive, move.

The order fixes the delays: the driver and the controller see the same sample; the
torque computed from it acts one control step later; the head is seen where it was at
the end of the step before.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled, repeat
from costeer.controller import step as controller
from costeer.controller.signals import Signals
from costeer.controller.step import ControllerParameters, ControllerState
from costeer.controller.trajectory import TrajectoryParameters
from costeer.drivers import arm, driver
from costeer.drivers.arm import ArmCommand, ArmParameters, ArmState
from costeer.drivers.driver import (
    Action,
    DriverNoise,
    DriverParameters,
    DriverState,
    Knowledge,
    Perception,
)
from costeer.drivers.gaze import head_yaw
from costeer.loop.events import (
    EventState,
    Lead,
    initial_events,
    lead_of,
    step_events,
)
from costeer.plant import world
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.road import cruising_lane, lane_centre
from costeer.plant.traffic import TrafficParameters
from costeer.plant.vehicle import drive_command
from costeer.plant.world import Inputs, WorldState
from costeer.sensing.measurement import Measurement
from costeer.sensing.sensors import (
    HeadTracker,
    SensorParameters,
    TrackerNoise,
    initial_tracker,
    measure,
    track_head,
)

DT = 1.0 / 60.0
"""Control step [s]."""


class StartParameters(NamedTuple):
    """How a trial begins.

    Attributes:
        speed: Of the car [m/s]. Source: paper, about 70 km/h.
        lateral_offset: From the centre of the cruising lane [m]. Source: assumed, 0.
        events: 1 with leaders to overtake, 0 without [-]. Source: paper.
    """

    speed: Real = 70.0 / 3.6
    lateral_offset: Real = 0.0
    events: Real = 1.0


class LoopParameters(NamedTuple):
    """Everything that one trial needs besides random numbers.

    Attributes:
        car: Of the plant [SI units]. Source: plant/parameters.py.
        column: Of the plant [SI units]. Source: plant/parameters.py.
        road: Lanes [SI units]. Source: plant/parameters.py.
        traffic: Leaders [SI units]. Source: plant/traffic.py.
        sensors: Errors [SI units]. Source: sensing/sensors.py.
        controller: Of the method [SI units]. Source: controller/step.py.
        driver: Who holds the wheel [SI units]. Source: drivers/driver.py.
        start: How the trial begins [SI units]. Source: this file.
        follows_plan: 1 if the system's lane changes begin and last as the driver plans
            this one, 0 if as the method says [-]. Source: assumed, for the pilot runs
            in which nobody disagrees.
        plant_steps: Plant steps in a control step [-]. Source: assumed, 8 make 480
            Hz.
    """

    car: CarParameters = CarParameters()
    column: ColumnParameters = ColumnParameters()
    road: RoadParameters = RoadParameters()
    traffic: TrafficParameters = TrafficParameters()
    sensors: SensorParameters = SensorParameters()
    controller: ControllerParameters = ControllerParameters()
    driver: DriverParameters = DriverParameters()
    start: StartParameters = StartParameters()
    follows_plan: Real = 0.0
    plant_steps: int = 8


class LoopState(NamedTuple):
    """World, driver, controller and what passes between them.

    Attributes:
        world: Car and column.
        events: Leader and event zone.
        controller: Of the method.
        driver: Who holds the wheel.
        head: What the tracker says of the head.
        torque_command: Computed at the step before, acts in this one [N·m].
        time: Since the trial began [s].
    """

    world: WorldState
    events: EventState
    controller: ControllerState
    driver: DriverState
    head: HeadTracker
    torque_command: Real
    time: Real


class Sample(NamedTuple):
    """All that was measured and computed at one step, for the record.

    Attributes:
        time: Since the trial began [s].
        measurement: Of the sensors.
        signals: Of the controller.
        motor_torque: Guidance torque that the motor gives [N·m].
        action: Of the driver.
        events: Leader and event zone.
        lead: The leader as the record shows it.
    """

    time: Real
    measurement: Measurement
    signals: Signals
    motor_torque: Real
    action: Action
    events: EventState
    lead: Lead


@compiled
def initial_state(parameters: LoopParameters) -> LoopState:
    """The car in the cruising lane, driver relaxed, controller keeping that lane."""
    lane = cruising_lane(parameters.road)
    centre = lane_centre(parameters.road, lane)
    offset = parameters.start.lateral_offset
    return LoopState(
        world=world.initial_state(
            parameters.car, centre + offset, parameters.start.speed
        ),
        events=initial_events(),
        controller=controller.initial_state(parameters.road, lane),
        driver=driver.initial_state(centre + parameters.driver.tracking.lane_bias),
        head=initial_tracker(),
        torque_command=0.0,
        time=0.0,
    )


@compiled
def sense(parameters: LoopParameters, state: LoopState) -> Measurement:
    """This step's sample of everything that is measured."""
    return measure(
        parameters.car,
        parameters.road,
        state.world,
        state.driver.arm.torque,
        state.head,
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
    )
    moved = world.step(held.car, held.column, motion.world, inputs, held.dt)
    return PlantMotion(world=moved, arm=moved_arm, muscles=motion.muscles + muscles)


@compiled
def _felt_torque(
    parameters: LoopParameters, before: WorldState, after: PlantMotion, action: Action
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
    parameters: LoopParameters, state: LoopState, action: Action
) -> tuple[WorldState, ArmState]:
    """Run plant and arms through one control step.

    The arms move with the wheel, so their inertia and damping are part of the column
    while the hands hold it.
    """
    hands = parameters.driver.arm
    held = PlantHeld(
        car=parameters.car,
        column=arm.held_column(hands, parameters.column, action.arm.stiffening),
        arm=hands,
        command=action.arm,
        torque_command=state.torque_command,
        drive_command=drive_command(
            parameters.car, action.pedals.accelerator, action.pedals.brake
        ),
        dt=DT / parameters.plant_steps,
    )
    start = PlantMotion(world=state.world, arm=state.driver.arm, muscles=0.0)
    motion = repeat(plant_step, parameters.plant_steps, start, held)
    moved = motion.arm
    return motion.world, ArmState(
        equilibrium=moved.equilibrium,
        delayed=moved.delayed,
        reflex=moved.reflex,
        relief=moved.relief,
        torque=_felt_torque(parameters, state.world, motion, action),
    )


@compiled
def _with_arm(state: DriverState, moved: ArmState) -> DriverState:
    """The driver with arms that have moved."""
    return DriverState(
        vision=state.vision,
        arm=moved,
        reliance=state.reliance,
        tracking=state.tracking,
        decision=state.decision,
        gaze=state.gaze,
        longitudinal=state.longitudinal,
    )


@compiled
def drive(
    parameters: LoopParameters,
    state: LoopState,
    measurement: Measurement,
    noise: DriverNoise,
) -> tuple[DriverState, Action]:
    """What the driver does at this step."""
    knowledge = Knowledge(
        car=parameters.car, column=parameters.column, road=parameters.road
    )
    perception = Perception(
        measurement=measurement,
        leader=state.events.leader,
        guidance_torque=state.world.column.motor_torque,
    )
    return driver.act(parameters.driver, state.driver, knowledge, perception, noise, DT)


@compiled
def _method(parameters: LoopParameters, state: LoopState) -> ControllerParameters:
    """The controller, with the driver's own duration if it follows the plan."""
    method = parameters.controller
    own = state.driver.decision.change_duration
    duration = xp.select(
        parameters.follows_plan > 0.5, own, method.trajectory.change_duration
    )
    return ControllerParameters(
        car=method.car,
        column=method.column,
        road=method.road,
        inference=method.inference,
        trajectory=TrajectoryParameters(change_duration=duration),
        preview=method.preview,
        guidance=method.guidance,
        consistency=method.consistency,
        strength=method.strength,
        replanning=method.replanning,
        actuation=method.actuation,
    )


@compiled
def _tracked(
    parameters: LoopParameters,
    state: LoopState,
    moved: DriverState,
    noise: DriverNoise,
) -> HeadTracker:
    """What the tracker says of the head of a driver who has moved."""
    return track_head(
        parameters.sensors,
        state.head,
        head_yaw(parameters.driver.gaze, moved.gaze),
        TrackerNoise(normal=noise.head_tracker, uniform=noise.tracker_uniform),
        DT,
    )


@compiled
def step(
    parameters: LoopParameters,
    state: LoopState,
    measurement: Measurement,
    crossing_probability: Real,
    requested: Flag,
    noise: DriverNoise,
) -> tuple[LoopState, Sample]:
    """Close the loop for one control step.

    Args:
        parameters: Of the trial.
        state: Of everything.
        measurement: This step's sample (`sense`).
        crossing_probability: Of the predictor; NaN for no verdict [-].
        requested: A lane change asked for from outside.
        noise: Random numbers of this step.
    """
    controller_state, signals = controller.step(
        _method(parameters, state),
        state.controller,
        measurement,
        crossing_probability,
        requested,
        DT,
    )
    driver_state, action = drive(parameters, state, measurement, noise)
    moved_world, moved_arm = move(parameters, state, action)
    sample = Sample(
        time=state.time,
        measurement=measurement,
        signals=signals,
        motor_torque=state.world.column.motor_torque,
        action=action,
        events=state.events,
        lead=lead_of(state.events, measurement.longitudinal_position),
    )
    events = step_events(
        parameters.traffic,
        parameters.road,
        state.events,
        measurement,
        driver_state.decision.phase,
        xp.select(parameters.start.events > 0.5, noise.leader_uniform, -1.0),
        DT,
    )
    return LoopState(
        world=moved_world,
        events=events,
        controller=controller_state,
        driver=_with_arm(driver_state, moved_arm),
        head=_tracked(parameters, state, driver_state, noise),
        torque_command=signals.applied_torque,
        time=state.time + DT,
    ), sample


@compiled
def planned_to_cross(time_to_crossing: Real, horizon: Real) -> Flag:
    """Whether the driver's own plan crosses the line within `horizon` [s]."""
    return (time_to_crossing > 0.0) & (time_to_crossing <= horizon)
