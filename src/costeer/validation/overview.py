"""What else a population does in manual driving: printed, not held to a range."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.study.crossings import LEFT, RIGHT
from costeer.validation.manual import ManualDriving, Row, columns_of


class Quantity(NamedTuple):
    """One number about a population.

    Attributes:
        quantity: What it is.
        unit: Of the value as printed.
        value: NaN if it could not be computed.
    """

    quantity: str
    unit: str
    value: Real


def overview(driving: ManualDriving) -> list[Quantity]:
    """Durations by both definitions, speed, lane changes, departures, first glances."""
    return [
        *_durations(driving.changes, "duration_by_speed", "lateral speed 0.1 m/s"),
        *_durations(driving.changes, "duration", "yaw 0.5 deg"),
        *_course(driving),
        *_first_glances(driving.changes),
    ]


def _durations(changes: list[Row], name: str, definition: str) -> list[Quantity]:
    values = columns_of(changes)(name)
    return [
        Quantity(
            f"lane-change duration ({definition}), {q} %", "s", _quantile(values, q)
        )
        for q in (10, 50, 90)
    ]


def _quantile(values: NDArray[np.float64], percent: int) -> Real:
    return float(np.percentile(values, percent)) if values.size else float("nan")


def _course(driving: ManualDriving) -> list[Quantity]:
    trial = columns_of(driving.trials)
    kilometres = float(trial("distance").sum()) / 1000.0
    seconds = float(trial("duration").sum())
    departures = float(trial("num_lane_departures").sum())
    return [
        Quantity("mean speed", "km/h", 3600.0 * kilometres / seconds),
        Quantity("lane changes planned", "-", float(driving.planned_changes)),
        Quantity("lane changes achieved", "-", float(len(driving.changes))),
        Quantity("lane departures", "1/km", departures / kilometres),
    ]


def _first_glances(changes: list[Row]) -> list[Quantity]:
    sides = {"to the right": RIGHT, "back to the left": LEFT}
    return [
        Quantity(
            f"first glance before the wheel touches the line, {name}, mean",
            "s",
            _mean([c["first_glance_lead"] for c in changes if c["direction"] == side]),
        )
        for name, side in sides.items()
    ]


def _mean(values: list[Real]) -> Real:
    known = [value for value in values if np.isfinite(value)]
    return float(np.mean(known)) if known else float("nan")
