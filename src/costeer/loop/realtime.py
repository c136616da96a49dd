"""The person's loop between packed arrays, as the real-time process calls it.

Unboxing a deep tuple would cost microseconds at every plant step; one packed float64
array costs less than one (docs/decisions/0002-engine.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.entry import entry, entry_for
from costeer.base.packing import leaf_names, pack, packed, unpack
from costeer.drivers import arm
from costeer.drivers.arm import ArmCommand, ArmParameters
from costeer.loop.half_step import initial_control
from costeer.loop.parameters import LoopParameters
from costeer.loop.person import (
    PersonHeld,
    PersonInput,
    control,
    counted_from_here,
    hands_step,
    initial_motion,
)
from costeer.loop.real_wheel import WheelInput, wheel_step
from costeer.loop.rollout import row_width
from costeer.loop.rows import writer_of
from costeer.methods.interface import (
    Method,
    P,
    Rule,
    S,
    compiled_once,
    rule_of,
    usual_parameters,
)
from costeer.plant.fleet import num_cars, write_cars
from costeer.sensing.torque_observer import (
    TorqueObserverParameters,
    WheelMotion,
)
from costeer.sensing.torque_observer import initial_state as observer_state
from costeer.sensing.torque_observer import step as observe

_LIKE = LoopParameters(controller=0.0)
"""Plant and hands do not look at the method."""

_MOTION = initial_motion(_LIKE)

NOTHING_GIVEN = PersonInput(
    intended_angle=0.0,
    grip=0.0,
    accelerator=0.0,
    brake=0.0,
    head_yaw=0.0,
    head_yaw_valid=False,
    crossing_probability=math.nan,
    requested=False,
    leader_uniform=0.0,
)
"""Hands rest on the wheel, no pedal, no head, no verdict."""

_HELD = PersonHeld(intended_angle=0.0, grip=0.0, torque_command=0.0, drive_command=0.0)
_WHEEL = WheelInput(
    steering_wheel_angle=0.0,
    steering_wheel_rate=0.0,
    driver_torque=0.0,
    damping=0.0,
    friction=0.0,
)

_OBSERVER = TorqueObserverParameters()
_OBSERVED = observer_state()
_READING = WheelMotion(
    steering_wheel_angle=0.0, steering_wheel_rate=0.0, motor_torque=0.0
)
_RATE = leaf_names(_OBSERVED).index("steering_wheel_rate")


class PersonMemory(NamedTuple):
    """All that one drive remembers, in arrays that the ticks change in place.

    Attributes:
        parameters: Packed `LoopParameters`, shape `(parameter,)`.
        plant: The same without the method, for the plant steps.
        state: Packed `ControlState`, shape `(state,)`.
        motion: Packed `PersonMotion`, shape `(motion,)`.
        given: Room for a packed `PersonInput`, shape `(input,)`.
        held: Room for a packed `PersonHeld`, shape `(held,)`.
        wheel: Room for a packed `WheelInput`, shape `(wheel,)`.
        row: The newest row, the columns of every record and those of the method,
            shape `(column,)`.
    """

    parameters: NDArray[np.float64]
    plant: NDArray[np.float64]
    state: NDArray[np.float64]
    motion: NDArray[np.float64]
    given: NDArray[np.float64]
    held: NDArray[np.float64]
    wheel: NDArray[np.float64]
    row: NDArray[np.float64]


def person_memory(method: Method[P, S], parameters: LoopParameters[P]) -> PersonMemory:
    """Memory of a drive that begins."""
    return PersonMemory(
        parameters=packed(parameters),
        plant=packed(LoopParameters(0.0, *parameters[1:])),
        state=packed(initial_control(rule_of(method), parameters)),
        motion=packed(initial_motion(parameters)),
        given=packed(NOTHING_GIVEN),
        held=packed(_HELD),
        wheel=packed(_WHEEL),
        row=np.full(row_width(method, parameters), np.nan),
    )


def with_method(
    memory: PersonMemory,
    before: Method[Any, Any],
    method: Method[P, S],
    parameters: LoopParameters[P],
    lane: float,
) -> PersonMemory:
    """Memory of a drive that goes on with another method.

    Args:
        memory: Of the drive.
        before: The method until now.
        method: From now on; it begins by keeping the lane.
        parameters: Of the drive, with those of the new method.
        lane: That the car is in [-].
    """
    usual = LoopParameters(controller=usual_parameters(before))
    old = unpack(initial_control(rule_of(before), usual), memory.state)
    own = method.initial_state(parameters.controller, lane)
    return memory._replace(
        parameters=packed(parameters),
        state=packed(old._replace(method=own)),
        row=np.full(row_width(method, parameters), np.nan),
    )


ControlTick = Callable[..., None]
"""One control step on the arrays of a `PersonMemory`: see `control_tick`."""


def control_tick(method: Method[P, S]) -> ControlTick:
    """The compiled control step of a method: sense, run the method, fill the row.

    Returns:
        A function of the arrays `parameters`, `state` and `motion` of a `PersonMemory`,
        the packed `PersonInput`, whether a real wheel is held, `held` and `row`. State
        and motion are changed in place (the driver's torque counts anew), `held` is
        filled with what the plant steps until the next control step hold.
    """
    tick: ControlTick = compiled_once(_compiled_tick, method)
    return tick


def _compiled_tick(method: Method[P, S]) -> ControlTick:
    """`control_tick`, made anew."""
    initial_state, step = rule_of(method)
    fill = writer_of(method).fill
    like = LoopParameters(controller=usual_parameters(method))
    like_state = initial_control(rule_of(method), like)

    def tick(
        parameters: NDArray[np.float64],
        state: NDArray[np.float64],
        motion: NDArray[np.float64],
        given: NDArray[np.float64],
        has_wheel: bool,
        held: NDArray[np.float64],
        out: NDArray[np.float64],
    ) -> None:
        now, chosen = unpack(_MOTION, motion), unpack(like, parameters)
        new_state, kept, sample = control(
            Rule(initial_state, step),
            chosen,
            unpack(like_state, state),
            now,
            unpack(NOTHING_GIVEN, given),
            has_wheel,
        )
        pack(state, new_state)
        pack(motion, counted_from_here(now))
        pack(held, kept)
        fill(out, sample)
        write_cars(out, num_cars(chosen.fleet), sample.events.fleet)

    return entry_for((initial_state, step), tick)


@entry
def hands_tick(
    parameters: NDArray[np.float64],
    motion: NDArray[np.float64],
    held: NDArray[np.float64],
) -> None:
    """One plant step with virtual hands; `motion` is changed in place."""
    moved = hands_step(
        unpack(_LIKE, parameters), unpack(_MOTION, motion), unpack(_HELD, held)
    )
    pack(motion, moved)


@entry
def wheel_tick(
    parameters: NDArray[np.float64],
    motion: NDArray[np.float64],
    held: NDArray[np.float64],
    wheel: NDArray[np.float64],
) -> float:
    """One plant step with a real wheel; returns the torque it is to give [N·m]."""
    moved, torque = wheel_step(
        unpack(_LIKE, parameters),
        unpack(_MOTION, motion),
        unpack(_HELD, held),
        unpack(_WHEEL, wheel),
    )
    pack(motion, moved)
    return torque


_ARMS, _ARM_STATE, _COMMAND = ArmParameters(), arm.initial_state(), ArmCommand()


@entry
def arms_tick(
    parameters: NDArray[np.float64],
    state: NDArray[np.float64],
    command: NDArray[np.float64],
    angle: float,
    dt: float,
) -> float:
    """Arms one step on; returns the torque of their muscles on the wheel [N·m].

    Args:
        parameters: Packed `ArmParameters`.
        state: Packed `ArmState`, changed in place.
        command: Packed `ArmCommand`.
        angle: Of the wheel [rad].
        dt: Step [s].
    """
    arms, asked = unpack(_ARMS, parameters), unpack(_COMMAND, command)
    moved = arm.step(arms, unpack(_ARM_STATE, state), asked, angle, dt)
    pack(state, moved)
    return arm.muscle_torque(arms, moved, asked, angle)


class ObserverMemory(NamedTuple):
    """A running torque observer, in arrays.

    Attributes:
        parameters: Packed `TorqueObserverParameters`, shape `(parameter,)`.
        state: Packed `TorqueObserverState`, changed in place, shape `(state,)`.
        reading: Room for a packed `WheelMotion`, shape `(3,)`.
    """

    parameters: NDArray[np.float64]
    state: NDArray[np.float64]
    reading: NDArray[np.float64]

    @property
    def steering_wheel_rate(self) -> float:
        """Rate of the last reading, made of angles if the device tells none [rad/s]."""
        return float(self.state[_RATE])


def observer_memory(
    parameters: TorqueObserverParameters, steering_wheel_angle: float
) -> ObserverMemory:
    """Memory of an observer that begins at an angle [rad]."""
    return ObserverMemory(
        parameters=packed(parameters),
        state=packed(observer_state(steering_wheel_angle, 0.0)),
        reading=packed(_READING),
    )


@entry
def observer_tick(
    parameters: NDArray[np.float64],
    state: NDArray[np.float64],
    reading: NDArray[np.float64],
    dt: float,
) -> float:
    """One reading of the torque observer; returns the driver's torque [N·m]."""
    new_state, torque = observe(
        unpack(_OBSERVER, parameters),
        unpack(_OBSERVED, state),
        unpack(_READING, reading),
        dt,
    )
    pack(state, new_state)
    return torque
