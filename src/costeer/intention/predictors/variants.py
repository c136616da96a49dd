"""Which coefficients speak: signals that a recording lacks, and a head that is lost.

A predictor that is fitted once per variant of `features.VARIANTS` uses the one with
most signals of those that are there. A lost head keeps its last yaw for a second; then
the variant that does without it speaks until the head is back.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import (
    FEATURES,
    HEAD_YAW,
    SAMPLE_RATE,
    VARIANTS,
    full_windows,
)

HEAD_MEMORY = 1.0
"""How long a lost head keeps its last yaw [s]. Source: assumed, a long glance."""

Weights = TypeVar("Weights")
_Given = TypeVar("_Given", contravariant=True)


class Spoken(Protocol[_Given]):
    """Probability of a crossing within 3 s at every sample, see `by_variant`."""

    def __call__(
        self,
        weights: Mapping[str, _Given],
        features: NDArray[np.float64],
        absent: tuple[str, ...] = (),
    ) -> NDArray[np.float64]:
        """Shape `(time,)`, from the weights by variant."""


Verdict = Callable[[Weights, tuple[str, ...], NDArray[np.float64]], NDArray[np.float64]]


def signals_of(variant: str) -> tuple[str, ...]:
    """Signals that a variant uses, in the order of `FEATURES`."""
    return tuple(name for name in FEATURES if name not in VARIANTS[variant])


def richest_variant(names: Collection[str], absent: tuple[str, ...]) -> str | None:
    """The variant with most signals, all of them present; None if there is none.

    Args:
        names: Variants to choose from, keys of `features.VARIANTS`.
        absent: Signals that are not there.
    """
    fits = [n for n in VARIANTS if n in names and not set(signals_of(n)) & set(absent)]
    return max(fits, key=lambda name: len(signals_of(name)), default=None)


def held_head(
    features: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Bridge a lost head.

    Args:
        features: Facing right, head yaw NaN where lost, shape `(time, feature)`.

    Returns:
        The features with the last head yaw where it is lost, straight ahead before the
        first; and whether the head was seen within `HEAD_MEMORY`, shape `(time,)`.
    """
    head = features[:, HEAD_YAW]
    here = np.arange(len(head))
    last = np.maximum.accumulate(np.where(np.isfinite(head), here, -1))
    held = features.copy()
    held[:, HEAD_YAW] = np.where(last >= 0, head[np.maximum(last, 0)], 0.0)
    return held, (last >= 0) & (here - last <= HEAD_MEMORY * SAMPLE_RATE)


def by_variant(verdict: Verdict[Weights]) -> Spoken[Weights]:
    """Verdicts at every sample from those of single variants.

    Args:
        verdict: From weights, the signals they use and features without lost heads.

    Returns:
        A function of the weights by variant, the features, shape `(time, feature)`,
        facing right and NaN where missing, and the signals that the recording does not
        have. It gives the probability of a crossing within 3 s, shape `(time,)`: of the
        variant that fits, NaN where no full window of valid samples ends or no variant
        can speak.
    """

    def crossing_probabilities(
        weights: Mapping[str, Weights],
        features: NDArray[np.float64],
        absent: tuple[str, ...] = (),
    ) -> NDArray[np.float64]:
        held, seen = held_head(features)

        def spoken(missing: tuple[str, ...]) -> NDArray[np.float64]:
            name = richest_variant(weights.keys(), missing)
            if name is None:
                return np.full(len(features), np.nan)
            return verdict(weights[name], signals_of(name), held)

        said = spoken(absent)
        if "head_yaw" not in absent and not seen.all():
            said = np.where(seen, said, spoken((*absent, "head_yaw")))
        return np.where(full_windows(features, absent), said, np.nan)

    return crossing_probabilities
