"""The judgement: what it counts, its intervals, and its form."""

from __future__ import annotations

import json
from functools import cache, partial
from typing import Any

import numpy as np
import pytest

from costeer.intention.gru import NetworkWeights, random_weights
from costeer.intention.predictors.gru import our_probabilities
from costeer.intention.wavefront import crossing_probabilities
from costeer.training.evaluate import (
    DriverVerdicts,
    EvaluationParameters,
    at_false_rate,
    balanced_scores,
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
        if name not in ("feature_mean", "feature_scale", "dispensable")
    }
    watcher = weights._replace(**zeros)
    watcher.feature_scale[5] = 0.01
    watcher.input_weights[2, 0, 5] = -1.0
    watcher.input_bias[1] = -5.0
    watcher.output_weights[0] = 20.0
    watcher.output_bias[0] = -16.0
    return watcher


WATCH = partial(our_probabilities, yaw_watcher())
RECORDINGS = drives(5)


@cache
def result() -> dict[str, Any]:
    """What is judged in most tests."""
    return evaluate(WATCH, RECORDINGS)


def test_samples_are_those_with_verdict_and_known_answer() -> None:
    said, truth = judged_samples(verdicts(WATCH, RECORDINGS))
    known = sum(int(r.labels.known[179:].sum()) for r in RECORDINGS)
    assert len(said) == len(truth) == known == result()["num_samples"]


def test_verdicts_are_those_of_the_exact_window() -> None:
    (one,) = verdicts(WATCH, [RECORDINGS[0]])
    expected = crossing_probabilities(yaw_watcher(), RECORDINGS[0].features)
    # In the last 3 s nobody knows the answer, so nothing is judged there.
    expected[~RECORDINGS[0].labels.known] = np.nan
    np.testing.assert_array_equal(one.probabilities[0], expected)
    assert np.isnan(expected[-180:]).all()


def test_a_good_watcher_finds_all_crossings() -> None:
    triggers = result()["triggers"]
    assert triggers["num_crossings"] == 20.0
    assert triggers["missed"] == 0.0
    assert 0.5 < triggers["lead_time_median"] < 3.0
    assert result()["samples"]["pr_auc"] > 0.8


def test_intervals_hold_the_value() -> None:
    balanced = {f"{name}_balanced": v for name, v in result()["balanced"].items()}
    rated = {"lead_time_at_false_rate": result()["at_false_rate"]["lead_time_median"]}
    values = result()["samples"] | result()["triggers"] | balanced | rated
    for name, (low, high) in result()["interval_95"].items():
        # Areas of the intervals come from bins of 0.1 % of a class.
        assert low - 2e-3 <= values[name] <= high + 2e-3
    wanted = {"pr_auc", "f1", "lead_time_median", "lead_time_at_false_rate"}
    assert set(result()["interval_95"]) >= wanted


def test_the_intervals_say_how_they_were_made() -> None:
    assert result()["intervals"] == {
        "method": "percentile bootstrap over drivers",
        "level": 0.95,
        "resamples": 1000,
        "seed": 1,
        "drivers": 5,
    }


def test_too_few_drivers_get_the_reason_and_no_interval() -> None:
    few = evaluate(WATCH, RECORDINGS[:4])
    assert few["interval_95"] == {}
    assert few["intervals"]["none_because"] == (
        "4 drivers are too few for an interval; it needs at least 5"
    )
    assert few["samples"]["log_loss"] > 0.0


@pytest.mark.slow
def test_drivers_alike_give_narrow_intervals_unlike_ones_wide() -> None:
    blind = [
        r._replace(features=r.features * np.array([1, 1, 1, 1, 1, 0.3]))
        for r in RECORDINGS[:2]
    ]
    mixed = evaluate(WATCH, blind + RECORDINGS[2:])
    width = np.diff(mixed["interval_95"]["recall"])
    assert width > 3.0 * np.diff(result()["interval_95"]["recall"])


def test_the_result_is_json_without_nan() -> None:
    text = json.dumps(result(), allow_nan=False)
    assert json.loads(text) == result()


