"""A trial record as the page shows it: a description, and all rows as one block."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.export.markers import markers_of
from costeer.plant.parameters import CARS, CarParameters, RoadParameters
from costeer.records.checks import check_time
from costeer.records.columns import COLUMNS, COLUMNS_BY_NAME, Column, TrialRecord
from costeer.web.messages import LONGEST_NAME, marker_shown, told_of
from costeer.web.scenery import bounded, cars_of_record, scenery_of

NEEDED = (
    "time",
    "longitudinal_position",
    "lateral_position",
    "yaw_angle",
    "longitudinal_velocity",
    "steering_wheel_angle",
)
"""Columns without which nothing can be shown."""

_ROAD = {
    "lane_width": (1.0, 20.0),
    "num_lanes": (1.0, 20.0),
    "length": (1.0, 1e6),
    "overtaking_side": (-1.0, 1.0),
}
"""What a page can draw of a road, in the units of `RoadParameters`."""

_CAR = {
    "width": (0.5, 5.0),
    "front_distance": (0.1, 10.0),
    "rear_distance": (0.1, 10.0),
    "steering_ratio": (1.0, 100.0),
}
"""The same of a car."""

# Any: the element type differs from column to column.
Values = NDArray[Any]


class Replay(NamedTuple):
    """What the page is given of a record.

    Attributes:
        hello: The first message, without `type` and `role`.
        rows: Little-endian float64, row after row, in the order of hello's columns.
    """

    hello: dict[str, object]
    rows: bytes


def replay_of(record: TrialRecord, title: str) -> Replay:
    """A record as the page shows it.

    Args:
        record: A trial, or any table that has the columns of `NEEDED`.
        title: What the page is headed with.

    Raises:
        ValueError: If a needed column is missing or has a value that is not finite,
            or if time does not increase.
    """
    _check(record.columns)
    declared = (*COLUMNS, *record.method_columns)
    shown = [column for column in declared if column.name in record.columns]
    values = [_numbers(column, record.columns[column.name]) for column in shown]
    rows = np.stack(values, axis=1).astype("<f8")
    hello = _described(record, title) | told_of(shown)
    return Replay(hello=hello, rows=rows.tobytes())


def _check(columns: Mapping[str, Values]) -> None:
    """Refuse a record that cannot be shown."""
    missing = [name for name in NEEDED if name not in columns]
    if missing:
        raise ValueError(
            f"there is no column {', '.join(missing)}; a replay needs "
            f"{', '.join(NEEDED)}, in SI units"
        )
    if len(columns["time"]) < 2:
        raise ValueError("there are fewer than two rows; a replay needs a stretch")
    for name in NEEDED:
        _check_finite(name, _numbers(COLUMNS_BY_NAME[name], columns[name]))
    check_time(_numbers(COLUMNS_BY_NAME["time"], columns["time"]))


def _check_finite(name: str, values: NDArray[np.float64]) -> None:
    gaps = np.flatnonzero(~np.isfinite(values))
    if gaps.size:
        raise ValueError(
            f"column {name} is {values[gaps[0]]} in row {gaps[0]}; a replay needs a "
            "number in every row"
        )


def _numbers(column: Column, values: Values) -> NDArray[np.float64]:
    """A column as floats: texts by their place among the labels, undefined is NaN.

    Raises:
        ValueError: If it holds text that has no labels.
    """
    if column.labels and values.dtype.kind == "U":
        return _places(column.labels, values)
    if values.dtype.kind not in "fiub":
        raise ValueError(f"column {column.name} holds text; a replay needs numbers")
    numbers = np.ma.getdata(values).astype(np.float64)
    numbers[np.ma.getmaskarray(values)] = np.nan
    numbers[np.isinf(numbers)] = np.nan  # a chart has no place for it
    return numbers


def _places(labels: Sequence[str], values: Values) -> NDArray[np.float64]:
    """The number of each label; NaN for other words."""
    numbers = np.full(len(values), np.nan)
    for number, label in enumerate(labels):
        numbers[values == label] = number
    return numbers


def _described(record: TrialRecord, title: str) -> dict[str, object]:
    """What the page is told of a record; where it tells nothing, what is usual."""
    about = record.metadata
    time = _numbers(COLUMNS_BY_NAME["time"], record.columns["time"])
    condition, method = _word(about.get("condition")), _word(about.get("method"))
    return {
        "mode": "replay",
        "title": title,
        "duration": float(time[-1] - time[0]),
        "markers": [marker_shown(marker) for marker in markers_of(about)],
        "rate": float(1.0 / np.median(np.diff(time))),
        "road": _road(about),
        "scenario": scenery_of(about.get("scenario")),
        "other_cars": cars_of_record(about, _road(about)["length"]),
        "car": _car(about),
        "conditions": [condition] if condition else [],
        "condition": condition,
        "methods": [method] if method else [],
        "method": method,
        "tunables": [],
        "input": "wheel",
        "show_signals": True,
        "torque_limit": bounded(about.get("torque_limit"), 5.0, 0.1, 100.0),
    }


def _word(value: object) -> str:
    """A name as the page shows it: short and printable, or none."""
    fits = isinstance(value, str) and len(value) <= LONGEST_NAME
    return str(value) if fits and str(value).isprintable() else ""


def _within(about: Mapping[str, object], name: str) -> Mapping[str, object]:
    """A part of the configuration that a record keeps; empty if it does not."""
    configuration = about.get("configuration")
    part = configuration.get(name) if isinstance(configuration, Mapping) else None
    return part if isinstance(part, Mapping) else {}


def _road(about: Mapping[str, object]) -> dict[str, float]:
    """The road that was driven on."""
    given, usual = _within(about, "road"), RoadParameters()._asdict()
    return {
        name: bounded(given.get(name), float(usual[name]), *span)
        for name, span in _ROAD.items()
    }


def _car(about: Mapping[str, object]) -> dict[str, object]:
    """The car that was driven."""
    usual = CARS.get(str(about.get("car")), CarParameters())
    given = _within(about, "car")

    def known(name: str) -> float:
        return bounded(given.get(name), float(getattr(usual, name)), *_CAR[name])

    return {
        "width": known("width"),
        "wheelbase": known("front_distance") + known("rear_distance"),
        "steering_ratio": known("steering_ratio"),
    }
