"""The threshold that a file of weights brings: adapted networks have their own."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from costeer.intention.predictors.registry import OURS
from costeer.intention.weights import load_weights

USUAL = 0.5
"""Source: paper, sigmoid output."""

NAME = "inference.threshold"
"""Of the parameter of the loop."""


def own_threshold(predictor: object, weights: object) -> float | None:
    """Threshold that a network's file was given by `costeer train --adapt`.

    Args:
        predictor: Name, or what else may predict.
        weights: Its file; what is none is refused elsewhere.

    Returns:
        None if the file tells none, or is of another predictor.

    Raises:
        ValueError: If the file holds no network.
        OSError: If it cannot be read.
    """
    if not isinstance(weights, str | Path) or predictor != OURS:
        return None
    if Path(weights).suffix == ".onnx":
        return None
    found = load_weights(Path(weights)).facts.get("threshold")
    return float(found) if isinstance(found, int | float) else None


def chosen_threshold(given: float | None, predictor: object, weights: object) -> float:
    """The threshold that was asked for, else that of the weights, else 0.5.

    Raises:
        ValueError: If the file holds no network.
        OSError: If it cannot be read.
    """
    if given is not None:
        return given
    own = own_threshold(predictor, weights)
    return USUAL if own is None else own


def with_threshold(
    values: Mapping[str, float],
    predictor: object,
    weights: object,
    method: object = "ibhs",
) -> dict[str, float]:
    """Parameters of the loop, with the threshold of the weights if none was set.

    Args:
        values: By dotted name.
        predictor: As for `own_threshold`.
        weights: Its file.
        method: Guidance; only the paper's has this threshold.
    """
    own = own_threshold(predictor, weights) if method == "ibhs" else None
    return dict(values) if own is None else {NAME: own, **values}
