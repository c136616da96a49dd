"""How near other cars come: time to collision, gaps, headways, accepted gaps, contacts.

Names and definitions are those of SAE J2944: a gap ends at the rear bumper of the car
ahead, a headway at its front bumper.
"""

from __future__ import annotations

from math import nan

import numpy as np

from costeer.plant.place import BARRIER, CAR, STRIP
from costeer.study.definitions import (
    Columns,
    Measure,
    MeasureParameters,
    Signal,
    missing,
    runs,
    unknown,
)
from costeer.study.lanes import lanes
from costeer.study.neighbours import Neighbours, Others, at, neighbours
from costeer.study.segments import LaneChange

TTC_PERCENTILE = 15.0
"""Beside the minimum, which hangs on one sample [%]. Source: assumed, as usual for the
lower end of a distribution in traffic engineering."""

Measures = dict[str, Measure]

CONTACTS = {
    "num_rumble_strip_contacts": STRIP,
    "num_barrier_collisions": BARRIER,
    "num_car_collisions": CAR,
}
"""Counts, and what the column `contact` says of each."""

NEARNESS = {
    "time_to_collision_minimum": "s",
    "time_to_collision_15th_percentile": "s",
    "time_gap_minimum": "s",
    "time_gap_mean": "s",
    "time_headway_minimum": "s",
    "time_headway_mean": "s",
}
"""Measures of the car ahead and their units."""

ACCEPTED = {
    "lead_gap": "m",
    "lead_time_gap": "s",
    "lag_gap": "m",
    "lag_time_gap": "s",
    "lag_time_to_collision": "s",
}
"""What is told of the gap that a lane change begins into, and the units."""


def time_to_collision(gap: Signal, closing: Signal) -> Signal:
    """Time until two cars touch if both keep their speeds [s], shape `(time,)`.

    Args:
        gap: Between them along the road [m].
        closing: How fast it gets smaller [m/s].

    Returns:
        0 where they touch; NaN where they do not come nearer, or there is no gap.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        times = np.where(closing > 0.0, gap / closing, np.nan)
    return np.asarray(np.where(gap <= 0.0, 0.0, times))


def time_gap(gap: Signal, velocity: Signal) -> Signal:
    """Time in which a car drives the gap before it [s]; NaN for one that stands."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(velocity > 0.0, gap / velocity, np.nan))


def nearness(
    columns: Columns, cars: Others | str, own_length: float, limits: MeasureParameters
) -> Measures:
    """How near the car ahead in the lane driven in was.

    Args:
        columns: Of the stretch that is measured, shape `(time,)` each.
        cars: The others in it, or why there are none.
        own_length: Of the driven car [m].
        limits: The road, and what following is.
    """
    if isinstance(cars, str):
        return {name: unknown(unit, cars) for name, unit in NEARNESS.items()}
    lane = lanes(np.asarray(columns["lateral_position"]), limits)
    near = neighbours(cars, lane, own_length)
    velocity = np.asarray(columns["longitudinal_velocity"])
    closing = velocity - near.lead_velocity
    approach = _known(time_to_collision(near.lead_gap, closing))
    gap = time_gap(near.lead_gap, velocity)
    headway = time_gap(near.lead_gap + near.lead_length, velocity)
    with np.errstate(invalid="ignore"):
        following = headway <= limits.following_headway
    why = "no car was ahead in the lane"
    freely = f"no car was ahead by {limits.following_headway:g} s or less"
    never = "the car never came nearer to one ahead in its lane"
    low = np.percentile(approach, TTC_PERCENTILE) if approach.size else nan
    return {
        "time_to_collision_minimum": _least(approach, never),
        "time_to_collision_15th_percentile": _seconds(float(low), never),
        "time_gap_minimum": _least(_known(gap), why),
        "time_gap_mean": _mean(gap[following], freely),
        "time_headway_minimum": _least(_known(headway), why),
        "time_headway_mean": _mean(headway[following], freely),
    }


def accepted_gaps(
    columns: Columns,
    cars: Others | str,
    change: LaneChange,
    own_length: float,
    limits: MeasureParameters,
) -> Measures:
    """The gap in the new lane at the start of a lane change.

    Args:
        columns: Of the trial, shape `(time,)` each.
        cars: The others, or why there are none.
        change: Which lane change.
        own_length: Of the driven car [m].
        limits: The road.
    """
    if isinstance(cars, str):
        return {name: unknown(unit, cars) for name, unit in ACCEPTED.items()}
    row = int(np.searchsorted(columns["time"], change.start_time))
    near = neighbours(at(cars, row), np.array([change.lane]), own_length)
    velocity = np.asarray(columns["longitudinal_velocity"])[row : row + 1]
    return _gaps(near, velocity)


def _gaps(near: Neighbours, velocity: Signal) -> Measures:
    nobody = {"lead": "no car was ahead in the new lane"}
    nobody["lag"] = "no car was behind in the new lane"
    closing = near.lag_velocity - velocity
    values = {
        "lead_gap": near.lead_gap,
        "lead_time_gap": time_gap(near.lead_gap, velocity),
        "lag_gap": near.lag_gap,
        "lag_time_gap": time_gap(near.lag_gap, near.lag_velocity),
        "lag_time_to_collision": time_to_collision(near.lag_gap, closing),
    }
    found = {}
    for name, value in values.items():
        why = nobody[name.split("_")[0]]
        if name == "lag_time_to_collision" and np.isfinite(near.lag_gap[0]):
            why = "the car behind did not come nearer"
        defined = bool(np.isfinite(value[0]))
        unit = ACCEPTED[name]
        found[name] = Measure(float(value[0]), unit) if defined else unknown(unit, why)
    return found


def contacts(columns: Columns) -> Measures:
    """How often the car touched strips, barriers and other cars."""
    reason = missing(columns, "contact")
    if reason:
        return dict.fromkeys(CONTACTS, unknown("-", reason))
    touched = np.ma.filled(np.ma.asarray(columns["contact"]), 0)
    return {
        name: Measure(len(runs(np.asarray(touched == kind))), "-")
        for name, kind in CONTACTS.items()
    }


def _known(values: Signal) -> Signal:
    return np.asarray(values[np.isfinite(values)])


def _seconds(value: float, why: str) -> Measure:
    return unknown("s", why) if np.isnan(value) else Measure(value, "s")


def _least(values: Signal, why: str) -> Measure:
    return _seconds(float(values.min()) if values.size else nan, why)


def _mean(values: Signal, why: str) -> Measure:
    return _seconds(float(values.mean()) if values.size else nan, why)
