"""Procedures that move a wheel gently and keep what it did: no clock, no device.

A procedure is a generator: it gives an instruction, is sent the reading that followed,
and returns what it found. The wheel is open without calibration, so that a "torque"
is the device's command in [-1, 1], and no hands are on it unless the text says so.
"""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Generator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.devices.wheels.interface import WheelReading

LEVELS = (0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
"""Commands of which the torque curve is made; the last ones only if they are gentle."""

HANDS_OFF = "Take your hands off the wheel."
"""What the user is asked for during all but the turns."""

_AWAY = "; keep hands and legs away, then run it again"
_LOOKBACK = 0.016


class SelfTestStopped(ValueError):
    """The wheel did what it should not; the torque is zero again."""


class ExcitationParameters(NamedTuple):
    """How far, how fast and how long the wheel is pushed.

    Attributes:
        duration: Of the pushes [s]. Source: assumed, every level some dozen times.
        amplitude: Pushes outward end this far from where the wheel stood [rad].
            Source: assumed, 35 deg.
        largest_amplitude: The test stops here [rad]. Source: assumed, 170 deg.
        largest_rate: Pushes end at this speed [rad/s]. Source: assumed, a brisk turn.
        unsafe_rate: The test stops here [rad/s]. Source: assumed, five turns a second.
        largest_acceleration: Higher levels than the one that gives it are not tried
            [rad/s²]. Source: assumed, twice that of a consumer wheel at full force.
        shortest_push: Of one level [s]. Source: assumed, twice the smoothing.
        longest_push: Of one level [s]. Source: assumed.
        first_movement: Angle that is a movement and no noise [rad]. Source: assumed,
            0.6 deg, twice the step of a 10-bit axis.
        largest_breakaway: Command that must move the wheel, else it is held [-].
            Source: assumed, friction of a consumer wheel takes up to a third.
        ramp: Growth of the command that looks for it [1/s]. Source: assumed, so slow
            that latency adds 1 % of the command.
        patience: Wheel without movement for this long is held [s]. Source: assumed.
    """

    duration: float = 20.0
    amplitude: float = 0.6
    largest_amplitude: float = 3.0
    largest_rate: float = 4.0
    unsafe_rate: float = 30.0
    largest_acceleration: float = 250.0
    shortest_push: float = 0.03
    longest_push: float = 0.11
    first_movement: float = 0.0105
    largest_breakaway: float = 0.6
    ramp: float = 0.25
    patience: float = 2.0


DEFAULTS = ExcitationParameters()
"""Pushes of the calibration."""


class Instruction(NamedTuple):
    """What to do until the next reading.

    Attributes:
        command: To the device, in [-1, 1].
        text: What the user is asked to do meanwhile.
    """

    command: float
    text: str


class Breakaway(NamedTuple):
    """First movement under a growing command.

    Attributes:
        command: At which the wheel moved, with its sign [-].
        direction: +1 if its angle grew, else -1.
    """

    command: float
    direction: float


class Excitation(NamedTuple):
    """What was sent and what the wheel did, one value a reading.

    Attributes:
        time: Of the readings [s].
        angle: Of the wheel [rad].
        command: Sent right after the reading, in [-1, 1].
    """

    time: NDArray[np.float64]
    angle: NDArray[np.float64]
    command: NDArray[np.float64]


Steps = Generator[Instruction, WheelReading, None]
"""A procedure that returns nothing."""


def stay_still(
    seconds: float, text: str = HANDS_OFF, patience: float = 5.0
) -> Generator[Instruction, WheelReading, float]:
    """Wait until the wheel stands still for some time; return its angle [rad].

    Args:
        seconds: For which it must stand [s].
        text: For the user.
        patience: After this it is given up [s].

    Raises:
        SelfTestStopped: If the wheel does not come to rest.
    """
    reading = yield Instruction(0.0, text)
    start = since = reading.time
    angle = reading.steering_wheel_angle
    while reading.time - since < seconds:
        reading = yield Instruction(0.0, text)
        if abs(reading.steering_wheel_angle - angle) > DEFAULTS.first_movement:
            angle, since = reading.steering_wheel_angle, reading.time
        if reading.time - start > seconds + patience:
            raise SelfTestStopped(f"the wheel does not come to rest{_AWAY}")
    return reading.steering_wheel_angle


def find_breakaway(
    parameters: ExcitationParameters, sign: float
) -> Generator[Instruction, WheelReading, Breakaway]:
    """Let the command grow from zero until the wheel moves.

    Args:
        parameters: How fast, and what a movement is.
        sign: Of the command.

    Raises:
        SelfTestStopped: If the largest command allowed does not move it.
    """
    angle = yield from stay_still(0.3)
    reading = yield Instruction(0.0, HANDS_OFF)
    start, command = reading.time, 0.0
    while command < parameters.largest_breakaway:
        reading = yield Instruction(sign * command, HANDS_OFF)
        moved = reading.steering_wheel_angle - angle
        if abs(moved) > parameters.first_movement:
            yield Instruction(0.0, HANDS_OFF)
            return Breakaway(sign * command, 1.0 if moved > 0.0 else -1.0)
        command = parameters.ramp * (reading.time - start)
    raise SelfTestStopped(
        f"the wheel does not move at {parameters.largest_breakaway:.0%} of its "
        "command: let it go, switch its power on, set the force to full in its "
        "maker's software, then run it again"
    )


def find_direction(
    parameters: ExcitationParameters,
) -> Generator[Instruction, WheelReading, Breakaway]:
    """Push both ways; return which way a positive command turns the wheel.

    The command of the result is the mean of both sides.

    Raises:
        SelfTestStopped: If both commands turn it the same way.
    """
    left = yield from find_breakaway(parameters, 1.0)
    right = yield from find_breakaway(parameters, -1.0)
    if left.direction == right.direction:
        raise SelfTestStopped(
            f"commands of both signs turn the wheel the same way: something else "
            f"pushes it{_AWAY}"
        )
    return Breakaway((left.command - right.command) / 2.0, left.direction)


class _Watch:
    """Rate and acceleration from the last angles, and whether the wheel is safe."""

    def __init__(self, parameters: ExcitationParameters, centre: float) -> None:
        self._parameters = parameters
        self._centre = centre
        self._last: deque[tuple[float, float]] = deque()
        self.angle = self.rate = self.acceleration = 0.0
        self.moved_at = -1.0
        self._moved_from = centre

    def see(self, reading: WheelReading) -> None:
        """Take a reading.

        Raises:
            SelfTestStopped: If the wheel goes too far or too fast, or is held.
        """
        time, angle = reading.time, reading.steering_wheel_angle
        self.angle = angle - self._centre
        while self._last and time - self._last[0][0] > 2.0 * _LOOKBACK:
            self._last.popleft()
        self._last.append((time, angle))
        self._differentiate()
        if self.moved_at < 0.0 or abs(angle - self._moved_from) > 0.05:
            self.moved_at, self._moved_from = time, angle
        self._check(time)

    def _differentiate(self) -> None:
        newest, oldest = self._last[-1], self._last[0]
        middle = self._last[len(self._last) // 2]
        if not oldest[0] < middle[0] < newest[0]:
            return
        before = (middle[1] - oldest[1]) / (middle[0] - oldest[0])
        self.rate = (newest[1] - middle[1]) / (newest[0] - middle[0])
        self.acceleration = 2.0 * (self.rate - before) / (newest[0] - oldest[0])

    def _check(self, time: float) -> None:
        limits = self._parameters
        if abs(self.angle) > limits.largest_amplitude:
            raise SelfTestStopped(f"the wheel turns too far{_AWAY}")
        if abs(self.rate) > limits.unsafe_rate:
            raise SelfTestStopped(f"the wheel turns too fast{_AWAY}")
        if time - self.moved_at > limits.patience:
            raise SelfTestStopped(f"the wheel is held{_AWAY}")


class _Pushes:
    """Which command comes next: every level both ways, harsh ones left out."""

    def __init__(self, breakaway: Breakaway, seed: int) -> None:
        self._random = random.Random(seed)
        self._direction = breakaway.direction
        moving = [n for n, level in enumerate(LEVELS) if level > breakaway.command]
        self._driving = min(moving[0] + 1 if moving else len(LEVELS), len(LEVELS) - 1)
        self.highest = self._driving
        self._rising = True
        self._untried = False

    def rise(self) -> None:
        """Allow one more level, which comes next."""
        if self._rising and self.highest < len(LEVELS) - 1:
            self.highest += 1
            self._untried = True

    def stop_rising(self) -> None:
        """Allow no more levels: this one is harsh enough."""
        self._rising = False

    def draw(self, watch: _Watch, amplitude: float) -> tuple[float, float]:
        """Side on which the wheel shall be pushed, +1 or -1, and the level."""
        side = -1.0 if watch.angle > 0.0 else 1.0
        lowest = 0
        if abs(watch.angle) > amplitude or self._random.random() < 0.4:
            lowest = self._driving
        if self._untried:
            lowest, self._untried = self.highest, False
        # More often towards the middle, so that the wheel seldom reaches the limits.
        elif self._random.random() < 0.5 - 0.5 * abs(watch.angle) / amplitude:
            side = -side
        return side, LEVELS[self._random.randint(lowest, self.highest)]

    def command(self, side: float, level: float) -> float:
        """What the device is told to push to a side with a level."""
        return side * self._direction * level

    def duration(self, parameters: ExcitationParameters) -> float:
        """Of the next push [s]."""
        return self._random.uniform(parameters.shortest_push, parameters.longest_push)


def excite(
    parameters: ExcitationParameters, breakaway: Breakaway, seed: int = 1
) -> Generator[Instruction, WheelReading, Excitation]:
    """Push the wheel to and fro with all levels; return what it did.

    Args:
        parameters: Limits of the pushes.
        breakaway: Where the wheel begins to move, and which way.
        seed: Of the order of the pushes.

    Raises:
        SelfTestStopped: If the wheel is held, or goes too far or too fast.
    """
    centre = yield from stay_still(0.3)
    watch, pushes = _Watch(parameters, centre), _Pushes(breakaway, seed)
    reading = yield Instruction(0.0, HANDS_OFF)
    rows: list[tuple[float, float, float]] = []
    start = risen = pushed = reading.time
    side, level, length = 1.0, 0.0, 0.0
    while reading.time - start < parameters.duration:
        watch.see(reading)
        if watch.acceleration**2 > parameters.largest_acceleration**2:
            pushes.stop_rising()
        if reading.time - risen > 0.04 * parameters.duration:
            pushes.rise()
            risen = reading.time
        outward = side * watch.angle > parameters.amplitude and level > 0.0
        if reading.time - pushed >= length or outward:
            side, level = pushes.draw(watch, parameters.amplitude)
            pushed, length = reading.time, pushes.duration(parameters)
        ahead = watch.rate + _LOOKBACK * watch.acceleration
        if side * ahead > parameters.largest_rate:
            level = 0.0
        command = pushes.command(side, level)
        rows.append((reading.time, reading.steering_wheel_angle, command))
        reading = yield Instruction(command, HANDS_OFF)
    yield Instruction(0.0, HANDS_OFF)
    return Excitation(*np.array(rows).T)
