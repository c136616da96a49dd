"""The network's weights as a file, and the weights that ship with costeer.

The format is NumPy's `.npz` without pickles: one array per field of `NetworkWeights`
and `header`, a JSON text in UTF-8 with the format's version and what is known of the
training. The same network gives the same bytes.
"""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.files import read_whole
from costeer.intention.arrays import (
    Form,
    arrays_hash,
    check_array,
    read_arrays,
    write_arrays,
)
from costeer.intention.features import (
    INPUTS,
    NUM_FEATURES,
    NUM_INPUTS,
    NUM_SCALED,
)
from costeer.intention.gru import NetworkWeights

FORM = Form(
    version=2,
    kind="intention weights (.npz of `costeer train`)",
    remedy="train again with `costeer train`",
)
_DOUBLE = ("feature_mean", "feature_scale", "dispensable")
_SHIPPED = "ibhs.npz"


class IntentionNetwork(NamedTuple):
    """A trained network and where it comes from.

    Attributes:
        weights: All numbers.
        facts: What is known of the training: drivers, samples, seed, results.
        hash: SHA-256 of the weights, see `weights_hash`.
    """

    weights: NetworkWeights
    facts: dict[str, Any]  # Any: JSON
    hash: str


def weights_hash(weights: NetworkWeights) -> str:
    """SHA-256 over names, shapes and little-endian bytes of all arrays."""
    return arrays_hash(_stored(weights))


def intention_network(
    weights: NetworkWeights, facts: dict[str, Any]
) -> IntentionNetwork:
    """Join weights and facts, after a check of all shapes and values.

    Raises:
        ValueError: If an array has the wrong shape or a value is not finite.
    """
    checked = NetworkWeights(**_stored(weights))
    _check(checked, "the network")
    return IntentionNetwork(weights=checked, facts=facts, hash=weights_hash(checked))


def save_weights(path: Path, network: IntentionNetwork) -> None:
    """Write the file in one piece: it is there whole or not at all."""
    write_arrays(
        path,
        FORM,
        _stored(network.weights),
        inputs=list(INPUTS),
        hash=network.hash,
        facts=network.facts,
    )


def load_weights(path: Path | None = None) -> IntentionNetwork:
    """Read a network; without a path, the one that ships with costeer.

    Raises:
        ValueError: If the file is not such a network, is of another version, does not
            fit itself or has been altered.
        OSError: If the file cannot be read.
    """
    if path is None:
        content = resources.files(__package__).joinpath("data", _SHIPPED).read_bytes()
        return _parsed(content, f"the shipped {_SHIPPED}")
    return _parsed(read_whole(path), str(path))


def _stored(weights: NetworkWeights) -> dict[str, NDArray[Any]]:
    """The arrays by name, in the types of the file."""
    return {
        name: np.ascontiguousarray(values, "<f8" if name in _DOUBLE else "<f4")
        for name, values in weights._asdict().items()
    }


def _parsed(content: bytes, source: str) -> IntentionNetwork:
    header, arrays = read_arrays(content, FORM, source)
    missing = [name for name in NetworkWeights._fields if name not in arrays]
    if missing:
        raise ValueError(f"{source} lacks the arrays {', '.join(missing)}")
    weights = NetworkWeights(**{name: arrays[name] for name in NetworkWeights._fields})
    _check(weights, source)
    facts = header.get("facts", {})
    if not isinstance(facts, dict):
        raise ValueError(f"{source} is damaged: what it tells of its training is none")
    network = intention_network(weights, facts)
    if network.hash != header.get("hash"):
        raise ValueError(f"{source} was altered: its hash does not fit its weights")
    return network


def _check(weights: NetworkWeights, source: str) -> None:
    """Refuse shapes that do not fit together and values that are not finite."""
    hidden = weights.output_weights.size
    wanted = {
        "feature_mean": (NUM_SCALED,),
        "feature_scale": (NUM_SCALED,),
        "dispensable": (NUM_FEATURES,),
        "input_weights": (3, hidden, NUM_INPUTS),
        "input_bias": (3, hidden),
        "hidden_weights": (3, hidden, hidden),
        "hidden_bias": (3, hidden),
        "output_weights": (hidden,),
        "output_bias": (1,),
    }
    for name, values in weights._asdict().items():
        check_array(values, wanted[name], f"{name} of {source}")
    if not np.isin(weights.dispensable, (0.0, 1.0)).all():
        raise ValueError(
            f"dispensable of {source} is {weights.dispensable.tolist()}; it is 0 or 1 "
            "for each signal"
        )
