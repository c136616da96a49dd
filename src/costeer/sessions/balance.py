"""How balanced the orders are in which participants drive."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from costeer.sessions.plan import Plan, block_order


class Balance(NamedTuple):
    """How balanced the orders of some slots are.

    Attributes:
        places: How often each condition stands in each place, `{name: counts}`.
        follows: How often each condition follows each other, `{(before, name): count}`.
    """

    places: dict[str, list[int]]
    follows: dict[tuple[str, str], int]

    @property
    def is_even(self) -> bool:
        """Whether no condition is favoured by place or predecessor."""
        places = [count for counts in self.places.values() for count in counts]
        return len(set(places)) <= 1 and len(set(self.follows.values())) <= 1


def balance(plan: Plan, slots: Sequence[int]) -> Balance:
    """How balanced the first block of trials is over some slots.

    Args:
        plan: Of the study.
        slots: Of the participants who count, each perhaps several times.
    """
    block = next((each for each in plan.steps if each.kind == "trials"), None)
    if block is None:
        return Balance({}, {})
    names = block.conditions
    places = {name: [0] * len(names) for name in names}
    follows = {(a, b): 0 for a in names for b in names if a != b}
    for slot in slots:
        order = block_order(block, slot, plan.seed)
        for place, name in enumerate(order):
            places[name][place] += 1
        for pair in pairwise(order):
            follows[pair] += 1
    return Balance(places, follows)
