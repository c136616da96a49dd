"""Cheaper forms of the window, and how they are compared with the exact one."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.windows.agreement import agreement, joined, matched, percentile
from benchmarks.windows.forms import (
    CARRIED,
    EXACT,
    WATCHER,
    enlarged,
    few_probabilities,
    forms,
    num_starts,
    strided,
)
from benchmarks.windows.sparse import NEVER, STRIDE
from costeer.intention.features import WINDOW_LENGTH
from costeer.intention.gru import crossing_probability
from costeer.intention.wavefront import crossing_probabilities
from tests.intention.lively import lively_weights, signals

# Each form is compiled anew, and no command of a user runs them.
pytestmark = pytest.mark.slow


def test_windows_that_start_at_every_sample_are_the_exact_ones() -> None:
    weights, features = lively_weights(16), signals(700)
    features[300, 2] = np.nan
    np.testing.assert_array_equal(
        strided(weights, features, 1), crossing_probabilities(weights, features)
    )


@pytest.mark.parametrize("stride", [3, 6, 12, 60])
def test_a_strided_window_starts_at_the_last_multiple_of_the_stride(
    stride: int,
) -> None:
    weights, features = lively_weights(16), signals(430)
    found = strided(weights, features, stride)
    for end in (179, 180, 200, 239, 240, 241, 429):
        start = (end + 1 - WINDOW_LENGTH) // stride * stride
        # A fresh run in float64; the kernel's errors stay below 1e-6.
        fresh = crossing_probability(weights, features[start : end + 1])
        assert abs(found[end] - fresh) < 2e-6
    assert num_starts(1) == WINDOW_LENGTH
    assert num_starts(60) == 4


def test_the_watcher_is_the_strided_window_bit_for_bit() -> None:
    weights, features = lively_weights(20), signals(900)
    features[400, 1] = np.inf
    np.testing.assert_array_equal(
        few_probabilities(weights, features, STRIDE), strided(weights, features, STRIDE)
    )


def test_a_carried_state_is_the_window_at_the_first_verdict_and_no_more() -> None:
    weights, features = lively_weights(16), signals(700)
    exact = crossing_probabilities(weights, features)
    carried = few_probabilities(weights, features, NEVER)
    first = WINDOW_LENGTH - 1
    np.testing.assert_array_equal(carried[: first + 1], exact[: first + 1])
    assert np.nanmax(np.abs(carried - exact)) > 1e-3
    # It is a run from the first sample on.
    fresh = crossing_probability(weights, features)
    assert abs(carried[-1] - fresh) < 2e-6


def test_every_form_has_verdicts_where_the_exact_one_has() -> None:
    weights, features = lively_weights(8), signals(500)
    known = forms(weights, gates=(0.1,))
    assert [form.name for form in known[:2]] == [EXACT, CARRIED]
    assert WATCHER in [form.name for form in known]
    exact = known[0].run(features)
    for form in known:
        np.testing.assert_array_equal(
            np.isfinite(form.run(features)), np.isfinite(exact)
        )


def test_idle_units_change_no_verdict() -> None:
    weights, features = lively_weights(8), signals(400)
    np.testing.assert_array_equal(
        crossing_probabilities(enlarged(weights, 32), features),
        crossing_probabilities(weights, features),
    )
    with pytest.raises(ValueError, match="give that or more, not 4"):
        enlarged(weights, 4)


def test_triggers_are_missing_extra_or_shifted() -> None:
    exact, form = np.array([100, 500, 900, 2000]), np.array([100, 503, 1500, 2000])
    assert matched(exact, form) == (1, 1, 1)
    assert matched(exact, exact) == (0, 0, 0)
    assert matched(exact, np.array([], np.int64)) == (4, 0, 0)


def series(*positive: tuple[int, int]) -> np.ndarray:
    """Verdicts of 0.1, and of 0.9 between the given samples."""
    values = np.full(1000, 0.1)
    for start, end in positive:
        values[start:end] = 0.9
    return values


def test_agreement_counts_what_differs() -> None:
    exact, form = series((100, 110), (500, 502)), series((101, 110), (700, 710))
    found = agreement(exact, form, 2.0, gates=(0.05, 0.5))
    assert (found.missing, found.extra, found.shifted) == (0, 1, 1)
    # One sample at 100, two at 500 that are no trigger, ten at 700.
    assert found.verdicts == 13
    # Triggers hold from the third sample on: one at 102, eight at 702.
    assert found.held == 9
    assert found.largest == pytest.approx(0.8)
    assert found.lowest == 0.9
    assert found.stirred.tolist() == [1000, 19]
    assert percentile(found, 99.9) == pytest.approx(0.8, abs=1.1e-4)
    assert percentile(found, 50.0) == 1e-4


def test_two_sets_of_recordings_are_counted_together() -> None:
    one = agreement(series((100, 110)), series(), 1.0, (0.05,))
    both = joined(one, agreement(series(), series((100, 110)), 2.0, (0.05,)))
    assert (both.missing, both.extra, both.seconds) == (1, 1, 3.0)
    assert both.largest == one.largest
    assert both.lowest == pytest.approx(0.1)


def test_a_form_without_verdicts_where_there_are_some_is_refused() -> None:
    silent = series()
    silent[10] = np.nan
    with pytest.raises(ValueError, match="other samples"):
        agreement(series(), silent, 1.0)
