"""What methods are compared by: six aims, the measures of each, and what is better.

Which measure speaks for an aim was set before any method was compared.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.study.quantities import DEG

LESS, NEITHER, MORE = -1, 0, 1
"""What is better: less of it, neither, more of it."""


class Criterion(NamedTuple):
    """One measure of a trial as it is compared and shown.

    Attributes:
        name: Column of `trials.csv`.
        aim: That it belongs to.
        title: In words.
        label: As short as an axis needs it.
        unit: As shown.
        meaning: What the column holds.
        si_unit: Of the column.
        better: `LESS`, `NEITHER` or `MORE`.
        factor: Shown value of one unit of the column.
        digits: Decimals shown.
        speaks: Whether it speaks for its aim.
    """

    name: str
    aim: str
    title: str
    label: str
    unit: str
    meaning: str
    si_unit: str
    better: int = LESS
    factor: float = 1.0
    digits: int = 3
    speaks: bool = False

    @property
    def is_count(self) -> bool:
        """Whether it counts events, so that zero is no event at all."""
        return self.unit in ("per drive", "1/km")


_SAFETY = (
    Criterion(
        "num_safety_events",
        "safety",
        "Departures and collisions",
        "Departures, collisions",
        "per drive",
        "lane departures and collisions together",
        "-",
        speaks=True,
    ),
    Criterion(
        "line_crossing_time_minimum",
        "safety",
        "Smallest time to the line",
        "Least time to line",
        "s",
        "smallest time to line crossing while the lane is kept; at most 20 s",
        "s",
        better=MORE,
        digits=2,
        speaks=True,
    ),
    Criterion(
        "num_lane_departures",
        "safety",
        "Lane departures",
        "Departures",
        "per drive",
        "times a wheel crossed a line outside a lane change",
        "-",
    ),
    Criterion(
        "num_collisions",
        "safety",
        "Collisions",
        "Collisions",
        "per drive",
        "collisions with cars, obstacles and barriers",
        "-",
    ),
    Criterion(
        "time_to_collision_minimum",
        "safety",
        "Smallest time to collision",
        "Least time to collision",
        "s",
        "smallest time to collision with the car ahead in the lane",
        "s",
        better=MORE,
        digits=2,
    ),
)


_PERFORMANCE = (
    Criterion(
        "sdlp",
        "performance",
        "SDLP",
        "SDLP",
        "m",
        "standard deviation of the lateral position in lane keeping",
        "m",
        speaks=True,
    ),
    Criterion(
        "change_duration",
        "performance",
        "Lane change duration",
        "Lane change",
        "s",
        "mean duration of the drive's lane changes",
        "s",
        better=NEITHER,
        digits=2,
    ),
    Criterion(
        "overshoot",
        "performance",
        "Overshoot",
        "Overshoot",
        "m",
        "mean overshoot of the drive's lane changes",
        "m",
    ),
)


_EFFORT = (
    Criterion(
        "driver_torque_rms",
        "effort",
        "Driver torque RMS",
        "Driver torque",
        "N·m",
        "root mean square of the driver's torque",
        "N·m",
        speaks=True,
    ),
    Criterion(
        "opposing_torque_rms",
        "effort",
        "Opposing torque RMS",
        "Opposing torque",
        "N·m",
        "root mean square of the guidance's torque against the driver's",
        "N·m",
    ),
    Criterion(
        "conflict_share",
        "effort",
        "Time in conflict",
        "Time in conflict",
        "%",
        "share of the time in which driver and guidance push against each other",
        "-",
        factor=100.0,
        digits=2,
    ),
)


_COMFORT = (
    Criterion(
        "lateral_jerk_rms",
        "comfort",
        "Lateral jerk RMS",
        "Lateral jerk",
        "m/s³",
        "root mean square of the rate of the lateral acceleration",
        "m/s³",
        speaks=True,
    ),
    Criterion(
        "wheel_rate_rms",
        "comfort",
        "Wheel rate RMS",
        "Wheel rate",
        "deg/s",
        "root mean square of the steering-wheel rate",
        "rad/s",
        factor=DEG,
        digits=2,
    ),
)


_ANNOYANCE = (
    Criterion(
        "false_triggers_per_km",
        "annoyance",
        "False activations",
        "False activations",
        "1/km",
        "lane changes that the system started and nobody wanted",
        "1/km",
        speaks=True,
    ),
    Criterion(
        "false_trigger_settle_time",
        "annoyance",
        "Time to recover",
        "Time to recover",
        "s",
        "mean time from a false activation until the car has settled again",
        "s",
        digits=2,
    ),
)


_INTENTION = (
    Criterion(
        "detection_lead_time",
        "intention",
        "Lead time",
        "Lead time",
        "s",
        "mean of crossing minus first trigger over intended crossings, 0 if missed",
        "s",
        better=MORE,
        digits=2,
        speaks=True,
    ),
    Criterion(
        "missed_per_km",
        "intention",
        "Missed lane changes",
        "Missed",
        "1/km",
        "intended crossings without a trigger",
        "1/km",
    ),
)


CRITERIA: tuple[Criterion, ...] = (
    *_SAFETY,
    *_PERFORMANCE,
    *_EFFORT,
    *_COMFORT,
    *_ANNOYANCE,
    *_INTENTION,
)
NAMES: tuple[str, ...] = tuple(each.name for each in CRITERIA)
AIMS: tuple[str, ...] = tuple(dict.fromkeys(each.aim for each in CRITERIA))
SPEAKING: tuple[Criterion, ...] = tuple(each for each in CRITERIA if each.speaks)
RANKED: tuple[Criterion, ...] = tuple(each for each in CRITERIA if each.better)


def criterion(name: str) -> Criterion:
    """The criterion of a column."""
    return CRITERIA[NAMES.index(name)]
