"""Which axis a pedal is: the one that moves when the pedal is pressed."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, Protocol, runtime_checkable

STEERING_AXIS = 0
"""Axis of the rim on every wheel."""

PRESSED = 0.5
"""Share of an axis's whole travel of 2 that a press must move it."""


class PedalAxis(NamedTuple):
    """An axis of a device.

    Attributes:
        number: Of the axis; -1 if there is none.
        sign: +1 if it grows when the pedal is pressed, else -1.
    """

    number: int
    sign: float


NO_PEDAL = PedalAxis(-1, 1.0)
"""Of a device without this pedal."""


def pressed_axis(
    rows: Iterable[tuple[float, ...]], taken: frozenset[int] = frozenset()
) -> PedalAxis:
    """Find the pedal that was pressed, from released to pressed.

    Args:
        rows: All axes of the device in [-1, 1], first row with the pedal released.
        taken: Axes that are other pedals.

    Returns:
        The axis that moved most; `NO_PEDAL` if none moved far enough.
    """
    first: tuple[float, ...] | None = None
    furthest: dict[int, float] = {}
    for row in rows:
        first = row if first is None else first
        for number, (value, released) in enumerate(zip(row, first, strict=False)):
            moved = value - released
            if abs(moved) > abs(furthest.get(number, 0.0)):
                furthest[number] = moved
    found = {
        number: moved
        for number, moved in furthest.items()
        if number not in taken | {STEERING_AXIS} and abs(moved) > 2.0 * PRESSED
    }
    if not found:
        return NO_PEDAL
    number = max(found, key=lambda each: abs(found[each]))
    return PedalAxis(number, 1.0 if found[number] > 0.0 else -1.0)


@runtime_checkable
class ShowsAxes(Protocol):
    """A wheel that shows its axes as they are."""

    def axes(self) -> tuple[float, ...]:
        """Every axis in [-1, 1], the steering first."""
        ...
