"""Strong guidance without hands: three cars at four speeds, beside the bounds.

    python benchmarks/hands_off.py

Prints for each car and speed how long a 0.5 m offset takes, how much the car hunts
about the lane's centre afterwards, and for lane changes of 4, 6 and 8 s the largest
path error, the overshoot, the peaks of wheel angle and torque, and for how many control
steps the rate limit held the torque back (in brackets: other than within 0.1 s after
an end of the path). Exit code 1 if a bound is missed.
"""

from __future__ import annotations

import math
import sys

from costeer.validation.hands_off import (
    Bounds,
    ChangeFigures,
    HandsOffFigures,
    every_figure,
    missed_bounds,
)

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
    print("python benchmarks/hands_off.py")
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
