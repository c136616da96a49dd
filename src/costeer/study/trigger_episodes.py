"""Which stretch of a trial shows what a trigger led to, or the lack of one.

A false trigger is followed from its own time on, while the driver means to stay. A
crossing that the driver intended is followed over its lane change, whether the system
announced it or missed it, so that both are measured in the same way.
"""

from __future__ import annotations

from math import inf, nan
from typing import NamedTuple

from costeer.study.crossings import Crossing
from costeer.study.definitions import Columns, MeasureParameters
from costeer.study.detection import FALSE, Detection, Trigger, detect
from costeer.study.lanes import lanes
from costeer.study.segments import LaneChange, Segments
from costeer.study.trial_measures import Trial

MISSED = "missed"
"""Kind of an intended crossing without a true or early trigger."""


class Episode(NamedTuple):
    """A trigger or a missed crossing, and when its cost is looked at.

    Attributes:
        kind: "true", "early", "false" or "missed".
        time: Of the trigger [s]; NaN if missed.
        direction: Of trigger or crossing: -1 to the right, +1 to the left.
        crossing_time: Of the intended crossing [s]; NaN if false.
        lead: Crossing minus trigger [s]; 0 if missed, NaN if false.
        lane: That the driver means to be in, after the crossing if there is one,
            counted from the right.
        start_time: The trigger if false, else the lane change's start [s].
        end_time: Of the episode [s]. Start and end are NaN if the intended crossing
            makes no lane change.
        limit_time: What happens from here on has another cause: the next trigger or
            the start of the next intended lane change [s]; inf without any.
        change: The lane change of the intended crossing, if it makes one.
    """

    kind: str
    time: float
    direction: int
    crossing_time: float
    lead: float
    lane: int
    start_time: float
    end_time: float
    limit_time: float
    change: LaneChange | None


class _Judged(NamedTuple):
    """A trial with its verdicts."""

    columns: Columns
    parameters: MeasureParameters
    segments: Segments
    found: Detection


def episodes(trial: Trial) -> tuple[Episode, ...] | str:
    """Every trigger and every missed crossing of a trial, in order of time.

    Args:
        trial: With `intention` and, under assistance, `driver_intention`.

    Returns:
        The episodes, or the reason why they cannot be told.
    """
    if isinstance(trial.segments, str):
        return trial.segments
    found = detect(trial.columns, trial.parameters)
    if isinstance(found, str):
        return found
    judged = _Judged(trial.columns, trial.parameters, trial.segments, found)
    every = [_of_trigger(judged, trigger) for trigger in found.triggers]
    every += [_of_crossing(judged, missed) for missed in _missed(found)]
    return tuple(sorted(every, key=_place))


def _meant_lane(judged: _Judged, instant: float) -> int:
    """The lane that the driver means to be in, counted from the right.

    That which the last intended crossing led to. A crossing that only the guidance
    wanted does not change it. Before any crossing it is the lane of the first sample.
    """
    before = [c.lane for c in judged.found.crossings if c.time <= instant]
    began = lanes(judged.columns["lateral_position"][:1], judged.parameters)
    return before[-1] if before else int(began[0])


def _missed(found: Detection) -> list[Crossing]:
    announced = {trigger.crossing_time for trigger in found.triggers}
    return [each for each in found.crossings if each.time not in announced]


def _place(episode: Episode) -> float:
    """When the episode comes in the order of the trial [s]."""
    return episode.crossing_time if episode.kind == MISSED else episode.time


def _of_trigger(judged: _Judged, trigger: Trigger) -> Episode:
    if trigger.verdict == FALSE:
        return _of_false(judged, trigger)
    announced = [c for c in judged.found.crossings if c.time == trigger.crossing_time]
    return _of_crossing(judged, announced[0])._replace(
        kind=trigger.verdict,
        time=trigger.time,
        lead=trigger.crossing_time - trigger.time,
    )


def _of_false(judged: _Judged, trigger: Trigger) -> Episode:
    limit = _limit(judged, trigger.time)
    longest = trigger.time + judged.parameters.episode_duration
    last = float(judged.columns["time"][-1])
    return Episode(
        kind=FALSE,
        time=trigger.time,
        direction=trigger.direction,
        crossing_time=nan,
        lead=nan,
        lane=_meant_lane(judged, trigger.time),
        start_time=trigger.time,
        end_time=min(longest, limit, last),
        limit_time=limit,
        change=None,
    )


def _of_crossing(judged: _Judged, crossing: Crossing) -> Episode:
    """The episode of an intended crossing, as if nothing had announced it."""
    made = [c for c in judged.segments.changes if c.crossing_time == crossing.time]
    change = made[0] if made else None
    return Episode(
        kind=MISSED,
        time=nan,
        direction=crossing.direction,
        crossing_time=crossing.time,
        lead=0.0,
        lane=crossing.lane,
        start_time=change.start_time if change else nan,
        end_time=change.end_time if change else nan,
        limit_time=_limit(judged, crossing.time),
        change=change,
    )


def _limit(judged: _Judged, instant: float) -> float:
    """The first trigger or start of an intended lane change after an instant [s]."""
    segments = judged.segments
    starts = {c.crossing_time: c.start_time for c in segments.changes}
    starts |= {c.crossing_time: c.start_time for c in segments.dropped}
    later = [t.time for t in judged.found.triggers if t.time > instant]
    later += [
        max(starts[crossing.time], instant)
        for crossing in judged.found.crossings
        if crossing.time > instant
    ]
    return min(later, default=inf)
