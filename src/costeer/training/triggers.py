"""What the verdicts would do on the road: triggers, lead times, false and missed ones.

A trigger is the start of `trigger_samples` positives in a row; triggers within 1 s of
the one before merge with it. It is true if the driver crosses to that side within 3 s,
early within 5 s, else false. The lead of a crossing is its time minus that of its
first true or early trigger, 0 if missed. The controller's lock after a lane change is
not part of this: the network is judged by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import FEATURES, SAMPLE_RATE
from costeer.training.labels import PREDICTION_HORIZON
from costeer.training.recordings import Recording

_VELOCITY = FEATURES.index("longitudinal_velocity")


class TriggerParameters(NamedTuple):
    """From a probability to a trigger.

    Attributes:
        threshold: Positive from this probability on [-]. Source: paper, 0.5.
        trigger_samples: Positives in a row [-]. Source: assumed, 50 ms.
        merge: Triggers closer than this are one [s]. Source: assumed.
        early_horizon: A crossing between the prediction horizon and this makes a
            trigger early, not false [s]. Source: assumed.
    """

    threshold: float = 0.5
    trigger_samples: int = 3
    merge: float = 1.0
    early_horizon: float = 5.0


class TriggerCounts(NamedTuple):
    """Of one driver, or of many summed.

    Attributes:
        true: Triggers with a crossing within 3 s.
        early: Triggers with one within 3 to 5 s.
        false: Triggers without.
        leads: Of each crossing that the driver meant [s], 0 if missed.
        kilometres: Driven while there were verdicts [km].
        hours: Of verdicts [h].
    """

    true: int
    early: int
    false: int
    leads: tuple[float, ...]
    kilometres: float
    hours: float


class Announced(NamedTuple):
    """What a trigger at each sample would announce.

    Attributes:
        lead: Time until the next crossing to the side of the adjacent lane that the
            driver meant [s], infinite without one, `(time,)`.
        target: Place of that crossing among those that are judged, -1 if it is none of
            them or there is none, `(time,)`.
        num_crossings: That are judged: with a verdict at the sample before.
    """

    lead: NDArray[np.float64]
    target: NDArray[np.int64]
    num_crossings: int


def announced(recording: Recording, running: NDArray[np.bool_]) -> Announced:
    """Crossings that triggers can announce.

    Args:
        recording: With the crossings that the driver meant.
        running: Whether there is a verdict, `(time,)`.
    """
    crossed = np.flatnonzero(recording.intended)
    judged = running[np.maximum(crossed - 1, 0)]
    place_among = np.where(judged, np.cumsum(judged) - 1, -1)
    here = np.arange(len(running))
    lead = np.full(len(running), np.inf)
    target = np.full(len(running), -1)
    for side in (-1, 1):
        own = np.flatnonzero(recording.intended[crossed] == side)
        following = np.searchsorted(crossed[own], here, side="right")
        rows = np.flatnonzero((recording.side == side) & (following < len(own)))
        next_one = own[following[rows]]
        target[rows] = place_among[next_one]
        lead[rows] = (crossed[next_one] - rows) / SAMPLE_RATE
    return Announced(lead=lead, target=target, num_crossings=int(judged.sum()))


def sustained(
    probability: NDArray[np.float64], parameters: TriggerParameters
) -> NDArray[np.float64]:
    """Lowest of the last `trigger_samples` verdicts, `(time,)`.

    A trigger may begin where this reaches the threshold. NaN, and what lies before the
    start, is no positive: minus infinity.
    """
    length = parameters.trigger_samples
    values = np.where(np.isfinite(probability), probability, -np.inf)
    padded = np.concatenate([np.full(length - 1, -np.inf), values])
    num = len(values)
    return np.asarray(np.minimum.reduce([padded[k : k + num] for k in range(length)]))


def onsets(
    probability: NDArray[np.float64], parameters: TriggerParameters
) -> NDArray[np.int64]:
    """Samples at which a merged trigger begins; NaN is no positive."""
    held = sustained(probability, parameters) >= parameters.threshold
    rises = np.flatnonzero(held & ~np.concatenate([[False], held[:-1]]))
    return rises[apart(rises, parameters)]


def apart(
    places: NDArray[np.int64], parameters: TriggerParameters
) -> NDArray[np.bool_]:
    """Which of the ascending places are too far from the one before to merge."""
    gaps = np.diff(places, prepend=-(10**9))
    return np.asarray(gaps > parameters.merge * SAMPLE_RATE)


def judge(
    recording: Recording,
    probability: NDArray[np.float64],
    parameters: TriggerParameters,
) -> TriggerCounts:
    """Judge the triggers of one recording.

    Args:
        recording: With the crossings that the driver meant.
        probability: Verdicts, NaN where there is none, shape `(time,)`.
        parameters: Threshold and debounce.
    """
    running = np.isfinite(probability)
    told = announced(recording, running)
    rows = onsets(probability, parameters)
    lead = told.lead[rows]
    useful = lead <= parameters.early_horizon
    true = int(np.sum(lead <= PREDICTION_HORIZON))
    leads = np.zeros(told.num_crossings)
    found = useful & (told.target[rows] >= 0)
    np.maximum.at(leads, told.target[rows[found]], lead[found])
    return TriggerCounts(
        true=true,
        early=int(useful.sum()) - true,
        false=int(np.sum(~useful)),
        leads=tuple(float(each) for each in leads),
        kilometres=kilometres(recording, running),
        hours=float(running.sum()) / SAMPLE_RATE / 3600.0,
    )


def kilometres(recording: Recording, running: NDArray[np.bool_]) -> float:
    """Driven while there were verdicts [km]."""
    driven = recording.features[running, _VELOCITY].sum() / SAMPLE_RATE
    return float(driven) / 1000.0


def total(parts: Sequence[TriggerCounts]) -> TriggerCounts:
    """Sum of the counts of several recordings."""
    return TriggerCounts(
        true=sum(p.true for p in parts),
        early=sum(p.early for p in parts),
        false=sum(p.false for p in parts),
        leads=tuple(lead for p in parts for lead in p.leads),
        kilometres=sum(p.kilometres for p in parts),
        hours=sum(p.hours for p in parts),
    )


def trigger_scores(counts: TriggerCounts) -> dict[str, float]:
    """Rates and lead times; NaN where nothing was driven or crossed."""
    leads = np.array(counts.leads)
    nan = float("nan")
    low, median, high = np.percentile(leads, [10, 50, 90]) if len(leads) else [nan] * 3
    missed = float(np.sum(leads == 0.0))
    return {
        "num_crossings": float(len(leads)),
        "true_triggers": float(counts.true),
        "early_triggers": float(counts.early),
        "false_triggers": float(counts.false),
        "false_per_km": counts.false / counts.kilometres if counts.kilometres else nan,
        "false_per_hour": counts.false / counts.hours if counts.hours else nan,
        "missed": missed,
        "missed_share": missed / len(leads) if len(leads) else nan,
        "lead_time_median": float(median),
        "lead_time_p10": float(low),
        "lead_time_p90": float(high),
    }
