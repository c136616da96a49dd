"""Deadlines lie on a grid; what was late is caught up, what was lost is given up."""

from __future__ import annotations

import itertools
import os
import time

import pytest

from costeer.runtime.clock import LONGEST_BACKLOG, Pacer, favour_thread, raise_priority

PERIOD = 0.002


def test_deadlines_are_never_early_and_stay_on_their_grid() -> None:
    pacer, start = Pacer(PERIOD), time.perf_counter()
    for count in range(1, 51):
        late = pacer.wait()
        now = time.perf_counter() - start
        assert late >= 0.0
        # The grid began a moment before `start` was read.
        assert now >= count * PERIOD - 1e-4
    assert pacer.given_up == pytest.approx(0.0, abs=0.5)


def test_late_step_is_followed_by_steps_without_a_wait() -> None:
    pacer = Pacer(PERIOD)
    pacer.wait()
    time.sleep(10.5 * PERIOD)
    lateness = [pacer.wait() for _ in range(9)]
    # Each of the missed deadlines comes at once, later than it should by what is left.
    assert lateness[0] > 9.0 * PERIOD
    assert all(a > b for a, b in itertools.pairwise(lateness))
    assert pacer.given_up == 0.0


def test_long_stall_is_given_up_and_time_goes_on_from_there() -> None:
    pacer = Pacer(PERIOD)
    time.sleep(LONGEST_BACKLOG + 0.05)
    assert pacer.wait() > LONGEST_BACKLOG
    assert pacer.given_up > LONGEST_BACKLOG
    start = time.perf_counter()
    for _ in range(5):
        pacer.wait()
    assert time.perf_counter() - start >= 4 * PERIOD


def test_priority_that_is_refused_is_told_and_no_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refuse, raising=False)
    monkeypatch.setattr(os, "nice", refuse)
    answer = raise_priority()
    assert not answer.realtime
    assert "not permitted" in answer.detail
    favour_thread()


def test_system_without_such_priorities_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delattr(os, "sched_setscheduler", raising=False)
    assert "no real-time scheduling" in raise_priority().detail
    favour_thread()
