"""Another program's GRU gives the same verdicts from our weights."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from costeer.export.onnx import write_onnx
from costeer.intention.gru import crossing_probability, random_weights
from costeer.intention.weights import intention_network

onnxruntime = pytest.importorskip("onnxruntime")
pytest.importorskip("onnx")


def test_onnx_runtime_agrees(tmp_path: Path) -> None:
    random = random_weights(24, seed=4)
    weights = random._replace(
        feature_mean=np.linspace(-1.0, 1.0, 6),
        feature_scale=np.linspace(0.5, 2.0, 6),
        output_weights=3.0 * random.output_weights,
    )
    write_onnx(tmp_path / "network.onnx", intention_network(weights, {}))
    window = np.random.default_rng(0).normal(0.0, 2.0, (50, 180, 6))
    window[0, :, 2] = 1e4  # beyond the limit of scaled signals
    session = onnxruntime.InferenceSession(
        str(tmp_path / "network.onnx"), providers=["CPUExecutionProvider"]
    )
    (answer,) = session.run(None, {"feature_window": window.astype(np.float32)})
    exact = crossing_probability(weights, window)
    # Both sides compute in float32 there, and its inputs are rounded to float32 too.
    np.testing.assert_allclose(answer, exact, rtol=0, atol=1e-5)
    assert np.ptp(exact) > 0.1
