"""A person in the loop: the closed loop of a trial with the driver left out.

Controller, world and record are those of the studies (loop/step.py); what a virtual
driver would do comes in from outside: at 60 Hz the pedals, the head, the network's
verdict, and at the plant's rate either the intended angle of virtual hands
(`hands_step`) or the angle of a real wheel (loop/real_wheel.py). The order and the
delays are the same: a torque computed from a sample acts one control step later.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, TypeVar

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled, inlined
from costeer.controller import inference
from costeer.controller.inference import InferenceParameters
from costeer.controller.signals import Request
from costeer.drivers import arm
from costeer.drivers.arm import ArmCommand, ArmParameters
from costeer.drivers.interface import Action
from costeer.drivers.longitudinal import Pedals
from costeer.loop.events import place_of, with_car
from costeer.loop.half_step import ControlState, Sample, Seat, half_step
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.step import PlantHeld, PlantMotion, plant_step, seen_head
from costeer.methods.interface import Rule
from costeer.plant import world
from costeer.plant.alignment import bend_at
from costeer.plant.parameters import RoadParameters, holding_stiffness
from costeer.plant.place import Place
from costeer.plant.road import cruising_lane, lane_centre
from costeer.plant.steering import ColumnState
from costeer.plant.vehicle import drive_command
from costeer.sensing.measurement import Measurement
from costeer.sensing.sensors import HeadTracker, measure

S = TypeVar("S")

_SETTLED = InferenceParameters()
"""When a car has settled after a lane change, whatever the method."""


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
        crossing_side: That probability or request are about, -1 right, +1 left; 0: the
            usual one [-].
        requested: A lane change asked for from outside.
        leader_uniform: Sets the next leader's speed, in [0, 1) [-].
        indicator: Side that it is set to, -1 right, 0 off, +1 left [-].
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
    indicator: Real = 0.0
    crossing_side: Real = 0.0


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
        place: What the road does to the car.
    """

    intended_angle: Real
    grip: Real
    torque_command: Real
    drive_command: Real
    place: Place = Place()


@compiled
def initial_motion(parameters: LoopParameters[Any]) -> PersonMotion:
    """The car in the cruising lane at the start's speed, wheel straight ahead."""
    centre = lane_centre(parameters.road, cruising_lane(parameters.road))
    offset = parameters.start.lateral_offset
    state = world.initial_state(parameters.car, centre + offset, parameters.start.speed)
    plant = PlantMotion(world=state, arm=arm.initial_state(), muscles=0.0)
    return PersonMotion(plant=plant, before=state.column)


@compiled
def driver_torque(
    parameters: LoopParameters[Any], motion: PersonMotion, has_wheel: Flag
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
def at_home(road: RoadParameters, measurement: Measurement) -> Flag:
    """Whether the car runs straight in the cruising lane.

    Of a person nobody knows the decision; the event zone ends when the car has
    returned and settled.
    """
    is_settled = inference.settled(_SETTLED, road, measurement)
    return is_settled & (measurement.lane == cruising_lane(road))


@compiled
def sense(
    parameters: LoopParameters[Any],
    motion: PersonMotion,
    given: PersonInput,
    has_wheel: Flag,
) -> Measurement:
    """This step's sample of everything that is measured."""
    position = motion.plant.world.vehicle.longitudinal_position
    head = HeadTracker(head_yaw=given.head_yaw, valid=given.head_yaw_valid)
    return measure(
        parameters.car,
        parameters.road,
        motion.plant.world,
        driver_torque(parameters, motion, has_wheel),
        seen_head(parameters, position, head),
        bend_at(parameters.alignment, position),
    )


@compiled
def seated(
    parameters: LoopParameters[Any],
    motion: PersonMotion,
    given: PersonInput,
    measurement: Measurement,
) -> Seat:
    """The person's seat; nobody knows what a person intends."""
    return Seat(
        action=Action(
            arm=ArmCommand(intended_angle=given.intended_angle),
            pedals=Pedals(accelerator=given.accelerator, brake=given.brake),
            head_yaw=given.head_yaw,
            intention=math.nan,
            at_home=at_home(parameters.road, measurement),
            indicator=given.indicator,
        ),
        leader_uniform=given.leader_uniform,
        motor_torque=motion.plant.world.column.motor_torque,
    )


@inlined
def control(
    rule: Rule[Any, S],
    parameters: LoopParameters[Any],
    state: ControlState[S],
    motion: PersonMotion,
    given: PersonInput,
    has_wheel: Flag,
) -> tuple[ControlState[S], PersonHeld, Sample[S]]:
    """One control step: sense, then the half-step that trials run too.

    Args:
        rule: The method's functions.
        parameters: Of the trial.
        state: Of the control steps.
        motion: World and hands now.
        given: What reaches the loop.
        has_wheel: Whether a real wheel is held.

    Returns:
        The new state, what is held until the next control step, and the sample.
    """
    measurement = sense(parameters, motion, given, has_wheel)
    request = Request(
        crossing_probability=given.crossing_probability,
        requested=given.requested,
        change_duration=math.nan,
        side=given.crossing_side,
    )
    state = state._replace(events=with_car(state.events, measurement))
    seat = seated(parameters, motion, given, measurement)
    new_state, sample = half_step(rule, parameters, state, measurement, request, seat)
    held = PersonHeld(
        intended_angle=given.intended_angle,
        grip=given.grip,
        torque_command=state.torque_command,
        drive_command=drive_command(parameters.car, given.accelerator, given.brake),
        place=place_of(
            parameters.road, parameters.stretches, sample.events, measurement
        ),
    )
    return new_state, held, sample


@compiled
def counted_from_here(motion: PersonMotion) -> PersonMotion:
    """The motion with the driver's torque counted from this control step on."""
    plant = motion.plant._replace(muscles=0.0)
    return PersonMotion(plant=plant, before=plant.world.column)


@compiled
def gripping(hands: ArmParameters, grip: Real) -> ArmParameters:
    """Arms that hold with a share of their stiffness; resting hands still weigh."""
    return hands._replace(
        holding_gain=hands.holding_gain * grip, stiffness=hands.stiffness * grip
    )


@compiled
def hands_step(
    parameters: LoopParameters[Any], motion: PersonMotion, held: PersonHeld
) -> PersonMotion:
    """World and virtual hands one plant step later: the plant step of the studies."""
    hands = gripping(parameters.driver.arm, held.grip)
    speed = motion.plant.world.vehicle.longitudinal_velocity
    command = ArmCommand(
        intended_angle=held.intended_angle,
        holding_stiffness=holding_stiffness(
            parameters.car, parameters.column, xp.maximum(speed, 1.0)
        ),
    )
    fixed = PlantHeld(
        car=parameters.car,
        column=arm.held_column(hands, parameters.column, 1.0),
        arm=hands,
        command=command,
        torque_command=held.torque_command,
        drive_command=held.drive_command,
        dt=DT / parameters.plant_steps,
        place=held.place,
    )
    return motion._replace(plant=plant_step(motion.plant, fixed))
