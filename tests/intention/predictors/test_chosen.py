"""The predictor that is meant: a file of weights as it is now."""

from __future__ import annotations

from pathlib import Path

from costeer.intention.predictors.chosen import chosen_predictor
from costeer.intention.weights import (
    load_weights,
    save_weights,
    weights_hash,
)


def test_weights_that_are_written_anew_are_read_anew(tmp_path: Path) -> None:
    file = tmp_path / "mine.npz"
    save_weights(file, load_weights())
    before = chosen_predictor(weights=str(file))
    assert chosen_predictor(weights=str(file)) is before
    network = load_weights()
    changed = network.weights._replace(output_bias=network.weights.output_bias + 1)
    save_weights(file, network._replace(weights=changed, hash=weights_hash(changed)))
    assert chosen_predictor(weights=str(file)).hash != before.hash
