"""The cascade: exact where the watcher stirs, to the last bit."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from benchmarks.windows import cascade, sparse
from costeer.intention import wavefront
from costeer.intention.features import WINDOW_LENGTH, IntentionSample
from costeer.intention.kernel import TILE
from tests.intention.lively import lively_weights, needy_weights, signals
from tests.intention.test_kernel import in_python, pair_in_numpy

# It takes half a minute to compile, and no command of a user runs it.
pytestmark = pytest.mark.slow

SIZES = (3, 8, 20, 33)


def with_gaps(num_samples: int, seed: int = 0) -> Any:
    features = signals(num_samples, seed)
    features[200:215, 0] = np.nan
    features[400, 2] = np.inf
    return features


@pytest.mark.parametrize("hidden", SIZES)
def test_with_gate_0_it_is_the_exact_window_bit_for_bit(hidden: int) -> None:
    weights, features = lively_weights(hidden), with_gaps(900)
    packed = cascade.cascade_weights(weights, gate=0.0)
    np.testing.assert_array_equal(
        cascade.crossing_probabilities(packed, features),
        wavefront.crossing_probabilities(weights, features),
    )


@pytest.mark.parametrize("gate", [0.3, 0.4, 0.5])
def test_it_is_exact_from_the_gate_on_and_the_watcher_below(gate: float) -> None:
    weights, features = lively_weights(16), with_gaps(3000)
    found = cascade.crossing_probabilities(
        cascade.cascade_weights(weights, gate), features
    )
    exact = wavefront.crossing_probabilities(weights, features)
    watcher = cascade.cascade_weights(weights)._replace(gate=2.0)
    watched = cascade.crossing_probabilities(watcher, features)
    np.testing.assert_array_equal(found, np.where(watched >= gate, exact, watched))
    opened = np.mean(watched >= gate)
    assert 0.1 < opened < 0.9  # both are seen
    assert np.nanmax(np.abs(exact - watched)) > 1e-3  # and can be told apart


def test_windows_opened_again_within_a_tile_take_what_they_missed() -> None:
    weights, features = lively_weights(8), signals(WINDOW_LENGTH + 3 * TILE)
    packed = cascade.cascade_weights(weights, gate=0.0)
    asleep = packed._replace(gate=2.0)
    exact = wavefront.crossing_probabilities(weights, features)
    state = cascade.initial_state(packed)
    rng = np.random.default_rng(4)
    for row, expected in zip(features, exact, strict=True):
        stirs = rng.random() < 0.3
        found = cascade.advance(
            packed if stirs else asleep, state, IntentionSample(*row)
        )
        if stirs:
            np.testing.assert_equal(found, expected)


def test_sample_by_sample_equals_the_whole_recording() -> None:
    packed = cascade.cascade_weights(lively_weights(16), gate=0.4)
    features = with_gaps(700)
    state = cascade.initial_state(packed)
    one_by_one = [
        cascade.advance(packed, state, IntentionSample(*row)) for row in features
    ]
    np.testing.assert_array_equal(
        one_by_one, cascade.crossing_probabilities(packed, features)
    )


def test_after_a_reset_the_past_is_forgotten() -> None:
    packed = cascade.cascade_weights(lively_weights(8), gate=0.4)
    state = cascade.initial_state(packed)

    def run() -> list[float]:
        rows = signals(400)
        return [cascade.advance(packed, state, IntentionSample(*r)) for r in rows]

    first = run()
    cascade.reset(state)
    np.testing.assert_array_equal(run(), first)


def test_absent_signals_are_not_looked_at() -> None:
    weights, features = lively_weights(8), signals(400)
    packed = cascade.cascade_weights(weights, gate=0.0)
    found = cascade.crossing_probabilities(packed, features, ("head_yaw",))
    expected = wavefront.crossing_probabilities(weights, features, ("head_yaw",))
    np.testing.assert_array_equal(found, expected)
    needy = cascade.cascade_weights(needy_weights(8))
    with pytest.raises(ValueError, match="head_yaw"):
        cascade.initial_state(needy, ("head_yaw",))


def test_what_cannot_be_is_refused() -> None:
    weights = lively_weights(8)
    with pytest.raises(ValueError, match=r"gate is 0\.6; give"):
        cascade.cascade_weights(weights, gate=0.6)
    with pytest.raises(ValueError, match="stride is 59 samples"):
        cascade.cascade_weights(weights, stride=59)
    with pytest.raises(ValueError, match=r"\(time, 6\)"):
        cascade.crossing_probabilities(
            cascade.cascade_weights(weights), np.zeros((200, 5))
        )


def block_in_numpy(
    recurrent: Any, bias: Any, projection: Any, states: Any, new_states: Any, block: int
) -> None:
    """What `advance_block` does, in the order of its rows."""
    width = recurrent.shape[-1]
    own = slice(block * width, (block + 1) * width)
    hidden = recurrent.shape[1]
    rows = np.einsum("kgw,sk->gsw", recurrent[block], states[:, :hidden])
    reset = 0.5 + 0.5 * np.tanh(rows[0] + projection[0, own])
    update = 0.5 + 0.5 * np.tanh(rows[1] + projection[1, own])
    candidate = np.tanh(projection[2, own] + reset * (rows[2] + bias[own]))
    new_states[:, own] = candidate + update * (states[:, own] - candidate)


def test_the_bookkeeping_in_plain_python_gives_the_same_verdicts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    packed = cascade.cascade_weights(lively_weights(4), gate=0.4)
    rows = with_gaps(700)
    expected = cascade.crossing_probabilities(packed, rows)
    monkeypatch.setattr(wavefront, "advance_pair", pair_in_numpy)
    monkeypatch.setattr(sparse, "advance_block", block_in_numpy)
    found = np.empty(len(rows))
    state = cascade.initial_state(packed)
    in_python(cascade._advance_over)(packed, state, rows, found)
    # float32, and tanh within 4e-7.
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-6)
    state = cascade.initial_state(packed)
    step = in_python(cascade.advance)
    again = [step(packed, state, IntentionSample(*row)) for row in rows]
    np.testing.assert_array_equal(again, found)
    assert math.isnan(found[400])
