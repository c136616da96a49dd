"""One verdict of the exact window by hidden size: time, work, share of the limit."""

from __future__ import annotations

import ctypes
import os
import tempfile
import time
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.speed.cost import intensity, moved, operations, verdict_cost
from benchmarks.speed.timing import (
    Effort,
    Figure,
    Outcome,
    Skipped,
    figure,
    percentiles,
    seconds_of,
)
from costeer.intention.features import (
    NUM_FEATURES,
    SAMPLE_RATE,
    WINDOW_LENGTH,
    IntentionSample,
)
from costeer.intention.gru import NetworkWeights, hidden_size
from costeer.intention.wavefront import advance, initial_state, wavefront_weights
from costeer.intention.weights import intention_network
from costeer.scale.jobs import default_jobs

SIZES = (8, 16, 24, 32, 48, 64)

BUDGETS = {"p50 compiled": 80.0, "p99 compiled": 150.0}
"""Of one verdict at hidden size 64 [us]."""

BUDGET_SIZE = 64

STUDY_SECONDS = 34_500.0
"""Driving in the whole study [s]."""

STUDY_BUDGET = 30.0
"""Network time of the whole study [s]."""

SPARING = 10
"""Calls of a round are divided by this, as seven networks are measured [-]."""

_FRESH = 200


def single_verdicts(weights: NetworkWeights, calls: int) -> NDArray[np.float64]:
    """Time of each of some calls by compiled code, `(call,)` [s].

    The clock costs 0.05 us of it.

    Raises:
        NotImplementedError: If compiled code cannot read the clock of this system.
    """
    packed = wavefront_weights(weights)
    state = initial_state(packed)
    features = np.random.default_rng(0).normal(size=(_FRESH, NUM_FEATURES))
    times = np.empty(calls)
    timed = _timed_calls()
    timed(packed, state, features, np.empty(_FRESH))
    timed(packed, state, features, times)
    return times


@cache
def _timed_calls() -> Any:  # Any: a dispatcher of Numba
    """Compile the loop that times each call; not cached, as it holds an address."""
    if os.name != "posix":
        raise NotImplementedError("compiled code reads the clock on POSIX systems only")
    read = ctypes.CDLL(None).clock_gettime
    read.argtypes, read.restype = (ctypes.c_int, ctypes.c_void_p), ctypes.c_int
    clock = time.CLOCK_MONOTONIC

    @numba.njit(nogil=True, error_model="numpy")
    def timed(weights: Any, state: Any, features: Any, times: Any) -> None:
        moment = np.zeros(2, np.int64)  # seconds, nanoseconds
        for i in range(times.shape[0]):
            row = features[i % features.shape[0]]
            sample = IntentionSample(row[0], row[1], row[2], row[3], row[4], row[5])
            read(clock, moment.ctypes)
            seconds, nanoseconds = moment[0], moment[1]
            advance(weights, state, sample)
            read(clock, moment.ctypes)
            passed = (moment[0] - seconds) * 1_000_000_000 + moment[1] - nanoseconds
            times[i] = 1e-9 * passed

    return timed


def measure_verdict(
    name: str, weights: NetworkWeights, limit: float, effort: Effort
) -> Outcome:
    """Times, work, and share of what the core can do; a named line if not possible.

    Args:
        name: Of the network.
        weights: The network.
        limit: Operations per second that the core can do at most [1/s].
        effort: Rounds, and calls in a round.
    """
    group = f"verdict, {name}"
    calls = effort.calls // SPARING
    cost = verdict_cost(hidden_size(weights))
    work, size = float(operations(cost)), hidden_size(weights)
    try:
        rounds = [single_verdicts(weights, calls) for _ in range(effort.rounds)]
    except NotImplementedError as error:
        return [Skipped(group, group, str(error))]
    median, high = np.percentile(np.array(rounds), [50.0, 99.0], axis=1)
    numbers = {
        ("p50 compiled", "us"): 1e6 * median,
        ("p99 compiled", "us"): 1e6 * high,
        ("work", "MFLOP"): np.array([work / 1e6]),
        ("moved", "kB"): np.array([moved(cost) / 1e3]),
        ("intensity", "FLOP/B"): np.array([intensity(cost)]),
        ("rate", "GFLOP/s"): work / median / 1e9,
        ("share of limit", "%"): 100.0 * work / median / limit,
        ("study, all cores", "s"): STUDY_SECONDS
        * SAMPLE_RATE
        * median
        / default_jobs(),
    }
    figures = [
        figure(group, what, unit, values, _remark(size, what, unit, values))
        for (what, unit), values in numbers.items()
    ]
    return [
        *figures[:2],
        *_from_python(group, weights, effort),
        *_in_onnx_runtime(group, weights, effort),
        *figures[2:],
    ]


def _from_python(group: str, weights: NetworkWeights, effort: Effort) -> list[Figure]:
    """p50 and p99 of calls from Python."""
    packed = wavefront_weights(weights)
    state, sample = initial_state(packed), IntentionSample(*([0.1] * NUM_FEATURES))
    for _ in range(_FRESH):
        advance(packed, state, sample)
    found = percentiles(
        group,
        "from Python",
        lambda: advance(packed, state, sample),
        effort._replace(calls=effort.calls // SPARING),
    )
    return [
        each._replace(name=f"{label} from Python")
        for each, label in zip(found, ("p50", "p99"), strict=False)
    ]


def _in_onnx_runtime(
    group: str, weights: NetworkWeights, effort: Effort
) -> list[Figure]:
    """The whole window of 180 samples anew, on one thread; none if not installed."""
    try:
        import onnxruntime

        from costeer.export.onnx import write_onnx
    except ImportError:
        return []
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "network.onnx"
        write_onnx(file, intention_network(weights, {}))
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = 1
        session = onnxruntime.InferenceSession(
            str(file), options, providers=["CPUExecutionProvider"]
        )
    window = np.zeros((1, WINDOW_LENGTH, NUM_FEATURES), np.float32)
    times = seconds_of(
        lambda: session.run(None, {"feature_window": window}), _FRESH * effort.rounds
    )
    return [figure(group, "ONNX Runtime", "us", 1e6 * times)]


def _remark(size: int, what: str, unit: str, values: NDArray[np.float64]) -> str:
    """Whether a budget is kept."""
    budget = BUDGETS.get(what) if size == BUDGET_SIZE else None
    if what.startswith("study"):
        budget = STUDY_BUDGET
    if budget is None:
        return ""
    kept = "kept" if float(np.median(values)) < budget else "NOT kept"
    return f"budget {budget:g} {unit}: {kept}"
