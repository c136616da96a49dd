"""What came of an emergency: collision, distances, reaction, wheel, torque, gain."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.emergencies.design import Emergency
from costeer.methods.conditions import MANUAL
from costeer.plant.parameters import RoadParameters
from costeer.plant.place import BARRIER, CAR, beyond_line
from costeer.plant.road import lane_centre
from costeer.records.columns import LANE_CHANGING, TrialRecord
from costeer.scenarios.definition import KINDS

WHEEL_MOVED = math.radians(2.0)
"""Change of the wheel angle that is a reaction [rad]. Source: spec section 12."""

PEDAL_MOVED = 0.05
"""Position of the brake pedal that is a reaction [-]. Source: assumed."""

SLOW = 2.0
"""A car that is slower has stopped for the obstacle [m/s]. Source: assumed."""

SETTLED_OFFSET, SETTLED_TIME = 0.3, 2.0
"""Settled is who stays so near a lane's centre [m] for so long [s]. Source: assumed."""

_CAR_LENGTH, _CAR_WIDTH = KINDS["car"]

_TOUCHING = 0.5
"""Gap below which the obstacle is what was hit [m]. Source: assumed; a car that stands
askew reaches farther across than its width."""

ROAD = RoadParameters()
"""Lanes of the road on which emergencies are driven."""

Values = NDArray[Any]


class EmergencyRow(NamedTuple):
    """One drive as a row of `emergencies.csv`, in SI units.

    Attributes:
        condition: Of the guidance.
        meant_situation: That the drive was meant to come to [-].
        situation: That it came to; 0 without assistance. A method that gives no
            verdict is taken for consistent [-].
        suggested_speed: To the driver [m/s].
        speed: Of the car when the obstacle appeared [m/s].
        time_to_collision: Then [s].
        lane_is_free: Whether nothing drove in the lane beside.
        participant: Number of the driver.
        collided: Whether the car hit obstacle, other car or barrier.
        hit: What it hit: "", "obstacle", "car" or "barrier".
        smallest_distance: Between car and obstacle, as rectangles [m].
        smallest_time: To collision, while the obstacle was in the way [s].
        reaction_time: Until wheel or brake differed from the same drive without an
            obstacle [s]; NaN: neither did.
        peak_wheel_angle: Until the car had passed the obstacle, hit it or stood [rad].
        peak_wheel_rate: As above [rad/s].
        peak_driver_torque: As above [N·m].
        haptic_gain: K_h when the obstacle appeared [-]; NaN without assistance.
        gain_at_obstacle: K_h when the car was beside it, or stopped [-].
        left_road: Whether a wheel crossed an outer line afterwards.
        time_to_settle: Until the car stayed in a lane's middle [s]; NaN: never.
    """

    condition: str
    meant_situation: int
    situation: int
    suggested_speed: float
    speed: float
    time_to_collision: float
    lane_is_free: bool
    participant: int
    collided: bool
    hit: str
    smallest_distance: float
    smallest_time: float
    reaction_time: float
    peak_wheel_angle: float
    peak_wheel_rate: float
    peak_driver_torque: float
    haptic_gain: float
    gain_at_obstacle: float
    left_road: bool
    time_to_settle: float


def outcome_of(
    drive: Emergency, record: TrialRecord, undisturbed: TrialRecord
) -> EmergencyRow | None:
    """What came of a drive; None if the obstacle never appeared.

    Args:
        drive: As it was planned.
        record: Of the drive; its first other car is the obstacle.
        undisturbed: The same drive without an obstacle.
    """
    columns = _filled(record)
    there = np.flatnonzero(np.isfinite(columns["car_01_position"]))
    if not there.size:
        return None
    first = int(there[0])
    after = {name: values[first:] for name, values in columns.items()}
    gaps = _gaps(after)
    passed = int(np.argmin(np.abs(after["car_01_position"] - _place(after))))
    met = _until_met(after, passed)
    contact = float(columns["contact"][-1])
    return EmergencyRow(
        condition=drive.condition,
        meant_situation=drive.situation,
        situation=_situation(drive, after),
        suggested_speed=drive.speed,
        speed=float(after["longitudinal_velocity"][0]),
        time_to_collision=drive.time_to_collision,
        lane_is_free=drive.lane_is_free,
        participant=drive.participant,
        collided=contact >= BARRIER,
        hit=_hit(contact, gaps),
        smallest_distance=float(np.hypot(*np.maximum(gaps, 0.0)).min()),
        smallest_time=_smallest_time(after, gaps),
        reaction_time=_reaction_time(columns, undisturbed, first),
        peak_wheel_angle=float(np.abs(after["steering_wheel_angle"][:met]).max()),
        peak_wheel_rate=float(np.abs(after["steering_wheel_rate"][:met]).max()),
        peak_driver_torque=float(np.abs(after["driver_torque"][:met]).max()),
        haptic_gain=float(after["haptic_gain"][0]),
        gain_at_obstacle=float(after["haptic_gain"][passed]),
        left_road=_outside(after),
        time_to_settle=_time_to_settle(after, passed),
    )


