"""The torque of guidance and wheel under whatever they are asked for.

    python -m benchmarks.torque_limits [SECONDS]

Random torques (steady, jumping, huge, NaN, infinite) go through the torque guard of a
real wheel (1,000,000 steps) and through the controller's limits (200,000), and a whole
drive is stepped for SECONDS (60) on a simulated wheel whose readings jump, stick or are
no numbers, while it is paused, resumed, restarted, started and its strength changed at
random. Prints how many torques there were, the largest, its limit, the fastest change
and its limit. Exit code 1 if a limit was passed or a torque was no number.
"""

from __future__ import annotations

import math
import random
import sys
from collections.abc import Callable, Iterator
from typing import NamedTuple

from costeer.controller import actuation
from costeer.controller.actuation import ActuationParameters
from costeer.devices.wheels.interface import WheelReading
from costeer.loop.parameters import DT
from costeer.runtime import guard
from costeer.runtime.guard import GuardParameters, GuardState
from costeer.runtime.setup import PLANT_DT
from costeer.runtime.states import RunState
from tests.runtime.rig import Rig, wheel_setup
from tests.runtime.test_driving_wheel import HANDS

SEED = 1
GUARD_STEPS, ACTUATION_STEPS = 1_000_000, 200_000
NO_NUMBERS = (math.nan, math.inf, -math.inf)
ROUNDING = 1e-9


class Limits(NamedTuple):
    """What no torque may pass: torque [N·m] and rate [N·m/s]."""

    torque: float
    rate: float


class Seen(NamedTuple):
    """Torques that were given.

    Attributes:
        name: Where.
        number: How many.
        torque: The largest, NaN if one was no number [N·m].
        rate: The fastest change [N·m/s].
        limits: Of both.
    """

    name: str
    number: int
    torque: float
    rate: float
    limits: Limits

    @property
    def keeps(self) -> bool:
        """Whether no limit was passed."""
        torque, rate = self.limits
        return self.torque <= torque and self.rate <= rate * (1.0 + ROUNDING)


def seen(name: str, torques: Iterator[float], dt: float, limits: Limits) -> Seen:
    """Look at torques that follow each other every `dt` [s], from none at first."""
    number, before, largest, fastest = 0, 0.0, 0.0, 0.0
    for torque in torques:
        if not math.isfinite(torque):
            return Seen(name, number + 1, math.nan, fastest, limits)
        number += 1
        largest = max(largest, abs(torque))
        fastest = max(fastest, abs(torque - before) / dt)
        before = torque
    return Seen(name, number, largest, fastest, limits)


def wishes(draw: random.Random, number: int) -> Iterator[float]:
    """Torques to ask for [N·m]: held for a while, then another sort of them."""
    sorts: list[Callable[[], float]] = [
        lambda: draw.gauss(0.0, 3.0),
        lambda: draw.choice((-1.0, 1.0)) * 10.0 ** draw.uniform(-3.0, 300.0),
        lambda: draw.choice(NO_NUMBERS),
        lambda: draw.choice((-6.0, 6.0)),
    ]
    left, sort, held = 0, sorts[0], 0.0
    for _ in range(number):
        if left == 0:
            left, sort = draw.randrange(1, 400), draw.choice(sorts)
            held = sort() if draw.random() < 0.5 else math.nan
        left -= 1
        yield sort() if math.isnan(held) else held


def through_guard(number: int = GUARD_STEPS) -> Seen:
    """Through the guard of a real wheel, with starts, stops and faults at random."""
    draw, limits = random.Random(SEED), GuardParameters()

    def torques() -> Iterator[float]:
        state, engaged, fault = GuardState(), False, False
        for wanted in wishes(draw, number):
            engaged ^= draw.random() < 1e-3
            fault ^= draw.random() < (0.05 if fault else 1e-3)
            state, torque = guard.step(limits, state, wanted, engaged, fault, PLANT_DT)
            yield torque

    rates = (limits.torque_rate_limit, limits.torque_limit / limits.fault_time)
    allowed = Limits(limits.torque_limit, max(rates))
    return seen("torque guard", torques(), PLANT_DT, allowed)


