"""The half of a control step that is the same whoever drives.

The method turns a measurement into a torque command, the leader moves on, and all of it
becomes a sample. Who holds the wheel sits in the `Seat`: a virtual driver
(loop/step.py) or a person (loop/person.py).
"""

from __future__ import annotations

from typing import Any, Generic, NamedTuple, TypeVar

from costeer.base import array as xp
from costeer.base.array import Real, compiled, inlined
from costeer.controller.signals import Assistance, Request
from costeer.drivers.interface import Action
from costeer.loop.events import (
    EventState,
    Lead,
    contact_of,
    initial_events,
    lead_of,
    step_events,
)
from costeer.loop.mistakes import (
    Heard,
    MistakeState,
    given_torque,
    goes_wrong,
    heard,
)
from costeer.loop.parameters import DT, LoopParameters
from costeer.methods.interface import Rule
from costeer.plant.fleet_motion import World, moved
from costeer.plant.road import cruising_lane
from costeer.sensing.measurement import Measurement, towards

S = TypeVar("S")

NO_FAULT, NOT_FINITE, OVER_LIMIT = 0.0, 1.0, 2.0
"""What was wrong with the torque that a method asked for."""


class ControlState(NamedTuple, Generic[S]):
    """What the control steps remember.

    Attributes:
        method: Of the method.
        events: Leader and event zone.
        torque_command: Computed at the step before, acts in this one [N·m].
        time: Since the trial began [s].
        mistakes: Of what goes wrong on purpose.
    """

    method: S
    events: EventState
    torque_command: Real
    time: Real
    mistakes: MistakeState


class Seat(NamedTuple):
    """What whoever drives does at a control step.

    Attributes:
        action: Arms, pedals, head. At home is a virtual driver who cruises, and a
            person whose car has settled.
        leader_uniform: Sets the next leader's speed, in [0, 1) [-].
        motor_torque: Guidance torque at the wheel now [N·m].
    """

    action: Action
    leader_uniform: Real
    motor_torque: Real


class Sample(NamedTuple, Generic[S]):
    """All that was measured and computed at one step, for the record.

    Attributes:
        time: Since the trial began [s].
        measurement: Of the sensors.
        request: What was asked of the method.
        signals: Of the method.
        method: Its state after the step, for columns of its own.
        torque_fault: `NO_FAULT`, `NOT_FINITE` or `OVER_LIMIT` [-].
        motor_torque: Guidance torque that the motor gives [N·m].
        action: Of the driver.
        events: Leader and event zone.
        lead: The leader as the record shows it.
    """

    time: Real
    measurement: Measurement
    request: Request
    signals: Assistance
    method: S
    torque_fault: Real
    motor_torque: Real
    action: Action
    events: EventState
    lead: Lead


@inlined
def initial_control(
    rule: Rule[Any, S], parameters: LoopParameters[Any]
) -> ControlState[S]:
    """The method keeps the cruising lane, the road is empty."""
    lane = cruising_lane(parameters.road)
    return ControlState(
        method=rule.initial_state(parameters.controller, lane),
        events=initial_events(parameters.fleet),
        torque_command=0.0,
        time=0.0,
        mistakes=MistakeState(),
    )


@inlined
def fault_of(torque: Real, limit: Real) -> Real:
    """What is wrong with a torque that a method asks for [-].

    Args:
        torque: [N·m].
        limit: Of the motor [N·m].
    """
    over = (torque > limit) | (torque < -limit)
    return xp.select(
        xp.isfinite(torque), xp.select(over, OVER_LIMIT, NO_FAULT), NOT_FINITE
    )


@inlined
def contained(torque: Real, limit: Real) -> Real:
    """The torque that may reach the motor: within its limit, none if not finite [N·m].

    Args:
        torque: That a method asks for [N·m].
        limit: Of the motor [N·m].
    """
    return xp.select(xp.isfinite(torque), xp.clip(torque, -limit, limit), 0.0)


@compiled
def moved_events(
    parameters: LoopParameters[Any],
    state: EventState,
    measurement: Measurement,
    seat: Seat,
    time: Real,
) -> EventState:
    """Leader, event zone and other cars one control step later."""
    events = step_events(
        parameters.traffic,
        parameters.road,
        state,
        measurement,
        seat.action.at_home,
        xp.select(parameters.start.events > 0.5, seat.leader_uniform, -1.0),
        DT,
    )
    around = World(road=parameters.road, law=parameters.following, time=time, dt=DT)
    return events._replace(fleet=moved(parameters.fleet, events.fleet, around))


@inlined
def half_step(
    rule: Rule[Any, S],
    parameters: LoopParameters[Any],
    state: ControlState[S],
    measurement: Measurement,
    request: Request,
    seat: Seat,
) -> tuple[ControlState[S], Sample[S]]:
    """One control step of method and road; the car has been put into the fleet before.

    Args:
        rule: The method's functions.
        parameters: Of the trial.
        state: Of the control steps.
        measurement: This step's sample of the sensors.
        request: Verdict of the predictor and what is asked for from outside.
        seat: What the driver does.

    Returns:
        The new state, whose torque command acts in the next step, and the sample.
    """
    contact = contact_of(
        parameters.fleet, parameters.road, parameters.car, state.events, measurement
    )
    now = state.events._replace(contact=contact)
    wrong, road = parameters.mistakes, parameters.road
    seen = towards(road, measurement, request.side)
    request = request._replace(indicator=seat.action.indicator, side=seen.side)
    limit = xp.select(parameters.assists > 0.5, parameters.column.torque_limit, 0.0)
    given = wrong, state.mistakes, road, seen, request, seat.action, state.time
    truly = Heard(seen, request, state.mistakes)
    got = xp.when(goes_wrong(wrong), heard, given, truly)
    method_state, signals = rule.step(
        parameters.controller, state.method, got.measurement, got.request, DT
    )
    asked = contained(signals.applied_torque, limit)
    told = wrong, got.memory, seen.side, asked, limit, state.time
    same = got.memory, asked
    memory, command = xp.when(goes_wrong(wrong), given_torque, told, same)
    sample = Sample(
        time=state.time,
        measurement=measurement,
        request=got.request,
        signals=signals,
        method=method_state,
        torque_fault=fault_of(signals.applied_torque, limit),
        motor_torque=seat.motor_torque,
        action=seat.action,
        events=now,
        lead=lead_of(now, measurement.longitudinal_position),
    )
    return ControlState(
        method=method_state,
        events=moved_events(parameters, now, measurement, seat, state.time),
        torque_command=command,
        time=state.time + DT,
        mistakes=memory,
    ), sample
