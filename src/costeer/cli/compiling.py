"""Say on stderr that machine code is being made, and for how long already."""

from __future__ import annotations

import threading
import time

from costeer.base import notice
from costeer.cli.console import note

USUAL = 20
"""How long the whole loop takes on a quiet computer, about [s]."""

_PATIENCE = 1.0
"""Shorter compilations are not worth a word [s]."""

_INTERVAL = 5.0
"""Between two words [s]."""


def announce() -> None:
    """Tell of every compilation from now on."""
    if _begun not in notice.displays:
        notice.displays.append(_begun)
        notice.tellers.append(lambda text: note(f"costeer: {text}"))


def _begun() -> notice.End:
    """A compilation has begun."""
    done = threading.Event()
    start = time.monotonic()
    threading.Thread(target=_tell, args=(done, start), daemon=True).start()
    return done.set


def _tell(done: threading.Event, start: float) -> None:
    """Say what takes so long, until it is done."""
    if done.wait(_PATIENCE):
        return
    note(f"costeer: compiling once, about {USUAL} s; later starts find it done")
    while not done.wait(_INTERVAL):
        note(f"costeer: compiling, {time.monotonic() - start:.0f} s")
    note(f"costeer: compiled in {time.monotonic() - start:.0f} s")
