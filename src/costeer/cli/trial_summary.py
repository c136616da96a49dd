"""A trial in a few lines, in the units people speak of."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from costeer.cli.console import print_table

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

    from costeer.records.record import TrialRecord
    from costeer.study.measures import Row

RIGHT = -1


def print_summary(record: TrialRecord) -> None:
    """Print what happened in a trial: course, torques, guidance, lane changes."""
    from costeer.study.measures import lane_change_rows, trial_row

    about = record.metadata
    title = f"participant {about['participant']}, {about['condition']}"
    rows = summary_rows(record, trial_row(record))
    print_table(("measure", "value", "unit"), rows, title)
    changes = lane_change_rows(record)
    if changes:
        heads = ("change", "to", "at [s]", "for [s]", "beyond [m]", "peak [deg]")
        print_table(heads, [change_cells(change) for change in changes])


def summary_rows(record: TrialRecord, measures: Row) -> list[tuple[str, str, str]]:
    """Return name, value and unit of what a reader looks for first."""
    columns = record.columns

    def peak(name: str, scale: float = 1.0) -> str:
        return number(scale * max_abs(columns[name]), 2)

    return [
        *_ending(record.metadata),
        ("duration", number(measures["duration"], 1), "s"),
        ("distance", number(measures["distance"], 0), "m"),
        ("mean speed", number(_kmh(measures["mean_speed"]), 1), "km/h"),
        ("overtaking events", number(measures["num_events"], 0), ""),
        ("lane changes", number(measures["num_lane_changes"], 0), ""),
        ("lane departures", number(measures["num_lane_departures"], 0), ""),
        ("SDLP", number(measures["sdlp"], 3), "m"),
        ("reversal rate", number(measures["swrr"], 1), "1/min"),
        ("peak wheel angle", peak("steering_wheel_angle", 180 / math.pi), "deg"),
        ("peak driver torque", peak("driver_torque"), "N·m"),
        ("driver torque RMS", number(measures["driver_torque_rms"], 3), "N·m"),
        ("peak guidance torque", peak("applied_torque"), "N·m"),
        ("triggers, false", number(measures["num_false_triggers"], 0), ""),
        ("crossings missed", number(measures["num_missed"], 0), ""),
        ("inconsistencies", number(measures["num_inconsistencies"], 0), ""),
        *_faults(record.metadata),
    ]


_ENDINGS = {
    "collision": "collision",
    "stopped": "stopped for good",
    "out of time": "out of time",
}
"""What is said of a trial that did not arrive."""


def _ending(about: Mapping[str, object]) -> list[tuple[str, str, str]]:
    """A row for a trial that did not arrive at the end of its course."""
    ending = _ENDINGS.get(str(about.get("outcome")))
    return [("ended by", ending, "")] if ending else []


def _kmh(speed: object) -> float:
    return 3.6 * speed if isinstance(speed, float) else math.nan


def _faults(about: Mapping[str, object]) -> list[tuple[str, str, str]]:
    """A row for torques of the method that were no number or over the limit."""
    faults = about.get("torque_faults")
    return [("faults of the torque", f"{faults}", "steps")] if faults else []


def change_cells(change: Row) -> list[str]:
    """Return the cells of one lane change."""
    angle = change["peak_steering_angle"]
    degrees = math.degrees(angle) if isinstance(angle, float) else math.nan
    return [
        str(change["index"]),
        "right" if change["direction"] == RIGHT else "left",
        number(change["crossing_time"], 1),
        number(change["duration"], 2),
        number(change["overshoot"], 3),
        number(degrees, 1),
    ]


def number(value: object, digits: int) -> str:
    """Return a number with so many decimals; a dash if it is undefined."""
    if not isinstance(value, int | float) or math.isnan(value):
        return "-"
    return f"{value:.{digits}f}"


def max_abs(values: NDArray[np.float64]) -> float:
    """Return the largest magnitude, undefined samples left out."""
    import numpy as np

    return float(np.nanmax(np.abs(values)))
