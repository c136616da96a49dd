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


def onsets(
    probability: NDArray[np.float64], parameters: TriggerParameters
) -> NDArray[np.int64]:
    """Samples at which a merged trigger begins; NaN is no positive."""
    rises = _rises(probability, parameters)
    apart = np.diff(rises, prepend=-(10**9)) > parameters.merge * SAMPLE_RATE
    return rises[apart]


def _rises(
    probability: NDArray[np.float64], parameters: TriggerParameters
) -> NDArray[np.int64]:
    """Samples at which enough positives in a row are complete for the first time."""
    with np.errstate(invalid="ignore"):
        positive = probability >= parameters.threshold
    total = np.concatenate([[0], np.cumsum(positive)])
    length = parameters.trigger_samples
    held = np.zeros(len(positive), bool)
    held[length - 1 :] = total[length:] - total[:-length] == length
    return np.flatnonzero(held & ~np.concatenate([[False], held[:-1]]))


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
    crossed = np.flatnonzero(recording.intended)
    crossed = crossed[running[np.maximum(crossed - 1, 0)]]
    first: dict[int, float] = {}
    true = early = false = 0
    for row in onsets(probability, parameters):
        target, lead = _announced(recording, crossed, int(row))
        if lead > parameters.early_horizon:
            false += 1
            continue
        true += lead <= PREDICTION_HORIZON
        early += lead > PREDICTION_HORIZON
        first.setdefault(target, lead)
    driven = recording.features[running, _VELOCITY].sum() / SAMPLE_RATE
    return TriggerCounts(
        true=true,
        early=early,
        false=false,
        leads=tuple(first.get(int(c), 0.0) for c in crossed),
        kilometres=float(driven) / 1000.0,
        hours=float(running.sum()) / SAMPLE_RATE / 3600.0,
    )


def _announced(
    recording: Recording, crossed: NDArray[np.int64], row: int
) -> tuple[int, float]:
    """Next crossing to the side of a trigger, and the time until then [s]."""
    later = crossed[crossed > row]
    same = later[recording.intended[later] == recording.side[row]]
    if len(same) == 0:
        return -1, float("inf")
    return int(same[0]), float(same[0] - row) / SAMPLE_RATE


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