def _hit(contact: float, gaps: tuple[Values, Values]) -> str:
    """What the car hit at the end; it may stand askew and touch from some way."""
    if contact == CAR and max(gaps[0][-1], gaps[1][-1]) < _TOUCHING:
        return "obstacle"
    return {BARRIER: "barrier", CAR: "car"}.get(contact, "")


def _filled(record: TrialRecord) -> dict[str, Values]:
    """Columns without masks; who has no verdict is taken for consistent."""
    return {
        name: np.ma.filled(each, name == "consistent")
        for name, each in record.columns.items()
    }


def _place(columns: dict[str, Values]) -> Values:
    return np.asarray(columns["longitudinal_position"])


def _situation(drive: Emergency, after: dict[str, Values]) -> int:
    """The situation when the obstacle appeared, by mode and verdict."""
    if drive.condition == MANUAL:
        return 0
    changing = after["mode"][0] == LANE_CHANGING
    return (3 if changing else 1) + (not after["consistent"][0])


def _gaps(after: dict[str, Values]) -> tuple[Values, Values]:
    """Gaps of car and obstacle along and across the road [m], negative in overlap."""
    length, width = KINDS["obstacle"]
    along = np.abs(after["car_01_position"] - _place(after))
    across = np.abs(after["car_01_lateral"] - after["lateral_position"])
    return along - (length + _CAR_LENGTH) / 2.0, across - (width + _CAR_WIDTH) / 2.0


def _smallest_time(after: dict[str, Values], gaps: tuple[Values, Values]) -> float:
    """Smallest time to collision while the obstacle is in the way [s]."""
    ahead = (after["car_01_position"] > _place(after)) & (gaps[1] < 0.0)
    speed = np.maximum(after["longitudinal_velocity"], 0.1)
    times = np.maximum(gaps[0], 0.0)[ahead] / speed[ahead]
    return float(times.min()) if times.size else math.nan


def _until_met(after: dict[str, Values], passed: int) -> int:
    """Samples until the car is beside the obstacle, or stands."""
    stands = np.flatnonzero(after["longitudinal_velocity"] < SLOW)
    last = int(stands[0]) if stands.size else passed
    return max(min(last, passed), 1)


def _reaction_time(
    columns: dict[str, Values], undisturbed: TrialRecord, first: int
) -> float:
    """From the appearance until wheel or brake differ from those without it [s]."""
    other = _filled(undisturbed)
    last = min(len(columns["time"]), len(other["time"]))

    def apart(name: str) -> Values:
        ours = columns[name][first:last]
        return np.asarray(np.abs(ours - other[name][first:last]))

    wheel, brake = apart("steering_wheel_angle"), apart("brake")
    moved = np.flatnonzero((wheel > WHEEL_MOVED) | (brake > PEDAL_MOVED))
    time = columns["time"]
    return float(time[first + moved[0]] - time[first]) if moved.size else math.nan


def _outside(after: dict[str, Values]) -> bool:
    """Whether a side of the car was beyond an outer line."""
    y: Any = after["lateral_position"]  # an array where the annotation shows a number
    return bool(np.any(beyond_line(ROAD, y, _CAR_WIDTH) > 0.0))


def _time_to_settle(after: dict[str, Values], passed: int) -> float:
    """From the appearance until the car stays in the middle of a lane [s]."""
    y, time = after["lateral_position"], after["time"]
    centres = [lane_centre(ROAD, lane) for lane in range(int(ROAD.num_lanes))]
    nearest = np.min([np.abs(y - centre) for centre in centres], axis=0)
    off = nearest > SETTLED_OFFSET
    late = np.flatnonzero(off[passed:])
    start = passed + (int(late[-1]) + 1 if late.size else 0)
    if start >= len(time) or time[-1] - time[start] < SETTLED_TIME:
        return math.nan
    return float(time[start] - time[0])


def drive_of(row: EmergencyRow) -> Emergency:
    """The drive that a row is of."""
    return Emergency(
        condition=row.condition,
        situation=row.meant_situation,
        speed=row.suggested_speed,
        time_to_collision=row.time_to_collision,
        lane_is_free=row.lane_is_free,
        participant=row.participant,
    )
