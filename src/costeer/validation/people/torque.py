"""How hard and how often people steer on real roads: torque and reversals.

`udacity_steering` has the torque that a production car senses at its wheel and the
angle, `comma2k19_example` one minute of angle. Real roads bend and are crowned, and
that sensor has an offset; ours is straight. Torque is reported, not aimed at.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from costeer.base.array import Real
from costeer.records.columns import TrialRecord
from costeer.study.definitions import runs
from costeer.study.measures import parameters_of
from costeer.study.reversals import steering_wheel_reversal_rate
from costeer.study.segments import Segments, segment
from costeer.validation.people.findings import Values
from costeer.validation.people.folder import (
    Columns,
    Table,
    groups,
    read_table,
    table_path,
)

LEAST_SPEED = 12.0
"""Slower driving is turning and parking [m/s]."""

REVERSAL_STRETCH = 60.0
"""Reversals of people are counted in stretches of this length [s]."""

_TORQUE_EVERY = 1.0  # s between two samples of torque that are kept
_RATE = 20.0  # of udacity_steering [Hz]
_GAP = 0.5  # s: a longer step between two rows is a gap
_RECORD_RATE = 60.0
_UDACITY = Columns(numbers=("t", "angle", "torque", "speed", "part"))
_COMMA = Columns(numbers=("t", "steering_angle_deg", "speed"))


def torque_levels(folder: Path | None) -> Values:
    """|torque| at more than 12 m/s, one a second, shape `(sample,)` [N·m].

    Args:
        folder: With the sets.

    Returns:
        Empty if the set is absent.

    Raises:
        ValueError: If the table cannot be read.
    """
    path = table_path(folder, "udacity_steering")
    if path is None:
        return np.empty(0)
    table = read_table(path, _UDACITY)
    fast = table["speed"] > LEAST_SPEED
    levels: Values = np.abs(table["torque"][fast])[:: round(_TORQUE_EVERY * _RATE)]
    return levels


def record_torque_levels(record: TrialRecord) -> Values:
    """The same of a trial [N·m]."""
    columns = record.columns
    fast = np.asarray(columns["longitudinal_velocity"]) > LEAST_SPEED
    torque: Values = np.abs(np.asarray(columns["driver_torque"])[fast])
    return torque[:: round(_TORQUE_EVERY * _RECORD_RATE)]


def reversal_rates(folder: Path | None) -> Values:
    """Reversals of 3 deg per minute in whole minutes above 12 m/s [1/min].

    Args:
        folder: With the sets.

    Returns:
        Of both sets, shape `(minute,)`; empty if both are absent.

    Raises:
        ValueError: If a table cannot be read.
    """
    tables = [*_udacity_parts(folder), *_comma_parts(folder)]
    rates = [rate for table in tables for rate in _minutes(table)]
    return np.array(rates, np.float64)


def _udacity_parts(folder: Path | None) -> list[Table]:
    path = table_path(folder, "udacity_steering")
    if path is None:
        return []
    table = read_table(path, _UDACITY)
    return [
        {name: values[rows] for name, values in table.items()}
        for rows in groups(table["part"])
    ]


def _comma_parts(folder: Path | None) -> list[Table]:
    path = table_path(folder, "comma2k19_example")
    if path is None:
        return []
    table = read_table(path, _COMMA)
    return [table | {"angle": np.radians(table["steering_angle_deg"])}]


def _minutes(table: Table) -> list[Real]:
    """Reversal rate of each whole minute without a gap and above 12 m/s."""
    time, angle = table["t"], table["angle"]
    good = table["speed"] > LEAST_SPEED
    good &= np.diff(time, prepend=time[:1]) < _GAP
    rates = []
    for rows in runs(good):
        even = np.arange(time[rows.start], time[rows.stop - 1], 1.0 / _RATE)
        resampled = np.interp(even, time[rows], angle[rows])
        length = round(REVERSAL_STRETCH * _RATE)
        for first in range(0, even.size - length + 1, length):
            minute = resampled[first : first + length]
            rates.append(steering_wheel_reversal_rate([minute], _RATE).value)
    return rates


def record_reversal_rate(record: TrialRecord) -> Values:
    """Reversals of a trial's lane keeping, shape `(1,)`; or empty [1/min]."""
    parameters = parameters_of(record)
    segments = segment(record.columns, parameters)
    if not isinstance(segments, Segments):
        return np.empty(0)
    angle = np.asarray(record.columns["steering_wheel_angle"])
    kept = [angle[rows] for rows in segments.lane_keeping]
    rate = steering_wheel_reversal_rate(kept, _RECORD_RATE, parameters).value
    return np.array([rate])
