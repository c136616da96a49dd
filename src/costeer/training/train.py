"""From recordings to a network with its papers: split, fit, choose the size, judge."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from costeer.drivers.population import POPULATION_VERSION
from costeer.intention.features import VARIANTS
from costeer.intention.predictors.gru import our_probabilities
from costeer.intention.predictors.interface import Probabilities
from costeer.intention.weights import IntentionNetwork, intention_network
from costeer.training.augmentation import dispensable
from costeer.training.dataset import (
    DatasetParameters,
    Split,
    shown,
    split_by_driver,
    windows,
)
from costeer.training.evaluate import EvaluationParameters, evaluate, sample_scores
from costeer.training.fit import Fit, FitParameters, fit, trained_variants
from costeer.training.recordings import Recording, lacking
from costeer.training.scaling import scaling
from costeer.training.verdicts import judged_samples, verdicts


class TrainingParameters(NamedTuple):
    """All that a training depends on besides recordings and seed.

    Attributes:
        hidden_sizes: Candidates, small ones first [-]. Source: assumed; the time of a
            verdict grows with the square.
        tolerance: The smallest size whose validation PR-AUC, mean over the variants of
            the signals, is within this of the best one is taken [-]. Source: assumed,
            less than the spread between seeds.
        dataset: Who is in which part and which samples are used.
        fit: How long and how fast.
        evaluation: How the result is judged.
    """

    hidden_sizes: tuple[int, ...] = (8, 16, 32)
    tolerance: float = 0.005
    dataset: DatasetParameters = DatasetParameters()
    fit: FitParameters = FitParameters()
    evaluation: EvaluationParameters = EvaluationParameters()


DEFAULTS = TrainingParameters()


def train(
    recordings: Sequence[Recording],
    seed: int,
    parameters: TrainingParameters = DEFAULTS,
    source: str = "recordings",
    progress: Callable[[int], None] | None = None,
) -> IntentionNetwork:
    """Train networks of all candidate sizes and return the one that is chosen.

    Args:
        recordings: Of at least three drivers.
        seed: Of the split, the first weights and the order of windows.
        parameters: Everything else.
        source: What the recordings are, for the facts.
        progress: Told how many steps were done.

    Returns:
        With facts: source, split, learning curves, the choice, and the judgement of
        drivers who had no part in training or choice.

    Raises:
        ValueError: If the recordings do not suffice.
    """
    split = split_by_driver(recordings, seed, parameters.dataset)
    scale = scaling(split.training, dispensable(parameters.fit.augmentation))
    data = windows(shown(split.training), parameters.dataset)
    fits = {
        hidden: fit(
            data, scale, split.validation, hidden, seed, parameters.fit, progress
        )
        for hidden in parameters.hidden_sizes
    }
    hidden = chosen_size(fits, parameters.tolerance)
    weights = fits[hidden].weights
    predict = partial(our_probabilities, weights)
    facts = {
        "source": source,
        "population": POPULATION_VERSION,
        "seed": seed,
        "hidden_size": hidden,
        "hidden_sizes": _candidates(fits),
        "tolerance": parameters.tolerance,
        "drivers": _drivers(split),
        "training_windows": len(data.ends),
        "training_windows_positive": int(data.positive.sum()),
        "curves": {str(h): [list(p) for p in f.curve] for h, f in fits.items()},
        "test": evaluate(predict, split.test, parameters.evaluation),
        "variants": {
            variant: _variant_scores(predict, split.test, variant)
            for variant in trained_variants(parameters.fit.augmentation)
        },
    }
    return intention_network(weights, facts)


def chosen_size(fits: dict[int, Fit], tolerance: float) -> int:
    """Smallest size that is within a tolerance of the best, in the mean of variants."""
    best = max(_quality(f) for f in fits.values())
    return min(
        hidden for hidden, one in fits.items() if _quality(one) >= best - tolerance
    )


def _quality(one: Fit) -> float:
    """Validation PR-AUC, mean over the variants of the signals."""
    return float(np.mean(list(one.best.pr_auc.values())))


def _variant_scores(
    predict: Probabilities, recordings: Sequence[Recording], variant: str
) -> dict[str, float]:
    """Scores over samples without some of the signals."""
    seen = [lacking(one, VARIANTS[variant]) for one in recordings]
    return sample_scores(*judged_samples(verdicts(predict, seen)), 0.5)


def _candidates(fits: dict[int, Fit]) -> dict[str, Any]:
    return {str(hidden): one.best._asdict() for hidden, one in fits.items()}


def _drivers(split: Split) -> dict[str, list[str]]:
    return {
        name: sorted({r.driver for r in part}) for name, part in split._asdict().items()
    }
