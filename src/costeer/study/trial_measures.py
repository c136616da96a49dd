"""All measures of one trial, each with its value or the reason why there is none."""

from collections.abc import Callable
from math import nan
from typing import NamedTuple

import numpy as np

from costeer.study import detection as triggers
from costeer.study.definitions import (
    DEFAULTS,
    Columns,
    Measure,
    MeasureParameters,
    Signal,
    incomplete,
    is_defined,
    missing,
    runs,
    too_short,
    unknown,
)
from costeer.study.detection import Detection, detect
from costeer.study.inconsistencies import Inconsistency, find_inconsistencies
from costeer.study.lane_keeping import (
    lane_departures,
    lateral_speed,
    sdlp,
    times_to_line_crossing,
)
from costeer.study.manoeuvres import rms
from costeer.study.reversals import steering_wheel_reversal_rate
from costeer.study.segments import Segments, segment

Measures = dict[str, Measure]


class Trial(NamedTuple):
    """A trial with what several measures need, found once.

    Attributes:
        columns: As recorded.
        parameters: Thresholds.
        segments: Lane changes and lane keeping, or why they are not known.
        speed: Lateral speed [m/s], shape `(time,)`; empty without segments.
        method: Name of the guidance; empty if it is not known.
    """

    columns: Columns
    parameters: MeasureParameters
    segments: Segments | str
    speed: Signal
    method: str = ""


def prepare(
    columns: Columns, parameters: MeasureParameters = DEFAULTS, method: str = ""
) -> Trial:
    """Cut a trial into segments and find its lateral speed."""
    segments = segment(columns, parameters)
    known = isinstance(segments, Segments)
    speed = lateral_speed(columns) if known else np.zeros(0)
    return Trial(columns, parameters, segments, speed, method)


def trial_measures(trial: Trial) -> Measures:
    """Every measure of a trial by its name in `trials.csv`, in that order."""
    return (
        lane_keeping_measures(trial)
        | course_measures(trial)
        | _lane_changes(trial)
        | _departures(trial)
        | _detection(trial)
        | _inconsistencies(trial)
    )


def sampling_rate(time: Signal) -> float:
    """Mean number of samples per second [Hz]; NaN with fewer than two."""
    return (time.size - 1) / float(time[-1] - time[0]) if time.size > 1 else nan


def lane_keeping_measures(trial: Trial) -> Measures:
    """SDLP, reversal rate, driver's torque and times to line crossing."""
    return {
        "sdlp": _position_deviation(trial),
        "swrr": _reversal_rate(trial),
        "driver_torque_rms": torque_rms(trial),
    } | _line_crossing_times(trial)


def _position_deviation(trial: Trial) -> Measure:
    if isinstance(trial.segments, str):
        return unknown("m", trial.segments)
    return sdlp(trial.columns, trial.segments, trial.parameters)


def _reversal_rate(trial: Trial) -> Measure:
    """In lane keeping; over the whole recording where lane keeping is not known."""
    reason = missing(trial.columns, "time", "steering_wheel_angle")
    reason = reason or too_short(trial.columns["time"])
    if reason:
        return unknown("1/min", reason)
    angle = trial.columns["steering_wheel_angle"]
    measured = is_defined(angle)
    if isinstance(trial.segments, Segments):
        if trial.segments.no_keeping:
            return unknown("1/min", trial.segments.no_keeping)
        kept = np.zeros(angle.size, bool)
        for rows in trial.segments.lane_keeping:
            kept[rows] = True
        measured &= kept
    return steering_wheel_reversal_rate(
        [angle[rows] for rows in runs(measured)],
        sampling_rate(trial.columns["time"]),
        trial.parameters,
    )


def torque_rms(trial: Trial) -> Measure:
    """Root mean square of the driver's torque over every sample [N·m]."""
    return _of_column(trial, "driver_torque", "N·m", rms, gaps=True)


def _line_crossing_times(trial: Trial) -> Measures:
    names = ("line_crossing_time_minimum", "line_crossing_time_median")
    if isinstance(trial.segments, str):
        return dict.fromkeys(names, unknown("s", trial.segments))
    times = times_to_line_crossing(
        trial.columns, trial.speed, trial.segments, trial.parameters
    )
    return dict(zip(names, times, strict=True))


def course_measures(trial: Trial) -> Measures:
    """Duration, distance and mean speed."""
    return {
        "duration": _of_column(trial, "time", "s", _extent),
        "distance": _of_column(trial, "longitudinal_position", "m", _extent),
        "mean_speed": _of_column(
            trial, "longitudinal_velocity", "m/s", _mean, gaps=True
        ),
    }


def _of_column(
    trial: Trial,
    name: str,
    unit: str,
    measure: Callable[[Signal], float],
    gaps: bool = False,
) -> Measure:
    reason = (missing if gaps else incomplete)(trial.columns, name)
    if gaps and not reason:
        reason = too_short(trial.columns["time"])
    if reason:
        return unknown(unit, reason)
    values = trial.columns[name]
    return Measure(value=measure(values[is_defined(values)]), unit=unit)


