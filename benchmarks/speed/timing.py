"""Times as median and spread, because one run on a shared machine says little."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Figure(NamedTuple):
    """One measured number.

    Attributes:
        group: What it belongs to.
        name: What was measured.
        unit: Of the numbers.
        median: Over the rounds.
        low: Lowest round.
        high: Highest round.
        remark: What one should know to read it.
    """

    group: str
    name: str
    unit: str
    median: float
    low: float
    high: float
    remark: str = ""


class Skipped(NamedTuple):
    """Something that could not be measured here.

    Attributes:
        group: What it belongs to.
        name: What was to be measured.
        reason: Why not, and the way out.
    """

    group: str
    name: str
    reason: str


Outcome = list[Figure | Skipped]


class Effort(NamedTuple):
    """How long to measure.

    Attributes:
        rounds: Times that each thing is run.
        calls: Single calls whose percentiles are taken.
        length: Of the course of a trial [m].
        batch: Trials in a batch.
    """

    rounds: int
    calls: int
    length: float
    batch: int


FULL = Effort(rounds=5, calls=20_000, length=8000.0, batch=96)
QUICK = Effort(rounds=2, calls=5_000, length=1500.0, batch=16)


def seconds_of(work: Callable[[], object], rounds: int) -> NDArray[np.float64]:
    """Wall time of each of some rounds of `work`, shape `(round,)` [s]."""
    times = np.empty(rounds)
    for i in range(rounds):
        start = time.perf_counter()
        work()
        times[i] = time.perf_counter() - start
    return times


def figure(
    group: str, name: str, unit: str, values: NDArray[np.float64], remark: str = ""
) -> Figure:
    """Median, lowest and highest of the rounds as a figure."""
    median = float(np.median(values))
    low, high = float(values.min()), float(values.max())
    return Figure(group, name, unit, median, low, high, remark)


def percentiles(
    group: str, name: str, call: Callable[[], object], effort: Effort, remark: str = ""
) -> list[Figure]:
    """p50, p99 and p99.9 of single calls from Python [us], over some rounds.

    Args:
        group: What it belongs to.
        name: What is called.
        call: The call.
        effort: Calls in a round, and rounds.
        remark: What one should know.
    """
    rounds = np.array([call_times(call, effort.calls) for _ in range(effort.rounds)])
    microseconds = 1e6 * np.percentile(rounds, [50.0, 99.0, 99.9], axis=1)
    return [
        figure(group, f"{name}, {label}", "us", values, remark)
        for label, values in zip(("p50", "p99", "p99.9"), microseconds, strict=True)
    ]


def call_times(call: Callable[[], object], calls: int) -> NDArray[np.float64]:
    """Wall time of each single call, shape `(call,)` [s]; the clock costs 0.05 us."""
    clock = time.perf_counter
    times = np.empty(calls)
    for i in range(calls):
        start = clock()
        call()
        times[i] = clock() - start
    return times
