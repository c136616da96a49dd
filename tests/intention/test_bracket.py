"""The bracket: exact to the bit with an open band, and what it does with another."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.intention import bracket, starts
from costeer.intention.bracket import advance, watched
from costeer.intention.features import HEAD_YAW, WINDOW_LENGTH, IntentionSample
from costeer.intention.gru import crossing_probability
from costeer.intention.starts import (
    STRIDE,
    Band,
    bracket_weights,
    initial_state,
    logit,
    reset,
)
from costeer.intention.wavefront import crossing_probabilities
from tests.intention.lively import lively_weights, needy_weights, signals
from tests.intention.test_kernel import in_python

BAND = Band(0.05, 0.95)
NARROW = Band(0.45, 0.55)


def with_gaps(num_samples: int, seed: int = 0) -> NDArray[np.float64]:
    """Signals with a sample that nobody can use and a head that is lost for a while."""
    rows = signals(num_samples, seed)
    rows[num_samples // 3, 2] = np.inf
    rows[num_samples // 2 : num_samples // 2 + 7, HEAD_YAW] = np.nan
    return rows


def sides(probability: NDArray[np.float64]) -> NDArray[np.bool_]:
    return probability >= 0.5


@pytest.mark.parametrize(
    "hidden", [3, 16, *(pytest.param(n, marks=pytest.mark.slow) for n in (8, 33, 64))]
)
def test_with_an_open_band_it_is_the_wavefront_to_the_last_bit(hidden: int) -> None:
    weights, rows = lively_weights(hidden), with_gaps(1300)
    found = watched(bracket_weights(weights), rows)
    expected = crossing_probabilities(weights, rows)
    np.testing.assert_array_equal(found.probability, expected)
    assert np.ptp(expected[np.isfinite(expected)]) > 0.05
    np.testing.assert_array_equal(found.exact, np.isfinite(expected))


@pytest.mark.parametrize("weights", [lively_weights(8), needy_weights(8)])
def test_it_is_silent_where_the_exact_window_is(weights: Any) -> None:
    rows = with_gaps(1300)
    found = watched(bracket_weights(weights, BAND), rows)
    expected = crossing_probabilities(weights, rows)
    np.testing.assert_array_equal(np.isnan(found.probability), np.isnan(expected))
    # A lost head silences the one that needs it.
    assert np.isnan(expected[660]) == (weights.dispensable[HEAD_YAW] == 0.0)


def test_absent_signals_are_not_looked_at() -> None:
    weights, rows = lively_weights(8), with_gaps(900)
    absent = ("head_yaw", "yaw_angle")
    found = watched(bracket_weights(weights), rows, absent)
    expected = crossing_probabilities(weights, rows, absent)
    np.testing.assert_array_equal(found.probability, expected)
    with pytest.raises(ValueError, match="head_yaw"):
        initial_state(bracket_weights(needy_weights(8)), ("head_yaw",))


def test_the_states_are_fresh_runs_from_the_last_starts() -> None:
    weights, rows = lively_weights(16), signals(500)
    found = watched(bracket_weights(weights), rows)
    for end in (179, 180, 239, 240, 241, 499):
        oldest = (end + 1 - WINDOW_LENGTH) // STRIDE * STRIDE
        fresh = [
            logit(float(crossing_probability(weights, rows[oldest + k * 60 : end + 1])))
            for k in range(3)
        ]
        # The kernel's probabilities err by 1e-6; logits within ±3 by 20 times that.
        assert found.least[end] == pytest.approx(min(fresh), abs=3e-5)
        assert found.most[end] == pytest.approx(max(fresh), abs=3e-5)


def decided(rows: NDArray[np.float64], band: Band, weights: Any) -> NDArray[np.bool_]:
    """Which verdicts are exact, said once more in plain Python."""
    free = watched(bracket_weights(weights), rows)
    exact, confirmed = np.zeros(len(rows), bool), 0
    for i, value in enumerate(free.probability):
        if math.isnan(value) or free.most[i] < logit(band.low):
            confirmed = 0
        elif not (free.least[i] > logit(band.high) and confirmed >= 3):
            exact[i] = True
            confirmed = confirmed + 1 if value >= 0.5 else 0
    return exact


def test_exact_windows_are_asked_where_the_states_do_not_agree() -> None:
    weights = lively_weights(16)
    rows = np.concatenate([with_gaps(1500, seed) for seed in range(3)])
    found = watched(bracket_weights(weights, NARROW), rows)
    expected = crossing_probabilities(weights, rows)
    asked = decided(rows, NARROW, weights)
    np.testing.assert_array_equal(found.exact, asked)
    np.testing.assert_array_equal(found.probability[asked], expected[asked])
    told = np.isfinite(expected) & ~asked
    assert sides(found.probability[told]).any()
    assert asked[np.isfinite(expected)].mean() < 0.9
    # What is not exact is on the states' side.
    low = told & (found.most < logit(NARROW.low))
    assert not sides(found.probability[low]).any()
    assert sides(found.probability[told & ~low]).all()


def test_yes_begins_with_three_exact_windows() -> None:
    weights = lively_weights(16)
    weights = weights._replace(output_bias=weights.output_bias + 40.0)
    found = watched(bracket_weights(weights, BAND), signals(400))
    first = WINDOW_LENGTH - 1
    assert sides(found.probability[first:]).all()
    np.testing.assert_array_equal(np.flatnonzero(found.exact), first + np.arange(3))


def test_sample_by_sample_after_a_reset_it_says_the_same() -> None:
    packed, rows = bracket_weights(lively_weights(8), NARROW), signals(400)
    state = initial_state(packed)
    first = [advance(packed, state, IntentionSample(*row)) for row in rows]
    reset(state)
    again = [advance(packed, state, IntentionSample(*row)) for row in rows]
    np.testing.assert_array_equal(first, again)
    np.testing.assert_array_equal(first, watched(packed, rows).probability)


def test_what_cannot_be_is_refused() -> None:
    weights = lively_weights(8)
    with pytest.raises(ValueError, match=r"band 0\.6 to 0\.9"):
        bracket_weights(weights, Band(0.6, 0.9))
    with pytest.raises(ValueError, match=r"\(time, 6\)"):
        watched(bracket_weights(weights), np.zeros((200, 5)))


def block_in_numpy(
    recurrent: Any, unit_weights: Any, ring: Any, states: Any, places: Any
) -> None:
    """What `advance_block` does, in the order of its rows."""
    slot, which, block = places
    width, hidden = recurrent.shape[-1], recurrent.shape[1]
    own = slice(block * width, (block + 1) * width)
    given, old = ring[slot][:, own], states[which]
    rows = np.einsum("kgw,sk->gsw", recurrent[block], old[:, :hidden])
    opened = 0.5 + 0.5 * np.tanh(rows[0] + given[0])
    kept = 0.5 + 0.5 * np.tanh(rows[1] + given[1])
    candidate = np.tanh(given[2] + opened * (rows[2] + unit_weights[0, own]))
    states[2][:, own] = candidate + kept * (old[:, own] - candidate)


def test_the_bookkeeping_in_plain_python_gives_the_same_verdicts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    packed = bracket_weights(lively_weights(4), NARROW)
    rows = with_gaps(700)
    expected = watched(packed, rows)
    monkeypatch.setattr(starts, "advance_block", block_in_numpy)
    step = in_python(bracket.advance)
    monkeypatch.setattr(bracket, "advance", step)
    told = np.empty((len(rows), 4))
    in_python(bracket._advance_over)(packed, initial_state(packed), rows, told)
    # float32, and tanh within 4e-7; logits of such probabilities by four times that.
    np.testing.assert_allclose(told[:, 0], expected.probability, rtol=0, atol=2e-6)
    np.testing.assert_allclose(told[:, 1], expected.least, rtol=0, atol=1e-5)
    np.testing.assert_array_equal(told[:, 3] > 0.5, expected.exact)
