"""Scores in resamplings of the drivers.

Samples of one driver are not independent, so drivers are resampled, not samples. Every
score is made of sums over drivers, which are computed once; a resampling weighs them.
Two predictors that are resampled alike can be compared drawing by drawing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import NDArray

from costeer.training import metrics
from costeer.training.operating import OperatingCounts, resampled_leads
from costeer.training.triggers import TriggerCounts
from costeer.training.verdicts import DriverVerdicts, judged_samples

Numbers = NDArray[np.float64]
Times = NDArray[np.int64]
Drawn = dict[str, Numbers]
"""Value of each score in each resampling, `(resample,)`."""

FEWEST_DRIVERS = 5
"""With fewer no interval is told: resampling so few says more of chance than of
drivers. Source: assumed; five can be drawn in 126 different ways, four in 35."""

AT_RATE = "lead_time_at_false_rate"
_LEADS = {"lead_time_p10": 10, "lead_time_median": 50, "lead_time_p90": 90}


def resamplings(
    num_drivers: int, num_resamples: int, seed: int
) -> Int[Times, "resample driver"]:
    """How often each driver is drawn in each resampling."""
    rng = np.random.default_rng(seed)
    share = np.full(num_drivers, 1.0 / num_drivers)
    return np.asarray(rng.multinomial(num_drivers, share, num_resamples))


def intervals_told(
    num_drivers: int, num_resamples: int, seed: int, unit: str = "drivers"
) -> dict[str, str | float]:
    """How the intervals beside it were made, or why there are none.

    Args:
        num_drivers: That are resampled.
        num_resamples: Of the bootstrap.
        seed: Of the bootstrap.
        unit: What stands for a driver.
    """
    told: dict[str, str | float] = {
        "method": f"percentile bootstrap over {unit}",
        "level": 0.95,
        "resamples": num_resamples,
        "seed": seed,
        unit: num_drivers,
    }
    if num_drivers < FEWEST_DRIVERS:
        told["none_because"] = (
            f"{num_drivers} {unit} are too few for an interval; it needs at least "
            f"{FEWEST_DRIVERS}"
        )
    return told


def drawn_samples(
    drivers: Sequence[DriverVerdicts],
    times: Int[Times, "resample driver"],
    threshold: float,
) -> Drawn:
    """Scores over samples in each resampling; areas from bins of 0.1 % of a class."""
    drawn = times.astype(np.float64)
    pairs = [judged_samples([one]) for one in drivers]
    edges = metrics.bin_edges(*judged_samples(drivers))
    binned = [metrics.binned_counts(*pair, edges) for pair in pairs]
    positives = drawn @ np.array([yes for yes, _ in binned])
    negatives = drawn @ np.array([no for _, no in binned])
    cells = np.array([metrics.confusion(*pair, threshold) for pair in pairs])
    counts = metrics.Confusion(*(drawn @ cells).T)
    fair = metrics.scores(metrics.balanced(counts))
    return {
        "pr_auc": metrics.pr_auc(positives, negatives),
        "roc_auc": metrics.roc_auc(positives, negatives),
        **metrics.scores(counts),
        "pr_auc_balanced": metrics.pr_auc(
            *metrics.balanced_levels(positives, negatives)
        ),
        "f1_balanced": fair["f1"],
        "precision_balanced": fair["precision"],
        **_losses(pairs, drawn),
    }


def _losses(
    pairs: Sequence[tuple[Numbers, NDArray[np.bool_]]], drawn: Numbers
) -> Drawn:
    """Brier score and log loss from their sums over drivers."""
    num = np.array([float(len(said)) for said, _ in pairs])
    with np.errstate(invalid="ignore", divide="ignore"):
        return {
            name: (drawn @ np.array([_sum(loss, *pair) for pair in pairs]))
            / (drawn @ num)
            for name, loss in (("brier", metrics.brier), ("log_loss", metrics.log_loss))
        }


def _sum(loss: metrics.Loss, said: Numbers, truth: NDArray[np.bool_]) -> float:
    return loss(said, truth) * len(said) if len(said) else 0.0


def drawn_triggers(
    counts: Sequence[TriggerCounts], times: Int[Times, "resample driver"]
) -> Drawn:
    """False triggers, missed share and lead times in each resampling.

    Args:
        counts: Of each driver at the threshold.
        times: How often each driver was drawn.
    """
    drawn = times.astype(np.float64)
    false = drawn @ np.array([c.false for c in counts], np.float64)
    missed = drawn @ np.array([sum(lead == 0.0 for lead in c.leads) for c in counts])
    num = drawn @ np.array([len(c.leads) for c in counts], np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        return {
            "false_per_km": false / (drawn @ np.array([c.kilometres for c in counts])),
            "false_per_hour": false / (drawn @ np.array([c.hours for c in counts])),
            "missed_share": missed / num,
            **_leads(counts, times),
        }


def _leads(counts: Sequence[TriggerCounts], times: Times) -> Drawn:
    """Percentiles of the lead in each resampling, NaN without a crossing."""
    leads = np.array([lead for c in counts for lead in c.leads])
    of_driver = np.repeat(np.arange(len(counts)), [len(c.leads) for c in counts])
    found = np.full((len(_LEADS), len(times)), np.nan)
    for i, row in enumerate(times):
        several = np.repeat(leads, row[of_driver])
        if len(several):
            found[:, i] = np.percentile(several, list(_LEADS.values()))
    return dict(zip(_LEADS, found, strict=True))


def drawn_at_rate(
    counts: OperatingCounts, times: Int[Times, "resample driver"], false_per_km: float
) -> Drawn:
    """Median lead at the best threshold that keeps to a rate, chosen each time."""
    return {AT_RATE: resampled_leads(counts, times, false_per_km)}


def interval_95(drawn: Float[Numbers, " resample"]) -> tuple[float, float] | None:
    """Percentiles 2.5 and 97.5; None if no drawing has a value."""
    known = drawn[np.isfinite(drawn)]
    if len(known) == 0:
        return None
    low, high = np.percentile(known, [2.5, 97.5])
    return float(low), float(high)
