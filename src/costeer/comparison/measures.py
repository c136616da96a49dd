"""The row of a trial: its criteria, each by the definitions of the study."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pandas as pd

from costeer.comparison.criteria import NAMES
from costeer.records.columns import TrialRecord
from costeer.study.definitions import Measure, under_assistance
from costeer.study.detection import FALSE
from costeer.study.disputes import in_lane_change
from costeer.study.effort import (
    conflict_share,
    lateral_jerk_rms,
    opposing_torque_rms,
    wheel_rate_rms,
)
from costeer.study.inconsistencies import find_inconsistencies
from costeer.study.manoeuvres import overshoot
from costeer.study.measures import prepared
from costeer.study.scenario import surroundings
from costeer.study.scenario_measures import surrounding_measures
from costeer.study.trial_measures import Trial, trial_measures
from costeer.study.trigger_costs import trigger_costs

BESIDE = ("num_lane_changes", "num_dropped_changes", "duration", "distance")
"""Columns of a row beside the criteria."""

COLUMNS: tuple[str, ...] = (*NAMES, *BESIDE)

NEVER_NEAR = 20.0
"""Longest time to the line [s]; longer ones count as this. A drive with hardly any lane
keeping may have one of an hour, which would outweigh those of all others. Source:
assumed."""

_OF_A_TRIGGER = (
    "false_triggers_per_km",
    "detection_lead_time",
    "missed_per_km",
)
"""Without assistance a trigger moves nothing: nobody is annoyed or helped by it."""


class Moment(NamedTuple):
    """When an inconsistency came.

    Attributes:
        from_crossing: After the nearest crossing of a lane change [s], negative before
            it; NaN if there is none near.
        share: Of the lane change that had passed, 0 to 1; NaN outside of one.
    """

    from_crossing: float
    share: float


class TrialOutcome(NamedTuple):
    """What a trial came to.

    Attributes:
        participant: Number of the driver.
        failure: Why there is no result; empty if there is one.
        torque_faults: Samples in which the method asked for a torque that was not
            finite or over the limit, and got none or the limit [-].
        values: By the names of `COLUMNS`, SI units; NaN if not defined.
        disputes: When inconsistencies came; None of a method that gives no verdict.
    """

    participant: int
    failure: str
    torque_faults: int
    values: tuple[float, ...]
    disputes: tuple[Moment, ...] | None = None


def outcome_of(participant: int, record: TrialRecord) -> TrialOutcome:
    """Measure a trial."""
    trial = prepared(record)
    values = _values(trial, record)
    faults = record.metadata.get("torque_faults")
    return TrialOutcome(
        participant=participant,
        failure="",
        torque_faults=faults if isinstance(faults, int) else 0,
        values=tuple(float(values[name]) for name in COLUMNS),
        disputes=_disputes(trial),
    )


def _disputes(trial: Trial) -> tuple[Moment, ...] | None:
    """When the inconsistencies of a trial came; None without a verdict."""
    found = find_inconsistencies(trial.columns, trial.parameters, trial.method)
    if isinstance(found, str) or not under_assistance(trial.columns):
        return None
    changes = () if isinstance(trial.segments, str) else trial.segments.changes
    table = pd.DataFrame([each._asdict() for each in changes]) if changes else None
    return tuple(Moment(*in_lane_change(each.start_time, table)) for each in found)


def failed(participant: int, reason: str) -> TrialOutcome:
    """A trial that came to no end."""
    told = " ".join(reason.split()) or "it gave no reason"
    return TrialOutcome(participant, told, 0, (math.nan,) * len(COLUMNS))


def _values(trial: Trial, record: TrialRecord) -> dict[str, float]:
    found: dict[str, Measure] = {
        **trial_measures(trial),
        **surrounding_measures(trial, surroundings(record)),
        "opposing_torque_rms": opposing_torque_rms(trial.columns),
        "conflict_share": conflict_share(trial.columns),
        "lateral_jerk_rms": lateral_jerk_rms(trial.columns),
        "wheel_rate_rms": wheel_rate_rms(trial.columns),
    }
    values = {name: float(each.value) for name, each in found.items()}
    least = "line_crossing_time_minimum"
    values[least] = float(np.minimum(values[least], NEVER_NEAR))
    if not under_assistance(trial.columns):
        values |= dict.fromkeys(_OF_A_TRIGGER, math.nan)
    collisions = values["num_car_collisions"] + values["num_barrier_collisions"]
    events = [collisions, values["num_lane_departures"]]
    return {
        **values,
        **_lane_changes(trial),
        "num_collisions": collisions,
        "num_safety_events": _sum(events),
        "false_trigger_settle_time": _settle_time(trial),
    }


def _lane_changes(trial: Trial) -> dict[str, float]:
    """Means over the drive's lane changes [s, m]."""
    changes = () if isinstance(trial.segments, str) else trial.segments.changes
    beyond = [overshoot(trial.columns, each, trial.parameters) for each in changes]
    return {
        "change_duration": _mean([each.end_time - each.start_time for each in changes]),
        "overshoot": _mean(beyond),
    }


def _settle_time(trial: Trial) -> float:
    """Mean time until the car has settled after a false activation [s]."""
    if not under_assistance(trial.columns):
        return math.nan
    rows = [each for each in trigger_costs(trial) if each["kind"] == FALSE]
    return _mean([float(str(each["time_to_settle"])) for each in rows])


def _sum(values: list[float]) -> float:
    """Sum of what is known: who hits something at once has left no lane before."""
    known = [each for each in values if math.isfinite(each)]
    return sum(known) if known else math.nan


def _mean(values: list[float]) -> float:
    known = np.array([each for each in values if math.isfinite(each)])
    return float(known.mean()) if known.size else math.nan
