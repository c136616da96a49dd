"""Medians and spread of times."""

from __future__ import annotations

import numpy as np

from benchmarks.speed.timing import (
    FULL,
    QUICK,
    call_times,
    figure,
    percentiles,
    seconds_of,
)


def test_a_figure_is_median_lowest_and_highest() -> None:
    found = figure("trial", "one", "s", np.array([3.0, 1.0, 2.0]), "told")
    assert (found.median, found.low, found.high) == (2.0, 1.0, 3.0)
    assert found.remark == "told"


def test_work_is_done_once_a_round() -> None:
    done: list[int] = []
    times = seconds_of(lambda: done.append(1), 4)
    assert len(done) == times.size == 4
    assert (times >= 0.0).all()


def test_every_call_is_timed() -> None:
    assert call_times(lambda: None, 10).shape == (10,)


def test_percentiles_rise_and_are_in_microseconds() -> None:
    tiny = QUICK._replace(rounds=2, calls=200)
    found = percentiles("step", "step", lambda: sum(range(100)), tiny)
    assert [f.name for f in found] == ["step, p50", "step, p99", "step, p99.9"]
    assert found[0].median <= found[1].median <= found[2].median
    # A hundred additions take between 0.1 us and 1 ms on any machine.
    assert 0.1 < found[0].median < 1000.0


def test_quick_is_less_than_full() -> None:
    assert all(q < f for q, f in zip(QUICK, FULL, strict=True))
