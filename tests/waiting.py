"""Waiting for what another thread or process does, on a machine that may be busy."""

from __future__ import annotations

import time
from collections.abc import Callable

PATIENCE = 60.0
"""After which what takes milliseconds will never happen, on any machine [s]."""


def wait_for(fact: Callable[[], object], patience: float = PATIENCE) -> None:
    """Wait until something is so.

    Args:
        fact: What is to be.
        patience: After which it never will [s].
    """
    deadline = time.monotonic() + patience
    while not fact():
        assert time.monotonic() < deadline, "it did not come to pass"
        time.sleep(0.005)
