"""Who is told that machine code is being made: the first call of a loop takes a while.

Nothing here is printed; the command line puts its display into `displays` and
`tellers`.
"""

from __future__ import annotations

import threading
from collections.abc import Callable

End = Callable[[], None]
"""To be called when the compiler is done."""

displays: list[Callable[[], End]] = []
"""Each is called when compilation begins, and gives what is to be called at its end."""


tellers: list[Callable[[str], None]] = []
"""Each is called with what a user should know of the machine code."""


def tell(text: str) -> None:
    """Pass a line on to those who show it."""
    for teller in tellers:
        teller(text)


class Compilations:
    """Compilations of one thread, of which those within another do not count."""

    def __init__(self) -> None:
        self._here = threading.local()

    def begin(self) -> None:
        """One begins."""
        depth = getattr(self._here, "depth", 0)
        if depth == 0:
            self._here.ends = [display() for display in displays]
        self._here.depth = depth + 1

    def end(self) -> None:
        """One is over."""
        self._here.depth = getattr(self._here, "depth", 1) - 1
        if self._here.depth == 0:
            for end in self._here.ends:
                end()
