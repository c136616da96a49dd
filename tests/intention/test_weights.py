"""A file of weights is whole, unaltered and fits, or it is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from costeer.intention.gru import NetworkWeights, random_weights
from costeer.intention.weights import (
    IntentionNetwork,
    intention_network,
    load_weights,
    save_weights,
)


def network(hidden: int = 8, seed: int = 1) -> IntentionNetwork:
    return intention_network(random_weights(hidden, seed), {"seed": seed})


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    file = tmp_path / "weights.npz"
    save_weights(file, network())
    again = load_weights(file)
    assert again.hash == network().hash
    assert again.facts == {"seed": 1}
    for mine, read in zip(network().weights, again.weights, strict=True):
        np.testing.assert_array_equal(mine, read)


def test_the_same_network_gives_the_same_bytes(tmp_path: Path) -> None:
    save_weights(tmp_path / "a.npz", network())
    save_weights(tmp_path / "b.npz", network())
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_a_file_at_hidden_64_stays_far_below_a_megabyte(tmp_path: Path) -> None:
    save_weights(tmp_path / "a.npz", network(64))
    assert (tmp_path / "a.npz").stat().st_size < 100_000


def test_any_changed_weight_changes_the_hash() -> None:
    weights = random_weights(8, 1)
    before = intention_network(weights, {}).hash
    weights.output_bias[0] += 1e-6
    assert intention_network(weights, {}).hash != before


def test_facts_do_not_change_the_hash() -> None:
    weights = random_weights(8, 1)
    with_facts = intention_network(weights, {"drivers": 9})
    assert with_facts.hash == intention_network(weights, {}).hash


def altered(**changes: np.ndarray) -> NetworkWeights:
    return random_weights(8, 1)._replace(**changes)


@pytest.mark.parametrize(
    ("weights", "words"),
    [
        (altered(input_weights=np.zeros((3, 8, 5))), "input_weights.*(3, 8, 5)"),
        (altered(input_weights=np.zeros((3, 8, 6))), "expected (3, 8, 13)"),
        (altered(hidden_weights=np.zeros((3, 8, 9))), "hidden_weights.*(3, 8, 9)"),
        (altered(output_weights=np.zeros(0)), "shape"),
        (altered(output_bias=np.zeros(2)), "output_bias"),
        (altered(input_bias=np.full((3, 8), np.nan)), "not finite"),
        (altered(feature_mean=np.zeros(6)), "feature_mean.*(6,), expected (7,)"),
        (altered(feature_scale=np.zeros(7)), "positive"),
        (altered(dispensable=np.full(6, 0.5)), "0 or 1"),
        (altered(dispensable=np.ones(7)), "dispensable.*(7,), expected (6,)"),
        (altered(dispensable=np.full(6, np.nan)), "dispensable.*not finite"),
    ],
)
def test_weights_that_do_not_fit_are_refused(
    weights: NetworkWeights, words: str
) -> None:
    with pytest.raises(ValueError, match=words.replace("(", r"\(").replace(")", r"\)")):
        intention_network(weights, {})


def test_damage_is_found(tmp_path: Path) -> None:
    file = tmp_path / "weights.npz"
    save_weights(file, network())
    content = file.read_bytes()
    for damaged in (content[: len(content) // 2], b"", b"not a file", content[::-1]):
        file.write_bytes(damaged)
        with pytest.raises(ValueError, match=r"not a file of intention weights"):
            load_weights(file)


def test_another_numpy_file_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "array.npy"
    np.save(file, np.zeros(3))
    with pytest.raises(ValueError, match=r"not a file of intention weights"):
        load_weights(file)


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("output_bias", np.array(["x"]), "output_bias of .* holds <U1, expected"),
        ("output_bias", np.array([1j]), "holds complex128, expected"),
        ("header", np.frombuffer(b"[1]", np.uint8), "not a file of intention weights"),
    ],
)
def test_an_array_that_holds_no_floats_is_refused(
    name: str, value: Any, said: str, tmp_path: Path
) -> None:
    file = tmp_path / "weights.npz"
    save_weights(file, network())
    with np.load(file) as archive:
        arrays: dict[str, Any] = {key: archive[key] for key in archive.files}
    np.savez(file, **(arrays | {name: value}))
    with pytest.raises(ValueError, match=said):
        load_weights(file)


def test_weights_changed_in_the_file_are_found(tmp_path: Path) -> None:
    file = tmp_path / "weights.npz"
    save_weights(file, network())
    with np.load(file) as archive:
        arrays = dict(archive)
    arrays["output_bias"] = arrays["output_bias"] + np.float32(1.0)
    np.savez(file, **arrays)
    with pytest.raises(ValueError, match="altered"):
        load_weights(file)


def test_missing_arrays_are_named(tmp_path: Path) -> None:
    file = tmp_path / "weights.npz"
    save_weights(file, network())
    with np.load(file) as archive:
        arrays = {k: v for k, v in archive.items() if k != "hidden_bias"}
    np.savez(file, **arrays)
    with pytest.raises(ValueError, match="hidden_bias"):
        load_weights(file)


@pytest.mark.parametrize(
    "change",
    [
        ('"version": 2', '"version": 9'),
        ('"version": 2', '"version": 1'),
        ("yaw", "jaw"),
    ],
)
def test_another_version_or_other_signals_are_refused(
    tmp_path: Path, change: tuple[str, str]
) -> None:
    file = tmp_path / "weights.npz"
    save_weights(file, network())
    with np.load(file) as archive:
        arrays = dict(archive)
    header = arrays["header"].tobytes().decode().replace(*change)
    arrays["header"] = np.frombuffer(header.encode(), np.uint8)
    np.savez(file, **arrays)
    with pytest.raises(ValueError, match="costeer train"):
        load_weights(file)


@pytest.mark.parametrize("seed", range(60))
def test_damage_anywhere_is_refused_in_one_line(seed: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed)
    file = tmp_path / "weights.npz"
    save_weights(file, network())
    content = bytearray(file.read_bytes())
    num = int(rng.integers(1, 40))
    place = int(rng.integers(len(content) - num))
    content[place : place + num] = rng.bytes(num)
    file.write_bytes(content)
    told = ""
    try:
        load_weights(file)
    except ValueError as error:
        told = str(error)
    assert not told or "weights.npz" in told


def test_an_array_of_a_size_that_no_memory_holds_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "weights.npz"
    save_weights(file, network())
    whole = file.read_bytes()
    file.write_bytes(
        whole.replace(b"'shape': (8,), }  ", b"'shape': (9999999999,)}"[:18])
    )
    with pytest.raises(ValueError, match=r"weights\.npz is not a file of intention"):
        load_weights(file)
