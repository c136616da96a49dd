"""The wavefront gives the numbers of the window, whatever the samples."""

from __future__ import annotations

import math
import threading

import numba
import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.intention.features import (
    FEATURES,
    NUM_FEATURES,
    WINDOW_LENGTH,
    IntentionSample,
    facing,
    feature_series,
)
from costeer.intention.gru import crossing_probability
from costeer.intention.wavefront import (
    WavefrontState,
    WavefrontWeights,
    advance,
    crossing_probabilities,
    initial_state,
    reset,
    wavefront_weights,
)
from tests.intention.lively import lively_weights, needy_weights, signals, windows


@pytest.mark.parametrize(
    "hidden", [3, 16, *(pytest.param(n, marks=pytest.mark.slow) for n in (8, 33, 64))]
)
def test_each_verdict_equals_a_fresh_run_over_its_window(hidden: int) -> None:
    weights, features = lively_weights(hidden), signals(500)
    verdicts = crossing_probabilities(weights, features)
    exact = crossing_probability(weights, windows(features))
    # float32 rounds to 6e-8 and the kernel's tanh errs by up to 4e-7; the errors of 180
    # steps have either sign and partly cancel.
    np.testing.assert_allclose(verdicts[WINDOW_LENGTH - 1 :], exact, rtol=0, atol=1e-6)
    assert np.ptp(exact) > 0.05


def test_verdict_agrees_with_the_reference_in_float32() -> None:
    weights, features = lively_weights(32), signals(400, seed=3)
    verdicts = crossing_probabilities(weights, features)[WINDOW_LENGTH - 1 :]
    single = crossing_probability(weights, windows(features), np.float32)
    assert single.dtype == np.float32
    np.testing.assert_allclose(verdicts, single, rtol=0, atol=1e-6)


def test_there_is_no_verdict_before_the_window_is_full() -> None:
    verdicts = crossing_probabilities(lively_weights(8), signals(400))
    assert np.isnan(verdicts[: WINDOW_LENGTH - 1]).all()
    assert np.isfinite(verdicts[WINDOW_LENGTH - 1 :]).all()


@pytest.mark.parametrize("broken", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("column", range(NUM_FEATURES))
def test_an_invalid_sample_silences_exactly_the_windows_that_hold_it(
    broken: float, column: int
) -> None:
    weights, features = needy_weights(8), signals(700)
    features[300, column] = broken
    verdicts = crossing_probabilities(weights, features)
    silent = np.flatnonzero(np.isnan(verdicts[WINDOW_LENGTH - 1 :])) + WINDOW_LENGTH - 1
    np.testing.assert_array_equal(silent, np.arange(300, 300 + WINDOW_LENGTH))
    later = crossing_probabilities(weights, features[301:])
    np.testing.assert_array_equal(verdicts[480:], later[WINDOW_LENGTH - 1 :])


def test_the_reference_gives_no_verdict_from_an_invalid_window() -> None:
    features = signals(WINDOW_LENGTH)
    features[17, 2] = np.nan
    assert np.isnan(crossing_probability(lively_weights(4), features))


def test_absurd_values_do_not_break_the_verdict() -> None:
    features = signals(400)
    features[200] = 1e300
    verdicts = crossing_probabilities(lively_weights(8), features)[WINDOW_LENGTH - 1 :]
    assert ((verdicts >= 0.0) & (verdicts <= 1.0)).all()


def test_sample_by_sample_equals_the_whole_recording_bit_for_bit() -> None:
    weights, features = lively_weights(16), signals(400)
    packed = wavefront_weights(weights)
    state = initial_state(packed)
    one_by_one = [advance(packed, state, IntentionSample(*row)) for row in features]
    at_once = crossing_probabilities(weights, features)
    np.testing.assert_array_equal(one_by_one, at_once)


def test_after_a_reset_the_past_is_forgotten() -> None:
    packed = wavefront_weights(lively_weights(8))
    state = initial_state(packed)
    first = [advance(packed, state, IntentionSample(*row)) for row in signals(250)]
    reset(state)
    again = [advance(packed, state, IntentionSample(*row)) for row in signals(250)]
    np.testing.assert_array_equal(first, again)


@numba.njit
def last_verdict(
    weights: WavefrontWeights, state: WavefrontState, rows: NDArray[np.float64]
) -> float:
    verdict = 0.0
    for i in range(rows.shape[0]):
        sample = IntentionSample(
            rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5]
        )
        verdict = advance(weights, state, facing(sample, -1.0))
    return verdict


def test_compiled_code_may_call_it() -> None:
    weights, features = lively_weights(16), signals(200)
    packed = wavefront_weights(weights)
    verdict = last_verdict(packed, initial_state(packed), features)
    assert verdict == crossing_probabilities(weights, features)[-1]


def test_threads_with_their_own_states_do_not_disturb_each_other() -> None:
    packed = wavefront_weights(lively_weights(16))
    results: dict[int, float] = {}

    def run(seed: int) -> None:
        rows = signals(2000, seed)
        results[seed] = last_verdict(packed, initial_state(packed), rows)

    threads = [threading.Thread(target=run, args=(seed,)) for seed in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for seed in range(4):
        alone = last_verdict(packed, initial_state(packed), signals(2000, seed))
        assert results[seed] == alone


def test_mirrored_world_gives_the_same_verdict() -> None:
    rng = np.random.default_rng(5)
    columns = dict(zip(FEATURES, signals(400).T, strict=True))
    side = rng.choice(np.array([-1, 1], np.int8), 400)
    turned = {"head_yaw", "steering_wheel_angle", "yaw_angle"}
    mirrored = {name: -v if name in turned else v for name, v in columns.items()}
    weights = lively_weights(8)
    np.testing.assert_array_equal(
        crossing_probabilities(weights, feature_series(columns, side)),
        crossing_probabilities(weights, feature_series(mirrored, -side)),
    )


def test_without_mirroring_the_verdict_would_differ() -> None:
    columns = dict(zip(FEATURES, signals(400).T, strict=True))
    right = feature_series(columns, np.full(400, -1, np.int8))
    left = feature_series(columns, np.full(400, 1, np.int8))
    weights = lively_weights(8)
    gap = crossing_probabilities(weights, right) - crossing_probabilities(weights, left)
    assert np.nanmax(np.abs(gap)) > 0.01


def test_wrong_shapes_are_refused() -> None:
    with pytest.raises(ValueError, match=r"\(time, 6\)"):
        crossing_probabilities(lively_weights(8), np.zeros((200, 5)))
    with pytest.raises(ValueError, match="time, 6"):
        crossing_probability(lively_weights(8), np.zeros((200, 5)))


@pytest.mark.parametrize("missing", [0, 1])
def test_a_window_of_another_length_would_be_noticed(missing: int) -> None:
    weights, features = lively_weights(16), signals(WINDOW_LENGTH + 1)
    exact = crossing_probability(weights, features[1:])
    other = crossing_probability(weights, features[2 * missing :])
    assert abs(other - exact) > 2e-5
