"""What a false trigger or a missed lane change costs: deviation, torque, time.

Deviation and settling are told of every drive; what the guidance did is empty in
manual driving, where a trigger moves nothing.
"""

from __future__ import annotations

from math import nan
from typing import Any

import numpy as np

from costeer.study.crossings import within
from costeer.study.definitions import (
    Columns,
    Flags,
    MeasureParameters,
    Signal,
    incomplete,
    runs,
)
from costeer.study.detection import FALSE
from costeer.study.lanes import centre
from costeer.study.manoeuvres import overshoot, rms
from costeer.study.trial_measures import Trial
from costeer.study.trigger_episodes import Episode, episodes

Row = dict[str, object]

COST_COLUMNS = (
    "initial_deviation",
    "largest_deviation",
    "wheel_over_line",
    "left_lane",
    "overshoot",
    "peak_driver_torque",
    "driver_torque_rms",
    "peak_opposing_torque",
    "gain_minimum",
    "inconsistent",
    "replanned",
    "time_to_recover",
    "time_to_settle",
)
"""What `costs` tells."""

_GUIDANCE = ("applied_torque", "torque_agreement", "haptic_gain", "consistent")
_TOLERANCE = 1e-9  # s; sums of control steps are not exact


def trigger_costs(trial: Trial) -> list[Row]:
    """Every trigger and missed crossing of a trial with its cost, in order of time.

    Returns:
        Column names and values; no row where triggers cannot be judged.
    """
    found = episodes(trial)
    if isinstance(found, str):
        return []
    return [
        {
            "kind": each.kind,
            "time": each.time,
            "direction": each.direction,
            "crossing_time": each.crossing_time,
            "lead": each.lead,
            "start_time": each.start_time,
            "end_time": each.end_time,
            **costs(trial, each),
        }
        for each in found
    ]


def costs(trial: Trial, episode: Episode) -> Row:
    """Deviation, torque and time of one episode; what is not defined is NaN or None.

    Args:
        trial: That holds the episode.
        episode: When to look, and where the driver means to be.

    Returns:
        By the names of `COST_COLUMNS`.
    """
    rows = within(trial.columns["time"], episode.start_time, episode.end_time)
    if rows.stop - rows.start < 2:
        return dict.fromkeys(COST_COLUMNS, nan)
    return {
        **_place(trial, episode, rows),
        **_driver(trial.columns, rows),
        **_guidance(trial, episode, rows),
        "time_to_settle": time_to_settle(trial, episode),
    }


def _place(trial: Trial, episode: Episode, rows: slice) -> Row:
    """How far from its lane a false trigger took the car; overshoot of a change."""
    columns, parameters = trial.columns, trial.parameters
    if episode.kind != FALSE:
        names = COST_COLUMNS[: COST_COLUMNS.index("overshoot")]
        beyond = nan
        if episode.change is not None:
            beyond = overshoot(columns, episode.change, parameters)
        return {**dict.fromkeys(names, nan), "overshoot": beyond}
    away = np.abs(_from_centre(columns, parameters, episode.lane)[rows])
    largest = float(away.max())
    return {
        "initial_deviation": float(away[0]),
        "largest_deviation": largest,
        "wheel_over_line": largest > (parameters.lane_width - parameters.car_width) / 2,
        "left_lane": largest > parameters.lane_width / 2,
        "overshoot": nan,
    }


def _from_centre(columns: Columns, parameters: MeasureParameters, lane: int) -> Signal:
    """Distance to the left of a lane's centre [m], shape `(time,)`."""
    return np.asarray(columns["lateral_position"] - centre(parameters, lane))


def _driver(columns: Columns, rows: slice) -> Row:
    if incomplete(columns, "driver_torque"):
        return {"peak_driver_torque": nan, "driver_torque_rms": nan}
    torque = columns["driver_torque"][rows]
    return {
        "peak_driver_torque": float(np.abs(torque).max()),
        "driver_torque_rms": rms(torque),
    }


def _guidance(trial: Trial, episode: Episode, rows: slice) -> Row:
    """What the guidance did against the driver, and when it was back."""
    columns, parameters = trial.columns, trial.parameters
    if incomplete(columns, *_GUIDANCE):
        first = COST_COLUMNS.index("peak_opposing_torque")
        return dict.fromkeys(COST_COLUMNS[first:-1], nan)
    opposed = columns["torque_agreement"][rows] < 0.0
    against = np.abs(columns["applied_torque"][rows][opposed])
    gain, inconsistent = columns["haptic_gain"][rows], _inconsistent(columns)[rows]
    faded = inconsistent & (gain < parameters.replan_gain)
    return {
        "peak_opposing_torque": float(against.max(initial=0.0)),
        "gain_minimum": float(gain.min()),
        "inconsistent": bool(inconsistent.any()),
        "replanned": bool(faded.any()),
        "time_to_recover": _time_to_recover(trial, episode, rows),
    }


def _inconsistent(columns: Columns) -> Flags:
    return np.asarray(~np.ma.getdata(columns["consistent"]).astype(bool))


def _time_to_recover(trial: Trial, episode: Episode, rows: slice) -> float:
    """From the start until the gain is back after the last inconsistent verdict [s].

    NaN without such a verdict in the episode, or if the record ends before.
    """
    columns = trial.columns
    inconsistent = _inconsistent(columns)
    disputed = np.flatnonzero(inconsistent[rows])
    if disputed.size == 0:
        return nan
    last = rows.start + int(disputed[-1])
    gain = columns["haptic_gain"]
    back = ~inconsistent & (gain >= trial.parameters.recovery_gain)
    return _first(columns["time"], back, last) - episode.start_time


def _first(time: Signal, flags: Flags, row: int) -> float:
    """Time of the first sample from a row on at which a flag holds [s], or NaN."""
    found = np.flatnonzero(flags[row:])
    return float(time[row + int(found[0])]) if found.size else nan


def time_to_settle(trial: Trial, episode: Episode) -> float:
    """From the start until the car stays where the driver means to be [s].

    Settled is a car near the centre of that lane and straight, with a guidance, if
    there is one, that aims at that lane. It must stay so for a while; the time is
    that at which it begins to.

    Returns:
        NaN if the next trigger, the next intended lane change or the end of the
        record comes first.
    """
    columns, parameters = trial.columns, trial.parameters
    time: Signal = columns["time"]
    rows = within(time, episode.start_time, episode.limit_time)
    for stretch in runs(_settled(columns, parameters, episode.lane)[rows]):
        first, last = time[rows][stretch.start], time[rows][stretch.stop - 1]
        if last - first >= parameters.settled_duration - _TOLERANCE:
            return float(first - episode.start_time)
    return nan


def _settled(columns: Columns, parameters: MeasureParameters, lane: int) -> Flags:
    """Samples near a lane's centre, straight, with guidance to it, `(time,)`."""
    away = np.abs(_from_centre(columns, parameters, lane))
    straight = np.abs(columns["yaw_angle"]) <= parameters.yaw_threshold
    near = away <= parameters.settled_offset
    return np.asarray(near & straight & _aims_at(columns, lane))


def _aims_at(columns: Columns, lane: int) -> Flags:
    """Samples at which the guidance steers to a lane, or there is no guidance."""
    if "target_lane" not in columns:
        return np.ones(len(columns["time"]), dtype=bool)
    target: np.ma.MaskedArray[Any, Any] = np.ma.masked_array(columns["target_lane"])
    return np.asarray(np.ma.filled(target == lane, True))
