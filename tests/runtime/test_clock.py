"""Deadlines lie on a grid; what was late is caught up, what was lost is given up."""

from __future__ import annotations

import itertools
import os
import time

import pytest

from costeer.runtime import clock
from costeer.runtime.clock import LONGEST_BACKLOG, Pacer, favour_thread, raise_priority

PERIOD = 0.002


class Clock:
    """A clock that a sleep moves, and each look by a microsecond."""

    def __init__(self) -> None:
        self.now = 100.0

    def perf_counter(self) -> float:
        """Look."""
        self.now += 1e-6
        return self.now

    def sleep(self, seconds: float) -> None:
        """Sleep, and wake a little late, as one does."""
        self.now += seconds + 1e-4


@pytest.fixture
def made_up(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(clock, "time", made)
    return made


def test_deadlines_are_never_early_and_stay_on_their_grid(made_up: Clock) -> None:
    pacer, start = Pacer(PERIOD), made_up.now
    for count in range(1, 51):
        late = pacer.wait()
        assert 0.0 <= late < 1e-5  # it spins from before the deadline on
        assert made_up.now - start == pytest.approx(count * PERIOD + late, abs=1e-9)
    assert pacer.given_up == 0.0


def test_a_deadline_of_the_systems_clock_is_not_early() -> None:
    pacer, start = Pacer(PERIOD), time.perf_counter()
    for count in range(1, 6):
        assert pacer.wait() >= 0.0
        # The grid began a moment before `start` was read.
        assert time.perf_counter() - start >= count * PERIOD - 1e-4


def test_late_step_is_followed_by_steps_without_a_wait(made_up: Clock) -> None:
    pacer = Pacer(PERIOD)
    pacer.wait()
    made_up.sleep(10.5 * PERIOD)
    lateness = [pacer.wait() for _ in range(9)]
    # Each of the missed deadlines comes at once, later than it should by what is left.
    assert lateness[0] > 9.0 * PERIOD
    assert all(a > b for a, b in itertools.pairwise(lateness))
    assert pacer.given_up == 0.0


def test_long_stall_is_given_up_and_time_goes_on_from_there(made_up: Clock) -> None:
    pacer = Pacer(PERIOD)
    made_up.sleep(LONGEST_BACKLOG + 0.05)
    assert pacer.wait() > LONGEST_BACKLOG
    assert pacer.given_up > LONGEST_BACKLOG
    start = made_up.now
    for _ in range(5):
        pacer.wait()
    assert made_up.now - start == pytest.approx(5 * PERIOD, abs=1e-5)


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
