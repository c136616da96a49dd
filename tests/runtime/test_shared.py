"""Rings and mailbox: whole rows in order, the newest word, across processes."""

from __future__ import annotations

import errno
import multiprocessing
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from costeer.runtime.frame import TRACE_COLUMNS, WIDTH
from costeer.runtime.shared import (
    FRAME_ROWS,
    NEEDED,
    Ring,
    Shared,
    close_shared,
    make_shared,
    open_shared,
)


@pytest.fixture
def shared() -> Iterator[Shared]:
    made = make_shared()
    yield made
    close_shared(made, unlink=True)


def ring(rows: int = 8, columns: int = 3) -> Ring:
    return Ring(np.zeros(1 + rows * (columns + 2)), rows, columns)


def test_reader_gets_every_row_once_and_in_order() -> None:
    here, asked, got = ring(), 0, []
    for k in range(20):
        here.put(np.full(3, float(k)))
        if k % 3 == 2:
            asked, rows = here.since(asked)
            got += rows[:, 0].tolist()
    assert got == [float(k) for k in range(18)]
    assert here.since(asked)[1][:, 0].tolist() == [18.0, 19.0]


def test_reader_that_names_an_end_gets_no_row_after_it() -> None:
    here = ring(rows=8)
    for k in range(12):
        here.put(np.full(3, float(k)))
    number, rows = here.since(6, until=9)
    assert (number, rows[:, 0].tolist()) == (9, [6.0, 7.0, 8.0])
    assert here.since(9, until=9)[1].shape == (0, 3)
    assert here.since(10, until=90)[1][:, 0].tolist() == [10.0, 11.0]


def test_slow_reader_finds_the_newest_rows_and_no_other() -> None:
    here = ring(rows=8)
    for k in range(30):
        here.put(np.full(3, float(k)))
    number, rows = here.since(0)
    assert number == 30
    # One of the eight may be under the writer's hand at any time.
    assert rows[:, 0].tolist() == [float(k) for k in range(23, 30)]


def test_row_that_is_being_written_is_left_out() -> None:
    numbers = np.zeros(1 + 8 * 5)
    here = Ring(numbers, 8, 3)
    for k in range(8):
        here.put(np.full(3, float(k)))
    numbers[1 + 5 * 7] = 16.0  # the writer has begun to overwrite the last row
    assert here.since(4)[1][:, 0].tolist() == [4.0, 5.0, 6.0]


def test_empty_ring_gives_no_rows() -> None:
    number, rows = ring().since(0)
    assert (number, rows.shape) == (0, (0, 3))


def _other_process(name: str) -> None:
    there = open_shared(name)
    there.mailbox.put(head_yaw=0.25, head_time=7.0)
    there.frames.put(np.arange(WIDTH, dtype=float))
    there.trace.put(np.arange(len(TRACE_COLUMNS), dtype=float))
    close_shared(there, unlink=False)


def test_another_process_writes_what_this_one_reads(shared: Shared) -> None:
    other = multiprocessing.get_context("spawn").Process(
        target=_other_process, args=(shared.memory.name,)
    )
    other.start()
    other.join(60)
    assert other.exitcode == 0
    assert shared.mailbox.get("head_yaw") == 0.25
    np.testing.assert_array_equal(shared.frames.since(0)[1], [np.arange(WIDTH)])
    assert shared.trace.since(0)[1].shape == (1, len(TRACE_COLUMNS))


def test_mailbox_starts_without_a_verdict(shared: Shared) -> None:
    assert np.isnan(shared.mailbox.get("crossing_probability"))
    assert shared.mailbox.get("input_sequence") == 0.0
    assert shared.frames.since(0)[0] == 0
    assert shared.frames.size == FRAME_ROWS


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="nothing to allocate by")
def test_shared_memory_without_room_is_told_and_given_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    names = []

    def full(descriptor: int, first: int, size: int) -> None:
        names.append(Path(f"/proc/self/fd/{descriptor}").resolve())
        assert (first, size) == (0, NEEDED)
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "posix_fallocate", full)
    with pytest.raises(ValueError, match=r"shared memory lacks room for the .* MB"):
        make_shared()
    assert not names[0].exists()


AFTER_ITS_END = """
import os
from costeer.runtime.shared import close_shared, make_shared, next_rows, open_shared
shared = make_shared()
other = open_shared(shared.memory.name)
before = len(os.listdir("/proc/self/fd")) if os.path.isdir("/proc") else 0
for each in (other, shared):
    close_shared(each, unlink=each is shared)
    each.mailbox.put(steer=0.5)
    assert next_rows(each).frames == 0
after = len(os.listdir("/proc/self/fd")) if os.path.isdir("/proc") else -2
assert after == before - 2, (before, after)
for each in (other, shared):
    close_shared(each, unlink=False)
    assert each.mailbox.get("steer") == 0.5
maps = "/proc/self/maps"
name = shared.memory.name
del shared, other, each
if os.path.exists(maps):
    assert name not in open(maps).read(), "it stays for ever"
"""


@pytest.mark.slow
def test_a_key_pressed_while_the_drive_ends_kills_nobody() -> None:
    """In a process of its own: it would take this one with it."""
    done = subprocess.run(
        [sys.executable, "-c", AFTER_ITS_END], capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
