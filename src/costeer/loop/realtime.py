"""The person's loop between packed arrays, as the real-time process calls it.

Unboxing a deep tuple would cost microseconds at every plant step; one packed float64
array costs less than one (docs/decisions/0002-engine.md).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.entry import entry
from costeer.base.packing import leaf_names, pack, packed, unpack
from costeer.loop.person import (
    PersonHeld,
    PersonInput,
    control,
    counted_from_here,
    hands_step,
    initial_motion,
    initial_state,
)
from costeer.loop.real_wheel import WheelInput, wheel_step
from costeer.loop.rows import fill_row
from costeer.loop.step import LoopParameters
from costeer.records.row import ROW_COLUMNS
from costeer.sensing.torque_observer import (
    TorqueObserverParameters,
    WheelMotion,
)
from costeer.sensing.torque_observer import initial_state as observer_state
from costeer.sensing.torque_observer import step as observe

_LIKE = LoopParameters()
_STATE = initial_state(_LIKE)
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
        state: Packed `PersonState`, shape `(state,)`.
        motion: Packed `PersonMotion`, shape `(motion,)`.
        given: Room for a packed `PersonInput`, shape `(input,)`.
        held: Room for a packed `PersonHeld`, shape `(held,)`.
        wheel: Room for a packed `WheelInput`, shape `(wheel,)`.
        row: The newest row in the order of `ROW_COLUMNS`, shape `(column,)`.
    """

    parameters: NDArray[np.float64]
    state: NDArray[np.float64]
    motion: NDArray[np.float64]
    given: NDArray[np.float64]
    held: NDArray[np.float64]
    wheel: NDArray[np.float64]
    row: NDArray[np.float64]


def person_memory(parameters: LoopParameters) -> PersonMemory:
    """Memory of a drive that begins."""
    return PersonMemory(
        parameters=packed(parameters),
        state=packed(initial_state(parameters)),
        motion=packed(initial_motion(parameters)),
        given=packed(NOTHING_GIVEN),
        held=packed(_HELD),
        wheel=packed(_WHEEL),
        row=np.full(len(ROW_COLUMNS), np.nan),
    )


@entry
def control_tick(
    parameters: NDArray[np.float64],
    state: NDArray[np.float64],
    motion: NDArray[np.float64],
    given: NDArray[np.float64],
    has_wheel: bool,
    held: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    """One control step: sense, run the method, fill the row.

    Args:
        parameters: Of `PersonMemory`.
        state: Of `PersonMemory`, changed in place.
        motion: Of `PersonMemory`, changed in place: the driver's torque counts anew.
        given: Packed `PersonInput`.
        has_wheel: Whether a real wheel is held.
        held: Filled with what the plant steps until the next control step hold.
        out: Filled in the order of `ROW_COLUMNS`.
    """
    now = unpack(_MOTION, motion)
    new_state, kept, sample = control(
        unpack(_LIKE, parameters),
        unpack(_STATE, state),
        now,
        unpack(NOTHING_GIVEN, given),
        has_wheel,
    )
    pack(state, new_state)
    pack(motion, counted_from_here(now))
    pack(held, kept)
    fill_row(out, sample)


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
