"""Judge a predictor on recordings: samples, triggers, drivers, uncertainty.

Judged are all samples with a verdict and a known answer, at natural prevalence, and
beside it as if half of them were positive. Intervals are 95 % percentiles of a
bootstrap that resamples drivers, because samples of one driver are not independent.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.predictors.interface import Probabilities
from costeer.training import bootstrap, metrics
from costeer.training.operating import (
    OperatingCounts,
    best_place,
    counts_at,
    operating_counts,
)
from costeer.training.recordings import Recording
from costeer.training.triggers import (
    TriggerCounts,
    TriggerParameters,
    judge,
    total,
    trigger_scores,
)
from costeer.training.verdicts import DriverVerdicts, judged_samples, verdicts

__all__ = [
    "DEFAULTS",
    "DriverVerdicts",
    "EvaluationParameters",
    "Judgement",
    "at_false_rate",
    "balanced_scores",
    "evaluate",
    "judged_samples",
    "judgement",
    "plain",
    "sample_scores",
    "trigger_counts",
    "verdicts",
]


class EvaluationParameters(NamedTuple):
    """How a network is judged.

    Attributes:
        triggers: Threshold and debounce.
        false_per_km: Rate at which lead times are compared [1/km]. Source: assumed,
            one false trigger in 20 km.
        num_resamples: Of the bootstrap [-]. Source: assumed, the 2.5 % points then
            vary by about 0.1 standard deviation.
        seed: Of the bootstrap [-]. Source: assumed, any number.
    """

    triggers: TriggerParameters = TriggerParameters()
    false_per_km: float = 0.05
    num_resamples: int = 1000
    seed: int = 1


DEFAULTS = EvaluationParameters()


class Judgement(NamedTuple):
    """A judgement, and what comparisons and figures need of it.

    Attributes:
        facts: Plain numbers, lists and dictionaries, NaN as None.
        drivers: What was judged.
        operating: Triggers at all thresholds.
        drawn: Scores in each resampling of the drivers.
    """

    facts: dict[str, Any]  # Any: JSON
    drivers: list[DriverVerdicts]
    operating: OperatingCounts
    drawn: bootstrap.Drawn


def sample_scores(
    probability: NDArray[np.float64], positive: NDArray[np.bool_], threshold: float
) -> dict[str, float]:
    """Scores over samples, without intervals."""
    levels = metrics.level_counts(probability, positive)
    counts = metrics.confusion(probability, positive, threshold)
    found = {name: float(value) for name, value in metrics.scores(counts).items()}
    bins = metrics.calibration(probability, positive)
    return found | {
        "pr_auc": float(metrics.pr_auc(*levels)),
        "roc_auc": float(metrics.roc_auc(*levels)),
        "brier": metrics.brier(probability, positive),
        "log_loss": metrics.log_loss(probability, positive),
        "calibration_error": metrics.calibration_error(bins),
    }


def balanced_scores(
    probability: NDArray[np.float64], positive: NDArray[np.bool_], threshold: float
) -> dict[str, float]:
    """Scores over samples if half of them were positive: each class weighs as much.

    Accuracy, precision and F1 are those of the same answers. `accuracy_even_odds` is
    that of the probabilities as Bayes' rule turns them for even odds, at 0.5; a network
    that is fitted on as many positives as negatives says these.
    """
    levels = metrics.level_counts(probability, positive)
    counts = metrics.confusion(probability, positive, threshold)
    found = metrics.scores(metrics.balanced(counts))
    names = ("prevalence", "accuracy", "precision", "recall", "f1")
    even = metrics.with_even_odds(probability, float(positive.mean()))
    turned = metrics.scores(metrics.confusion(even, positive, 0.5))
    return {name: float(found[name]) for name in names} | {
        "pr_auc": float(metrics.pr_auc(*metrics.balanced_levels(*levels))),
        "accuracy_even_odds": float(turned["balanced_accuracy"]),
    }


def trigger_counts(
    driver: DriverVerdicts, parameters: TriggerParameters
) -> TriggerCounts:
    """Triggers and leads of one driver."""
    pairs = zip(driver.recordings, driver.probabilities, strict=True)
    return total([judge(r, p, parameters) for r, p in pairs])


def at_false_rate(
    drivers: Sequence[DriverVerdicts], parameters: EvaluationParameters
) -> dict[str, float]:
    """Trigger scores at the threshold with the largest median lead at a false rate.

    All thresholds of a fine grid are looked at, because false triggers per kilometre
    are not monotone in the threshold; of those that keep to the rate the one with the
    largest median lead is taken (operating.py).

    Empty if none does.
    """
    return _at_rate(operating_counts(drivers, parameters.triggers), parameters)


def _at_rate(
    counts: OperatingCounts, parameters: EvaluationParameters
) -> dict[str, float]:
    place = best_place(counts, parameters.false_per_km)
    if place is None:
        return {}
    score = trigger_scores(counts_at(counts, place))
    return {"threshold": float(counts.thresholds[place]), **score}


def evaluate(
    predict: Probabilities,
    recordings: Sequence[Recording],
    parameters: EvaluationParameters = DEFAULTS,
) -> dict[str, Any]:
    """Judge a predictor; the result is plain numbers, lists and dictionaries.

    Raises:
        ValueError: If no sample can be judged.
    """
    return judgement(parameters, verdicts(predict, recordings)).facts


def judgement(
    parameters: EvaluationParameters, drivers: list[DriverVerdicts]
) -> Judgement:
    """Judge what a predictor said.

    Raises:
        ValueError: If no sample can be judged.
    """
    probability, positive = judged_samples(drivers)
    if len(probability) == 0:
        raise ValueError(
            "no sample can be judged: a verdict needs 180 valid samples in a row, an "
            "answer 3 s of driving after it"
        )
    counts = [trigger_counts(one, parameters.triggers) for one in drivers]
    operating = operating_counts(drivers, parameters.triggers)
    drawn = _drawn(parameters, drivers, counts, operating)
    found = {
        **_amounts(drivers, total(counts), len(probability)),
        **_scores(parameters, probability, positive),
        "triggers": trigger_scores(total(counts)),
        "false_per_km_allowed": parameters.false_per_km,
        "at_false_rate": _at_rate(operating, parameters),
        "between_drivers": _spread(drivers, counts, parameters.triggers.threshold),
        "intervals": bootstrap.intervals_told(
            len(drivers), parameters.num_resamples, parameters.seed
        ),
        "interval_95": _intervals(drawn, len(drivers)),
    }
    return Judgement(plain(found), drivers, operating, drawn)


def _amounts(
    drivers: Sequence[DriverVerdicts], counts: TriggerCounts, num_samples: int
) -> dict[str, Any]:
    """How much was judged."""
    return {
        "num_drivers": len(drivers),
        "num_recordings": sum(len(one.recordings) for one in drivers),
        "num_crossings": len(counts.leads),
        "num_samples": num_samples,
        "hours": counts.hours,
        "kilometres": counts.kilometres,
    }


def _scores(
    parameters: EvaluationParameters,
    probability: NDArray[np.float64],
    positive: NDArray[np.bool_],
) -> dict[str, Any]:
    """Scores over samples at natural and at even prevalence, and calibration."""
    threshold = parameters.triggers.threshold
    bins = metrics.calibration(probability, positive)
    return {
        "threshold": threshold,
        "samples": sample_scores(probability, positive, threshold),
        "balanced": balanced_scores(probability, positive, threshold),
        "calibration": [one._asdict() for one in bins],
    }


def _spread(
    drivers: Sequence[DriverVerdicts],
    counts: Sequence[TriggerCounts],
    threshold: float,
) -> dict[str, dict[str, float]]:
    """10th, 50th and 90th percentile over drivers of the main scores."""
    rows = []
    for one, count in zip(drivers, counts, strict=True):
        probability, positive = judged_samples([one])
        if len(probability):
            scores = sample_scores(probability, positive, threshold)
            rows.append(scores | trigger_scores(count))
    names = ("pr_auc", "balanced_accuracy", "f1", "lead_time_median", "false_per_km")
    found = {}
    for name in names:
        values = [row[name] for row in rows if math.isfinite(row[name])]
        if values:
            low, median, high = np.percentile(values, [10, 50, 90])
            found[name] = {"p10": low, "median": median, "p90": high}
    return found


def _drawn(
    parameters: EvaluationParameters,
    drivers: Sequence[DriverVerdicts],
    counts: Sequence[TriggerCounts],
    operating: OperatingCounts,
) -> bootstrap.Drawn:
    """All scores in all resamplings of the drivers."""
    num, seed = parameters.num_resamples, parameters.seed
    times = bootstrap.resamplings(len(drivers), num, seed)
    return {
        **bootstrap.drawn_samples(drivers, times, parameters.triggers.threshold),
        **bootstrap.drawn_triggers(counts, times),
        **bootstrap.drawn_at_rate(operating, times, parameters.false_per_km),
    }


def _intervals(drawn: bootstrap.Drawn, num_drivers: int) -> dict[str, list[float]]:
    """95 % intervals of the scores that have one; none of too few drivers."""
    if num_drivers < bootstrap.FEWEST_DRIVERS:
        return {}
    found = {name: bootstrap.interval_95(values) for name, values in drawn.items()}
    return {name: list(ends) for name, ends in found.items() if ends is not None}


def plain(value: Any) -> Any:  # Any: a tree of numbers for JSON
    """NumPy numbers as Python's, NaN as None."""
    if isinstance(value, dict):
        return {name: plain(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(part) for part in value]
    if isinstance(value, (float, np.floating)):
        return float(value) if math.isfinite(value) else None
    return int(value) if isinstance(value, np.integer) else value
