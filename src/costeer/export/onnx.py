"""The intention network as an ONNX model, for other programs and as a second opinion.

Needs the package `onnx` (extra `dev`); nothing else in costeer does.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import (
    FEATURE_LIMIT,
    FEATURES,
    NUM_FEATURES,
    WINDOW_LENGTH,
)
from costeer.intention.gru import NetworkWeights, hidden_size
from costeer.intention.weights import IntentionNetwork

_OPSET = 14
_IR_VERSION = 8
_UPDATE_RESET_CANDIDATE = [1, 0, 2]


def _initializers(weights: NetworkWeights) -> dict[str, NDArray[np.generic]]:
    """Constants of the graph; ONNX stacks the gates as update, reset, candidate."""
    hidden, order = hidden_size(weights), _UPDATE_RESET_CANDIDATE
    biases = [weights.input_bias[order], weights.hidden_bias[order]]
    recurrent = weights.hidden_weights[order]
    return {
        "mean": weights.feature_mean.astype(np.float32),
        "scale": weights.feature_scale.astype(np.float32),
        "low": np.array(-FEATURE_LIMIT, np.float32),
        "high": np.array(FEATURE_LIMIT, np.float32),
        "W": weights.input_weights[order].reshape(1, 3 * hidden, NUM_FEATURES),
        "R": recurrent.reshape(1, 3 * hidden, hidden),
        "B": np.concatenate(biases).reshape(1, 6 * hidden),
        "output_weights": weights.output_weights.reshape(hidden, 1),
        "output_bias": weights.output_bias,
        "first": np.array([0], np.int64),
        "flat": np.array([-1], np.int64),
    }


def _nodes(node: Callable[..., Any], hidden: int) -> list[Any]:  # Any: onnx.NodeProto
    """Scale, run the GRU, close with the sigmoid."""
    return [
        node("Sub", ["feature_window", "mean"], ["centred"]),
        node("Div", ["centred", "scale"], ["deviation"]),
        node("Clip", ["deviation", "low", "high"], ["scaled"]),
        node("Transpose", ["scaled"], ["by_time"], perm=[1, 0, 2]),
        node(
            "GRU",
            ["by_time", "W", "R", "B"],
            ["", "last"],
            hidden_size=hidden,
            linear_before_reset=1,
        ),
        node("Squeeze", ["last", "first"], ["state"]),
        node("MatMul", ["state", "output_weights"], ["product"]),
        node("Add", ["product", "output_bias"], ["logit"]),
        node("Sigmoid", ["logit"], ["probability"]),
        node("Reshape", ["probability", "flat"], ["crossing_probability"]),
    ]


def write_onnx(path: Path, network: IntentionNetwork) -> None:
    """Write the network with its scaling as one ONNX graph.

    Input `feature_window`, float32 `(batch, 180, 6)` in the signals' units, facing
    right (intention/features.py); output `crossing_probability`, `(batch,)`.

    Raises:
        ImportError: If the package `onnx` is not installed.
    """
    import onnx
    from onnx import helper, numpy_helper

    nodes = _nodes(helper.make_node, hidden_size(network.weights))
    constants = _initializers(network.weights)
    kind = onnx.TensorProto.FLOAT
    shape: list[str | int | None] = ["batch", WINDOW_LENGTH, NUM_FEATURES]
    value = helper.make_tensor_value_info
    graph = helper.make_graph(
        nodes,
        "crossing_probability",
        [value("feature_window", kind, shape)],
        [value("crossing_probability", kind, ["batch"])],
        [numpy_helper.from_array(v, name) for name, v in constants.items()],
    )
    opset = helper.make_opsetid("", _OPSET)
    model = helper.make_model(graph, opset_imports=[opset], ir_version=_IR_VERSION)
    facts = {"features": ",".join(FEATURES), "weights_hash": network.hash}
    facts["facts"] = json.dumps(network.facts, sort_keys=True)
    helper.set_model_props(model, facts)
    onnx.checker.check_model(model)
    path.write_bytes(model.SerializeToString())
