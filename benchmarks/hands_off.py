"""Strong guidance without hands: three cars at four speeds, beside the bounds.

    python -m benchmarks.hands_off

Prints for each car and speed how long a 0.5 m offset takes, how much the car hunts
about the lane's centre afterwards, and for lane changes of 4, 6 and 8 s the largest
path error, the overshoot, the peaks of wheel angle and torque, and for how many control
steps the rate limit held the torque back (in brackets: other than within 0.1 s after
an end of the path). Exit code 1 if a bound is missed. The bounds are those of the
specification; tests/closed_loop/test_hands_off.py holds them.
"""

from __future__ import annotations

import math
import sys
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.controller import actuation
from costeer.controller.actuation import STRONG, ActuationParameters
from costeer.loop.parameters import DT
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import CARS, RoadParameters
from costeer.records.columns import TrialRecord
from costeer.validation.resistance import CHANGE_DURATIONS
from costeer.validation.stability import SPEEDS, amplitude

OFFSET = 0.5
"""Distance from the lane's centre that a run starts with [m]."""

SETTLED = 0.1
"""An offset within this has been corrected [m]."""

TRIGGER_TIME = 5.0
"""When a lane change starts [s]."""

_OFFSET_RUN = 90.0
_HUNTING_TIME = 30.0
_CHANGE_RUN = 40.0
_END = 0.1


class Bounds(NamedTuple):
    """What the figures of every car and speed may reach.

    Attributes:
        settling_time: Of a 0.5 m offset [s].
        path_error: Car to path, from the trigger on [m].
        overshoot: Beyond the new lane's centre [m].
        hunting: Amplitude of the lateral position long after [m].
        wheel_hunting: Amplitude of the steering-wheel angle then [rad]. The
            specification has no such bound; it shows a wheel that swings although the
            car hardly moves.
    """

    settling_time: Real = 2.7
    path_error: Real = 0.14
    overshoot: Real = 0.10
    hunting: Real = 0.08
    wheel_hunting: Real = 0.02


class ChangeFigures(NamedTuple):
    """One lane change without hands.

    Attributes:
        change_duration: Planned [s].
        path_error: Largest distance from the path and then the lane's centre [m].
        overshoot: Farthest beyond the new lane's centre [m].
        peak_steering_angle: [rad].
        peak_torque: Of the motor [N·m].
        num_limited: Control steps at which the rate limit held the torque back [-].
        num_limited_inside: Those of them that are not within 0.1 s after an end of
            the path, where the mode changes [-].
    """

    change_duration: Real
    path_error: Real
    overshoot: Real
    peak_steering_angle: Real
    peak_torque: Real
    num_limited: int
    num_limited_inside: int


class HandsOffFigures(NamedTuple):
    """One car at one speed.

    Attributes:
        car: Its name.
        speed: [m/s].
        settling_time: After which an offset of 0.5 m stays within 0.1 m [s].
        hunting: Amplitude of the lateral position from a minute on [m].
        wheel_hunting: Amplitude of the steering-wheel angle then [rad].
        changes: Lane changes, rapid to gentle.
    """

    car: str
    speed: Real
    settling_time: Real
    hunting: Real
    wheel_hunting: Real
    changes: tuple[ChangeFigures, ...]


def hands_off_setup(car: str, speed: Real, duration: Real) -> TrialSetup:
    """A drive of `duration` [s] with strong guidance and no hands on the wheel."""
    return TrialSetup(
        condition="hands-off",
        strength_factor=STRONG,
        car=car,
        speed=speed,
        length=speed * duration,
        driver="hands-off",
        intention="off",
        events=False,
    )


def settling_time(record: TrialRecord) -> Real:
    """Time from which the car stays within `SETTLED` of the left lane's centre [s]."""
    offset = np.abs(record.columns["lateral_position"])
    outside = np.flatnonzero(offset > SETTLED)
    return float(record.columns["time"][outside[-1]] + DT) if outside.size else 0.0


def limited_steps(record: TrialRecord) -> NDArray[np.bool_]:
    """Where the rate limit holds the torque back, shape `(time,)`."""
    wanted = record.columns["haptic_gain"] * record.columns["instructed_torque"]
    limits = ActuationParameters(strength_factor=STRONG)
    state, torques = actuation.initial_state(), []
    for torque in wanted.tolist():
        state, given = actuation.step(limits, state, 1.0, torque, DT)
        torques.append(given)
    asked = np.clip(wanted, -limits.torque_limit, limits.torque_limit)
    return np.asarray(np.array(torques) != asked)


def near_an_end(record: TrialRecord) -> NDArray[np.bool_]:
    """Samples within `_END` after a change of mode, shape `(time,)`."""
    mode = record.columns["mode"]
    changed = np.concatenate([[False], mode[1:] != mode[:-1]])
    return np.convolve(changed, np.ones(round(_END / DT)))[: len(mode)] > 0.0


