"""A person in the loop: the closed loop of a trial with the driver left out.

Controller, world and record are those of the studies (loop/step.py); what a virtual
driver would do comes in from outside: at 60 Hz the pedals, the head, the network's
verdict, and at the plant's rate either the intended angle of virtual hands
(`hands_step`) or the angle of a real wheel (loop/real_wheel.py). The order and the
delays are the same: a torque computed from a sample acts one control step later.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.controller import inference
from costeer.controller import step as controller
from costeer.controller.signals import Signals
from costeer.controller.step import ControllerState
from costeer.drivers import arm
from costeer.drivers.arm import ArmCommand, ArmParameters
from costeer.drivers.decision import CHANGING, CRUISING
from costeer.drivers.driver import Action
from costeer.drivers.longitudinal import Pedals
from costeer.loop.events import EventState, initial_events, lead_of, step_events
from costeer.loop.step import (
    DT,
    LoopParameters,
    PlantHeld,
    PlantMotion,
    Sample,
    plant_step,
)
from costeer.plant import world
from costeer.plant.parameters import holding_stiffness
from costeer.plant.road import cruising_lane, lane_centre
from costeer.plant.steering import ColumnState
from costeer.plant.vehicle import (
    drive_command,
)
from costeer.sensing.measurement import Measurement
from costeer.sensing.sensors import HeadTracker, measure


class PersonInput(NamedTuple):
    """What reaches the loop at one control step.

    Attributes:
        intended_angle: Of the virtual hands [rad].
        grip: How firmly the virtual hands hold, 0 resting to 1 steering [-].
        accelerator: Pedal position in [0, 1] [-].
        brake: Pedal position in [0, 1] [-].
        head_yaw: Normalised to [-1, 1], left positive [-].
        head_yaw_valid: Whether the head is seen.
        crossing_probability: Of the network; NaN for no verdict [-].
        requested: A lane change asked for from outside.
        leader_uniform: Sets the next leader's speed, in [0, 1) [-].
    """

    intended_angle: Real
    grip: Real
    accelerator: Real
    brake: Real
    head_yaw: Real
    head_yaw_valid: Flag
    crossing_probability: Real
    requested: Flag
    leader_uniform: Real


class PersonState(NamedTuple):
    """What the control steps remember.

    Attributes:
        controller: Of the method.
        events: Leader and event zone.
        torque_command: Computed at the step before, acts in this one [N·m].
        time: Since the trial began [s].
    """

    controller: ControllerState
    events: EventState
    torque_command: Real
    time: Real


class PersonMotion(NamedTuple):
    """What the plant steps of a control step carry on.

    Attributes:
        plant: World, arms, and the sum of the driver's torque since the last control
            step [N·m].
        before: The column at the last control step.
    """

    plant: PlantMotion
    before: ColumnState


class PersonHeld(NamedTuple):
    """What is held over the plant steps of a control step.

    Attributes:
        intended_angle: Of the virtual hands [rad].
        grip: Of the virtual hands [-].
        torque_command: Asked of the guidance motor [N·m].
        drive_command: Asked by the pedals [m/s²].
    """

    intended_angle: Real
    grip: Real
    torque_command: Real
    drive_command: Real


@compiled
def initial_state(parameters: LoopParameters) -> PersonState:
    """Lane keeping in the cruising lane, an empty road."""
    lane = cruising_lane(parameters.road)
    return PersonState(
        controller=controller.initial_state(parameters.road, lane),
        events=initial_events(),
        torque_command=0.0,
        time=0.0,
    )


@compiled
def initial_motion(parameters: LoopParameters) -> PersonMotion:
    """The car in the cruising lane at the start's speed, wheel straight ahead."""
    centre = lane_centre(parameters.road, cruising_lane(parameters.road))
    offset = parameters.start.lateral_offset
    state = world.initial_state(parameters.car, centre + offset, parameters.start.speed)
    plant = PlantMotion(world=state, arm=arm.initial_state(), muscles=0.0)
    return PersonMotion(plant=plant, before=state.column)


@compiled
def driver_torque(
    parameters: LoopParameters, motion: PersonMotion, has_wheel: Flag
) -> Real:
    """Mean torque of the driver over the last control step [N·m].

    Of virtual hands it is what the muscles give less what moves the arms; a real
    wheel measures or observes it between hand and rim.
    """
    mean = motion.plant.muscles / parameters.plant_steps
    now, before = motion.plant.world.column, motion.before
    hands = arm.hand_torque(
        parameters.driver.arm,
        mean,
        1.0,
        (now.steering_wheel_angle - before.steering_wheel_angle) / DT,
        (now.steering_wheel_rate - before.steering_wheel_rate) / DT,
    )
    return xp.select(has_wheel, mean, hands)


