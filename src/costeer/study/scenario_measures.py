"""Measures of what only some scenarios have: other cars, curves, zones.

They stand in a table of their own, a row for each value: which there are depends on
the scenario, and the tables of the paper's study stay as they are.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from costeer.records.cars import CAR_COLUMN
from costeer.scenarios.definition import Zone
from costeer.study.crossings import within
from costeer.study.curves import angle_beyond_curve
from costeer.study.definitions import (
    LEFT_OUT,
    Columns,
    Flags,
    Measure,
    missing,
    unknown,
)
from costeer.study.manoeuvres import rms, steering_rate
from costeer.study.neighbours import others
from costeer.study.scenario import Surroundings
from costeer.study.segments import LaneChange
from costeer.study.traffic import accepted_gaps, contacts, nearness
from costeer.study.trial_measures import (
    Measures,
    Trial,
    course_measures,
    lane_keeping_measures,
    prepare,
    torque_rms,
)

WHOLE_COURSE = "whole course"
"""In place of a zone; no zone has a space in its name."""


class ScenarioRow(NamedTuple):
    """One value of `scenario_measures.csv`, without the trial it belongs to.

    Attributes:
        zone: Name of the zone, or "whole course".
        lane_change: Number of the lane change in the trial; None if the value is of
            the whole zone.
        measure: Its name.
        value: In SI units; empty if it is not defined.
        unit: "-" if it has none.
    """

    zone: str
    lane_change: int | None
    measure: str
    value: float
    unit: str


def has_surroundings(columns: Columns) -> bool:
    """Whether a recording tells of other cars, curves or contacts."""
    if any(CAR_COLUMN.fullmatch(name) for name in columns):
        return True
    told = ("lead_distance", "road_curvature", "contact")
    return any(_says(columns, name) for name in told)


def _says(columns: Columns, name: str) -> bool:
    """Whether a column holds anything but zeros and undefined values."""
    if missing(columns, name):
        return False
    values = np.ma.filled(np.ma.asarray(columns[name]).astype(np.float64), 0.0)
    return bool(np.any(np.nan_to_num(values)))


def surrounding_measures(trial: Trial, around: Surroundings) -> Measures:
    """Contacts, nearness of the car ahead and steering beyond curves, whole course."""
    return _around(trial.columns, trial, around)


def _around(columns: Columns, trial: Trial, around: Surroundings) -> Measures:
    own_length = float(around.car.length)
    reason = missing(columns, "lateral_position")
    cars = reason or others(columns, around, trial.parameters)
    return {
        **contacts(columns),
        **nearness(columns, cars, own_length, trial.parameters),
        **angle_beyond_curve(columns, around.car),
    }


def change_surroundings(
    trial: Trial, around: Surroundings, change: LaneChange
) -> Measures:
    """Lanes, accepted gaps and steering beyond the curve of one lane change."""
    cars = others(trial.columns, around, trial.parameters)
    own_length = float(around.car.length)
    rows = within(trial.columns["time"], change.start_time, change.end_time)
    steering = angle_beyond_curve(_cut(trial.columns, rows), around.car)
    return {
        "from_lane": Measure(change.lane - change.direction, "-"),
        "to_lane": Measure(change.lane, "-"),
        **accepted_gaps(trial.columns, cars, change, own_length, trial.parameters),
        "peak_steering_angle_beyond_curve": steering["steering_beyond_curve_peak"],
    }


def zone_measures(trial: Trial, around: Surroundings, zone: Zone) -> Measures:
    """The measures of a stretch of the road by itself.

    Lane keeping is that of the whole trial as far as it lies in the zone, so that a
    lane change at its edge does not count as lane keeping.

    Args:
        trial: Whole.
        around: What is known beside the columns.
        zone: From where to where.
    """
    inside = _inside(trial.columns, zone)
    out = ~inside | trial.columns.get(LEFT_OUT, np.zeros(inside.size, bool))
    kept = prepare({**trial.columns, LEFT_OUT: out}, trial.parameters, trial.method)
    columns = _cut(trial.columns, inside)
    part = trial._replace(columns=columns)
    if int(inside.sum()) < 2:
        found = {**lane_keeping_measures(trial), **course_measures(trial)}
        why = "the car was not in the zone"
        return {name: unknown(each.unit, why) for name, each in found.items()}
    return {
        **lane_keeping_measures(kept),
        "driver_torque_rms": torque_rms(part),
        **course_measures(part),
        "steering_velocity_rms": _steering_velocity(columns),
        "num_lane_changes": _changes_inside(trial, inside),
        **_around(columns, trial, around),
    }


def scenario_rows(trial: Trial, around: Surroundings) -> list[ScenarioRow]:
    """All values of a trial: of the whole course, its lane changes and each zone."""
    found = _rows(WHOLE_COURSE, None, surrounding_measures(trial, around))
    for change in () if isinstance(trial.segments, str) else trial.segments.changes:
        measures = change_surroundings(trial, around, change)
        found += _rows(WHOLE_COURSE, change.number, measures)
    for zone in around.zones:
        found += _rows(zone.name, None, zone_measures(trial, around, zone))
    return found


def _rows(zone: str, change: int | None, measures: Measures) -> list[ScenarioRow]:
    return [
        ScenarioRow(zone, change, name, each.value, each.unit)
        for name, each in measures.items()
    ]


def _inside(columns: Columns, zone: Zone) -> Flags:
    """Samples with the car in a zone, shape `(time,)`."""
    if missing(columns, "longitudinal_position"):
        return np.zeros(len(columns["time"]), bool)
    place = np.asarray(columns["longitudinal_position"])
    return np.asarray((place >= zone.start) & (place < zone.end))


# Any: the element type differs from column to column.
def _cut(columns: Columns, rows: Any) -> dict[str, Any]:
    return {name: values[rows] for name, values in columns.items()}


def _steering_velocity(columns: Columns) -> Measure:
    reason = missing(columns, "steering_wheel_angle")
    if reason:
        return unknown("rad/s", reason)
    return Measure(rms(steering_rate(columns)), "rad/s")


def _changes_inside(trial: Trial, inside: Flags) -> Measure:
    """Lane changes whose crossing is in the zone."""
    if isinstance(trial.segments, str):
        return unknown("-", trial.segments)
    time = trial.columns["time"]
    last = time.size - 1
    crossed = [
        min(int(np.searchsorted(time, change.crossing_time)), last)
        for change in trial.segments.changes
    ]
    return Measure(sum(bool(inside[row]) for row in crossed), "-")
