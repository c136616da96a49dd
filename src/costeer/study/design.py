"""Who drives what when: a balanced Latin square, Sec. III-B.

Manual comes first. The assisted conditions follow the rows of a Williams square, in
which each condition stands equally often in each place and follows each other
condition equally often, so that neither practice nor the trial before favours one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from costeer.base.array import Real
from costeer.drivers.learning import PRACTICE
from costeer.methods.conditions import MANUAL, check_conditions

MOST_CONDITIONS = 8
"""Largest square made here; beyond it nobody drives all conditions in a day."""


class Trial(NamedTuple):
    """One trial of the study.

    Attributes:
        participant: From 1.
        condition: Name of the condition.
        order: Place in the participant's day, from 1.
    """

    participant: int
    condition: str
    order: int


def williams_square(size: int) -> tuple[tuple[int, ...], ...]:
    """Return the orders of `size` conditions, balanced to the first order.

    An even size needs `size` rows; an odd one twice as many, the second half being
    the first half backwards. Source: E. J. Williams, Aust. J. Sci. Res. A 2 (1949).

    Args:
        size: Number of conditions, 1 to 8.

    Raises:
        ValueError: If the size is outside that range.
    """
    if not 1 <= size <= MOST_CONDITIONS:
        raise ValueError(
            f"a Williams square has 1 to {MOST_CONDITIONS} conditions, not {size}"
        )
    zigzag = [(i + 1) // 2 if i % 2 else (size - i // 2) % size for i in range(size)]
    rows = [tuple((place + row) % size for place in zigzag) for row in range(size)]
    backwards = [row[::-1] for row in rows] if size % 2 and size > 1 else []
    return tuple(rows + backwards)


def condition_order(participant: int, conditions: Sequence[str]) -> tuple[str, ...]:
    """Return the conditions in the order in which the participant drives them.

    Participants take the rows of the square in turn; twelve participants and six
    assisted conditions go through it twice.

    Args:
        participant: From 1.
        conditions: Names, in any order.
    """
    known = check_conditions(conditions)
    first = tuple(name for name in known if name == MANUAL)
    assisted = tuple(name for name in known if name != MANUAL)
    if not assisted:
        return first
    rows = williams_square(len(assisted))
    row = rows[(participant - 1) % len(rows)]
    return first + tuple(assisted[place] for place in row)


def plan_trials(participants: int, conditions: Sequence[str]) -> tuple[Trial, ...]:
    """Return all trials of the study, participant by participant, as driven."""
    return tuple(
        Trial(participant=participant, condition=name, order=place)
        for participant in range(1, participants + 1)
        for place, name in enumerate(condition_order(participant, conditions), start=1)
    )


def guided_before(trial: Trial, conditions: Sequence[str], duration: Real) -> Real:
    """Driving with guidance before a trial: practice and earlier guided trials [s].

    Args:
        trial: Manual comes first, so that of those before only that one had none.
        conditions: Of the study.
        duration: Of a trial [s].
    """
    earlier = trial.order - 1 - (MANUAL in conditions)
    return PRACTICE + max(earlier, 0) * duration


def rows_needed(conditions: Sequence[str]) -> int:
    """Return the number of orders; a multiple of it as participants is balanced."""
    num_assisted = sum(name != MANUAL for name in conditions)
    return len(williams_square(num_assisted)) if num_assisted else 1
