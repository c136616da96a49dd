"""What holds for every predictor, whatever its numbers."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.intention.features import FEATURES, HEAD_YAW, WINDOW_LENGTH, feature_series
from costeer.intention.predictors.interface import Predictor, lacking
from costeer.intention.predictors.registry import fitted_predictor
from tests.intention.predictors.made import baselines, features

PREDICTORS = [fitted_predictor(name, one) for name, one in baselines().items()]
each = pytest.mark.parametrize("predictor", PREDICTORS, ids=lambda one: one.name)
DISTANCE = FEATURES.index("distance_to_adjacent_lane")

# Convolutions sum in the same order wherever a window lies, so only the last digits of
# products differ; single precision in the two recurrent networks.
TOLERANCE = 1e-6


@each
def test_no_verdict_before_the_window_is_full(predictor: Predictor) -> None:
    said = predictor.probabilities(features(240, 0), ())
    assert np.isnan(said[: WINDOW_LENGTH - 1]).all()
    rest = said[WINDOW_LENGTH - 1 :]
    assert ((rest >= 0.0) & (rest <= 1.0)).all()


@each
def test_an_empty_and_a_short_drive_have_no_verdict(predictor: Predictor) -> None:
    for length in (1, 100):
        assert np.isnan(predictor.probabilities(features(length, 0), ())).all()


@each
def test_the_future_does_not_change_the_past(predictor: Predictor) -> None:
    seen = features(400, 1)
    changed = seen.copy()
    changed[300:] += 1.0
    changed[350:, DISTANCE] = np.nan
    before, after = (predictor.probabilities(one, ())[:300] for one in (seen, changed))
    np.testing.assert_array_equal(before, after)


@each
def test_a_verdict_depends_on_its_window_only(predictor: Predictor) -> None:
    seen = features(400, 2)
    said = predictor.probabilities(seen, ())
    for end in (179, 250, 399):
        window = seen[end - WINDOW_LENGTH + 1 : end + 1]
        alone = predictor.probabilities(window, ())[-1]
        assert alone == pytest.approx(said[end], abs=TOLERANCE)


@each
def test_a_bad_sample_silences_the_windows_that_hold_it(predictor: Predictor) -> None:
    for bad in (np.nan, np.inf):
        seen = features(500, 3)
        seen[200, DISTANCE] = bad
        said = predictor.probabilities(seen, ())
        assert np.isnan(said[200 : 200 + WINDOW_LENGTH]).all()
        assert np.isfinite(said[179:200]).all()
        whole = predictor.probabilities(features(500, 3), ())
        np.testing.assert_allclose(said[380:], whole[380:], atol=TOLERANCE)


@each
def test_the_mirrored_world_gets_the_same_verdicts(predictor: Predictor) -> None:
    seen = features(300, 4)
    columns = {name: seen[:, i] for i, name in enumerate(FEATURES)}
    odd = ("head_yaw", "steering_wheel_angle", "yaw_angle")
    mirrored = {n: -v if n in odd else v for n, v in columns.items()}
    right, left = np.full(300, -1, np.int8), np.full(300, 1, np.int8)
    np.testing.assert_array_equal(
        predictor.probabilities(feature_series(columns, right), ()),
        predictor.probabilities(feature_series(mirrored, left), ()),
    )


@each
def test_absent_signals_are_not_looked_at(predictor: Predictor) -> None:
    absent = ("head_yaw", "steering_wheel_angle")
    seen = features(300, 5)
    blind, other = seen.copy(), seen.copy()
    for name in absent:
        blind[:, FEATURES.index(name)] = np.nan
        other[:, FEATURES.index(name)] = 0.3
    said = predictor.probabilities(blind, absent)
    np.testing.assert_array_equal(said, predictor.probabilities(other, absent))
    assert np.isnan(said[179:]).all() == bool(lacking(predictor, absent))


@each
def test_what_is_needed_is_needed(predictor: Predictor) -> None:
    for name in predictor.needs:
        said = predictor.probabilities(features(200, 6), (name,))
        assert np.isnan(said).all()


@each
def test_broken_units_stay_probabilities(predictor: Predictor) -> None:
    seen = 1e6 * features(300, 7)
    seen[:, HEAD_YAW] = 1e300
    said = predictor.probabilities(seen, ())[179:]
    assert ((said >= 0.0) & (said <= 1.0)).all()


@each
def test_the_input_is_left_as_it_was(predictor: Predictor) -> None:
    seen = features(200, 8)
    seen[50:80, HEAD_YAW] = np.nan
    kept = seen.copy()
    predictor.probabilities(seen, ())
    np.testing.assert_array_equal(seen, kept)
