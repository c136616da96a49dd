"""Say on stderr that machine code is being made, and for how long already."""

from __future__ import annotations

import threading
import time

from costeer.base import notice
from costeer.cli.console import note

USUAL = 35
"""How long the whole loop takes on a quiet computer, about [s]."""

_PATIENCE = 1.0
"""Shorter compilations are not worth a word [s]."""

_INTERVAL = 5.0
"""Between two words [s]."""


_of_thread = threading.local()


def compiled_for(what: str, more: int) -> None:
    """Say for what this thread may soon compile.

    Args:
        what: As `method traded`.
        more: How many others may follow.
    """
    _of_thread.told = what, more


def announce() -> None:
    """Tell of every compilation from now on."""
    if _begun not in notice.displays:
        notice.displays.append(_begun)
        notice.tellers.append(lambda text: note(f"costeer: {text}"))


def _begun() -> notice.End:
    """A compilation has begun."""
    done = threading.Event()
    start = time.monotonic()
    what, more = getattr(_of_thread, "told", ("", 0))
    words = f"compiling {what}".rstrip()
    threading.Thread(target=_tell, args=(done, start, words, more), daemon=True).start()
    return done.set


def _tell(done: threading.Event, start: float, words: str, more: int) -> None:
    """Say what takes so long, until it is done."""
    if done.wait(_PATIENCE):
        return
    others = f"; at most {more} more to compile" if more else ""
    note(
        f"costeer: {words} once, about {USUAL} s; later starts find it done{others}",
        at_once=True,
    )
    while not done.wait(_INTERVAL):
        note(
            f"costeer: {words}, {time.monotonic() - start:.0f} s{others}", at_once=True
        )
    note(f"costeer: compiled in {time.monotonic() - start:.0f} s", at_once=True)
