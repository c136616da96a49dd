"""Calibration and self-test of a wheel: procedures put together, and who runs them.

Nothing here knows a clock: `run_procedure` is handed what waits for the next reading,
so that a simulated wheel is calibrated in the time that its arithmetic takes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from contextlib import suppress
from typing import NamedTuple, TypeVar

from costeer.devices.wheels.calibration import (
    WheelCalibration,
    checked,
    device_command,
    device_torque,
    uncalibrated,
)
from costeer.devices.wheels.excitation import (
    DEFAULTS,
    ExcitationParameters,
    Instruction,
    SelfTestStopped,
    excite,
    find_direction,
)
from costeer.devices.wheels.interface import Wheel, WheelLost, WheelReading
from costeer.devices.wheels.mechanics import Mechanics, fit_mechanics
from costeer.devices.wheels.references import (
    Turns,
    Weight,
    come_to_the_middle,
    known_peak_torque,
    torque_of,
    turn_both_ways,
)
from costeer.devices.wheels.weighing import WeighingParameters, weigh

GENTLE_TORQUE = 2.0
"""Most that a wheel gets which may be held, if its torque is known [N·m]."""

LOOP_RATE = 960.0
"""Readings a second, if the wheel can be written as often [Hz]."""

TEST_PUSHES = ExcitationParameters(duration=10.0)
"""Pushes of a test against a calibration: half as long as those of a calibration."""

_WIDER = 1.1

Result = TypeVar("Result")
Procedure = Generator[Instruction, WheelReading, Result]


class Reference(NamedTuple):
    """What the user knows of the device.

    Attributes:
        peak_torque: At full command [N·m]; None if a weight gives the scale.
        weight: That is hung on the rim; None if the peak torque gives the scale.
        lock_to_lock: How far it turns [rad]; None if the device says it right.
        turns: Whether the user turns it to both ends.
    """

    peak_torque: float | None = None
    weight: Weight | None = None
    lock_to_lock: float | None = None
    turns: bool = True


class SelfTestResult(NamedTuple):
    """What a calibration found.

    Attributes:
        calibration: Of the device.
        explained: Share of the movement that the calibration explains [-].
        notes: What the user should know.
    """

    calibration: WheelCalibration
    explained: float
    notes: tuple[str, ...]


class StoredAndFound(NamedTuple):
    """One value of a calibration beside what a test found.

    Attributes:
        name: Of the value.
        stored: In the calibration, in `unit`.
        found: By the test, in `unit`.
        allowed: Largest difference.
        unit: Of the three.
    """

    name: str
    stored: float
    found: float
    allowed: float
    unit: str


def agrees(comparison: StoredAndFound) -> bool:
    """Whether a test found about what is stored."""
    return abs(comparison.found - comparison.stored) <= comparison.allowed


def reading_rate(wheel: Wheel) -> float:
    """How often a procedure reads and writes a wheel [Hz]."""
    return min(LOOP_RATE, wheel.write_rate)


def run_procedure(
    wheel: Wheel,
    procedure: Procedure[Result],
    wait: Callable[[], object],
    tell: Callable[[str], object],
) -> Result:
    """Run a procedure on an open wheel; its torque is zero afterwards, come what may.

    Args:
        wheel: Open.
        procedure: Gives instructions, is sent readings.
        wait: Returns when the next reading is due.
        tell: Shows the user a text when it changes.

    Raises:
        SelfTestStopped: As the procedure does.
        WheelLost: As the wheel does.
    """
    told, checks = "", _Checks()
    try:
        instruction = next(procedure)
        while True:
            if instruction.text != told:
                told = instruction.text
                tell(told)
            wheel.write(instruction.command)
            wait()
            instruction = procedure.send(checks.passed(wheel.read()))
    except StopIteration as end:
        result: Result = end.value
        return result
    finally:
        with suppress(WheelLost):
            wheel.write(0.0)


class _Checks:
    """Refuses readings on which no procedure would end, or end well."""

    def __init__(self) -> None:
        self._time = -math.inf
        self._repeated = 0

    def passed(self, reading: WheelReading) -> WheelReading:
        """Return the reading if it has an angle and is not the same for ever."""
        if not math.isfinite(reading.steering_wheel_angle):
            raise SelfTestStopped(
                "the wheel does not tell its angle; unplug it, plug it in again, then "
                "run it again"
            )
        self._repeated = 0 if reading.time > self._time else self._repeated + 1
        self._time = reading.time
        if self._repeated > LOOP_RATE:
            raise SelfTestStopped(
                "the wheel tells nothing new; unplug it, plug it in again, then run it "
                "again"
            )
        return reading


def calibrate(
    opened: WheelCalibration,
    reference: Reference,
    dt: float,
    pushes: ExcitationParameters = DEFAULTS,
) -> Procedure[SelfTestResult]:
    """Find the calibration of a wheel.

    Args:
        opened: What the wheel was opened with; as `uncalibrated` gives it.
        reference: What the user knows.
        dt: Between readings [s].
        pushes: How far, how fast and how long.

    Raises:
        ValueError: If the reference cannot be.
        SelfTestStopped: If the wheel did what it should not.
    """
    _check(reference)
    turns = Turns(1.0, opened.full_range)
    if reference.turns:
        turns = yield from turn_both_ways()
    else:
        yield from come_to_the_middle(0.0)
    full_range = _full_range(opened, turns, reference)
    peak = reference.peak_torque or known_peak_torque(opened.identity)
    gentle = 1.0 if peak is None else GENTLE_TORQUE / peak
    breakaway = yield from find_direction(_at_most(pushes, gentle))
    seen = yield from excite(pushes, breakaway)
    mechanics = fit_mechanics(seen, dt)
    if reference.weight is None:
        # A curve that ends below what was tried is flat there: its end is the peak.
        largest = (reference.peak_torque or 0.0) * mechanics.tried
    else:
        # Pushed, it may stand anywhere; the user hangs the weight on its top.
        yield from come_to_the_middle(turns.middle)
        share = yield from weigh(mechanics, WeighingParameters(), dt)
        largest = torque_of(reference.weight) / share
    calibration = _calibration(opened, turns, mechanics, full_range, largest)
    return SelfTestResult(
        calibration=checked(calibration),
        explained=mechanics.explained,
        notes=tuple(_notes(opened, turns, mechanics, reference)),
    )


def _at_most(pushes: ExcitationParameters, command: float) -> ExcitationParameters:
    """Pushes that look for the first movement up to a command."""
    return pushes._replace(largest_breakaway=min(pushes.largest_breakaway, command))


def _check(reference: Reference) -> None:
    """Refuse a reference that gives no scale, or two."""
    if (reference.peak_torque is None) == (reference.weight is None):
        raise ValueError(
            "the torque needs one reference: give --peak-torque, or --weight and "
            "--radius"
        )
    peak = reference.peak_torque
    if peak is not None and not 0.0 < peak <= 50.0:
        raise ValueError(f"a peak torque of {peak:g} N·m cannot be; give 0 to 50")
    if reference.weight is not None:
        torque_of(reference.weight)
    if reference.lock_to_lock is not None and not reference.turns:
        raise ValueError("--range needs the turns; leave --no-turns out")


def _full_range(opened: WheelCalibration, turns: Turns, reference: Reference) -> float:
    """Between the ends of the axis [rad], if the turns were lock to lock.

    Raises:
        SelfTestStopped: If they were not.
    """
    if reference.lock_to_lock is None:
        return opened.full_range
    found = opened.full_range * reference.lock_to_lock / turns.span
    if found > _WIDER * max(opened.full_range, reference.lock_to_lock):
        raise SelfTestStopped("the wheel was not turned to both ends; run it again")
    return found


def _calibration(
    opened: WheelCalibration,
    turns: Turns,
    mechanics: Mechanics,
    full_range: float,
    largest: float,
) -> WheelCalibration:
    """Give the ratios their scales; the angle's is the true over the opened range."""
    scale = largest * opened.full_range / full_range
    angle_sign = opened.angle_sign * turns.angle_sign
    return WheelCalibration(
        identity=opened.identity,
        angle_sign=angle_sign,
        full_range=full_range,
        torque_sign=mechanics.direction * turns.angle_sign,
        torque_curve=tuple(
            (level, largest * share) for level, share in mechanics.curve
        ),
        inertia=scale * mechanics.inertia,
        damping=scale * mechanics.damping,
        friction=largest * mechanics.friction,
        latency=mechanics.latency,
        accelerator_axis=opened.accelerator_axis,
        brake_axis=opened.brake_axis,
        accelerator_sign=opened.accelerator_sign,
        brake_sign=opened.brake_sign,
    )