def through_actuation(number: int = ACTUATION_STEPS) -> Seen:
    """Through the limits of the controller, with gains that may be no numbers."""
    draw, limits = random.Random(SEED), ActuationParameters()

    def torques() -> Iterator[float]:
        state, gain = actuation.initial_state(), 1.0
        for wanted in wishes(draw, number):
            if draw.random() < 0.05:
                gain = draw.choice((0.0, 1.0, draw.random(), math.nan))
            state, torque = actuation.step(limits, state, gain, wanted, DT)
            yield torque

    rate = max(limits.torque_rate_limit, limits.fault_rate_limit)
    return seen("controller", torques(), DT, Limits(limits.torque_limit, rate))


class Trouble:
    """A wheel's readings as a bad sensor gives them, and what is written to it.

    Args:
        rig: The drive.
        draw: Of everything at random.
    """

    def __init__(self, rig: Rig, draw: random.Random) -> None:
        self._rig, self._draw = rig, draw
        self._wheel: object = None
        self._left, self._sort = 0, "sound"
        self._stuck: WheelReading | None = None
        self.written: list[float] = []

    def hold(self) -> None:
        """Stand between the drive and its wheel, which may be another by now."""
        wheel = self._rig.driving._cabin.wheel
        if wheel is None or wheel is self._wheel:
            return
        self._wheel, read, write = wheel, wheel.read, wheel.write

        def told(torque: float) -> None:
            self.written.append(torque)
            write(torque)

        wheel.read = lambda: self._spoilt(read())  # type: ignore[method-assign]  # on purpose
        wheel.write = told  # type: ignore[method-assign]  # on purpose

    def _spoilt(self, reading: WheelReading) -> WheelReading:
        if self._left == 0:
            sorts = ("sound", "sound", "stuck", "jumps", "no number")
            self._left = self._draw.randrange(1, 200)
            self._sort = self._draw.choice(sorts)
            self._stuck = reading
        self._left -= 1
        if self._sort == "stuck" and self._stuck is not None:
            return self._stuck
        if self._sort == "jumps":
            return reading._replace(steering_wheel_angle=self._draw.uniform(-8.0, 8.0))
        if self._sort == "no number":
            return reading._replace(steering_wheel_angle=self._draw.choice(NO_NUMBERS))
        return reading


COMMANDS = (
    ("pause", "driver"),
    ("restart",),
    ("set", "condition", "weak-gentle"),
    ("set", "condition", "strong-rapid"),
    ("set", "lateral_error_gain", 3.0),
)


def through_a_drive(seconds: float) -> Seen:
    """Through a whole drive on a simulated wheel that is turned to and fro."""
    draw = random.Random(SEED)
    rig = Rig(wheel_setup(hands=HANDS._replace(amplitude=0.3)))
    trouble = Trouble(rig, draw)
    try:
        for _ in range(round(seconds / DT)):
            trouble.hold()
            if draw.random() < 0.02:
                rig.ask(*draw.choice(COMMANDS))
            if rig.driving._run_state != RunState.RUNNING and draw.random() < 0.1:
                rig.ask("acknowledge")
                rig.ask("start")
                rig.ask("resume")
            rig.steps(1)
            rig.heard()
    finally:
        rig.close()
    usual = GuardParameters()
    device = wheel_setup().calibration
    assert device is not None
    largest = min(usual.torque_limit, device.torque_curve[-1][1])
    rate = max(usual.torque_rate_limit, largest / usual.fault_time)
    return seen("whole drive", iter(trouble.written), PLANT_DT, Limits(largest, rate))


def main() -> int:
    """Print what was seen; return the exit code."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    every = [through_guard(), through_actuation(), through_a_drive(seconds)]
    for one in every:
        print(
            f"{one.name}: {one.number:,} torques, largest {one.torque:.3f} of "
            f"{one.limits.torque:g} N·m, fastest {one.rate:.1f} of "
            f"{one.limits.rate:g} N·m/s" + ("" if one.keeps else "  PASSED")
        )
    return int(not all(one.keeps for one in every))


if __name__ == "__main__":
    sys.exit(main())
