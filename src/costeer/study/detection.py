"""Did the system see the lane changes coming: triggers against the driver's crossings.

A trigger is a rise of the debounced `intention`. Under assistance a crossing counts
only if the driver meant it, because a false trigger makes the guidance cross.
"""

from math import nan
from typing import NamedTuple

import numpy as np

from costeer.records.columns import LANE_CHANGING
from costeer.study.crossings import Crossing, line_crossings
from costeer.study.definitions import (
    DEFAULTS,
    Columns,
    Flags,
    MeasureParameters,
    incomplete,
    is_defined,
    missing,
    under_assistance,
)
from costeer.study.lanes import adjacent_side, lanes

TRUE = "true"
EARLY = "early"
FALSE = "false"


class Trigger(NamedTuple):
    """One trigger and what it was worth.

    Attributes:
        time: When [s].
        direction: Towards the adjacent lane: -1 to the right, +1 to the left.
        verdict: "true", "early" or "false".
        crossing_time: Of the crossing it announced [s]; NaN if false.
    """

    time: float
    direction: int
    verdict: str
    crossing_time: float


class Detection(NamedTuple):
    """Triggers and intended crossings of a trial.

    Attributes:
        triggers: In order of time.
        crossings: Those the driver intended.
    """

    triggers: tuple[Trigger, ...]
    crossings: tuple[Crossing, ...]


def detect(
    columns: Columns, parameters: MeasureParameters = DEFAULTS, method: str = ""
) -> Detection | str:
    """Judge every trigger of a trial.

    Args:
        columns: `time`, `lateral_position`, `intention`; under assistance also
            `driver_intention` and `mode`; shape `(time,)` each.
        parameters: Horizons.
        method: Name of the guidance, for the reason.

    Returns:
        The verdicts, or the reason why there are none.
    """
    reason = incomplete(columns, "time", "lateral_position", "intention")
    reason = reason or _not_running(columns) or _never_triggers(columns, method)
    reason = reason or _cannot_judge(columns)
    if reason:
        return reason
    crossings = tuple(
        crossing
        for crossing in line_crossings(columns, parameters)
        if _intended(columns, crossing.time, crossing.direction)
    )
    rows = _merged(columns["time"], _onsets(columns), parameters.trigger_merge)
    judged = [_judged(columns, parameters, crossings, row) for row in rows]
    latest = float(columns["time"][-1]) - parameters.early_horizon
    triggers = [each for each in judged if not _is_open(columns, each, latest)]
    return Detection(triggers=tuple(triggers), crossings=crossings)


def lead_time(detection: Detection, crossing_time: float) -> float:
    """Crossing minus its first trigger [s]; 0 if missed, NaN if not intended."""
    intended = [c.time for c in detection.crossings]
    if crossing_time not in intended:
        return nan
    leads = [
        crossing_time - trigger.time
        for trigger in detection.triggers
        if trigger.crossing_time == crossing_time
    ]
    return max(leads, default=0.0)


def count(detection: Detection, verdict: str) -> int:
    """Number of triggers with a verdict."""
    return sum(trigger.verdict == verdict for trigger in detection.triggers)


def num_missed(detection: Detection) -> int:
    """Number of intended crossings without a true or early trigger."""
    announced = {trigger.crossing_time for trigger in detection.triggers}
    return sum(crossing.time not in announced for crossing in detection.crossings)


def _not_running(columns: Columns) -> str:
    """Why there are no triggers to judge; empty if there may be."""
    if np.any(columns["intention"]):
        return ""
    if missing(columns, "crossing_probability"):
        return "the intention inference did not run"
    return ""


def _never_triggers(columns: Columns, method: str) -> str:
    """That the guidance starts no lane change; empty if it may.

    It has then no target lane in any sample, and neither trigger nor path.
    """
    if not under_assistance(columns) or "target_lane" not in columns:
        return ""
    changing = np.any(columns["mode"] == LANE_CHANGING)
    if np.any(columns["intention"]) or changing or not missing(columns, "target_lane"):
        return ""
    return f"{' '.join(['the method', method]).strip()} does not trigger lane changes"


def _cannot_judge(columns: Columns) -> str:
    """Why the driver's own crossings are not known; empty if they are."""
    if _knows_intention(columns) or not under_assistance(columns):
        return ""
    return "under assistance needs driver_intention, which is unknown for people"


def _knows_intention(columns: Columns) -> bool:
    return not missing(columns, "driver_intention")


def _intended(columns: Columns, instant: float, direction: int) -> bool:
    """Whether the driver wants to that side then; manual people always do."""
    if not _knows_intention(columns):
        return True
    row = max(int(np.searchsorted(columns["time"], instant, side="right")) - 1, 0)
    decided = columns["driver_intention"]
    return bool(is_defined(decided)[row] and int(decided[row]) == direction)


def _onsets(columns: Columns) -> list[int]:
    """Rows at which the trigger rises while no lane-change path is running."""
    flags: Flags = np.asarray(columns["intention"], dtype=bool)
    rises = flags & ~np.concatenate([[False], flags[:-1]])
    if "mode" in columns:
        changing = np.asarray(columns["mode"] == LANE_CHANGING)
        rises[1:] &= ~changing[:-1]
    return [int(row) for row in np.flatnonzero(rises)]


def _merged(time: np.ndarray, rows: list[int], gap: float) -> list[int]:
    """The first row of each group of onsets that follow each other within a gap."""
    return [
        row
        for place, row in enumerate(rows)
        if place == 0 or time[row] - time[rows[place - 1]] > gap
    ]


def _is_open(columns: Columns, trigger: Trigger, latest: float) -> bool:
    """Whether the record ends before the crossing that the driver means may come.

    Args:
        columns: Of the record.
        trigger: As it was judged.
        latest: From then on a crossing may come after the end [s].
    """
    means = _intended(columns, trigger.time, trigger.direction)
    return trigger.verdict == FALSE and trigger.time > latest and means


def _asked_side(columns: Columns, parameters: MeasureParameters, row: int) -> int:
    """Side that the verdict of a row was about: the usual one if it is not told."""
    told = columns.get("crossing_side")
    if told is not None and told[row] != 0:
        return int(told[row])
    lane = int(lanes(columns["lateral_position"][row], parameters))
    return adjacent_side(parameters, lane)


def _judged(
    columns: Columns,
    parameters: MeasureParameters,
    crossings: tuple[Crossing, ...],
    row: int,
) -> Trigger:
    instant = float(columns["time"][row])
    direction = _asked_side(columns, parameters, row)
    following = [
        crossing.time
        for crossing in crossings
        if crossing.direction == direction
        and 0.0 <= crossing.time - instant <= parameters.early_horizon
    ]
    if not following or not _intended(columns, instant, direction):
        return Trigger(instant, direction, FALSE, nan)
    near = following[0] - instant <= parameters.prediction_horizon
    return Trigger(instant, direction, TRUE if near else EARLY, following[0])