def _extent(values: Signal) -> float:
    return float(values[-1] - values[0])


def _mean(values: Signal) -> float:
    return float(np.mean(values))


def _lane_changes(trial: Trial) -> Measures:
    segments = trial.segments
    names = ("num_events", "num_lane_changes", "num_dropped_changes")
    if isinstance(segments, str):
        reason = segments
        counts = dict.fromkeys(names, unknown("-", reason))
        return counts | {"lane_keeping_duration": unknown("s", reason)}
    numbers = (segments.num_events, len(segments.changes), len(segments.dropped))
    samples = sum(rows.stop - rows.start for rows in segments.lane_keeping)
    seconds = samples / sampling_rate(trial.columns["time"])
    return {
        **{n: Measure(value=v, unit="-") for n, v in zip(names, numbers, strict=True)},
        "lane_keeping_duration": Measure(value=seconds, unit="s"),
    }


def _departures(trial: Trial) -> Measures:
    if isinstance(trial.segments, str):
        return {"num_lane_departures": unknown("-", trial.segments)}
    found = lane_departures(
        trial.columns, trial.speed, trial.segments, trial.parameters
    )
    return {"num_lane_departures": Measure(value=len(found), unit="-")}


def _detection(trial: Trial) -> Measures:
    found = detect(trial.columns, trial.parameters, trial.method)
    if isinstance(found, str):
        reason = found
        return {name: unknown(unit, reason) for name, unit in _DETECTION_UNITS.items()}
    kilometres = course_measures(trial)["distance"]
    false = triggers.count(found, triggers.FALSE)
    missed = triggers.num_missed(found)
    return {
        "num_triggers": _count(len(found.triggers)),
        "num_true_triggers": _count(triggers.count(found, triggers.TRUE)),
        "num_early_triggers": _count(triggers.count(found, triggers.EARLY)),
        "num_false_triggers": _count(false),
        "num_missed": _count(missed),
        "false_triggers_per_km": _per_kilometre(false, kilometres),
        "missed_per_km": _per_kilometre(missed, kilometres),
        "detection_lead_time": _lead_time(found),
    }


_DETECTION_UNITS = {
    "num_triggers": "-",
    "num_true_triggers": "-",
    "num_early_triggers": "-",
    "num_false_triggers": "-",
    "num_missed": "-",
    "false_triggers_per_km": "1/km",
    "missed_per_km": "1/km",
    "detection_lead_time": "s",
}


def _count(number: int) -> Measure:
    return Measure(value=number, unit="-")


def _per_kilometre(number: int, distance: Measure) -> Measure:
    if distance.reason:
        return unknown("1/km", distance.reason)
    if distance.value <= 0.0:
        return unknown("1/km", "the car did not move")
    return Measure(value=1000.0 * number / distance.value, unit="1/km")


def _lead_time(found: Detection) -> Measure:
    leads = [triggers.lead_time(found, crossing.time) for crossing in found.crossings]
    if not leads:
        return unknown("s", "the driver crossed no line on purpose")
    return Measure(value=float(np.mean(leads)), unit="s")


def _inconsistencies(trial: Trial) -> Measures:
    found = find_inconsistencies(trial.columns, trial.parameters, trial.method)
    if isinstance(found, str):
        reason = found
        return {name: unknown(u, reason) for name, u in _INCONSISTENCY_UNITS.items()}
    return {
        "num_inconsistencies": _count(len(found)),
        "inconsistency_duration": _over(found, "s", _mean, "duration"),
        "inconsistency_gain_minimum": _over(found, "-", _least, "gain_minimum"),
        "recovery_time": _over(found, "s", _mean, "recovery_time"),
        "verdict_flips": _over(found, "-", _mean, "num_flips"),
        "frozen_time": _over(found, "s", _mean, "frozen_time"),
    }


_INCONSISTENCY_UNITS = {
    "num_inconsistencies": "-",
    "inconsistency_duration": "s",
    "inconsistency_gain_minimum": "-",
    "recovery_time": "s",
    "verdict_flips": "-",
    "frozen_time": "s",
}


def _least(values: Signal) -> float:
    return float(np.min(values))


def _over(
    found: tuple[Inconsistency, ...],
    unit: str,
    summary: Callable[[Signal], float],
    field: str,
) -> Measure:
    """One figure over the inconsistencies of a trial; undefined ones are left out."""
    values = np.array([getattr(each, field) for each in found], dtype=float)
    known = values[~np.isnan(values)]
    if known.size == 0:
        what = "no inconsistency" if not found else f"no {field} ended in the record"
        return unknown(unit, what)
    return Measure(value=summary(known), unit=unit)
