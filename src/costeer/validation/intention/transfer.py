"""From virtual drivers to people: as it comes, and after learning from some of them.

What was learned on virtual drivers is tried on recordings of people without a change.
Beside it stand the same after learning from other people of the same set: the network
fine-tuned, the logistic regression fitted anew. For these the vehicles are dealt to
folds, and each is judged by what learned from the others only.

Needs the extra `train`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import full_windows
from costeer.intention.gru import NetworkWeights
from costeer.intention.predictors.gru import our_probabilities
from costeer.intention.predictors.interface import Probabilities
from costeer.intention.predictors.registry import fitted_predictor, predictor
from costeer.training.ablation import variant_of
from costeer.training.comparison import (
    Comparison,
    Contender,
    compare_verdicts,
    contender,
)
from costeer.training.dataset import DatasetParameters
from costeer.training.datasets.folds import folds
from costeer.training.predictors.logistic import DEFAULTS as LOGISTIC
from costeer.training.predictors.logistic import fit_logistic
from costeer.training.predictors.samples import feature_scaling, summary_table
from costeer.training.recordings import Recording
from costeer.training.tuning import DEFAULTS as TUNING
from costeer.training.tuning import fine_tuned
from costeer.training.verdicts import asked

NUM_FOLDS = 4
RIVALS = ("line-time", "logistic", "crossing-time", "head-only")
"""Predictors of virtual drivers that can do without head and wheel, or with the head
alone."""

Learner = Callable[[list[Recording]], Probabilities]


def transfer(
    network: NetworkWeights,
    recordings: Sequence[Recording],
    seed: int,
    num_folds: int = NUM_FOLDS,
) -> Comparison:
    """Predictors of virtual drivers and of people, side by side.

    Args:
        network: Trained on virtual drivers; the reference.
        recordings: Of people, all with the same signals.
        seed: Of the folds and of what is learned.
        num_folds: Into which the drivers are dealt.
    """
    ours = asked(partial(our_probabilities, network), recordings)
    rows = [
        *(contender(predictor(name), recordings) for name in RIVALS),
        Contender("gru", "GRU with hidden signals", "", ours),
        Contender(
            "logistic-people",
            "Logistic regression, fitted to people",
            "",
            out_of_fold(recordings, num_folds, seed, _logistic),
        ),
        Contender(
            "gru-people",
            "GRU, fine-tuned to people",
            "",
            out_of_fold(recordings, num_folds, seed, partial(_tuned, network, seed)),
        ),
    ]
    return compare_verdicts(rows, recordings, "gru")


def out_of_fold(
    recordings: Sequence[Recording], num_folds: int, seed: int, learn: Learner
) -> list[NDArray[np.float64]]:
    """Verdicts on each recording by what learned from the other folds only.

    Args:
        recordings: Of at least as many drivers as folds.
        num_folds: Into which the drivers are dealt.
        seed: Of the folds.
        learn: From recordings to a predictor.
    """
    place = {id(recording): k for k, recording in enumerate(recordings)}
    found = [np.full(len(recording.side), np.nan) for recording in recordings]
    for others, held_out in folds(recordings, num_folds, seed):
        said = asked(learn(others), held_out)
        for recording, verdicts in zip(held_out, said, strict=True):
            found[place[id(recording)]] = verdicts
    return found


def _tuned(
    network: NetworkWeights, seed: int, recordings: list[Recording]
) -> Probabilities:
    return partial(our_probabilities, fine_tuned(network, recordings, seed, TUNING))


def _logistic(recordings: list[Recording]) -> Probabilities:
    """Logistic regression; a fourth of the drivers chooses its penalty."""
    dataset = DatasetParameters()
    scaling = feature_scaling(recordings)
    training, choosing = _two_parts(recordings)
    matching = variant_of(recordings[0].absent)
    variants = () if matching is None else (matching,)
    fitted = fit_logistic(
        summary_table(training, scaling, dataset),
        summary_table(choosing, scaling, dataset),
        scaling,
        LOGISTIC._replace(variants=variants),
    )
    return fitted_predictor("logistic", fitted).probabilities


def _two_parts(
    recordings: list[Recording],
) -> tuple[list[Recording], list[Recording]]:
    """Drivers to fit and drivers to choose by, with lane changes in both."""
    for training, choosing in folds(recordings, NUM_FOLDS, 0):
        if _changes_lanes(training) and _changes_lanes(choosing):
            return training, choosing
    return recordings, recordings


def _changes_lanes(recordings: Sequence[Recording]) -> bool:
    """Whether some full window precedes a crossing."""
    return any(
        bool((full_windows(r.features, r.absent) & r.labels.positive)[::6].any())
        for r in recordings
    )