def change_figures(car: str, speed: Real, change_duration: Real) -> ChangeFigures:
    """Change to the right lane without hands."""
    setup = hands_off_setup(car, speed, _CHANGE_RUN)._replace(
        change_duration=change_duration, trigger_times=(TRIGGER_TIME,)
    )
    record = simulate_trial(setup)
    columns = record.columns
    position = columns["lateral_position"]
    error = np.abs(position - columns["target_lateral_position"])
    limited = limited_steps(record)
    return ChangeFigures(
        change_duration=change_duration,
        path_error=float(error.max()),
        overshoot=float(-RoadParameters().lane_width - position.min()),
        peak_steering_angle=float(np.abs(columns["steering_wheel_angle"]).max()),
        peak_torque=float(np.abs(columns["applied_torque"]).max()),
        num_limited=int(limited.sum()),
        num_limited_inside=int((limited & ~near_an_end(record)).sum()),
    )


def hands_off_figures(car: str, speed: Real) -> HandsOffFigures:
    """All figures of one car at one speed.

    Args:
        car: Name of the car.
        speed: [m/s].

    Raises:
        ValueError: If the car is not known or the speed is out of range.
    """
    setup = hands_off_setup(car, speed, _OFFSET_RUN)._replace(initial_offset=OFFSET)
    record = simulate_trial(setup)
    late = record.columns["time"] >= _OFFSET_RUN - _HUNTING_TIME
    return HandsOffFigures(
        car=car,
        speed=speed,
        settling_time=settling_time(record),
        hunting=amplitude(record.columns["lateral_position"][late]),
        wheel_hunting=amplitude(record.columns["steering_wheel_angle"][late]),
        changes=tuple(change_figures(car, speed, time) for time in CHANGE_DURATIONS),
    )


def every_figure() -> list[HandsOffFigures]:
    """The figures of all cars at all speeds."""
    return [hands_off_figures(car, speed) for car in CARS for speed in SPEEDS]


def missed_bounds(figures: HandsOffFigures, bounds: Bounds) -> list[str]:
    """What of the figures is beyond its bound, in words; empty if nothing."""
    reached = {
        "settling_time": figures.settling_time,
        "hunting": figures.hunting,
        "path_error": max(change.path_error for change in figures.changes),
        "overshoot": max(change.overshoot for change in figures.changes),
        "wheel_hunting": figures.wheel_hunting,
    }
    place = f"{figures.car} at {figures.speed * 3.6:.0f} km/h"
    return [
        f"{place}: {name} {value:.3f} is above {getattr(bounds, name)}"
        for name, value in reached.items()
        if not value <= getattr(bounds, name)
    ]


HEADER = (
    "car      km/h  settle s  hunting m  (wheel deg)   "
    "change s  error m  overshoot m  wheel deg  torque N·m  limited steps"
)


def change_text(change: ChangeFigures) -> str:
    """One lane change as the right half of a line."""
    return (
        f"{change.change_duration:8.0f} {change.path_error:8.3f} "
        f"{change.overshoot:12.3f} {math.degrees(change.peak_steering_angle):10.1f} "
        f"{change.peak_torque:11.2f} {change.num_limited:10d} "
        f"({change.num_limited_inside})"
    )


def lines(figures: HandsOffFigures) -> list[str]:
    """One line for each lane change; the first also tells of the offset."""
    first = (
        f"{figures.car:8s} {figures.speed * 3.6:4.0f} {figures.settling_time:9.2f} "
        f"{figures.hunting:10.3f} {math.degrees(figures.wheel_hunting):12.2f}   "
    )
    lefts = [first, *[" " * len(first)] * (len(figures.changes) - 1)]
    texts = [change_text(change) for change in figures.changes]
    return [left + text for left, text in zip(lefts, texts, strict=True)]


def main() -> int:
    """Print the table and what was missed; return the exit code."""
    bounds = Bounds()
    every = every_figure()
    print("python -m benchmarks.hands_off")
    print(HEADER)
    for figures in every:
        print("\n".join(lines(figures)))
    worst = Bounds(
        settling_time=max(f.settling_time for f in every),
        path_error=max(c.path_error for f in every for c in f.changes),
        overshoot=max(c.overshoot for f in every for c in f.changes),
        hunting=max(f.hunting for f in every),
        wheel_hunting=max(f.wheel_hunting for f in every),
    )
    for name, value, bound in zip(Bounds._fields, worst, bounds, strict=True):
        print(f"largest {name}: {value:.3f}, bound {bound}")
    missed = [text for figures in every for text in missed_bounds(figures, bounds)]
    for text in missed:
        print(text, file=sys.stderr)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
