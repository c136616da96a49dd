"""Pacing by the wall clock: fixed deadlines, sleep, then spin."""

from __future__ import annotations

import os
import sys
import time
from contextlib import suppress
from typing import NamedTuple

SPIN = 0.0003
"""Spun before a deadline [s]: a sleep ends up to this late on a quiet machine."""

SPIN_PRIVILEGED = 0.00012
"""The same where the process has real-time priority [s]."""

LONGEST_BACKLOG = 0.1
"""A delay longer than this is not caught up: the deadlines move on [s]."""


class Pacer:
    """Deadlines at whole multiples of a period; the step itself never changes.

    A late wake-up is followed by shorter waits until the deadlines are met again, so
    that simulated time keeps to the wall clock. Only a delay over `LONGEST_BACKLOG`
    is given up.

    Args:
        period: Between deadlines [s].
        spin: How long before a deadline sleeping ends [s].
    """

    def __init__(self, period: float, spin: float = SPIN) -> None:
        self.period = period
        self.spin = spin
        self.given_up = 0.0
        self._origin = time.perf_counter()
        self._count = 0

    def hurry(self, period: float) -> None:
        """Go on with another period between deadlines [s]."""
        if period != self.period:
            self._origin += self._count * (self.period - period)
            self.period = period

    def wait(self) -> float:
        """Wait for the next deadline; return how late it was met [s]."""
        self._count += 1
        deadline = self._origin + self._count * self.period
        pause = deadline - time.perf_counter() - self.spin
        if pause > 0.0:
            time.sleep(pause)
        now = time.perf_counter()
        while now < deadline:
            now = time.perf_counter()
        late = now - deadline
        if late > LONGEST_BACKLOG:
            self._origin += late
            self.given_up += late
        return late


class Priority(NamedTuple):
    """What the system granted to the real-time process.

    Attributes:
        realtime: Whether it runs before all ordinary processes.
        detail: In words, for the log and for `costeer doctor`.
    """

    realtime: bool
    detail: str


def raise_priority(level: int = 60) -> Priority:
    """Ask for real-time scheduling and a core; take what the system grants.

    Args:
        level: Of SCHED_FIFO, 1 to 99; the watchdog stands above the wheel's loop.
    """
    if sys.platform == "win32":
        return _raise_on_windows()
    if not hasattr(os, "sched_setscheduler"):
        return Priority(False, "this system has no real-time scheduling for processes")
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(level))
    except PermissionError:
        with suppress(OSError):
            os.nice(-10)
        return Priority(False, "SCHED_FIFO is not permitted to this user")
    return Priority(True, f"SCHED_FIFO {level}")


def favour_thread(level: int = 30) -> None:
    """Let the calling thread run before ordinary ones, if that is permitted.

    For the threads that pass a frame on: they do little, and a browser that renders in
    software would let them wait for a tenth of a second.

    Args:
        level: Of SCHED_RR, below that of the wheel's loop.
    """
    if hasattr(os, "sched_setscheduler"):
        # Not for what the thread starts, a browser for example.
        policy = os.SCHED_RR | os.SCHED_RESET_ON_FORK
        with suppress(PermissionError):
            os.sched_setscheduler(0, policy, os.sched_param(level))


def _raise_on_windows() -> Priority:
    """The high priority class of Windows."""
    import ctypes

    kernel = getattr(ctypes, "windll").kernel32  # noqa: B009  absent elsewhere
    high = 0x80
    if kernel.SetPriorityClass(kernel.GetCurrentProcess(), high):
        # It is no real-time class: spin as without one.
        return Priority(False, "high priority class")
    return Priority(False, "the high priority class was not granted")


def own_core() -> int | None:
    """Keep this process on the last core, where there is more than one.

    Returns:
        The core, or None if the system does not let a process choose.
    """
    if not hasattr(os, "sched_setaffinity"):
        return None
    cores = sorted(os.sched_getaffinity(0))
    if len(cores) < 2:
        return None
    os.sched_setaffinity(0, {cores[-1]})
    return cores[-1]
