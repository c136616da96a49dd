"""What the car touches on the way, and what follows from it for the trial."""

from __future__ import annotations

import math
from collections.abc import Callable

from costeer.runtime.markers import Marker
from costeer.runtime.states import Contact

_BY_NUMBER = {int(each): each for each in Contact}

SHOWN_FOR = 3.0
"""Before a drive begins anew its end is on show for so long [s]."""


class Contacts:
    """Marks every contact, and says when a trial ends of one and when it begins anew.

    A trial ends with the collision, whatever the scenario says: nobody can measure
    across a jump back to the start. Where it says "restart", the next trial, with a
    record of its own, waits at the start a moment later.

    Args:
        after_collision: Of the scenario, "end" or "restart".
        mark: Takes a marker; its time is filled in there.
    """

    def __init__(self, after_collision: str, mark: Callable[[Marker], None]) -> None:
        self._restarts = after_collision == "restart"
        self._mark = mark
        self._before = Contact.NOTHING
        self._anew_at = math.inf

    def look(self, contact: float, now: float) -> bool:
        """Mark what is new; return whether the trial is over.

        Args:
            contact: Of the newest row, a number of `Contact`.
            now: Of the clock [s].
        """
        before, self._before = self._before, _BY_NUMBER[int(contact)]
        if self._before in (before, Contact.NOTHING):
            return False
        self._mark(Marker("contact", self._before.word))
        if self._before < Contact.BARRIER:
            return False
        self._mark(Marker("ended", "collision"))
        self._anew_at = now + SHOWN_FOR if self._restarts else math.inf
        return True

    def begins_anew(self, now: float) -> bool:
        """Whether the next trial is to be prepared now [s]."""
        return now >= self._anew_at

    def forget(self) -> None:
        """Nothing is touched, as a new trial begins."""
        self._before, self._anew_at = Contact.NOTHING, math.inf
