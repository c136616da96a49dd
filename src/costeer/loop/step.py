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
from costeer.drivers import driver
from costeer.drivers.arm import ArmCommand, ArmParameters, active_torque, driver_torque
from costeer.drivers.driver import (
    Action,
    DriverNoise,
    DriverParameters,
    DriverState,
    Knowledge,
    Perception,
)
from costeer.drivers.gaze import head_yaw
from costeer.loop.events import EventState, initial_events, step_events
from costeer.plant import world
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.road import cruising_lane, lane_centre
from costeer.plant.traffic import TrafficParameters
from costeer.plant.vehicle import drive_command
from costeer.plant.world import Inputs, WorldState
from costeer.sensing.measurement import Measurement
from costeer.sensing.sensors import SensorParameters, measure, measured_head_yaw

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
    plant_steps: int = 8


class LoopState(NamedTuple):
    """World, driver, controller and what passes between them.

    Attributes:
        world: Car and column.
        events: Leader and event zone.
        controller: Of the method.
        driver: Who holds the wheel.
        torque_command: Computed at the step before, acts in this one [N·m].
        time: Since the trial began [s].
    """

    world: WorldState
    events: EventState
    controller: ControllerState
    driver: DriverState
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
    """

    time: Real
    measurement: Measurement
    signals: Signals
    motor_torque: Real
    action: Action
    events: EventState


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
        torque_command=0.0,
        time=0.0,
    )


@compiled
def sense(
    parameters: LoopParameters, state: LoopState, noise: DriverNoise
) -> Measurement:
    """This step's sample of everything that is measured."""
    head = head_yaw(parameters.driver.gaze, state.driver.gaze)
    hands = driver_torque(
        parameters.driver.arm,
        state.driver.arm,
        state.world.column.steering_wheel_rate,
    )
    return measure(
        parameters.car,
        parameters.road,
        state.world,
        hands,
        measured_head_yaw(parameters.sensors, head, noise.head_tracker),
    )


class _Motion(NamedTuple):
    """What the plant steps carry on: the world and the muscle torque [N·m]."""

    world: WorldState
    arm: Real


class _Held(NamedTuple):
    """What is held over the plant steps of a control step."""

    car: CarParameters
    column: ColumnParameters
    arm: ArmParameters
    command: ArmCommand
    torque_command: Real
    drive_command: Real
    dt: Real


@compiled
def _plant_step(motion: _Motion, held: _Held) -> _Motion:
    """Arms and world one plant step later."""
    wheel = motion.world.column
    arm = active_torque(
        held.arm, motion.arm, held.command, wheel.steering_wheel_angle, held.dt
    )
    inputs = Inputs(
        driver_torque=driver_torque(held.arm, arm, wheel.steering_wheel_rate),
        torque_command=held.torque_command,
        drive_command=held.drive_command,
    )
    moved = world.step(held.car, held.column, motion.world, inputs, held.dt)
    return _Motion(world=moved, arm=arm)


@compiled
def move(parameters: LoopParameters, state: LoopState, action: Action) -> _Motion:
    """Run the plant through one control step."""
    held = _Held(
        car=parameters.car,
        column=parameters.column,
        arm=parameters.driver.arm,
        command=action.arm,
        torque_command=state.torque_command,
        drive_command=drive_command(
            parameters.car, action.pedals.accelerator, action.pedals.brake
        ),
        dt=DT / parameters.plant_steps,
    )
    motion = _Motion(world=state.world, arm=state.driver.arm)
    return repeat(_plant_step, parameters.plant_steps, motion, held)


@compiled
def _with_arm(state: DriverState, arm: Real) -> DriverState:
    """The driver with another muscle torque [N·m]."""
    return DriverState(
        vision=state.vision,
        arm=arm,
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
        parameters.controller,
        state.controller,
        measurement,
        crossing_probability,
        requested,
        DT,
    )
    driver_state, action = drive(parameters, state, measurement, noise)
    motion = move(parameters, state, action)
    sample = Sample(
        time=state.time,
        measurement=measurement,
        signals=signals,
        motor_torque=state.world.column.motor_torque,
        action=action,
        events=state.events,
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
        world=motion.world,
        events=events,
        controller=controller_state,
        driver=_with_arm(driver_state, motion.arm),
        torque_command=signals.applied_torque,
        time=state.time + DT,
    ), sample


@compiled
def planned_to_cross(time_to_crossing: Real, horizon: Real) -> Flag:
    """Whether the driver's own plan crosses the line within `horizon` [s]."""
    return (time_to_crossing > 0.0) & (time_to_crossing <= horizon)
