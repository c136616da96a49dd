"""How good are probabilities: curves, confusion and calibration.

The curves take counts of positives and negatives per level of the score, highest
level first, along the last axis. Levels may be all the values that occur (exact) or
bins; so one function serves a set of samples and a thousand resamplings of it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy.typing import NDArray

Counts = NDArray[np.float64]
Probabilities = NDArray[np.float64]
Truth = NDArray[np.bool_]
Loss: TypeAlias = Callable[[Probabilities, Truth], float]
"""Mean of a loss over samples."""

NUM_BINS = 2000


def level_counts(
    probability: Float[Probabilities, " sample"], positive: Bool[Truth, " sample"]
) -> tuple[Float[Counts, " level"], Float[Counts, " level"]]:
    """Positives and negatives at each value that occurs, highest first."""
    values, level = np.unique(-probability, return_inverse=True)
    return _counted(level, positive, len(values))


def bin_edges(
    probability: Float[Probabilities, " sample"], positive: Bool[Truth, " sample"]
) -> Float[Probabilities, " edge"]:
    """Edges of bins that hold about as many samples of each class, ascending.

    Quantiles of both classes, so that the bins follow any monotone change of the score:
    a predictor that says everything near 1 is not counted more coarsely than others.
    """
    share = np.linspace(0.0, 1.0, NUM_BINS // 2 + 1)
    classes = [probability[positive], probability[~positive]]
    cuts = [
        np.quantile(one, share, method="inverted_cdf") for one in classes if len(one)
    ]
    return np.unique(np.concatenate([np.empty(0), *cuts]))


def binned_counts(
    probability: Float[Probabilities, " sample"],
    positive: Bool[Truth, " sample"],
    edges: Float[Probabilities, " edge"],
) -> tuple[Float[Counts, " level"], Float[Counts, " level"]]:
    """Positives and negatives between the edges, highest first; one more than edges."""
    level = len(edges) - np.searchsorted(edges, probability, side="right")
    return _counted(level, positive, len(edges) + 1)


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


def balanced(counts: Confusion) -> Confusion:
    """The same answers if half of all samples were positive; each class sums to 0.5."""
    tp, fp, fn, tn = counts
    with np.errstate(invalid="ignore", divide="ignore"):
        yes, no = 0.5 / (tp + fn), 0.5 / (tn + fp)
        return Confusion(tp * yes, fp * no, fn * yes, tn * no)


def balanced_levels(
    positives: Float[Counts, "*batch level"], negatives: Float[Counts, "*batch level"]
) -> tuple[Float[Counts, "*batch level"], Float[Counts, "*batch level"]]:
    """Counts per level if half of all samples were positive; each class sums to 0.5."""
    with np.errstate(invalid="ignore", divide="ignore"):
        yes = 0.5 * positives / positives.sum(axis=-1, keepdims=True)
        no = 0.5 * negatives / negatives.sum(axis=-1, keepdims=True)
    return yes, no


def with_even_odds(
    probability: Float[Probabilities, " sample"], prevalence: float
) -> Float[Probabilities, " sample"]:
    """What was said at one prevalence, as it would be said if half were positive.

    Bayes: the odds are divided by those of the prevalence.
    """
    yes, no = probability * (1.0 - prevalence), (1.0 - probability) * prevalence
    return np.asarray(yes / np.maximum(yes + no, 1e-300))


def pr_curve(
    positives: Float[Counts, " level"], negatives: Float[Counts, " level"]
) -> tuple[Float[Counts, " level"], Float[Counts, " level"]]:
    """Recall and precision at each level, highest level first."""
    true, false = np.cumsum(positives), np.cumsum(negatives)
    return true / max(true[-1], 1.0), true / np.maximum(true + false, 1e-300)


def roc_curve(
    positives: Float[Counts, " level"], negatives: Float[Counts, " level"]
) -> tuple[Float[Counts, " level"], Float[Counts, " level"]]:
    """Share of the negatives and of the positives above each level."""
    true, false = np.cumsum(positives), np.cumsum(negatives)
    return false / max(false[-1], 1.0), true / max(true[-1], 1.0)


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
