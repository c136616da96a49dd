"""All that `costeer evaluate` finds out: one predictor, its rivals, its signals."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from costeer.intention.predictors.interface import Predictor
from costeer.intention.predictors.registry import (
    OURS,
    PREDICTORS,
    TITLES,
    predictor,
)
from costeer.training.ablation import ablations
from costeer.training.comparison import (
    Comparison,
    Contender,
    Judged,
    compare_verdicts,
    comparison_facts,
    contender,
)
from costeer.training.evaluate import DEFAULTS, EvaluationParameters
from costeer.training.recordings import Recording


class Asked(NamedTuple):
    """What is looked at beside the predictor itself.

    Attributes:
        rivals: Predictors to put beside it.
        unfitted: Rows of predictors that cannot be asked, with the reasons.
        ablations: Whether signals are taken away from it.
    """

    rivals: tuple[Predictor, ...] = ()
    unfitted: tuple[Contender, ...] = ()
    ablations: bool = False


class Assessment(NamedTuple):
    """What was found.

    Attributes:
        judged: The predictor over all samples at which it has a verdict.
        comparison: It and its rivals over their common samples; None if not asked.
        ablations: It with signals taken away; None if not asked.
    """

    judged: Judged
    comparison: Comparison | None = None
    ablations: Comparison | None = None


def all_rivals(name: str, path: Path | None, ablations: bool = False) -> Asked:
    """All predictors of the registry but one; those without a fit with the reason.

    Args:
        name: Of the one that is judged.
        path: Of its file; if that holds fitted predictors the rivals are its others.
        ablations: Whether signals are taken away from the one that is judged.
    """
    able: list[Predictor] = []
    unable: list[Contender] = []
    for rival in PREDICTORS:
        file = path if name != OURS and rival != OURS else None
        if rival == name:
            continue
        try:
            able.append(predictor(rival, file))
        except (ValueError, OSError) as error:
            unable.append(Contender(rival, *TITLES[rival], [], _unfitted(error)))
    return Asked(tuple(able), tuple(unable), ablations)


def _unfitted(error: ValueError | OSError) -> str:
    """Why there is no fit, without the place of a file on this machine."""
    if isinstance(error, OSError) and error.filename:
        return f"not fitted: there is no file {Path(error.filename).name}"
    return f"not fitted: {error}"


def assess(
    predictor: Predictor,
    recordings: Sequence[Recording],
    asked: Asked,
    parameters: EvaluationParameters = DEFAULTS,
) -> Assessment:
    """Judge a predictor and what is asked beside it.

    Args:
        predictor: The reference of the differences.
        recordings: Of drivers who trained none of the predictors.
        asked: Rivals and ablations.
        parameters: How it is judged.

    Raises:
        ValueError: If the predictor cannot judge the recordings.
    """
    own = contender(predictor, recordings)
    alone = compare_verdicts([own], recordings, own.name, parameters)
    rivals = [contender(rival, recordings) for rival in asked.rivals]
    rows = [*rivals, *asked.unfitted]
    together = (
        compare_verdicts([own, *rows], recordings, own.name, parameters)
        if rows
        else None
    )
    without = ablations(predictor, recordings, parameters) if asked.ablations else None
    return Assessment(alone.judged[0], together, without)


def shown(assessment: Assessment) -> list[Judged]:
    """Predictors that a figure shows, the one of the assessment first."""
    if assessment.comparison is None:
        return [assessment.judged]
    return assessment.comparison.judged


def assessment_facts(assessment: Assessment) -> dict[str, Any]:
    """Plain numbers, lists and dictionaries for JSON.

    As `evaluate` gives them, with `comparison` and `ablations` if they were asked for.
    """
    found: dict[str, Any] = {
        "predictor": assessment.judged.name,
        "coverage": assessment.judged.coverage,
        **assessment.judged.judgement.facts,
    }
    if assessment.comparison is not None:
        found["comparison"] = comparison_facts(assessment.comparison)
    if assessment.ablations is not None:
        found["ablations"] = comparison_facts(assessment.ablations)
    return found
