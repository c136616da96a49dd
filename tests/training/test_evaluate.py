"""The judgement: what it counts, its intervals, and its form."""

from __future__ import annotations

import json

import numpy as np
import pytest

from costeer.intention.gru import NetworkWeights, random_weights
from costeer.intention.wavefront import crossing_probabilities
from costeer.training.evaluate import (
    DriverVerdicts,
    EvaluationParameters,
    at_false_rate,
    evaluate,
    judged_samples,
    verdicts,
)
from costeer.training.triggers import TriggerParameters, judge
from tests.training.synthetic import drive, drives


def yaw_watcher() -> NetworkWeights:
    """One unit that says yes while the car points to the adjacent lane."""
    weights = random_weights(1, 1)
    zeros = {
        name: np.zeros_like(values)
        for name, values in weights._asdict().items()
        if name not in ("feature_mean", "feature_scale")
    }
    watcher = weights._replace(**zeros)
    watcher.feature_scale[5] = 0.01
    watcher.input_weights[2, 0, 5] = -1.0
    watcher.input_bias[1] = -5.0
    watcher.output_weights[0] = 20.0
    watcher.output_bias[0] = -16.0
    return watcher


RECORDINGS = drives(4)
RESULT = evaluate(yaw_watcher(), RECORDINGS)


def test_samples_are_those_with_verdict_and_known_answer() -> None:
    said, truth = judged_samples(verdicts(yaw_watcher(), RECORDINGS))
    known = sum(int(r.labels.known[179:].sum()) for r in RECORDINGS)
    assert len(said) == len(truth) == known == RESULT["num_samples"]


def test_verdicts_are_those_of_the_exact_window() -> None:
    (one,) = verdicts(yaw_watcher(), [RECORDINGS[0]])
    expected = crossing_probabilities(yaw_watcher(), RECORDINGS[0].features)
    np.testing.assert_array_equal(one.probabilities[0], expected)


def test_a_good_watcher_finds_all_crossings() -> None:
    triggers = RESULT["triggers"]
    assert triggers["num_crossings"] == 16.0
    assert triggers["missed"] == 0.0
    assert 0.5 < triggers["lead_time_median"] < 3.0
    assert RESULT["samples"]["pr_auc"] > 0.8


def test_intervals_hold_the_value() -> None:
    values = RESULT["samples"] | RESULT["triggers"]
    for name, (low, high) in RESULT["interval_95"].items():
        # Areas of the intervals come from bins, 0.002 coarse at most.
        assert low - 2e-3 <= values[name] <= high + 2e-3
    assert set(RESULT["interval_95"]) >= {"pr_auc", "f1", "lead_time_median"}


def test_drivers_alike_give_narrow_intervals_unlike_ones_wide() -> None:
    blind = [
        r._replace(features=r.features * np.array([1, 1, 1, 1, 1, 0.3]))
        for r in RECORDINGS[:2]
    ]
    mixed = evaluate(yaw_watcher(), blind + RECORDINGS[2:])
    width = np.diff(mixed["interval_95"]["recall"])
    assert width > 3.0 * np.diff(RESULT["interval_95"]["recall"])


def test_the_result_is_json_without_nan() -> None:
    text = json.dumps(RESULT, allow_nan=False)
    assert json.loads(text) == RESULT


def test_without_crossings_scores_are_null_and_nothing_fails() -> None:
    result = evaluate(yaw_watcher(), [drive(1, num_changes=0)])
    assert result["samples"]["pr_auc"] is None
    assert result["triggers"]["lead_time_median"] is None
    assert result["samples"]["prevalence"] == 0.0


def test_recordings_without_a_full_window_are_refused() -> None:
    short = drive(1)
    short.features[::100] = np.nan
    with pytest.raises(ValueError, match="no sample can be judged"):
        evaluate(yaw_watcher(), [short])


def test_the_threshold_is_the_lowest_that_keeps_to_the_rate() -> None:
    made = drive(1, num_changes=1)
    crossing = int(np.flatnonzero(made.intended)[0])
    probability = np.full(len(made.side), 0.01)
    probability[crossing - 150 : crossing] = 0.95
    for bump, start in ((0.3, 200), (0.6, crossing + 400), (0.8, crossing + 600)):
        probability[start : start + 10] = bump
    drivers = [DriverVerdicts("a", [made], [probability])]
    per_trigger = 1.0 / judge(made, probability, TriggerParameters()).kilometres
    for allowed, low, high in ((0, 0.8, 0.95), (1, 0.6, 0.8), (2, 0.3, 0.6)):
        rate = (allowed + 0.5) * per_trigger
        found = at_false_rate(drivers, EvaluationParameters(false_per_km=rate))
        assert found["false_triggers"] == allowed
        # The threshold moves in quarters of a logit.
        logit = np.log(found["threshold"] / (1.0 - found["threshold"]))
        assert low < found["threshold"] <= high
        assert logit - 0.25 <= np.log(low / (1.0 - low))


def test_a_rate_that_no_threshold_keeps_has_no_lead() -> None:
    made = drive(1, num_changes=0)
    drivers = [DriverVerdicts("a", [made], [np.full(len(made.side), 1.0)])]
    assert at_false_rate(drivers, EvaluationParameters()) == {}


def test_the_same_seed_gives_the_same_intervals() -> None:
    assert evaluate(yaw_watcher(), RECORDINGS) == RESULT
