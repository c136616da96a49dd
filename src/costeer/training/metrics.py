"""How good are probabilities: curves, confusion and calibration.

The curves take counts of positives and negatives per level of the score, highest
level first, along the last axis. Levels may be all the values that occur (exact) or
bins; so one function serves a set of samples and a thousand resamplings of it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy.typing import NDArray

Counts = NDArray[np.float64]
Probabilities = NDArray[np.float64]
Truth = NDArray[np.bool_]

NUM_BINS = 2000
_LARGEST_LOGIT = 15.0


def level_counts(
    probability: Float[Probabilities, " sample"], positive: Bool[Truth, " sample"]
) -> tuple[Float[Counts, " level"], Float[Counts, " level"]]:
    """Positives and negatives at each value that occurs, highest first."""
    values, level = np.unique(-probability, return_inverse=True)
    return _counted(level, positive, len(values))


def binned_counts(
    probability: Float[Probabilities, " sample"], positive: Bool[Truth, " sample"]
) -> tuple[Float[Counts, " level"], Float[Counts, " level"]]:
    """Positives and negatives in `NUM_BINS` bins of the logit, highest first."""
    tiny = 1e-12
    held = np.clip(probability, tiny, 1.0 - tiny)
    logit = np.log(held / (1.0 - held))
    place = (_LARGEST_LOGIT - logit) / (2.0 * _LARGEST_LOGIT) * NUM_BINS
    level = np.clip(place, 0, NUM_BINS - 1).astype(np.int64)
    return _counted(level, positive, NUM_BINS)


def _counted(
    level: Int[NDArray[np.int64], " sample"],
    positive: Bool[Truth, " sample"],
    num_levels: int,
) -> tuple[Float[Counts, " level"], Float[Counts, " level"]]:
    yes = np.bincount(level[positive], minlength=num_levels)
    no = np.bincount(level[~positive], minlength=num_levels)
    return yes.astype(np.float64), no.astype(np.float64)


def pr_auc(
    positives: Float[Counts, "*batch level"], negatives: Float[Counts, "*batch level"]
) -> Float[Counts, "*batch"]:
    """Area under precision over recall: average precision, without interpolation.

    Returns:
        One number per member of the batch; NaN without positives.
    """
    true, false = np.cumsum(positives, axis=-1), np.cumsum(negatives, axis=-1)
    total = true[..., -1]
    precision = true / np.maximum(true + false, 1e-300)
    with np.errstate(invalid="ignore"):
        return np.asarray((precision * positives).sum(axis=-1) / total)


def roc_auc(
    positives: Float[Counts, "*batch level"], negatives: Float[Counts, "*batch level"]
) -> Float[Counts, "*batch"]:
    """Chance that a positive scores above a negative, ties count half.

    Returns:
        One number per member of the batch; NaN if a class is missing.
    """
    above = np.cumsum(positives, axis=-1) - 0.5 * positives
    pairs = positives.sum(axis=-1) * negatives.sum(axis=-1)
    with np.errstate(invalid="ignore"):
        return np.asarray((above * negatives).sum(axis=-1) / pairs)


class Confusion(NamedTuple):
    """Counts at one threshold; arrays along any batch axes.

    Attributes:
        true_positive: Said yes, was yes.
        false_positive: Said yes, was no.
        false_negative: Said no, was yes.
        true_negative: Said no, was no.
    """

    true_positive: Counts
    false_positive: Counts
    false_negative: Counts
    true_negative: Counts


def confusion(
    probability: Float[Probabilities, " sample"],
    positive: Bool[Truth, " sample"],
    threshold: float,
) -> Confusion:
    """Count the four cases; at the threshold the answer is yes."""
    said = probability >= threshold
    return Confusion(
        true_positive=np.asarray(np.sum(said & positive, dtype=np.float64)),
        false_positive=np.asarray(np.sum(said & ~positive, dtype=np.float64)),
        false_negative=np.asarray(np.sum(~said & positive, dtype=np.float64)),
        true_negative=np.asarray(np.sum(~said & ~positive, dtype=np.float64)),
    )


def scores(counts: Confusion) -> dict[str, Counts]:
    """Accuracy beside that of the answer "never", balanced accuracy, F1 and parts."""
    tp, fp, fn, tn = counts
    with np.errstate(invalid="ignore", divide="ignore"):
        recall, specificity = tp / (tp + fn), tn / (tn + fp)
        found = {
            "prevalence": (tp + fn) / (tp + fp + fn + tn),
            "accuracy": (tp + tn) / (tp + fp + fn + tn),
            "accuracy_of_never": (fp + tn) / (tp + fp + fn + tn),
            "balanced_accuracy": (recall + specificity) / 2.0,
            "precision": tp / (tp + fp),
            "recall": recall,
            "f1": 2.0 * tp / (2.0 * tp + fp + fn),
        }
    return {name: np.asarray(value) for name, value in found.items()}


def brier(
    probability: Float[Probabilities, " sample"], positive: Bool[Truth, " sample"]
) -> float:
    """Mean squared difference of probability and truth."""
    return float(np.mean((probability - positive) ** 2))


def log_loss(
    probability: Float[Probabilities, " sample"], positive: Bool[Truth, " sample"]
) -> float:
    """Mean negative log of the probability given to the truth [nat]."""
    of_truth = np.where(positive, probability, 1.0 - probability)
    return float(-np.mean(np.log(np.maximum(of_truth, 1e-12))))


class CalibrationBin(NamedTuple):
    """Samples whose probability lies in one tenth.

    Attributes:
        probability: Mean of what was said [-].
        observed: Share that was positive [-].
        num_samples: In the bin.
    """

    probability: float
    observed: float
    num_samples: int


def calibration(
    probability: Float[Probabilities, " sample"], positive: Bool[Truth, " sample"]
) -> list[CalibrationBin]:
    """Said against observed in tenths of the probability; empty tenths are left out."""
    tenth = np.minimum((probability * 10.0).astype(np.int64), 9)
    found = []
    for place in range(10):
        rows = tenth == place
        if rows.any():
            said, seen = float(probability[rows].mean()), float(positive[rows].mean())
            found.append(CalibrationBin(said, seen, int(rows.sum())))
    return found


def calibration_error(bins: list[CalibrationBin]) -> float:
    """Mean distance of said and observed, weighted by samples."""
    total = sum(b.num_samples for b in bins)
    gap = sum(b.num_samples * abs(b.probability - b.observed) for b in bins)
    return gap / total if total else float("nan")
