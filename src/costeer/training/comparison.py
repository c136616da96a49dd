"""Several predictors on the same recordings and the same samples.

Judged are the samples at which every predictor that can judge the recordings has a
verdict, so that all rows of a table have the same kilometres and the same crossings. A
predictor that cannot, because a signal that it needs is absent, is listed with the
reason.

Differences to a reference predictor have intervals from the same resamplings of the
drivers for both: better or worse if the 95 % interval excludes 0, else a tie.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import full_windows
from costeer.intention.predictors.interface import Predictor, lacking
from costeer.training.bootstrap import AT_RATE, FEWEST_DRIVERS, interval_95
from costeer.training.evaluate import (
    DEFAULTS,
    EvaluationParameters,
    Judgement,
    judgement,
    plain,
)
from costeer.training.operating import operating_curve
from costeer.training.recordings import Recording
from costeer.training.verdicts import asked, by_driver

BETTER, WORSE, TIE, UNKNOWN = "better", "worse", "tie", "unknown"
COMPARED = ("pr_auc", AT_RATE)
"""Scores whose difference to the reference is judged."""


class Contender(NamedTuple):
    """A row of a comparison before it is judged.

    Attributes:
        name: By which it is chosen.
        title: In tables and figures.
        source: Publication that it is built from.
        probabilities: Verdicts on each recording, NaN where none, `(time,)` each.
        reason: Why it cannot judge the recordings; empty if it can.
    """

    name: str
    title: str
    source: str
    probabilities: list[NDArray[np.float64]]
    reason: str = ""


class Difference(NamedTuple):
    """A score minus that of the reference.

    Attributes:
        value: In the unit of the score.
        low: Lower end of the 95 % interval over drivers, NaN if unknown.
        high: Upper end.
        verdict: "better", "worse", "tie", or "unknown" with too few drivers.
    """

    value: float
    low: float
    high: float
    verdict: str


class Judged(NamedTuple):
    """A predictor with its judgement.

    Attributes:
        name: By which it is chosen.
        title: In tables and figures.
        source: Publication that it is built from.
        coverage: Share of the samples with full windows at which it has a verdict [-].
        judgement: As `training.evaluate` judges, over the common samples.
        differences: To the reference, by score; empty for the reference itself or
            without one.
    """

    name: str
    title: str
    source: str
    coverage: float
    judgement: Judgement
    differences: dict[str, Difference]


class Excluded(NamedTuple):
    """A predictor that cannot judge the recordings, and why."""

    name: str
    title: str
    reason: str


class Comparison(NamedTuple):
    """Predictors side by side.

    Attributes:
        reference: Name of the predictor that the others are held against; empty if it
            cannot judge the recordings.
        judged: In the order in which they were given.
        excluded: Those that cannot judge.
    """

    reference: str
    judged: list[Judged]
    excluded: list[Excluded]


def contender(predictor: Predictor, recordings: Sequence[Recording]) -> Contender:
    """Ask a predictor, unless it lacks what it needs."""
    words = (predictor.name, predictor.title, predictor.source)
    needed = {n for r in recordings for n in lacking(predictor, r.absent)}
    if needed:
        names = ", ".join(name for name in predictor.needs if name in needed)
        return Contender(*words, [], f"needs {names}, which recordings lack")
    return Contender(*words, asked(predictor.probabilities, recordings))


def compare_verdicts(
    rows: Sequence[Contender],
    recordings: Sequence[Recording],
    reference: str,
    parameters: EvaluationParameters = DEFAULTS,
) -> Comparison:
    """Judge what predictors said of the same recordings, over the same samples.

    Args:
        rows: What each said, see `contender`.
        recordings: Of drivers who trained none of them.
        reference: Name of the one that the others are held against.
        parameters: How it is judged.

    Raises:
        ValueError: If none can judge the recordings, or there is no common sample.
    """
    checked = [_silence_named(row) for row in rows]
    able = [row for row in checked if not row.reason]
    excluded = [Excluded(r.name, r.title, r.reason) for r in checked if r.reason]
    if not able:
        reasons = "; ".join(f"{each.title}: {each.reason}" for each in excluded)
        raise ValueError(f"no predictor can judge these recordings: {reasons}")
    shared = _common(able)
    found = [
        Judged(
            name=row.name,
            title=row.title,
            source=row.source,
            coverage=_coverage(row, recordings),
            judgement=_judged(row, shared, recordings, parameters),
            differences={},
        )
        for row in able
    ]
    known = {one.name: one.judgement for one in found}
    held = [
        one._replace(differences=differences(one.judgement, known[reference]))
        if reference in known and one.name != reference
        else one
        for one in found
    ]
    return Comparison(reference if reference in known else "", held, excluded)


def _silence_named(row: Contender) -> Contender:
    """A row without any verdict gets its reason."""
    if row.reason or any(np.isfinite(said).any() for said in row.probabilities):
        return row
    return row._replace(
        reason="no verdict on any sample: not fitted to do without what these "
        "recordings lack, or no window of 180 valid samples"
    )


def _common(rows: Sequence[Contender]) -> list[NDArray[np.bool_]]:
    """Samples of each recording at which all rows have a verdict."""
    each = zip(*(row.probabilities for row in rows), strict=True)
    return [np.isfinite(np.stack(said)).all(axis=0) for said in each]


def _coverage(row: Contender, recordings: Sequence[Recording]) -> float:
    full = [full_windows(r.features, r.absent) for r in recordings]
    possible = sum(int(one.sum()) for one in full)
    spoken = sum(int(np.isfinite(said).sum()) for said in row.probabilities)
    return spoken / possible if possible else float("nan")


def _judged(
    row: Contender,
    shared: Sequence[NDArray[np.bool_]],
    recordings: Sequence[Recording],
    parameters: EvaluationParameters,
) -> Judgement:
    """Judge one row over the common samples."""
    pairs = zip(row.probabilities, shared, strict=True)
    seen = [np.where(common, said, np.nan) for said, common in pairs]
    try:
        return judgement(parameters, by_driver(recordings, seen))
    except ValueError as error:
        raise ValueError(
            f"the predictors have no sample in common that can be judged ({error}); "
            "compare fewer of them"
        ) from error


def differences(one: Judgement, reference: Judgement) -> dict[str, Difference]:
    """Scores of one judgement minus those of the reference, over the same drivers."""
    return {
        score: _difference(
            _value(one.facts, score) - _value(reference.facts, score),
            one.drawn[score] - reference.drawn[score],
            len(one.drivers),
        )
        for score in COMPARED
    }


def _value(facts: dict[str, Any], score: str) -> float:
    """A compared score; the lead of a predictor that must stay silent is 0."""
    if score == AT_RATE:
        silent = None if facts["num_crossings"] == 0 else 0.0
        value = facts["at_false_rate"].get("lead_time_median", silent)
    else:
        value = facts["samples"][score]
    return float("nan") if value is None else float(value)


def _difference(
    value: float, drawn: NDArray[np.float64], num_drivers: int
) -> Difference:
    ends = interval_95(drawn)
    if num_drivers < FEWEST_DRIVERS or ends is None or not np.isfinite(value):
        return Difference(value, float("nan"), float("nan"), UNKNOWN)
    low, high = ends
    verdict = BETTER if low > 0.0 else WORSE if high < 0.0 else TIE
    return Difference(value, low, high, verdict)


def excluded_told(comparison: Comparison) -> list[str]:
    """A sentence for each reason why predictors are not in the table."""
    reasons: dict[str, list[str]] = {}
    for each in comparison.excluded:
        reasons.setdefault(each.reason, []).append(each.title)
    return [
        f"Not in the table: {'; '.join(titles)}. Reason: {reason}."
        for reason, titles in reasons.items()
    ]


def comparison_facts(comparison: Comparison) -> dict[str, Any]:
    """The comparison as plain numbers, lists and dictionaries for JSON."""
    found = {
        "reference": comparison.reference or None,
        "predictors": {one.name: _facts(one) for one in comparison.judged},
        "excluded": [one._asdict() for one in comparison.excluded],
    }
    return dict(plain(found))


def _facts(one: Judged) -> dict[str, Any]:
    curve = operating_curve(one.judgement.operating)
    return {
        "title": one.title,
        "source": one.source,
        "coverage": one.coverage,
        **one.judgement.facts,
        "operating_curve": {
            "threshold": [point.threshold for point in curve],
            "false_per_km": [point.false_per_km for point in curve],
            "lead_time_median": [point.lead_time_median for point in curve],
            "missed_share": [point.missed_share for point in curve],
        },
        "difference_to_reference": {
            name: each._asdict() for name, each in one.differences.items()
        },
    }
