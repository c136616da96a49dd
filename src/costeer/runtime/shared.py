"""Memory that the processes of a drive share: rings, a mailbox and a heartbeat.

Every number has one writer. A ring is written at its head and read by anyone at their
own pace; a reader that is too slow finds the oldest rows overwritten and skips them.
Each row bears its number twice, before and after its values, so that a row that was
being written is not taken for a whole one.
"""

from __future__ import annotations

import os
import signal
import threading
from contextlib import suppress
from multiprocessing.shared_memory import SharedMemory
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.runtime.frame import TRACE_COLUMNS, WIDTH

FRAME_ROWS = 1024
"""Frames kept: 17 s at 60 Hz."""

TRACE_ROWS = 16384
"""Rows of the wheel's trace kept: 17 s at 960 Hz."""

MAILBOX = (
    "input_sequence",
    "steer",
    "accelerator",
    "brake",
    "steering",
    "page_time",
    "server_time",
    "head_yaw",
    "head_valid",
    "head_time",
    "head_lost",
    "crossing_probability",
    "crossing_side",
    "verdict_row",
    "heartbeat",
    "armed",
    "watching",
    "watched_at",
    "reading",
    "stalled",
    "dismissed",
)
"""Newest values only, [s] on the host's monotonic clock where it is a time.

`page_time` is of the last word from a driver's page, `server_time` of the server's own
life, `head_lost` 1 while there is no tracker of the head, `verdict_row` the number of
the frame that the probability belongs to and `crossing_side` what it is about,
`heartbeat` of the real-time process, `armed` 1 while the watchdog has to look,
`watching` 1 once it does, `watched_at` when it last did, `stalled` 1 once it had to
act, `dismissed` 1 once it may go, and `reading` 1 once the network takes frames.
"""

_PLACES = {name: place for place, name in enumerate(MAILBOX)}


class Ring:
    """Rows of numbers from one writer to any number of readers.

    Args:
        numbers: Shared memory, shape `(1 + rows * (columns + 2),)`, zeroed.
        rows: That it keeps.
        columns: Numbers in a row.
    """

    def __init__(self, numbers: NDArray[np.float64], rows: int, columns: int) -> None:
        self._head = numbers[:1]
        self._rows = numbers[1:].reshape(rows, columns + 2)
        self.size = rows

    @property
    def written(self) -> int:
        """Rows written so far."""
        return int(self._head[0])

    def put(self, values: NDArray[np.float64]) -> None:
        """Append a row; only one process may."""
        number = self._head[0] + 1.0
        slot = self._rows[int(number - 1.0) % self.size]
        slot[0] = number
        slot[1:-1] = values
        slot[-1] = number
        self._head[0] = number

    def since(
        self, first: int, until: int | None = None
    ) -> tuple[int, NDArray[np.float64]]:
        """Whole rows from number `first` on, and the number of the next.

        Args:
            first: Number of the first row that is wanted, counted from 0.
            until: Number of the first that is wanted no more; None for all there are.

        Returns:
            Number to ask for next time, and rows, shape `(row, column)`; those that
            were overwritten are left out.
        """
        written = self.written
        first = max(first, written - self.size + 1, 0)
        end = written if until is None else min(until, written)
        if first >= end:
            return max(first, end), self._rows[:0, 1:-1].copy()
        places = np.arange(first, end)
        taken = self._rows[places % self.size]
        whole = (taken[:, 0] == places + 1.0) & (taken[:, -1] == places + 1.0)
        return end, taken[whole, 1:-1]


class Mailbox:
    """Newest values by name; each name has one writer."""

    def __init__(self, numbers: NDArray[np.float64]) -> None:
        self._numbers = numbers

    def get(self, name: str) -> float:
        """The newest value of `name`."""
        return float(self._numbers[_PLACES[name]])

    def put(self, **values: float) -> None:
        """Set values in the order given; a reader may see some before others."""
        for name, value in values.items():
            self._numbers[_PLACES[name]] = value


class Rows(NamedTuple):
    """A place in both rings: numbers of the next row of each."""

    frames: int = 0
    trace: int = 0


class LastingMemory(SharedMemory):
    """Shared memory that stays as long as someone looks at it.

    A page may press a key while its drive ends: memory that is taken from under a view
    kills the whole process.
    """

    def close(self) -> None:
        """Let go of it; views keep it until the last of them is gone."""
        try:
            super().close()
        except BufferError:
            # The views hold what is dropped here; the rest is closed.
            self._buf = self._mmap = None
            super().close()


