"""One verdict of the exact window by hidden size: time, work, share of the limit.

    python benchmarks/intention_speed.py [--quick]

Prints the machine, what one core of it can do at most, and for each hidden size and the
shipped network: p50 and p99 of single verdicts called by compiled code and from Python,
operations, bytes, their ratio, the share of the limit, and the network time of a whole
study (34,500 s of driving) on all cores. Then the same window in ONNX Runtime (one
thread), where that is installed. docs/bench.md says how all is counted.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

from costeer.bench.control import measure_network
from costeer.bench.machine import machine
from costeer.bench.timing import FULL, QUICK, Figure
from costeer.bench.verdicts import SIZES
from costeer.cli.bench import print_figures
from costeer.intention.features import NUM_FEATURES, WINDOW_LENGTH
from costeer.intention.gru import random_weights
from costeer.intention.weights import intention_network

RUNS = 200


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
    for _ in range(RUNS):
        start = time.perf_counter()
        session.run(None, {"feature_window": window})
        runs.append(time.perf_counter() - start)
    return float(np.median(runs))


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    outcome = measure_network(QUICK if parser.parse_args().quick else FULL)
    for name, value in machine().items():
        print(f"{name:10} {value}")
    print_figures([found for found in outcome if isinstance(found, Figure)])
    for hidden in SIZES:
        print(f"ONNX Runtime, {hidden} units: {1e6 * onnx_time(hidden):.0f} us")


if __name__ == "__main__":
    main()
