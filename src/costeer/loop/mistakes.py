"""Mistakes made on purpose: of the trigger, the sensors, the motor, the knowledge.

They stand between the road and the method, so that every method meets the same ones: it
hears a distorted measurement and request, and what it asks of the motor arrives late,
weak or not at all. The record keeps what truly was: the measurement of the sensors
before they err, and the torque that the motor gave.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.controller.signals import Request
from costeer.drivers.interface import Action
from costeer.loop.clock import DT
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.road import distance_to_adjacent_lane, lane_exists
from costeer.sensing.measurement import Measurement

POSITIVE = 0.5
"""Crossing probability that counts as a trigger for what delays or forces one [-]."""


class MistakeParameters(NamedTuple):
    """What goes wrong in a trial.

    Attributes:
        any: 1 if anything goes wrong [-]. Source: the others.
        false_trigger: 1 if triggers come while nobody wants to change lanes [-].
            Source: the scenario.
        false_trigger_period: From one of them to the next [s]. Source: assumed.
        trigger_duration: That a forced trigger lasts [s]. Source: assumed, four
            times what makes a trigger.
        missed_trigger: 1 if no trigger arrives [-]. Source: the scenario.
        trigger_delay: Triggers arrive so much later [s]. Source: the scenario.
        wrong_side: 1 if triggers name the other side, where a lane is [-]. Source: the
            scenario.
        trigger_when_given_up: 1 if a trigger comes when the driver gives a lane change
            up [-]. Source: the scenario.
        torque_bias: Of the driver-torque sensor [N·m]. Source: the scenario.
        torque_dead: 1 if that sensor reads nothing [-]. Source: the scenario.
        lateral_offset: Of the reference from the lane's centre, left positive [m].
            Source: the scenario.
        head_lost: 1 if the head is never seen [-]. Source: the scenario.
        friction_ratio: Of the column, over what the method believes [-]. Source: the
            scenario.
        mass_ratio: Mass that the method believes in, over the car's [-]. Source: the
            scenario.
        tyre_ratio: Cornering stiffness that the method believes in, over the car's
            [-]. Source: the scenario.
        latency: Of the motor, in whole control steps, at most six [s]. Source: the
            scenario.
        motor_limit: Torque beyond which the motor is saturated [N·m]. Source: the
            scenario.
        off: 1 if the guidance goes off [-]. Source: the scenario.
        off_time: When it does [s]. Source: assumed.
        off_duration: Over which it fades; 0 for at once [s]. Source: the scenario.
        false_steer: Torque of an evasive manoeuvre that nothing calls for, towards the
            other lane [N·m]. Source: the scenario.
        false_steer_duration: Of it [s]. Source: published studies, 0.5 to 2.
        false_steer_period: From one of them to the next [s]. Source: assumed.
    """

    any: Real = 0.0
    false_trigger: Real = 0.0
    false_trigger_period: Real = 60.0
    trigger_duration: Real = 0.2
    missed_trigger: Real = 0.0
    trigger_delay: Real = 0.0
    wrong_side: Real = 0.0
    trigger_when_given_up: Real = 0.0
    torque_bias: Real = 0.0
    torque_dead: Real = 0.0
    lateral_offset: Real = 0.0
    head_lost: Real = 0.0
    friction_ratio: Real = 1.0
    mass_ratio: Real = 1.0
    tyre_ratio: Real = 1.0
    latency: Real = 0.0
    motor_limit: Real = 100.0
    off: Real = 0.0
    off_time: Real = 60.0
    off_duration: Real = 0.0
    false_steer: Real = 0.0
    false_steer_duration: Real = 1.0
    false_steer_period: Real = 60.0


class TorqueDelay(NamedTuple):
    """Torques asked for one to six control steps ago [N·m]."""

    one: Real = 0.0
    two: Real = 0.0
    three: Real = 0.0
    four: Real = 0.0
    five: Real = 0.0
    six: Real = 0.0


class MistakeState(NamedTuple):
    """What the mistakes remember.

    Attributes:
        time_positive: Since a trigger has been there without a break [s].
        intention: Side that the driver meant to change to a step ago [-].
        origin: Lane in which the driver began to mean it [-].
        time_given_up: Since a lane change was given up [s].
        delay: Torques on their way to the motor.
    """

    time_positive: Real = 0.0
    intention: Real = 0.0
    origin: Real = -1.0
    time_given_up: Real = 1e9
    delay: TorqueDelay = TorqueDelay()


class Heard(NamedTuple):
    """What reaches a method.

    Attributes:
        measurement: As its sensors say.
        request: As its predictor says.
        memory: Of the mistakes.
    """

    measurement: Measurement
    request: Request
    memory: MistakeState


@compiled
def goes_wrong(parameters: MistakeParameters | None) -> Flag | None:
    """Whether anything does; None where nothing ever can."""
    if parameters is None:
        return None
    return parameters.any > 0.5


@compiled
def loses_head(parameters: MistakeParameters | None) -> Flag:
    """Whether the head tracker sees nothing all the time."""
    if parameters is None:
        return False
    return parameters.head_lost > 0.5


@compiled
def recurs(time: Real, period: Real, duration: Real) -> Flag:
    """Whether something lasts now that begins after each period.

    Args:
        time: Since the trial began [s].
        period: From one beginning to the next [s].
        duration: That it lasts [s].
    """
    since = time - xp.floor(time / period) * period
    return (time >= period) & (since < duration)


@compiled
def given_up(
    state: MistakeState, measurement: Measurement, action: Action, dt: Real
) -> MistakeState:
    """Look whether the driver has given a lane change up: not meant any more, not made.

    Of a person nobody knows the intention (NaN): nothing is ever given up.
    """
    means, meant = action.intention != 0.0, state.intention != 0.0
    begins = means & xp.logical_not(meant)
    stays = measurement.lane == state.origin
    ends = meant & (action.intention == 0.0) & stays
    return state._replace(
        intention=action.intention,
        origin=xp.select(begins, measurement.lane, state.origin),
        time_given_up=xp.select(ends, 0.0, state.time_given_up + dt),
    )


@compiled
def heard_request(
    parameters: MistakeParameters,
    state: MistakeState,
    side: Real,
    request: Request,
    action: Action,
    time: Real,
) -> tuple[MistakeState, Request]:
    """The request that reaches the method.

    Args:
        parameters: What goes wrong.
        state: Of the mistakes.
        side: Of the adjacent lane [-].
        request: As predictor, person or script gives it.
        action: Of the driver.
        time: Since the trial began [s].
    """
    p = parameters
    there = (request.crossing_probability >= POSITIVE) | request.requested
    positive = there | (request.indicator != 0.0)
    time_positive = xp.select(positive, state.time_positive + DT, 0.0)
    late = time_positive <= p.trigger_delay
    withheld = (p.missed_trigger > 0.5) | (positive & late & (p.trigger_delay > 0.0))
    probability = xp.select(withheld & there, 0.0, request.crossing_probability)
    indicator = xp.select(withheld, 0.0, request.indicator)
    nobody = xp.logical_not((action.intention < 0.0) | (action.intention > 0.0))
    due = recurs(time, p.false_trigger_period, p.trigger_duration)
    false = (p.false_trigger > 0.5) & due & nobody
    fresh = state.time_given_up < p.trigger_duration
    forced = false | ((p.trigger_when_given_up > 0.5) & fresh)
    return state._replace(time_positive=time_positive), request._replace(
        crossing_probability=xp.select(forced, 1.0, probability),
        requested=request.requested & xp.logical_not(withheld),
        indicator=xp.select(forced, side, indicator),
    )


@compiled
def measured_side(
    parameters: MistakeParameters, road: RoadParameters, measurement: Measurement
) -> Real:
    """Side on which the method believes the other lane [-]."""
    other = measurement.lane - measurement.side
    wrong = (parameters.wrong_side > 0.5) & lane_exists(road, other)
    return xp.select(wrong, -measurement.side, measurement.side)


@compiled
def heard_measurement(
    parameters: MistakeParameters, road: RoadParameters, measurement: Measurement
) -> Measurement:
    """The measurement that reaches the method.

    A reference beside the lane's centre is a car that is measured on its other side.
    """
    p, side = parameters, measured_side(parameters, road, measurement)
    position = measurement.lateral_position - p.lateral_offset
    torque = xp.select(p.torque_dead > 0.5, 0.0, measurement.driver_torque)
    return measurement._replace(
        lateral_position=position,
        side=side,
        distance_to_adjacent_lane=distance_to_adjacent_lane(
            road, position, measurement.lane, side
        ),
        driver_torque=torque + p.torque_bias,
    )


@compiled
def heard(
    parameters: MistakeParameters,
    state: MistakeState,
    road: RoadParameters,
    measurement: Measurement,
    request: Request,
    action: Action,
    time: Real,
) -> Heard:
    """What reaches the method at this step.

    Args:
        parameters: What goes wrong.
        state: Of the mistakes.
        road: Its lanes.
        measurement: Of the sensors.
        request: As predictor, person or script gives it.
        action: Of the driver.
        time: Since the trial began [s].
    """
    seen = heard_measurement(parameters, road, measurement)
    memory = given_up(state, measurement, action, DT)
    turned = measurement.side != seen.side
    told = request._replace(
        indicator=xp.select(turned, -request.indicator, request.indicator)
    )
    memory, asked = heard_request(parameters, memory, seen.side, told, action, time)
    return Heard(seen, asked, memory)


@compiled
def delayed(
    parameters: MistakeParameters, state: TorqueDelay, torque: Real
) -> tuple[TorqueDelay, Real]:
    """The torque of as many control steps ago as the latency is long [N·m]."""
    steps = xp.floor(parameters.latency / DT + 0.5)
    late = xp.select(steps >= 1.0, state.one, torque)
    late = xp.select(steps >= 2.0, state.two, late)
    late = xp.select(steps >= 3.0, state.three, late)
    late = xp.select(steps >= 4.0, state.four, late)
    late = xp.select(steps >= 5.0, state.five, late)
    late = xp.select(steps >= 6.0, state.six, late)
    moved = TorqueDelay(
        one=torque,
        two=state.one,
        three=state.two,
        four=state.three,
        five=state.four,
        six=state.five,
    )
    return moved, late


@compiled
def given_torque(
    parameters: MistakeParameters,
    state: MistakeState,
    side: Real,
    torque: Real,
    limit: Real,
    time: Real,
) -> tuple[MistakeState, Real]:
    """The torque that the motor is told, for what the method asked [N·m].

    Args:
        parameters: What goes wrong.
        state: Of the mistakes.
        side: Of the adjacent lane [-].
        torque: Asked for, within the limit [N·m].
        limit: Of the motor, 0 where nothing assists [N·m].
        time: Since the trial began [s].
    """
    p = parameters
    delay, arrived = delayed(p, state.delay, torque)
    over = xp.maximum(p.off_duration, DT)
    faded = xp.clip(1.0 - (time - p.off_time) / over, 0.0, 1.0)
    arrived = arrived * xp.select(p.off > 0.5, faded, 1.0)
    steers = recurs(time, p.false_steer_period, p.false_steer_duration)
    arrived = arrived + xp.select(steers, p.false_steer * side, 0.0)
    most = xp.minimum(limit, p.motor_limit)
    return state._replace(delay=delay), xp.clip(arrived, -most, most)


def believed_car(parameters: MistakeParameters, car: CarParameters) -> CarParameters:
    """The car that the method takes the true one for."""
    tyres = parameters.tyre_ratio
    return car._replace(
        mass=car.mass * parameters.mass_ratio,
        front_cornering_stiffness=car.front_cornering_stiffness * tyres,
        rear_cornering_stiffness=car.rear_cornering_stiffness * tyres,
    )


def true_column(
    parameters: MistakeParameters, column: ColumnParameters
) -> ColumnParameters:
    """The column as it is, of which the method knows the nominal one."""
    return column._replace(friction=column.friction * parameters.friction_ratio)


def judged(parameters: MistakeParameters) -> MistakeParameters:
    """The parameters, with `any` as the others say."""
    calm = parameters == MistakeParameters(any=parameters.any)
    return parameters._replace(any=0.0 if calm else 1.0)
