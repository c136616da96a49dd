"""Time of one verdict of the exact window, by hidden size.

    python benchmarks/intention_speed.py

Prints the median of a tick when compiled code calls (as the closed loop does), p50 and
p99 of single calls from Python, the rate of useful arithmetic (matrix product only),
and the same window in ONNX Runtime (one thread) where that is installed.
"""

from __future__ import annotations

import platform
import tempfile
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from costeer.bench.control import verdict_seconds
from costeer.intention.features import NUM_FEATURES, WINDOW_LENGTH, IntentionSample
from costeer.intention.gru import random_weights
from costeer.intention.kernel import LAYOUT
from costeer.intention.wavefront import (
    advance,
    initial_state,
    wavefront_weights,
)
from costeer.intention.weights import intention_network

SIZES = (8, 16, 24, 32, 48, 64)
TICKS = 20_000


def tick_times(hidden: int) -> NDArray[np.float64]:
    """Seconds of each call of `advance` from Python."""
    packed = wavefront_weights(random_weights(hidden, 1))
    state = initial_state(packed)
    sample = IntentionSample(*np.random.default_rng(0).normal(size=6))
    for _ in range(200):
        advance(packed, state, sample)
    times = np.empty(TICKS)
    for i in range(TICKS):
        start = time.perf_counter()
        advance(packed, state, sample)
        times[i] = time.perf_counter() - start
    return times


def onnx_time(hidden: int) -> float:
    """Median seconds of one whole window in ONNX Runtime, NaN if not installed."""
    try:
        import onnxruntime

        from costeer.export.onnx import write_onnx
    except ImportError:
        return float("nan")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "network.onnx"
        write_onnx(file, intention_network(random_weights(hidden, 1), {}))
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = 1
        session = onnxruntime.InferenceSession(
            str(file), options, providers=["CPUExecutionProvider"]
        )
    window = np.zeros((1, WINDOW_LENGTH, NUM_FEATURES), np.float32)
    runs = []
    for _ in range(200):
        start = time.perf_counter()
        session.run(None, {"feature_window": window})
        runs.append(time.perf_counter() - start)
    return float(np.median(runs))


def main() -> None:
    """Print the table."""
    print(f"{platform.processor() or platform.machine()}, {LAYOUT}, one thread")
    print("hidden   compiled us   from Python p50   p99   GFLOP/s   ONNX Runtime us")
    for hidden in SIZES:
        inside = float(np.median(verdict_seconds(random_weights(hidden, 1), 15)))
        p50, p99 = np.percentile(tick_times(hidden), [50, 99])
        work = 2 * 3 * hidden * hidden * WINDOW_LENGTH
        print(
            f"{hidden:6d} {inside * 1e6:13.1f} {p50 * 1e6:17.1f} {p99 * 1e6:5.1f} "
            f"{work / inside / 1e9:9.0f} {onnx_time(hidden) * 1e6:17.1f}"
        )


if __name__ == "__main__":
    main()
