"""All predictors by name, in the order of spec section 9."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.intention.predictors import (
    crossing_time,
    gru,
    head_only,
    line_time,
    logistic,
    support_vectors,
)
from costeer.intention.predictors.interface import Predictor, Probabilities
from costeer.intention.predictors.store import KINDS, Baseline, load_baselines
from costeer.intention.weights import load_weights

OURS = "gru"
PREDICTORS: tuple[str, ...] = (*KINDS, OURS)
"""Names, the rivals of spec section 9 first."""

TITLES: dict[str, tuple[str, str]] = {
    "line-time": ("Time to lane crossing", "Tsoi, Mulder, Abbink (2010)"),
    "logistic": ("Logistic regression", "Cox (1958)"),
    "support-vectors": ("Support vector machine", "Kumar et al. (2013)"),
    "head-only": ("Head only", "Lethaus et al. (2013)"),
    "crossing-time": ("LSTM, time to crossing", "Dang et al. (2017)"),
    "paper-gru": ("GRU of the paper", "Yan et al."),
    OURS: ("GRU with hidden signals", "Yan et al., ours"),
}
"""Title and publication of each."""

NEEDS: dict[str, tuple[str, ...]] = {
    "line-time": line_time.NEEDS,
    "logistic": logistic.NEEDS,
    "support-vectors": support_vectors.NEEDS,
    "head-only": head_only.NEEDS,
    "crossing-time": crossing_time.NEEDS,
    "paper-gru": gru.PAPER_NEEDS,
    OURS: gru.OUR_NEEDS,
}
"""Signals without which each says nothing."""


def predictor(name: str, path: Path | None = None) -> Predictor:
    """One predictor.

    Args:
        name: One of `PREDICTORS`.
        path: File of its numbers: for "gru" one of weights (intention/weights.py), else
            one of fitted predictors (store.py); those that ship with costeer if not
            given.

    Raises:
        ValueError: If the name is unknown, or the file cannot be read as such a file or
            lacks the predictor.
        OSError: If the file cannot be read.
    """
    check_name(name)
    if name == OURS:
        weights = load_weights(path).weights
        return _named(name, _bound(gru.our_probabilities, weights))
    fitted = load_baselines(path)
    if name not in fitted:
        raise ValueError(
            f"{path or 'the shipped file'} holds no fitted {name!r}; it holds "
            f"{', '.join(fitted) or 'none'}: fit it with training.predictors"
        )
    return fitted_predictor(name, fitted[name])


def fitted_predictor(name: str, baseline: Baseline) -> Predictor:
    """The predictor that a fit gives.

    Raises:
        ValueError: If the name is not of a fit that the store keeps.
    """
    if name not in KINDS:
        raise ValueError(f"{name!r} is none of the fits {', '.join(KINDS)}")
    return _named(name, _probabilities(name, baseline.variants))


def check_name(name: str) -> None:
    """Refuse an unknown name.

    Raises:
        ValueError: Naming it and the known ones.
    """
    if name not in PREDICTORS:
        raise ValueError(
            f"there is no predictor {name!r}; known are {', '.join(PREDICTORS)}"
        )


def _named(name: str, probabilities: Probabilities) -> Predictor:
    title, source = TITLES[name]
    return Predictor(name, title, source, NEEDS[name], probabilities)


def _probabilities(name: str, variants: Mapping[str, Any]) -> Probabilities:
    """The function of one kind, bound to its numbers."""
    if name == "logistic":
        return _bound(logistic.crossing_probabilities, variants)
    if name == "support-vectors":
        return _bound(support_vectors.crossing_probabilities, variants)
    if name == "crossing-time":
        return _bound(crossing_time.crossing_probabilities, variants)
    (only,) = variants.values()
    if name == "line-time":
        return _bound(line_time.crossing_probabilities, only)
    if name == "head-only":
        return _bound(head_only.crossing_probabilities, only)
    return _bound(gru.paper_probabilities, only)


def _bound(function: Any, numbers: Any) -> Probabilities:
    """A predictor's function with its numbers filled in."""

    def probabilities(
        features: NDArray[np.float64], absent: tuple[str, ...] = ()
    ) -> NDArray[np.float64]:
        said: NDArray[np.float64] = function(numbers, features, absent)
        return said

    return probabilities