@compiled
def phase(parameters: LoopParameters, measurement: Measurement) -> Real:
    """`CRUISING` while the car runs straight in the cruising lane, else `CHANGING`.

    Of a person nobody knows the decision; the event zone ends when the car has
    returned and settled.
    """
    settled = inference.settled(
        parameters.controller.inference, parameters.road, measurement
    )
    home = measurement.lane == cruising_lane(parameters.road)
    return xp.select(home & settled, CRUISING, CHANGING)


@compiled
def sense(
    parameters: LoopParameters,
    motion: PersonMotion,
    given: PersonInput,
    has_wheel: Flag,
) -> Measurement:
    """This step's sample of everything that is measured."""
    return measure(
        parameters.car,
        parameters.road,
        motion.plant.world,
        driver_torque(parameters, motion, has_wheel),
        HeadTracker(head_yaw=given.head_yaw, valid=given.head_yaw_valid),
    )


@compiled
def _sample(
    state: PersonState,
    motion: PersonMotion,
    measurement: Measurement,
    signals: Signals,
    given: PersonInput,
) -> Sample:
    """All of this step; nobody knows what a person intends."""
    command = ArmCommand(
        intended_angle=given.intended_angle,
        holding_stiffness=0.0,
        stiffening=1.0,
        guidance=0.0,
        reliance=0.0,
    )
    action = Action(
        arm=command,
        pedals=Pedals(accelerator=given.accelerator, brake=given.brake),
        head_yaw=given.head_yaw,
        intention=math.nan,
    )
    return Sample(
        time=state.time,
        measurement=measurement,
        signals=signals,
        motor_torque=motion.plant.world.column.motor_torque,
        action=action,
        events=state.events,
        lead=lead_of(state.events, measurement.longitudinal_position),
    )


@compiled
def control(
    parameters: LoopParameters,
    state: PersonState,
    motion: PersonMotion,
    given: PersonInput,
    has_wheel: Flag,
) -> tuple[PersonState, PersonHeld, Sample]:
    """One control step: sense, run the method, move the leader on.

    Args:
        parameters: Of the trial.
        state: Of the control steps.
        motion: World and hands now.
        given: What reaches the loop.
        has_wheel: Whether a real wheel is held.

    Returns:
        The new state, what is held until the next control step, and the sample.
    """
    measurement = sense(parameters, motion, given, has_wheel)
    controller_state, signals = controller.step(
        parameters.controller,
        state.controller,
        measurement,
        given.crossing_probability,
        given.requested,
        DT,
    )
    events = step_events(
        parameters.traffic,
        parameters.road,
        state.events,
        measurement,
        phase(parameters, measurement),
        xp.select(parameters.start.events > 0.5, given.leader_uniform, -1.0),
        DT,
    )
    held = PersonHeld(
        intended_angle=given.intended_angle,
        grip=given.grip,
        torque_command=state.torque_command,
        drive_command=drive_command(parameters.car, given.accelerator, given.brake),
    )
    sample = _sample(state, motion, measurement, signals, given)
    return (
        PersonState(
            controller=controller_state,
            events=events,
            torque_command=signals.applied_torque,
            time=state.time + DT,
        ),
        held,
        sample,
    )


@compiled
def counted_from_here(motion: PersonMotion) -> PersonMotion:
    """The motion with the driver's torque counted from this control step on."""
    plant = PlantMotion(world=motion.plant.world, arm=motion.plant.arm, muscles=0.0)
    return PersonMotion(plant=plant, before=motion.plant.world.column)


@compiled
def gripping(hands: ArmParameters, grip: Real) -> ArmParameters:
    """Arms that hold with a share of their stiffness; resting hands still weigh."""
    return ArmParameters(
        holding_gain=hands.holding_gain * grip,
        stiffness=hands.stiffness * grip,
        intrinsic_share=hands.intrinsic_share,
        lag=hands.lag,
        reflex_delay=hands.reflex_delay,
        inertia=hands.inertia,
        damping=hands.damping,
        hands_on=hands.hands_on,
    )


@compiled
def hands_step(
    parameters: LoopParameters, motion: PersonMotion, held: PersonHeld
) -> PersonMotion:
    """World and virtual hands one plant step later: the plant step of the studies."""
    hands = gripping(parameters.driver.arm, held.grip)
    speed = motion.plant.world.vehicle.longitudinal_velocity
    command = ArmCommand(
        intended_angle=held.intended_angle,
        holding_stiffness=holding_stiffness(
            parameters.car, parameters.column, xp.maximum(speed, 1.0)
        ),
        stiffening=1.0,
        guidance=0.0,
        reliance=0.0,
    )
    fixed = PlantHeld(
        car=parameters.car,
        column=arm.held_column(hands, parameters.column, 1.0),
        arm=hands,
        command=command,
        torque_command=held.torque_command,
        drive_command=held.drive_command,
        dt=DT / parameters.plant_steps,
    )
    return PersonMotion(plant=plant_step(motion.plant, fixed), before=motion.before)
