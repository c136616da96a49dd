"""What each signal is worth: the same predictor with signals taken away.

All rows are judged at the samples where each of them has a verdict; the one with all
signals that the recordings have is the reference.
"""

from __future__ import annotations

from collections.abc import Sequence

from costeer.intention.features import FEATURES, VARIANTS
from costeer.intention.predictors.interface import Predictor
from costeer.training.comparison import (
    Comparison,
    Contender,
    compare_verdicts,
    contender,
)
from costeer.training.evaluate import DEFAULTS, EvaluationParameters
from costeer.training.recordings import Recording, lacking

TITLES = {
    "full": "all signals",
    "no-head": "no head",
    "no-wheel": "no wheel",
    "motion": "no head, no wheel",
    "motion-without-place": "no head, no wheel, no place",
    "head": "head only",
}
"""Variants in words; "head only" keeps the speed beside the head."""


def ablations(
    predictor: Predictor,
    recordings: Sequence[Recording],
    parameters: EvaluationParameters = DEFAULTS,
) -> Comparison:
    """Judge a predictor with signals taken away; "full" is the reference.

    Args:
        predictor: To judge.
        recordings: With as many signals as there are.
        parameters: How it is judged.

    Raises:
        ValueError: If it can judge in no variant.
    """
    rows = [_row(predictor, recordings, name) for name in _different(recordings)]
    return compare_verdicts(rows, recordings, rows[0].name, parameters)


def _different(recordings: Sequence[Recording]) -> list[str]:
    """Variants that leave different signals, the richest first."""
    found: dict[tuple[tuple[str, ...], ...], str] = {}
    for name, absent in VARIANTS.items():
        left = tuple(lacking(r, absent).absent for r in recordings)
        found.setdefault(left, name)
    return list(found.values())


def _row(
    predictor: Predictor, recordings: Sequence[Recording], variant: str
) -> Contender:
    seen = [lacking(r, VARIANTS[variant]) for r in recordings]
    title = TITLES.get(variant, variant)
    return contender(predictor._replace(name=variant, title=title), seen)


def variant_of(absent: Sequence[str]) -> str | None:
    """Name of the variant that lacks exactly these signals; None if there is none."""
    lacked = tuple(name for name in FEATURES if name in absent)
    for name, signals in VARIANTS.items():
        if tuple(n for n in FEATURES if n in signals) == lacked:
            return name
    return None
