"""The designs that are tested: their cells and the effects over them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from costeer.methods.conditions import DURATIONS, MANUAL, condition
from costeer.study.cells import CHANGE_DURATION, CONDITION, STRENGTH
from costeer.study.contrasts import Effect, one_way, two_way


class Design(NamedTuple):
    """Cells and effects of one analysis of variance.

    Attributes:
        factor: What names the cells: `condition` or `strength`.
        cells: Levels of that factor, in the order of the effects' rows.
        effects: What is tested.
        note: What a reader should know of the design; empty if nothing.
    """

    factor: str
    cells: tuple[str, ...]
    effects: tuple[Effect, ...]
    note: str = ""


def one_way_design(factor: str, names: Sequence[str], note: str = "") -> Design:
    """Return the design with these levels of one factor."""
    return Design(factor, tuple(names), one_way(factor, len(names)), note)


def two_way_design(conditions: Sequence[str]) -> Design:
    """Return strength x change duration over the conditions with guidance.

    Crossed fully: a combination that the study does not have is a cell without values.
    """
    assisted = [condition(name) for name in conditions if name != MANUAL]
    strengths = tuple(dict.fromkeys(each.strength for each in assisted))
    present = {each.duration for each in assisted}
    durations = tuple(name for name in DURATIONS if name in present)
    return Design(
        factor=CONDITION,
        cells=tuple(f"{one}-{other}" for one in strengths for other in durations),
        effects=two_way(STRENGTH, len(strengths), CHANGE_DURATION, len(durations)),
        note="strength x change duration without manual",
    )


def compared_pairs(factor: str, names: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return the pairs of levels to compare, each first minus second.

    Every level against manual, whether or not the study has manual; for strengths also
    strong against weak.
    """
    others = [name for name in names if name != MANUAL]
    pairs = [(name, MANUAL) for name in others]
    if factor == STRENGTH and len(others) == 2:
        pairs.append((others[0], others[1]))
    return tuple(pairs)
