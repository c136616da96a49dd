"""Scores of answers: a missing answer makes a score NaN, it is never invented."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from costeer.sessions.questionnaires.answers import Value
from costeer.sessions.questionnaires.definition import (
    Definition,
    Item,
    Score,
    load_definition,
)
from costeer.sessions.questionnaires.instrument import Instrument


def scores(
    instrument_name: str, answers: Mapping[str, Value], folder: Path | None = None
) -> dict[str, float]:
    """Scores of one instrument.

    Args:
        instrument_name: Of the instrument.
        answers: Checked answers by item.
        folder: The study folder, which may have an instrument of that name.

    Returns:
        Score by name; NaN where an answer that it needs is missing. Empty for an
        instrument without scores.

    Raises:
        ValueError: If there is no such instrument.
    """
    return scores_of(load_definition(instrument_name, folder), answers)


def scores_of(
    instrument: Instrument | Definition, answers: Mapping[str, Value]
) -> dict[str, float]:
    """Scores of an instrument that is loaded already, as `scores` gives them."""
    items = {item.name: item for item in instrument.items}
    pairs = [item for item in instrument.items if item.kind == "pairs"]
    return {
        score.name: score.factor * _value(score, items, pairs, answers)
        for score in instrument.scores
    }


def _value(
    score: Score,
    items: Mapping[str, Item],
    pairs: Sequence[Item],
    answers: Mapping[str, Value],
) -> float:
    values = [_counted(items[name], answers) for name in score.items]
    if score.how == "sum":
        return math.fsum(values)
    if score.how == "mean":
        return math.fsum(values) / len(values)
    wins = weights(score.items, pairs, answers)
    total = math.fsum(w * v for w, v in zip(wins, values, strict=True))
    return total / len(pairs) if pairs else math.nan


def _counted(item: Item, answers: Mapping[str, Value]) -> float:
    """An answer as a score counts it; NaN if it is missing."""
    value = answers.get(item.name, math.nan)
    number = value if isinstance(value, int | float) else math.nan
    return item.low + item.high - number if item.reversed else float(number)


def weights(
    names: Sequence[str], pairs: Sequence[Item], answers: Mapping[str, Value]
) -> list[float]:
    """How many comparisons each item has won; NaN for all if one is missing.

    Args:
        names: The items.
        pairs: All comparisons between them.
        answers: The winner of each comparison, and other answers.
    """
    winners = [answers.get(pair.name) for pair in pairs]
    if None in winners:
        return [math.nan] * len(names)
    return [float(winners.count(name)) for name in names]


def change(
    baseline: Mapping[str, float], later: Mapping[str, float]
) -> dict[str, float]:
    """Rise of each score over the first answers, as `NAME_change`."""
    return {
        f"{name}_change": later[name] - baseline.get(name, math.nan) for name in later
    }


def stop_reason(
    instrument: Instrument | Definition,
    found: Mapping[str, float],
    baseline: Mapping[str, float] | None = None,
) -> str:
    """Why a participant should not go on; empty if nothing speaks against it.

    Args:
        instrument: With the rule.
        found: Scores now.
        baseline: Scores before the first drive; without them a rule about the rise
            looks at the score itself, which stops no later.
    """
    rule = instrument.stop
    if rule is None:
        return ""
    value, risen = found.get(rule.score, math.nan), ""
    if rule.from_baseline and baseline is not None:
        value -= baseline.get(rule.score, math.nan)
        risen = " above the baseline"
    if not value >= rule.at_least:
        return ""
    return (
        f"{rule.score} is {value:g}{risen}, the limit {rule.at_least:g}: "
        "end the session unless the participant is well"
    )
