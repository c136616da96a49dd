"""What a predictor is worth on recordings, in the words of training/evaluate.py."""

from __future__ import annotations

from collections.abc import Sequence

from costeer.intention.predictors.interface import Predictor
from costeer.training.evaluate import (
    DEFAULTS,
    EvaluationParameters,
    at_false_rate,
    judged_samples,
    sample_scores,
    verdicts,
)
from costeer.training.recordings import Recording


def predictor_scores(
    predictor: Predictor,
    recordings: Sequence[Recording],
    parameters: EvaluationParameters = DEFAULTS,
) -> dict[str, float]:
    """Main scores: of samples, and of triggers at the comparable false rate.

    Empty if the predictor says nothing on these recordings.
    """
    drivers = verdicts(predictor.probabilities, recordings)
    said, truth = judged_samples(drivers)
    if len(said) == 0 or not 0 < truth.sum() < len(truth):
        return {}
    scores = sample_scores(said, truth, parameters.triggers.threshold)
    found = {n: scores[n] for n in ("pr_auc", "roc_auc", "log_loss", "brier")}
    rated = at_false_rate(drivers, parameters)
    wanted = ("threshold", "false_per_km", "lead_time_median", "missed_share")
    return found | {n: rated[n] for n in wanted if n in rated}
