"""Another program's GRU gives the same verdicts from our weights."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.export.onnx import write_onnx
from costeer.intention.features import FEATURES, INPUTS, NUM_SCALED, VARIANTS
from costeer.intention.gru import NetworkWeights, crossing_probability, random_weights
from costeer.intention.weights import intention_network

onnxruntime = pytest.importorskip("onnxruntime")
pytest.importorskip("onnx")

# Both sides compute in float32 there, and its inputs are rounded to float32 too.
TOLERANCE = 1e-5


@pytest.fixture(scope="module")
def weights() -> NetworkWeights:
    """A network whose scaling and verdicts are far from trivial."""
    random = random_weights(24, seed=4)
    return random._replace(
        feature_mean=np.linspace(-1.0, 1.0, NUM_SCALED),
        feature_scale=np.linspace(0.5, 2.0, NUM_SCALED),
        dispensable=np.array([float(n != "longitudinal_velocity") for n in FEATURES]),
        output_weights=3.0 * random.output_weights,
    )


@pytest.fixture(scope="module")
def session(
    weights: NetworkWeights, tmp_path_factory: pytest.TempPathFactory
) -> Any:  # Any: onnxruntime has no types
    """The network as ONNX Runtime runs it."""
    path = tmp_path_factory.mktemp("onnx") / "network.onnx"
    write_onnx(path, intention_network(weights, {}))
    return onnxruntime.InferenceSession(str(path), providers=["CPUExecutionProvider"])


def answer(session: Any, window: NDArray[np.float64]) -> NDArray[np.float32]:
    (said,) = session.run(None, {"feature_window": window.astype(np.float32)})
    return np.asarray(said)


def windows() -> NDArray[np.float64]:
    window = np.random.default_rng(0).normal(0.0, 2.0, (50, 180, 6))
    window[0, :, 2] = 1e4  # beyond the limit of scaled signals
    return window


def test_onnx_runtime_agrees(weights: NetworkWeights, session: Any) -> None:
    exact = crossing_probability(weights, windows())
    np.testing.assert_allclose(
        answer(session, windows()), exact, rtol=0, atol=TOLERANCE
    )
    assert np.ptp(exact) > 0.1


@pytest.mark.parametrize("variant", VARIANTS)
def test_onnx_runtime_agrees_without_signals(
    variant: str, weights: NetworkWeights, session: Any
) -> None:
    window, absent = windows(), VARIANTS[variant]
    exact = crossing_probability(weights, window, absent=absent)
    window[..., [FEATURES.index(name) for name in absent]] = np.nan
    np.testing.assert_allclose(answer(session, window), exact, rtol=0, atol=TOLERANCE)
    assert np.ptp(exact) > 0.1


def test_onnx_runtime_agrees_when_the_head_is_lost_now_and_then(
    weights: NetworkWeights, session: Any
) -> None:
    window = windows()
    lost = np.random.default_rng(1).random(window.shape[:2]) < 0.3
    window[lost, FEATURES.index("head_yaw")] = np.nan
    exact = crossing_probability(weights, window)
    np.testing.assert_allclose(answer(session, window), exact, rtol=0, atol=TOLERANCE)
    seen = crossing_probability(weights, windows())
    assert np.abs(exact - seen).max() > 100.0 * TOLERANCE


def test_the_model_says_what_it_takes_and_what_it_can_do_without(session: Any) -> None:
    said = session.get_modelmeta().custom_metadata_map
    assert tuple(said["features"].split(",")) == FEATURES
    assert tuple(said["inputs"].split(",")) == INPUTS
    needed = set(FEATURES) - set(said["dispensable"].split(","))
    assert needed == {"longitudinal_velocity"}
