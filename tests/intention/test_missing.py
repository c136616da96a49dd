"""Signals that are not there: what a network can do without, and what it then says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.intention.features import (
    FEATURES,
    HEAD_YAW,
    VARIANTS,
    WINDOW_LENGTH,
)
from costeer.intention.gru import NetworkWeights, crossing_probability
from costeer.intention.predictors.gru import our_probabilities, paper_probabilities
from costeer.intention.wavefront import (
    crossing_probabilities,
    initial_state,
    wavefront_weights,
)
from tests.intention.lively import lively_weights, needy_weights, signals, windows

LACKING = {name: absent for name, absent in VARIANTS.items() if absent}
DIFFERENCE = 1e-3
"""What one signal more or less changes at least, far above rounding [-]."""


def places(absent: tuple[str, ...]) -> list[int]:
    return [FEATURES.index(name) for name in absent]


def garbage(
    features: NDArray[np.float64], absent: tuple[str, ...], kind: str
) -> NDArray[np.float64]:
    """The same drive with something else in the columns of absent signals."""
    rng = np.random.default_rng(7)
    shape = (len(features), len(absent))
    filled = features.copy()
    filled[:, places(absent)] = {
        "nan": np.full(shape, np.nan),
        "all of them": rng.choice([0.0, 1e300, np.nan, np.inf, -np.inf], shape),
    }[kind]
    return filled


@pytest.mark.parametrize("kind", ["nan", "all of them"])
@pytest.mark.parametrize("variant", LACKING)
def test_what_stands_in_an_absent_signal_changes_no_bit(
    variant: str, kind: str
) -> None:
    weights, features, absent = lively_weights(8), signals(300), LACKING[variant]
    other = garbage(features, absent, kind)
    said = crossing_probabilities(weights, features, absent)
    assert np.isfinite(said[WINDOW_LENGTH - 1 :]).all()
    np.testing.assert_array_equal(said, crossing_probabilities(weights, other, absent))
    np.testing.assert_array_equal(
        crossing_probability(weights, windows(features)[::30], absent=absent),
        crossing_probability(weights, windows(other)[::30], absent=absent),
    )


@pytest.mark.parametrize("variant", LACKING)
def test_an_absent_signal_is_missed(variant: str) -> None:
    weights, features = lively_weights(8), signals(300)
    said = crossing_probabilities(weights, features, LACKING[variant])
    gap = np.abs(said - crossing_probabilities(weights, features))
    assert np.nanmax(gap) > DIFFERENCE


@pytest.mark.slow
@pytest.mark.parametrize("variant", LACKING)
def test_without_signals_each_verdict_equals_a_fresh_run(variant: str) -> None:
    weights, features, absent = lively_weights(16), signals(500), LACKING[variant]
    verdicts = crossing_probabilities(weights, features, absent)
    exact = crossing_probability(weights, windows(features), absent=absent)
    # As with all signals: float32 against float64 over 180 steps.
    np.testing.assert_allclose(verdicts[WINDOW_LENGTH - 1 :], exact, rtol=0, atol=1e-6)
    assert np.ptp(exact) > 0.02


def losing_the_head(features: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same drive, a third of the head's samples lost, in runs of half a second."""
    lost = np.random.default_rng(2).random(-(-len(features) // 30)) < 1.0 / 3.0
    seen = features.copy()
    seen[np.repeat(lost, 30)[: len(features)], HEAD_YAW] = np.nan
    return seen


def test_with_a_head_lost_now_and_then_each_verdict_equals_a_fresh_run() -> None:
    weights, features = lively_weights(16), signals(500)
    seen = losing_the_head(features)
    verdicts = crossing_probabilities(weights, seen)[WINDOW_LENGTH - 1 :]
    exact = crossing_probability(weights, windows(seen))
    np.testing.assert_allclose(verdicts, exact, rtol=0, atol=1e-6)
    whole = crossing_probabilities(weights, features)[WINDOW_LENGTH - 1 :]
    assert np.abs(verdicts - whole).max() > DIFFERENCE


def test_a_head_that_is_lost_throughout_is_absent() -> None:
    weights, features = lively_weights(8), signals(300)
    lost = garbage(features, ("head_yaw",), "nan")
    np.testing.assert_array_equal(
        crossing_probabilities(weights, lost),
        crossing_probabilities(weights, features, ("head_yaw",)),
    )


def silent(verdicts: NDArray[np.float64]) -> NDArray[np.int64]:
    """Samples without a verdict after the first full window."""
    return np.flatnonzero(np.isnan(verdicts[WINDOW_LENGTH - 1 :])) + WINDOW_LENGTH - 1


def test_a_lost_head_silences_the_windows_that_hold_it_if_the_head_is_needed() -> None:
    needy, features = needy_weights(8), signals(700)
    can_all_but_head = np.ones(len(FEATURES))
    can_all_but_head[HEAD_YAW] = 0.0
    features[300:310, HEAD_YAW] = np.nan
    for weights in (needy, needy._replace(dispensable=can_all_but_head)):
        verdicts = crossing_probabilities(weights, features)
        np.testing.assert_array_equal(
            silent(verdicts), np.arange(300, 309 + WINDOW_LENGTH)
        )
        fresh = crossing_probability(weights, windows(features)[::20])
        np.testing.assert_array_equal(
            np.isnan(fresh), np.isnan(verdicts[WINDOW_LENGTH - 1 :: 20])
        )
    free = crossing_probabilities(lively_weights(8), features)
    assert silent(free).size == 0


@pytest.mark.parametrize("broken", [math.inf, -math.inf])
def test_a_head_that_cannot_be_is_no_lost_head(broken: float) -> None:
    features = signals(700)
    features[300, HEAD_YAW] = broken
    verdicts = crossing_probabilities(lively_weights(8), features)
    np.testing.assert_array_equal(silent(verdicts), np.arange(300, 300 + WINDOW_LENGTH))


@pytest.mark.parametrize("column", range(1, len(FEATURES)))
def test_any_other_signal_that_is_lost_makes_its_windows_silent(column: int) -> None:
    # Only the head is lost and found within a drive; for all others NaN is a fault.
    features = signals(500)
    features[200, column] = np.nan
    verdicts = crossing_probabilities(lively_weights(8), features)
    np.testing.assert_array_equal(silent(verdicts), np.arange(200, 200 + WINDOW_LENGTH))


def can_do_without(*names: str) -> NetworkWeights:
    dispensable = np.array([float(name in names) for name in FEATURES])
    return lively_weights(8)._replace(dispensable=dispensable)


@pytest.mark.parametrize("needed", FEATURES)
def test_what_a_network_needs_is_named_when_it_is_absent(needed: str) -> None:
    weights = can_do_without(*(name for name in FEATURES if name != needed))
    absent, features = FEATURES, signals(WINDOW_LENGTH)
    said = f"not trained to do without {needed}: give"
    with pytest.raises(ValueError, match=said):
        crossing_probabilities(weights, features, absent)
    with pytest.raises(ValueError, match=said):
        crossing_probability(weights, features, absent=absent)
    with pytest.raises(ValueError, match=said):
        initial_state(wavefront_weights(weights), absent)


def test_all_that_is_needed_is_named() -> None:
    weights = can_do_without("head_yaw")
    absent = ("head_yaw", "steering_wheel_angle", "yaw_angle")
    with pytest.raises(ValueError, match="without steering_wheel_angle, yaw_angle: "):
        crossing_probabilities(weights, signals(WINDOW_LENGTH), absent)


def test_the_papers_network_is_silent_without_any_signal() -> None:
    weights, features = needy_weights(8), signals(500)
    np.testing.assert_array_equal(
        paper_probabilities(weights, features),
        crossing_probabilities(weights, features),
    )
    for absent in LACKING.values():
        assert np.isnan(paper_probabilities(weights, features, absent)).all()
    features[200, HEAD_YAW] = np.nan
    verdicts = paper_probabilities(lively_weights(8), features)
    np.testing.assert_array_equal(silent(verdicts), np.arange(200, 200 + WINDOW_LENGTH))


def test_ours_is_silent_where_it_would_be_refused() -> None:
    features, absent = signals(300), ("head_yaw",)
    assert np.isnan(our_probabilities(needy_weights(8), features, absent)).all()
    np.testing.assert_array_equal(
        our_probabilities(lively_weights(8), features, absent),
        crossing_probabilities(lively_weights(8), features, absent),
    )
