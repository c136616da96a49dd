"""The intention network as an ONNX model, for other programs and as a second opinion.

The graph holds all of it: velocity towards the line, scaling, flags for what is
missing, GRU, sigmoid. NaN in the input is a missing signal, of which the graph makes
the best; whether the network was trained to do without it stands in the model's
metadata as `dispensable`.

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
    INPUTS,
    NUM_FEATURES,
    NUM_INPUTS,
    WINDOW_LENGTH,
)
from costeer.intention.gru import NetworkWeights, hidden_size
from costeer.intention.weights import IntentionNetwork

_OPSET = 9
"""The first with IsNaN and Where, for old runtimes too."""
_IR_VERSION = 4
_FLOAT = 1
"""ONNX's number of the type float32."""
_UPDATE_RESET_CANDIDATE = [1, 0, 2]


def _initializers(weights: NetworkWeights) -> dict[str, NDArray[np.generic]]:
    """Constants of the graph; ONNX stacks the gates as update, reset, candidate."""
    hidden, order = hidden_size(weights), _UPDATE_RESET_CANDIDATE
    biases = [weights.input_bias[order], weights.hidden_bias[order]]
    recurrent = weights.hidden_weights[order]
    return {
        "mean": weights.feature_mean.astype(np.float32),
        "scale": weights.feature_scale.astype(np.float32),
        "zero": np.array(0.0, np.float32),
        "W": weights.input_weights[order].reshape(1, 3 * hidden, NUM_INPUTS),
        "R": recurrent.reshape(1, 3 * hidden, hidden),
        "B": np.concatenate(biases).reshape(1, 6 * hidden),
        "output_weights": weights.output_weights.reshape(hidden, 1),
        "output_bias": weights.output_bias,
        "flat": np.array([-1], np.int64),
    }


def _input_nodes(node: Callable[..., Any]) -> list[Any]:  # Any: onnx.NodeProto
    """From `feature_window` to `inputs`, as `features.network_inputs` does."""

    def signal(name: str) -> Any:
        place = FEATURES.index(name)
        return node(
            "Slice",
            ["feature_window"],
            [name],
            axes=[2],
            starts=[place],
            ends=[place + 1],
        )

    limits = {"min": -FEATURE_LIMIT, "max": FEATURE_LIMIT}
    return [
        signal("longitudinal_velocity"),
        signal("yaw_angle"),
        node("Sin", ["yaw_angle"], ["away"]),
        node("Neg", ["away"], ["towards"]),
        node("Mul", ["longitudinal_velocity", "towards"], ["approach_velocity"]),
        node("Concat", ["feature_window", "approach_velocity"], ["signals"], axis=2),
        node("IsNaN", ["signals"], ["unknown"]),
        node("Sub", ["signals", "mean"], ["centred"]),
        node("Div", ["centred", "scale"], ["deviation"]),
        node("Clip", ["deviation"], ["held"], **limits),
        node("Where", ["unknown", "zero", "held"], ["values"]),
        node("IsNaN", ["feature_window"], ["missing"]),
        node("Cast", ["missing"], ["flags"], to=_FLOAT),
        node("Concat", ["values", "flags"], ["inputs"], axis=2),
    ]


def _network_nodes(node: Callable[..., Any], hidden: int) -> list[Any]:  # Any: as above
    """Run the GRU over `inputs`, close with the sigmoid."""
    return [
        node("Transpose", ["inputs"], ["by_time"], perm=[1, 0, 2]),
        node(
            "GRU",
            ["by_time", "W", "R", "B"],
            ["", "last"],
            hidden_size=hidden,
            linear_before_reset=1,
        ),
        node("Squeeze", ["last"], ["state"], axes=[0]),
        node("MatMul", ["state", "output_weights"], ["product"]),
        node("Add", ["product", "output_bias"], ["logit"]),
        node("Sigmoid", ["logit"], ["probability"]),
        node("Reshape", ["probability", "flat"], ["crossing_probability"]),
    ]


def _metadata(network: IntentionNetwork) -> dict[str, str]:
    """What the model says of itself."""
    each = zip(FEATURES, network.weights.dispensable, strict=True)
    return {
        "features": ",".join(FEATURES),
        "dispensable": ",".join(name for name, can_go in each if can_go),
        "inputs": ",".join(INPUTS),
        "weights_hash": network.hash,
        "facts": json.dumps(network.facts, sort_keys=True),
    }


def write_onnx(path: Path, network: IntentionNetwork) -> None:
    """Write the network and all that precedes it as one ONNX graph.

    Input `feature_window`, float32 `(batch, 180, 6)` in the signals' units, facing
    right (intention/features.py), NaN where a signal is missing; output
    `crossing_probability`, `(batch,)`.

    Raises:
        ImportError: If the package `onnx` is not installed.
    """
    import onnx
    from onnx import helper, numpy_helper

    hidden = hidden_size(network.weights)
    nodes = _input_nodes(helper.make_node) + _network_nodes(helper.make_node, hidden)
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
    helper.set_model_props(model, _metadata(network))
    onnx.checker.check_model(model, full_check=True)
    path.write_bytes(model.SerializeToString())
