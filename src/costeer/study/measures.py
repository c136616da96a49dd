"""The rows of the tables of a study, in SI units.

What a measure is stands in the files beside this one and in docs/measures.md. What
could not be computed is NaN here; `trial_measures` says why.
"""

from collections.abc import Mapping
from math import inf, isclose, nan

from costeer.records.columns import TrialRecord
from costeer.study.definitions import DEFAULTS, MeasureParameters, incomplete
from costeer.study.detection import Detection, detect, lead_time
from costeer.study.inconsistencies import Inconsistency, find_inconsistencies
from costeer.study.manoeuvres import (
    duration_sensitivity,
    is_assisted,
    overshoot,
    peak_steering_angle,
    settling,
    speed_measures,
    steering_velocity_rms,
)
from costeer.study.scenario import surroundings
from costeer.study.scenario_measures import scenario_rows
from costeer.study.segments import LaneChange, Segments
from costeer.study.trial_measures import Trial, prepare, trial_measures
from costeer.study.trigger_costs import trigger_costs

Row = dict[str, object]

_STRENGTHS = {0.0: "manual", 1.0: "strong", 0.4: "weak"}


def trial_row(
    record: TrialRecord,
    order: int | None = None,
    parameters: MeasureParameters = DEFAULTS,
) -> Row:
    """The row of a trial in `trials.csv`.

    Args:
        record: The trial.
        order: Its place in the participant's session, from 1.
        parameters: Thresholds of the measures.

    Returns:
        Column names and values; the same names for every record.
    """
    trial = prepared(record, parameters)
    measures = trial_measures(trial)
    return {
        **_identity(record),
        "order": order,
        **{name: measure.value for name, measure in measures.items()},
        "dropped_changes": _dropped(trial),
    }


def lane_change_rows(
    record: TrialRecord, parameters: MeasureParameters = DEFAULTS
) -> list[Row]:
    """The rows of a trial in `lane_changes.csv`, in order of time.

    Args:
        record: The trial.
        parameters: Thresholds of the measures.

    Returns:
        Per completed lane change, column names and values.
    """
    trial = prepared(record, parameters)
    if isinstance(trial.segments, str):
        return []
    found = detect(trial.columns, trial.parameters)
    disputes = find_inconsistencies(trial.columns, trial.parameters)
    return [
        {
            **_identity(record),
            **_change_row(trial, change),
            **_judged(change, found, disputes),
            **settling(trial.columns, change, trial.parameters),
        }
        for change in trial.segments.changes
    ]


def trigger_rows(
    record: TrialRecord, parameters: MeasureParameters = DEFAULTS
) -> list[Row]:
    """The rows of a trial in `triggers.csv`, in order of time.

    Args:
        record: The trial.
        parameters: Thresholds of the measures.

    Returns:
        Per trigger and per missed crossing, column names and values.
    """
    trial = prepared(record, parameters)
    return [{**_identity(record), **each} for each in trigger_costs(trial)]


def scenario_measure_rows(
    record: TrialRecord, parameters: MeasureParameters = DEFAULTS
) -> list[Row]:
    """The rows of a trial in `scenario_measures.csv`.

    Args:
        record: The trial.
        parameters: Thresholds of the measures.

    Returns:
        Per value, column names and values; none on the paper's scenario.
    """
    around = surroundings(record)
    if around.is_papers:
        return []
    found = scenario_rows(prepared(record, parameters), around)
    return [{**_identity(record), **each._asdict()} for each in found]


def prepared(record: TrialRecord, parameters: MeasureParameters = DEFAULTS) -> Trial:
    """A trial ready to be measured, with what its description says of it."""
    method = str(record.metadata.get("method") or "")
    return prepare(record.columns, parameters_of(record, parameters), method)


def parameters_of(
    record: TrialRecord, parameters: MeasureParameters = DEFAULTS
) -> MeasureParameters:
    """The parameters with the record's own road and re-plan gain, if it says them."""
    told: dict[str, object] = {"replan_gain": record.metadata.get("replan_gain")}
    configuration = record.metadata.get("configuration")
    road = configuration.get("road") if isinstance(configuration, Mapping) else None
    if isinstance(road, Mapping):
        told |= {name: road.get(name) for name in _OF_THE_ROAD}
    known = {name: value for name in told if (value := _number(told, name)) is not None}
    return parameters._replace(**known)


_OF_THE_ROAD = {
    "lane_width": (0.5, 20.0),
    "num_lanes": (1.0, 20.0),
    "overtaking_side": (-1.0, 1.0),
}
"""What the measures take from the road that a record says it was driven on, and the
range in which it is believed."""


def _number(told: Mapping[str, object], name: str) -> float | None:
    """A number that a record tells; None if it is none that can be."""
    value = told[name]
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        return None
    low, high = _OF_THE_ROAD.get(name, (-inf, inf))
    return float(value) if low <= value <= high else None


def strength(factor: object) -> str:
    """Name of a strength factor: manual, strong or weak; else the factor itself."""
    if not isinstance(factor, (int, float)):
        return "manual"
    for known, name in _STRENGTHS.items():
        if isclose(factor, known, abs_tol=1e-9):
            return name
    return f"{factor:g}"


def _identity(record: TrialRecord) -> Row:
    metadata = record.metadata
    name = strength(metadata.get("strength_factor"))
    duration = metadata.get("change_duration")
    known = isinstance(duration, (int, float)) and name != "manual"
    return {
        "participant": metadata.get("participant"),
        "condition": metadata.get("condition"),
        "strength": name,
        "change_duration": duration if known else nan,
    }


def _dropped(trial: Trial) -> str:
    """The crossings that make no lane change, as one text; empty if none."""
    if not isinstance(trial.segments, Segments):
        return ""
    return "; ".join(
        f"{dropped.crossing_time:.2f} s: {dropped.reason}"
        for dropped in trial.segments.dropped
    )


def _change_row(trial: Trial, change: LaneChange) -> Row:
    columns, parameters = trial.columns, trial.parameters
    return {
        "index": change.number,
        "direction": change.direction,
        "start_time": change.start_time,
        "crossing_time": change.crossing_time,
        "end_time": change.end_time,
        "duration": change.end_time - change.start_time,
        "overshoot": overshoot(columns, change, parameters),
        **_steering_row(trial, change),
        "assisted": is_assisted(columns, change),
        **speed_measures(columns, trial.speed, change, parameters),
        **duration_sensitivity(columns, change),
    }


def _steering_row(trial: Trial, change: LaneChange) -> Row:
    if incomplete(trial.columns, "steering_wheel_angle"):
        return {"steering_velocity_rms": nan, "peak_steering_angle": nan}
    return {
        "steering_velocity_rms": steering_velocity_rms(trial.columns, change),
        "peak_steering_angle": peak_steering_angle(trial.columns, change),
    }


def _judged(
    change: LaneChange,
    found: Detection | str,
    disputes: tuple[Inconsistency, ...] | str,
) -> Row:
    """Lead time of the detection and inconsistencies that began in the lane change."""
    lead, number = nan, nan
    if isinstance(found, Detection):
        lead = lead_time(found, change.crossing_time)
    if not isinstance(disputes, str):
        number = sum(
            change.start_time <= dispute.start_time <= change.end_time
            for dispute in disputes
        )
    return {"detection_lead_time": lead, "num_inconsistencies": number}