def _notes(
    opened: WheelCalibration, turns: Turns, mechanics: Mechanics, reference: Reference
) -> list[str]:
    """What the user should know of this calibration."""
    notes = []
    highest = mechanics.curve[-1][0]
    if highest < mechanics.tried:
        notes.append(f"commands above {highest:g} add nothing, and are never sent")
    if mechanics.tried < 1.0:
        notes.append(
            f"commands above {mechanics.tried:g} were too harsh to try, and are never "
            "sent"
        )
        if reference.weight is None:
            notes.append(
                "the torque there is taken as that share of the peak torque; a weight "
                "would measure it"
            )
    if not reference.turns:
        notes.append("range and side of the angle are the maker's: nobody turned it")
    elif reference.lock_to_lock is None:
        degrees = math.degrees(opened.full_range)
        notes.append(
            f"the range is taken as {degrees:.0f} deg; if it is another from lock to "
            "lock, run it again with --range DEG"
        )
        if turns.span < 0.9 * opened.full_range:
            share = turns.span / opened.full_range
            notes.append(f"the wheel turned over {share:.0%} of its axis only")
    return notes


def compare(
    stored: WheelCalibration,
    dt: float,
    pushes: ExcitationParameters = TEST_PUSHES,
) -> Procedure[list[StoredAndFound]]:
    """Push a wheel and hold what it does against its calibration.

    The wheel is open as `opened_for_test` says. The scale of the torque is not tested:
    that needs a reference.

    Args:
        stored: Its calibration.
        dt: Between readings [s].
        pushes: How far, how fast and how long.

    Raises:
        SelfTestStopped: If the wheel did what it should not.
    """
    yield from come_to_the_middle(0.0)
    gentle = abs(device_command(stored, GENTLE_TORQUE))
    breakaway = yield from find_direction(_at_most(pushes, gentle))
    seen = yield from excite(pushes, breakaway)
    found = fit_mechanics(seen, dt)
    highest = found.curve[-1][0]
    largest = abs(device_torque(stored, highest))
    worst = max(
        (
            abs(device_torque(stored, level)) / largest - share
            for level, share in found.curve
        ),
        key=abs,
    )
    return [
        StoredAndFound("direction", stored.torque_sign, found.direction, 0.5, "-"),
        _near("inertia", stored.inertia, largest * found.inertia, 0.2, 0.002, "kg·m²"),
        _near(
            "damping", stored.damping, largest * found.damping, 0.3, 0.03, "N·m·s/rad"
        ),
        _near("friction", stored.friction, largest * found.friction, 0.3, 0.05, "N·m"),
        _near("latency", stored.latency, found.latency, 0.2, 0.004, "s"),
        StoredAndFound("torque curve", 0.0, worst, 0.08, "of the largest"),
    ]


def _near(
    name: str, stored: float, found: float, share: float, least: float, unit: str
) -> StoredAndFound:
    """A value that may differ by a share of it, or by the least that matters."""
    return StoredAndFound(name, stored, found, max(share * stored, least), unit)


def opened_for_test(stored: WheelCalibration) -> WheelCalibration:
    """What to open a wheel with for `compare`: its angle, but commands as they are."""
    return uncalibrated(stored.identity, stored.full_range, stored.angle_sign)
