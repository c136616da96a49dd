"""Triggers over all thresholds: the trade of lead time against false triggers.

Thresholds stand on a fine grid of logits. At each of them the triggers of every driver
are counted once; what follows, the operating curve, the best point at a given rate of
false triggers and its interval over drivers, is made of these counts.

False triggers per kilometre are not monotone in the threshold: two triggers apart may
be one at a lower threshold. So all thresholds are looked at, and of those that keep to
the rate the one with the largest median lead is taken. It is chosen on the data that
it is judged on; that flatters every predictor alike, and each resampling of the
drivers chooses anew.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import NDArray

from costeer.intention.features import SAMPLE_RATE
from costeer.training.labels import PREDICTION_HORIZON
from costeer.training.triggers import (
    TriggerCounts,
    TriggerParameters,
    announced,
    apart,
    kilometres,
    sustained,
)
from costeer.training.verdicts import DriverVerdicts

Numbers = NDArray[np.float64]
Places = NDArray[np.int64]

_LARGEST_LOGIT, _STEPS_PER_LOGIT = 10, 20
_LOGITS = np.arange(-_LARGEST_LOGIT * _STEPS_PER_LOGIT, 201) / _STEPS_PER_LOGIT
THRESHOLDS: Numbers = 1.0 / (1.0 + np.exp(-_LOGITS))
"""Ascending; twenty to a logit from -10 to 10."""


class OperatingCounts(NamedTuple):
    """Triggers at each threshold, driver by driver.

    Attributes:
        thresholds: Ascending, `(threshold,)`.
        true: Triggers with a crossing within 3 s, `(threshold, driver)`.
        early: Triggers with one within 3 to 5 s, `(threshold, driver)`.
        false: Triggers without, `(threshold, driver)`.
        leads: Of each crossing [s], 0 if missed, `(threshold, crossing)`.
        driver: Place of each crossing's driver, `(crossing,)`.
        kilometres: Driven by each driver while there were verdicts, `(driver,)`.
        hours: Of each driver's verdicts, `(driver,)`.
    """

    thresholds: Numbers
    true: Numbers
    early: Numbers
    false: Numbers
    leads: Numbers
    driver: Places
    kilometres: Numbers
    hours: Numbers


class _Rises(NamedTuple):
    """Samples where a trigger begins at some thresholds, of all recordings.

    Attributes:
        place: On one time line of all recordings, too far apart to merge.
        low: First threshold at which it begins.
        high: Threshold after the last one.
        lead: What it announces [s].
        target: Which crossing.
        driver: Whose.
    """

    place: Places
    low: Places
    high: Places
    lead: Numbers
    target: Places
    driver: Places


def operating_counts(
    drivers: Sequence[DriverVerdicts],
    parameters: TriggerParameters,
    thresholds: Numbers = THRESHOLDS,
) -> OperatingCounts:
    """Count triggers at every threshold.

    Args:
        drivers: With their verdicts.
        parameters: Debounce; its threshold is not used.
        thresholds: Ascending, `(threshold,)`.
    """
    pieces, owners = _pieces(drivers, parameters, thresholds)
    rises = _Rises(*(np.concatenate(part) for part in zip(*pieces, strict=True)))
    shape = (len(thresholds), len(drivers))
    true, early, false = (np.zeros(shape) for _ in range(3))
    leads = np.zeros((len(thresholds), len(owners)))
    for k in range(len(thresholds)):
        rows = np.flatnonzero((rises.low <= k) & (k < rises.high))
        rows = rows[apart(rises.place[rows], parameters)]
        lead, driver = rises.lead[rows], rises.driver[rows]
        useful, timely = lead <= parameters.early_horizon, lead <= PREDICTION_HORIZON
        for counted, chosen in ((true, timely), (early, useful & ~timely)):
            counted[k] = np.bincount(driver[chosen], minlength=len(drivers))
        false[k] = np.bincount(driver[~useful], minlength=len(drivers))
        found = useful & (rises.target[rows] >= 0)
        np.maximum.at(leads[k], rises.target[rows[found]], lead[found])
    running = [[np.isfinite(p) for p in one.probabilities] for one in drivers]
    return OperatingCounts(
        thresholds=thresholds,
        true=true,
        early=early,
        false=false,
        leads=leads,
        driver=owners,
        kilometres=np.array(
            [
                sum(map(kilometres, one.recordings, on))
                for one, on in zip(drivers, running, strict=True)
            ]
        ),
        hours=np.array([sum(r.sum() for r in on) for on in running])
        / (SAMPLE_RATE * 3600.0),
    )


def _pieces(
    drivers: Sequence[DriverVerdicts],
    parameters: TriggerParameters,
    thresholds: Numbers,
) -> tuple[list[_Rises], Places]:
    """Rises of each recording, and the driver of each crossing."""
    pieces, owners = [_no_rises()], [np.empty(0, np.int64)]
    start, num_crossings = 0, 0
    for place, one in enumerate(drivers):
        for recording, said in zip(one.recordings, one.probabilities, strict=True):
            told = announced(recording, np.isfinite(said))
            held = sustained(said, parameters)
            level = np.searchsorted(thresholds, held, side="right")
            before = np.concatenate([[0], level[:-1]])
            rows = np.flatnonzero(level > before)
            pieces.append(
                _Rises(
                    place=rows + start,
                    low=before[rows],
                    high=level[rows],
                    lead=told.lead[rows],
                    target=np.where(
                        told.target[rows] < 0, -1, told.target[rows] + num_crossings
                    ),
                    driver=np.full(len(rows), place),
                )
            )
            owners.append(np.full(told.num_crossings, place))
            num_crossings += told.num_crossings
            start += len(said) + round(parameters.merge * SAMPLE_RATE) + 1
    return pieces, np.concatenate(owners)


def _no_rises() -> _Rises:
    nothing = np.empty(0, np.int64)
    return _Rises(nothing, nothing, nothing, np.empty(0), nothing, nothing)


def counts_at(counts: OperatingCounts, place: int) -> TriggerCounts:
    """Counts of all drivers together at one threshold."""
    return TriggerCounts(
        true=int(counts.true[place].sum()),
        early=int(counts.early[place].sum()),
        false=int(counts.false[place].sum()),
        leads=tuple(float(lead) for lead in counts.leads[place]),
        kilometres=float(counts.kilometres.sum()),
        hours=float(counts.hours.sum()),
    )


class OperatingPoint(NamedTuple):
    """What one threshold gives.

    Attributes:
        threshold: Positive from this probability on [-].
        false_per_km: False triggers [1/km].
        lead_time_median: [s].
        missed_share: Of the crossings [-].
    """

    threshold: float
    false_per_km: float
    lead_time_median: float
    missed_share: float


def operating_curve(counts: OperatingCounts) -> list[OperatingPoint]:
    """All points in order of the threshold; of equal neighbours the first."""
    columns = (counts.thresholds, *_pooled(counts))
    found: list[OperatingPoint] = []
    for row in zip(*columns, strict=True):
        point = OperatingPoint(*(float(value) for value in row))
        if not found or point[1:] != found[-1][1:]:
            found.append(point)
    return found


def _pooled(counts: OperatingCounts) -> tuple[Numbers, Numbers, Numbers]:
    """False triggers per km, median lead and missed share, `(threshold,)` each."""
    num = counts.leads.shape[1]
    unknown = np.full(len(counts.thresholds), np.nan)
    driven = counts.kilometres.sum()
    rate = counts.false.sum(axis=1) / driven if driven else unknown
    if num == 0:
        return rate, unknown, unknown
    missed = np.mean(counts.leads == 0.0, axis=1)
    return rate, np.median(counts.leads, axis=1), missed


def best_place(counts: OperatingCounts, false_per_km: float) -> int | None:
    """Threshold with the largest median lead among those that keep to a rate.

    Of several the one with the fewest false triggers, then the highest.

    Returns:
        Its place; None if there is none, or no crossing to judge.
    """
    rate, lead, _ = _pooled(counts)
    kept = np.flatnonzero((rate <= false_per_km) & np.isfinite(lead))
    if len(kept) == 0:
        return None
    return int(max(kept, key=lambda place: (lead[place], -rate[place], place)))


def trigger_place(counts: OperatingCounts, false_per_km: float) -> int | None:
    """Threshold to trigger at: of those that keep to a rate the one that tells most.

    The largest mean lead, where a missed crossing has 0 s; unlike the median it also
    ranks thresholds that miss more than half. Of several the one with the fewest false
    triggers, then the highest.

    Returns:
        Its place; None if none keeps to the rate, or there is no crossing to judge.
    """
    rate, _, _ = _pooled(counts)
    kept = np.flatnonzero(rate <= false_per_km)
    if len(kept) == 0 or counts.leads.shape[1] == 0:
        return None
    lead = counts.leads.mean(axis=1)
    return int(max(kept, key=lambda place: (lead[place], -rate[place], place)))


def resampled_leads(
    counts: OperatingCounts,
    times: Int[NDArray[np.int64], "resample driver"],
    false_per_km: float,
) -> Float[Numbers, " resample"]:
    """Largest median lead at a rate of false triggers, in each resampling of drivers.

    Args:
        counts: Of the drivers.
        times: How often each driver was drawn.
        false_per_km: Rate [1/km].

    Returns:
        [s]; 0 where no threshold keeps to the rate, because a predictor that is silent
        does; NaN where no driver with a crossing was drawn.
    """
    drawn = times.astype(np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        rate = (drawn @ counts.false.T) / (drawn @ counts.kilometres)[:, None]
    kept = rate <= false_per_km
    weights = times[:, counts.driver].T.astype(np.int32)
    best = np.where(weights.sum(axis=0) > 0, 0.0, np.nan)
    for places, lead in _medians(counts.leads, weights, np.asarray(kept.any(axis=0))):
        allowed = kept[:, places].any(axis=1)
        best = np.where(allowed, np.maximum(best, lead), best)
    return best


def _medians(
    leads: Numbers, weights: NDArray[np.int32], wanted: NDArray[np.bool_]
) -> Iterator[tuple[Places, Numbers]]:
    """Thresholds that are wanted and have the same leads, with the medians there."""
    places = np.flatnonzero(wanted)
    new = np.any(np.diff(leads[places], axis=0) != 0.0, axis=1)
    for same in np.split(places, np.flatnonzero(new) + 1):
        if len(same):
            yield same, weighted_medians(leads[same[0]], weights)


def weighted_medians(
    values: Float[Numbers, " value"], weights: Int[NDArray[np.int32], "value resample"]
) -> Float[Numbers, " resample"]:
    """Median of values that occur several times; NaN where none does.

    Args:
        values: Any numbers.
        weights: How often each occurs, in each resampling.
    """
    if len(values) == 0:
        return np.full(weights.shape[1], np.nan)
    order = np.argsort(values, kind="stable")
    reached = np.cumsum(weights[order], axis=0, dtype=np.int32)
    total = reached[-1]
    last = len(values) - 1
    low, high = (
        np.minimum((reached <= half).sum(axis=0), last)
        for half in ((total - 1) // 2, total // 2)
    )
    ranked = values[order]
    return np.where(total > 0, (ranked[low] + ranked[high]) / 2.0, np.nan)
