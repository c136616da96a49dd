"""The paper's network: the six signals of Eq. (1) on a two-lane road, nothing hidden.

It is fitted as ours is (training/fit.py), but on windows with all signals only and
without the input that is a product of two; the paper trains it on a road of two lanes.
The paper does not print the hidden size.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from costeer.intention.features import NUM_FEATURES
from costeer.intention.gru import NetworkWeights
from costeer.intention.predictors.store import Baseline
from costeer.training.augmentation import ALL_SIGNALS, dispensable
from costeer.training.dataset import DatasetParameters, Split, windows
from costeer.training.fit import FitParameters, fit
from costeer.training.scaling import scaling

HIDDEN = 32
"""Hidden units [-]. Source: assumed, more brought nothing on validation drivers."""

FIT = FitParameters(num_steps=4000, augmentation=ALL_SIGNALS)
DATASET = DatasetParameters()


_SILENT = 1e12
"""Standard deviation that makes an input vanish [m/s]."""


def fit_paper_network(
    split: Split,
    seed: int,
    progress: Callable[[int], None] | None = None,
    parameters: FitParameters = FIT,
    hidden: int = HIDDEN,
) -> Baseline:
    """The network with what its fit was.

    Args:
        split: Training drivers to learn from, validation drivers to stop by.
        seed: Of the first weights and the order of windows.
        progress: Told how many steps were done.
        parameters: How long and how fast.
        hidden: Size of the hidden state.

    Raises:
        ValueError: If the recordings do not suffice.
    """
    scale = scaling(split.training, dispensable(parameters.augmentation))
    silent = np.append(scale.scale[:NUM_FEATURES], _SILENT)
    data = windows(split.training, DATASET)
    found = fit(
        data,
        scale._replace(scale=silent),
        split.validation,
        hidden,
        seed,
        parameters,
        progress,
    )
    facts = {"hidden_size": hidden, "validation": found.best._asdict()}
    return Baseline({"full": signals_only(found.weights)}, facts)


def signals_only(weights: NetworkWeights) -> NetworkWeights:
    """The network with no input but the six signals: weights of the others are 0."""
    inputs = weights.input_weights.copy()
    inputs[:, :, NUM_FEATURES:] = 0.0
    deviations = np.append(weights.feature_scale[:NUM_FEATURES], 1.0)
    return weights._replace(input_weights=inputs, feature_scale=deviations)