class Shared(NamedTuple):
    """Everything that is shared, as one process sees it.

    Attributes:
        memory: To be closed, and unlinked by the process that made it.
        mailbox: Newest values.
        frames: At 60 Hz, columns as `frame.frame_columns`.
        trace: Of the wheel at the plant's rate, columns as `TRACE_COLUMNS`.
    """

    memory: SharedMemory
    mailbox: Mailbox
    frames: Ring
    trace: Ring


def next_rows(shared: Shared) -> Rows:
    """Where both rings are now."""
    return Rows(shared.frames.written, shared.trace.written)


def _ring_size(rows: int, columns: int) -> int:
    return 1 + rows * (columns + 2)


_FRAMES = _ring_size(FRAME_ROWS, WIDTH)
_TRACE = _ring_size(TRACE_ROWS, len(TRACE_COLUMNS))
_TOTAL = len(MAILBOX) + _FRAMES + _TRACE

NEEDED = 8 * _TOTAL
"""Shared memory of a drive [bytes]."""


def make_shared() -> Shared:
    """Make the memory of a drive; close and unlink it in the end.

    Raises:
        ValueError: If the system has no room for it.
    """
    _start_tracker()
    try:
        memory = LastingMemory(create=True, size=8 * _TOTAL)
    except OSError as error:
        raise ValueError(_no_room()) from error
    try:
        _allocate(memory)
    except OSError as error:
        memory.close()
        memory.unlink()
        raise ValueError(_no_room()) from error
    shared = _view(memory)
    _numbers(memory)[:] = 0.0
    shared.mailbox.put(head_yaw=0.0, crossing_probability=np.nan, verdict_row=-1.0)
    return shared


def _start_tracker() -> None:
    """Start what looks after shared memory so that a closed terminal leaves it alone.

    It ignores Ctrl-C by itself, but would die of SIGHUP before those that it serves.
    """
    from multiprocessing import resource_tracker

    number = getattr(signal, "SIGHUP", None)
    if number is None or threading.current_thread() is not threading.main_thread():
        return
    before = signal.signal(number, signal.SIG_IGN)
    try:
        resource_tracker.ensure_running()
    finally:
        signal.signal(number, before)


def _allocate(memory: SharedMemory) -> None:
    """Have the system give the memory now: later it would kill who writes to it.

    Raises:
        OSError: If there is too little.
    """
    descriptor = getattr(memory, "_fd", -1)  # there is no other way to it
    if hasattr(os, "posix_fallocate") and descriptor >= 0:
        os.posix_fallocate(descriptor, 0, memory.size)


def _no_room() -> str:
    return (
        f"shared memory lacks room for the {NEEDED / 1e6:.1f} MB of a drive; end other "
        "programs that use /dev/shm or make it larger; costeer doctor says how much "
        "there is"
    )


def open_shared(name: str) -> Shared:
    """Open the memory that another process made.

    Raises:
        FileNotFoundError: If it is gone.
    """
    return _view(attached(name))


def attached(name: str) -> LastingMemory:
    """Shared memory that this process does not own and will not unlink.

    Before Python 3.13 the resource tracker of a spawned process would unlink it when
    that process ends; it is told not to.
    """
    from multiprocessing import resource_tracker

    original = resource_tracker.register
    resource_tracker.register = _nothing  # type: ignore[assignment]  # for this call
    try:
        return LastingMemory(name=name)
    finally:
        resource_tracker.register = original


def _nothing(name: str, rtype: str) -> None:
    """Register nothing."""


def _numbers(memory: SharedMemory) -> NDArray[np.float64]:
    """All of it; an array by `np.ndarray` would not hold the memory it looks at."""
    assert memory.buf is not None  # only after its end
    return np.frombuffer(memory.buf, np.float64, _TOTAL)


def _view(memory: SharedMemory) -> Shared:
    numbers = _numbers(memory)
    mailbox, rest = numbers[: len(MAILBOX)], numbers[len(MAILBOX) :]
    return Shared(
        memory=memory,
        mailbox=Mailbox(mailbox),
        frames=Ring(rest[:_FRAMES], FRAME_ROWS, WIDTH),
        trace=Ring(rest[_FRAMES:], TRACE_ROWS, len(TRACE_COLUMNS)),
    )


def close_shared(shared: Shared, unlink: bool) -> None:
    """Let go of the memory; `unlink` by the process that made it."""
    shared.memory.close()
    if unlink:
        with suppress(FileNotFoundError):
            shared.memory.unlink()
