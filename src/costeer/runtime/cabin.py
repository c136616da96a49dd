"""Wheel or virtual hands, car and controller of one drive, without any clock.

The real-time process calls `control` 60 times a second and `advance` 960 times; a
test calls them as fast as it likes and gets the same numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.described import value_at
from costeer.base.packing import leaf_names, packed
from costeer.devices.wheels.calibration import observer_parameters
from costeer.devices.wheels.hands import Seen
from costeer.devices.wheels.interface import Wheel, WheelReading
from costeer.loop.parameters import LoopParameters
from costeer.loop.person import PersonInput, initial_motion
from costeer.loop.real_wheel import WheelInput
from costeer.loop.realtime import (
    NOTHING_GIVEN,
    ObserverMemory,
    control_tick,
    hands_tick,
    observer_memory,
    observer_tick,
    person_memory,
    wheel_tick,
    with_method,
)
from costeer.methods.conditions import CONDITION_NAMES
from costeer.methods.interface import rule_of
from costeer.methods.registry import AnyMethod, method_named
from costeer.plant.parameters import CarParameters
from costeer.records.row import ROW_COLUMNS
from costeer.runtime.guard import GuardParameters, GuardState
from costeer.runtime.guard import step as guarded
from costeer.runtime.hands import (
    FootParameters,
    FootState,
    HandsParameters,
    HandsState,
    asked_angle,
    press,
)
from costeer.runtime.hands import step as move_hands
from costeer.runtime.setup import (
    PLANT_DT,
    PLANT_STEPS,
    DriveSetup,
    drive_method,
    drive_parameters,
    offered_methods,
    under,
)
from costeer.runtime.tunables import place_of
from costeer.sensing.torque_observer import TorqueObserverParameters

_MOTION = leaf_names(initial_motion(LoopParameters(controller=0.0)))
_ANGLE = _MOTION.index("plant.world.column.steering_wheel_angle")
_RATE = _MOTION.index("plant.world.column.steering_wheel_rate")
_LANE = ROW_COLUMNS.index("lane")
_ASSISTED = CONDITION_NAMES[-1]
_SPEED = _MOTION.index("plant.world.vehicle.longitudinal_velocity")

STRAIGHT = 0.35
"""A trial begins with the wheel nearer to straight ahead than this [rad]."""


class Controls(NamedTuple):
    """What person and sensors say at a control step.

    Attributes:
        steer: Of a key or stick, -1 right to +1 left [-].
        steering: Whether a key or stick is used at all.
        accelerator: Pressed, in [0, 1] [-].
        brake: Pressed, in [0, 1] [-].
        head_yaw: Normalised, left positive [-].
        head_valid: Whether the head is seen.
        crossing_probability: Of the network; NaN for no verdict [-].
        crossing_side: That probability or request are about, -1 right, +1 left; 0: the
            usual one [-].
        requested: A lane change asked for by the indicator.
        leader_uniform: Sets the next leader's speed [-].
        indicator: Side that it is set to, -1 right, 0 off, +1 left [-].
    """

    steer: float = 0.0
    steering: bool = False
    accelerator: float = 0.0
    brake: float = 0.0
    head_yaw: float = 0.0
    head_valid: bool = False
    crossing_probability: float = math.nan
    crossing_side: float = 0.0
    requested: bool = False
    leader_uniform: float = 0.0
    indicator: float = 0.0


class Cabin:
    """One drive from its start to its end.

    It begins without a wheel; `change_wheel` brings one.

    Args:
        setup: Of the drive.
        is_released: Whether another process has told the wheel to let go.
    """

    def __init__(
        self, setup: DriveSetup, is_released: Callable[[], bool] = lambda: False
    ) -> None:
        self._setup = setup
        self._is_released = is_released
        self.method = drive_method(setup)
        self._parameters = drive_parameters(setup)
        self._tick = control_tick(self.method)
        self.wheel: Wheel | None = None
        self.reading: WheelReading | None = None
        self.wheel_torque = 0.0
        self.driver_torque = 0.0
        self._wanted = 0.0
        self._guard = guard_parameters(None)
        self._guard_state = GuardState()
        self._observer: ObserverMemory | None = None
        self._skipped = 0
        self.begin()

    def begin(self) -> None:
        """Put the car at the start of the course; what was chosen stays."""
        self.memory = person_memory(self.method, self._parameters)
        self.hands = HandsState()
        keeps = self._setup.keeps_speed
        speed = self._setup.trial.speed
        self._foot = FootState(kept_speed=speed if keeps else math.nan)
        self.first_row()

    def warm_up(self) -> None:
        """Compile all that will run, on a drive that is thrown away."""
        for place in offered_methods(self._setup).values():
            self._first_step(method_named(place))
        memory = person_memory(self.method, self._parameters)
        if self._setup.wheel is None:
            hands_tick(memory.plant, memory.motion, memory.held)
            return
        wheel_tick(memory.plant, memory.motion, memory.held, memory.wheel)
        observer = observer_memory(self._observed_device(), 0.0)
        observer_tick(observer.parameters, observer.state, observer.reading, PLANT_DT)

    def _first_step(self, method: AnyMethod) -> None:
        """Let a method that may be chosen later take a step that nobody sees."""
        now = under(self._setup, _ASSISTED, method.name)
        memory = person_memory(drive_method(now), drive_parameters(now))
        control_tick(drive_method(now))(
            memory.parameters,
            memory.state,
            memory.motion,
            memory.given,
            self._setup.wheel is not None,
            memory.held,
            memory.row,
        )

    def first_row(self) -> NDArray[np.float64]:
        """The row of the car at rest in time; nothing is stepped."""
        memory = self.memory
        self._tick(
            memory.parameters,
            memory.state.copy(),
            memory.motion.copy(),
            memory.given,
            self._setup.wheel is not None,
            memory.held.copy(),
            memory.row,
        )
        return memory.row

    @property
    def car(self) -> CarParameters:
        """Of the trial."""
        return self._parameters.car

    @property
    def fade(self) -> float:
        """Share of the torque that reaches a real wheel [-]."""
        return self._guard_state.fade

    @property
    def steering_wheel_angle(self) -> float:
        """Of the wheel now [rad]."""
        if self.reading is not None:
            return self.reading.steering_wheel_angle
        return float(self.memory.motion[_ANGLE])

    def take_on(self, method: AnyMethod, parameters: LoopParameters[Any]) -> None:
        """Drive on with a method and parameters; the car does not notice."""
        if rule_of(method) != rule_of(self.method):
            self._tick = control_tick(method)
            lane = float(self.memory.row[_LANE])
            old = self.memory, self.method
            self.memory = with_method(*old, method, parameters, lane)
        else:
            self.memory.parameters[:] = packed(parameters)
        self.method, self._parameters = method, parameters

    @property
    def strength(self) -> float:
        """Strength factor of the guidance now; 0 without assistance [-]."""
        for tunable in self.method.tunables:
            if tunable.name == "strength_factor":
                return float(value_at(self._parameters, place_of(tunable)))
        return 1.0 if self.method.assists else 0.0

    def control(self, controls: Controls) -> NDArray[np.float64]:
        """One control step; returns the row, which the next call overwrites."""
        memory = self.memory
        memory.given[:] = self._given(controls)
        self._tick(
            memory.parameters,
            memory.state,
            memory.motion,
            memory.given,
            self._setup.wheel is not None,
            memory.held,
            memory.row,
        )
        self._show(controls)
        return memory.row

    def _show(self, controls: Controls) -> None:
        """Let the hands on a simulated wheel see the drive."""
        if look := getattr(self.wheel, "see", None):
            hands = self.hands.intended_angle, self.hands.grip
            pedals = controls.accelerator, controls.brake
            road = self._parameters.road
            look(Seen(self.memory.row, self.car, road, *hands, *pedals))

    def _given(self, controls: Controls) -> PersonInput:
        """Hands and foot move; the rest is passed on."""
        speed = float(self.memory.motion[_SPEED])
        self.hands = move_hands(
            HandsParameters(),
            self.hands,
            asked_angle(HandsParameters(), self.car, speed, controls.steer),
            controls.steering,
            float(self.memory.motion[_ANGLE]),
            PLANT_DT * PLANT_STEPS,
        )
        self._foot, accelerator, brake = press(
            FootParameters(), self._foot, self.car, speed, self._pedals(controls)
        )
        return NOTHING_GIVEN._replace(
            intended_angle=self.hands.intended_angle,
            grip=self.hands.grip,
            accelerator=accelerator,
            brake=brake,
            head_yaw=controls.head_yaw,
            head_yaw_valid=controls.head_valid,
            crossing_probability=controls.crossing_probability,
            crossing_side=controls.crossing_side,
            requested=controls.requested,
            leader_uniform=controls.leader_uniform,
            indicator=controls.indicator,
        )

    def _pedals(self, controls: Controls) -> tuple[float, float]:
        """Accelerator and brake: the wheel's own pedals if it has some."""
        reading = self.reading
        if reading is None or math.isnan(reading.accelerator):
            return controls.accelerator, controls.brake
        brake = 0.0 if math.isnan(reading.brake) else reading.brake
        return reading.accelerator, max(brake, controls.brake)

    def advance(self, moving: bool, fault: bool) -> None:
        """One plant step, of the wheel alone if the trial stands still.

        Args:
            moving: Whether the trial runs.
            fault: Whether something is lost; a real wheel gets no torque then.

        Raises:
            WheelLost: If the wheel does not answer any more.
        """
        if self._setup.wheel is None and moving:
            memory = self.memory
            hands_tick(memory.plant, memory.motion, memory.held)
        if self.wheel is None:
            return
        self._feel(self.wheel, self.wheel.read())
        if moving and self.reading is not None:
            self._wanted = self._rendered(self.reading)
        self._guard_state, torque = guarded(
            self._guard, self._guard_state, self._wanted, moving, fault, PLANT_DT
        )
        self._give(self.wheel, torque)

    def _feel(self, wheel: Wheel, reading: WheelReading) -> None:
        """Take a reading and find the driver's torque in it.

        One that is not finite is none: the last stays, and grows old.
        """
        told = reading.driver_torque if wheel.measures_torque else 0.0
        if not math.isfinite(reading.steering_wheel_angle + told):
            return
        if self._observer is None:
            self._observer = observer_memory(
                self._observed_device(),
                reading.steering_wheel_angle,
            )
        observer = self._observer
        observer.reading[0] = reading.steering_wheel_angle
        observer.reading[1] = reading.steering_wheel_rate
        observer.reading[2] = self.wheel_torque
        observed = observer_tick(
            observer.parameters, observer.state, observer.reading, PLANT_DT
        )
        measured = reading.driver_torque
        self.driver_torque = observed if math.isnan(measured) else measured
        self.reading = reading._replace(
            steering_wheel_rate=observer.steering_wheel_rate
        )

    def _observed_device(self) -> TorqueObserverParameters:
        """The observer of the device as its calibration found it."""
        calibration = self._setup.calibration
        if calibration is None:
            return TorqueObserverParameters()
        return observer_parameters(calibration)

    def _rendered(self, reading: WheelReading) -> float:
        """Move the car on with the wheel's angle; return the torque to give [N·m]."""
        memory, calibration = self.memory, self._setup.calibration
        wheel = WheelInput(
            steering_wheel_angle=reading.steering_wheel_angle,
            steering_wheel_rate=reading.steering_wheel_rate,
            driver_torque=self.driver_torque,
            damping=calibration.damping if calibration else 0.0,
            friction=calibration.friction if calibration else 0.0,
        )
        memory.wheel[:] = wheel
        return wheel_tick(memory.plant, memory.motion, memory.held, memory.wheel)

    def _give(self, wheel: Wheel, torque: float) -> None:
        """Write to the device, as often as it takes it.

        Whether it was told to let go is looked at last: a process that was halted
        between reading and writing would push with what held before.
        """
        if self._is_released():
            self.release()
            torque = 0.0
        self.wheel_torque = torque
        self._skipped += 1
        if self._skipped * PLANT_DT * wheel.write_rate >= 1.0 - 1e-9:
            wheel.write(torque)
            self._skipped = 0

    def release(self) -> None:
        """Start from nothing: the device has let go without being told so from here."""
        self._guard_state = GuardState()
        self._wanted = self.wheel_torque = 0.0

    def check_wheel(self) -> None:
        """Refuse to begin with a real wheel that is turned, or whose angle is unknown.

        Raises:
            ValueError: If so; it says what to do.
        """
        if self.wheel is None:
            return
        if not getattr(self.wheel, "is_awake", True):
            raise ValueError("turn the wheel by 10 degrees and back, then start")
        if abs(self.steering_wheel_angle) > STRAIGHT:
            raise ValueError("the wheel is turned; turn it straight ahead, then start")

    def meet_wheel(self) -> None:
        """Put the column of the car at the angle of the real wheel."""
        if self.reading is not None:
            self.memory.motion[_ANGLE] = self.reading.steering_wheel_angle
            self.memory.motion[_RATE] = self.reading.steering_wheel_rate

    def change_wheel(self, wheel: Wheel | None) -> None:
        """Go on with a wheel that was opened anew, or with none that answers."""
        self.wheel = wheel
        self._guard = guard_parameters(wheel)
        self._observer = None
        self.release()


def guard_parameters(wheel: Wheel | None) -> GuardParameters:
    """Limits of the guard: never more than the device can give."""
    usual = GuardParameters()
    if wheel is None:
        return usual
    return usual._replace(torque_limit=min(usual.torque_limit, wheel.torque_limit))