def test_without_crossings_scores_are_null_and_nothing_fails() -> None:
    result = evaluate(WATCH, [drive(1, num_changes=0)])
    assert result["samples"]["pr_auc"] is None
    assert result["triggers"]["lead_time_median"] is None
    assert result["samples"]["prevalence"] == 0.0


def test_recordings_without_a_full_window_are_refused() -> None:
    short = drive(1)
    short.features[::100] = np.nan
    with pytest.raises(ValueError, match="no sample can be judged"):
        evaluate(WATCH, [short])


def test_what_was_judged_is_counted() -> None:
    assert result()["num_drivers"] == result()["num_recordings"] == 5
    assert result()["num_crossings"] == 20
    assert result()["hours"] == pytest.approx(5 * (5700 - 179 - 180) / 60 / 3600)
    # About 20 m/s.
    assert result()["kilometres"] == pytest.approx(72.0 * result()["hours"], rel=0.05)


def test_half_positive_accuracy_is_balanced_accuracy() -> None:
    balanced, natural = result()["balanced"], result()["samples"]
    assert balanced["prevalence"] == pytest.approx(0.5)
    assert balanced["accuracy"] == pytest.approx(natural["balanced_accuracy"])
    assert balanced["recall"] == pytest.approx(natural["recall"])


def test_a_network_of_even_odds_says_yes_at_the_prevalence() -> None:
    # Bayes: 0.5 at even odds is what was said at the natural prevalence, 0.25 here.
    said, truth = np.array([0.26, 0.24, 0.3, 0.1]), np.array([1, 0, 0, 0], bool)
    found = balanced_scores(said, truth, 0.5)
    assert found["accuracy"] == 0.5
    assert found["accuracy_even_odds"] == pytest.approx((1.0 + 2.0 / 3.0) / 2.0)


def bumped(*bumps: tuple[float, int]) -> tuple[DriverVerdicts, float]:
    """A driver with one crossing announced 2.5 s before, false bumps, and 1/km."""
    made = drive(1, num_changes=1)
    crossing = int(np.flatnonzero(made.intended)[0])
    probability = np.full(len(made.side), 0.01)
    probability[crossing - 150 : crossing] = 0.95
    for height, start in bumps:
        probability[start : start + 10] = height
    per_trigger = 1.0 / judge(made, probability, TriggerParameters()).kilometres
    return DriverVerdicts("a", [made], [probability]), per_trigger


def test_only_thresholds_that_keep_to_the_rate_are_taken() -> None:
    driver, per_trigger = bumped((0.3, 200), (0.6, 1500), (0.8, 1700))
    for allowed in (0, 1, 2):
        rate = (allowed + 0.5) * per_trigger
        found = at_false_rate([driver], EvaluationParameters(false_per_km=rate))
        # All of them announce the crossing 148 samples before: the fewest false win.
        assert found["lead_time_median"] == pytest.approx(148 / 60)
        assert found["false_triggers"] == 0
        assert 0.8 < found["threshold"] <= 0.95


def test_the_largest_lead_is_found_behind_a_worse_threshold() -> None:
    # At 0.6 two false bumps count twice. Below 0.4 what lies between them is positive
    # too: one false trigger, and an earlier announcement.
    driver, per_trigger = bumped()
    said = driver.probabilities[0]
    crossing = int(np.flatnonzero(driver.recordings[0].intended)[0])
    said[crossing - 170 : crossing - 150] = 0.4
    said[300:500] = 0.4
    said[300:310] = said[490:500] = 0.6
    rate = 1.5 * per_trigger
    found = at_false_rate([driver], EvaluationParameters(false_per_km=rate))
    assert found["false_triggers"] == 1
    assert found["lead_time_median"] == pytest.approx(168 / 60)
    # The grid has twenty thresholds to a logit.
    assert 0.37 < found["threshold"] <= 0.4


def test_a_rate_that_no_threshold_keeps_has_no_lead() -> None:
    made = drive(1, num_changes=0)
    drivers = [DriverVerdicts("a", [made], [np.full(len(made.side), 1.0)])]
    assert at_false_rate(drivers, EvaluationParameters()) == {}


@pytest.mark.slow
def test_the_same_seed_gives_the_same_intervals() -> None:
    assert evaluate(WATCH, RECORDINGS) == result()
