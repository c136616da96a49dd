"""Judge a network on recordings: samples, triggers, drivers, uncertainty.

Judged are all samples with a verdict and a known answer, at natural prevalence.
Intervals are 95 % percentiles of a bootstrap that resamples drivers, because samples
of one driver are not independent.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.gru import NetworkWeights
from costeer.intention.wavefront import crossing_probabilities
from costeer.training import metrics
from costeer.training.recordings import Recording
from costeer.training.triggers import (
    TriggerCounts,
    TriggerParameters,
    judge,
    total,
    trigger_scores,
)


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


class DriverVerdicts(NamedTuple):
    """Everything that is judged of one driver.

    Attributes:
        driver: Who.
        recordings: His or her stretches.
        probabilities: Verdicts of each stretch, NaN where none, `(time,)` each.
    """

    driver: str
    recordings: list[Recording]
    probabilities: list[NDArray[np.float64]]


def verdicts(
    weights: NetworkWeights, recordings: Sequence[Recording]
) -> list[DriverVerdicts]:
    """Run the exact window over all recordings, by driver in order of name."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        run = pool.map(
            lambda r: crossing_probabilities(weights, r.features), recordings
        )
        pairs = list(zip(recordings, run, strict=True))
    names = sorted({r.driver for r in recordings})
    return [
        DriverVerdicts(
            driver=name,
            recordings=[r for r, _ in pairs if r.driver == name],
            probabilities=[p for r, p in pairs if r.driver == name],
        )
        for name in names
    ]


def judged_samples(
    drivers: Sequence[DriverVerdicts],
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Probability and truth wherever both are known, all drivers in one row."""
    said, truth = [], []
    for one in drivers:
        for recording, probability in zip(
            one.recordings, one.probabilities, strict=True
        ):
            rows = np.isfinite(probability) & recording.labels.known
            said.append(probability[rows])
            truth.append(recording.labels.positive[rows])
    return np.concatenate(said), np.concatenate(truth)


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


def trigger_counts(
    driver: DriverVerdicts, parameters: TriggerParameters
) -> TriggerCounts:
    """Triggers and leads of one driver."""
    pairs = zip(driver.recordings, driver.probabilities, strict=True)
    return total([judge(r, p, parameters) for r, p in pairs])


def at_false_rate(
    drivers: Sequence[DriverVerdicts], parameters: EvaluationParameters
) -> dict[str, float]:
    """Trigger scores at the lowest threshold that keeps to the false-trigger rate.

    Empty if no threshold up to 0.999 does.
    """
    found: dict[str, float] = {}
    for logit in np.arange(7.0, -7.0, -0.25):
        threshold = float(1.0 / (1.0 + np.exp(-logit)))
        triggers = parameters.triggers._replace(threshold=threshold)
        counts = [trigger_counts(one, triggers) for one in drivers]
        score = trigger_scores(total(counts))
        if not score["false_per_km"] <= parameters.false_per_km:
            break
        found = {"threshold": threshold, **score}
    return found


def evaluate(
    weights: NetworkWeights,
    recordings: Sequence[Recording],
    parameters: EvaluationParameters = DEFAULTS,
) -> dict[str, Any]:
    """Judge the network; the result is plain numbers, lists and dictionaries.

    Raises:
        ValueError: If no sample can be judged.
    """
    drivers = verdicts(weights, recordings)
    probability, positive = judged_samples(drivers)
    if len(probability) == 0:
        raise ValueError(
            "no sample can be judged: a verdict needs 180 valid samples in a row, an "
            "answer 3 s of driving after it"
        )
    counts = [trigger_counts(one, parameters.triggers) for one in drivers]
    threshold = parameters.triggers.threshold
    result = {
        "num_drivers": len(drivers),
        "num_samples": len(probability),
        "hours": total(counts).hours,
        "kilometres": total(counts).kilometres,
        "threshold": threshold,
        "samples": sample_scores(probability, positive, threshold),
        "triggers": trigger_scores(total(counts)),
        "at_false_rate": at_false_rate(drivers, parameters),
        "calibration": [
            b._asdict() for b in metrics.calibration(probability, positive)
        ],
        "between_drivers": _spread(drivers, counts, threshold),
        "interval_95": _intervals(drivers, counts, parameters),
    }
    return {name: _plain(value) for name, value in result.items()}


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


def _intervals(
    drivers: Sequence[DriverVerdicts],
    counts: Sequence[TriggerCounts],
    parameters: EvaluationParameters,
) -> dict[str, list[float]]:
    """95 % intervals of the main scores by resampling drivers."""
    rng = np.random.default_rng(parameters.seed)
    num = len(drivers)
    times = rng.multinomial(num, np.full(num, 1.0 / num), parameters.num_resamples)
    per_driver = [judged_samples([one]) for one in drivers]
    binned = [metrics.binned_counts(*pair) for pair in per_driver]
    positives = times @ np.array([p for p, _ in binned])
    negatives = times @ np.array([n for _, n in binned])
    threshold = parameters.triggers.threshold
    cells = np.array([metrics.confusion(*pair, threshold) for pair in per_driver])
    drawn: dict[str, NDArray[np.float64]] = {
        "pr_auc": metrics.pr_auc(positives, negatives),
        "roc_auc": metrics.roc_auc(positives, negatives),
        **metrics.scores(metrics.Confusion(*(times @ cells).T)),
        **_resampled_triggers(times, counts),
    }
    return {
        name: [float(v) for v in np.nanpercentile(values, [2.5, 97.5])]
        for name, values in drawn.items()
        if np.isfinite(values).any()
    }


def _resampled_triggers(
    times: NDArray[np.int64], counts: Sequence[TriggerCounts]
) -> dict[str, NDArray[np.float64]]:
    """False triggers per kilometre and median lead of each resampling."""
    false = times @ np.array([c.false for c in counts], np.float64)
    driven = times @ np.array([c.kilometres for c in counts])
    leads = np.array([lead for c in counts for lead in c.leads])
    of_driver = np.repeat(np.arange(len(counts)), [len(c.leads) for c in counts])
    medians = np.full(len(times), np.nan)
    for i, row in enumerate(times):
        drawn = np.repeat(leads, row[of_driver])
        medians[i] = np.median(drawn) if len(drawn) else np.nan
    with np.errstate(invalid="ignore", divide="ignore"):
        return {"false_per_km": false / driven, "lead_time_median": medians}


def _plain(value: Any) -> Any:  # Any: a tree of numbers for JSON
    """NumPy numbers as Python's, NaN as None."""
    if isinstance(value, dict):
        return {name: _plain(part) for name, part in value.items()}
    if isinstance(value, list):
        return [_plain(part) for part in value]
    if isinstance(value, (float, np.floating)):
        return float(value) if math.isfinite(value) else None
    return int(value) if isinstance(value, np.integer) else value
