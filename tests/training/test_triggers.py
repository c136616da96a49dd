"""Triggers against crossings: true, early, false, missed, lead."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.training.labels import labels
from costeer.training.operating import operating_counts
from costeer.training.recordings import Recording
from costeer.training.triggers import (
    TriggerParameters,
    judge,
    onsets,
    total,
    trigger_scores,
)
from costeer.training.verdicts import DriverVerdicts

LENGTH = 1800
PARAMETERS = TriggerParameters()


def stretch(crossing_row: int | None = 1200, side: int = -1) -> Recording:
    """30 s at 20 m/s, with at most one crossing."""
    intended = np.zeros(LENGTH, np.int8)
    if crossing_row is not None:
        intended[crossing_row] = side
    sides = np.full(LENGTH, -1, np.int8)
    features = np.zeros((LENGTH, 6))
    features[:, 2] = 20.0
    return Recording(
        driver="a",
        name="a",
        features=features,
        side=sides,
        crossing=intended,
        intended=intended,
        labels=labels(intended, sides),
    )


def verdicts(*spans: tuple[int, int]) -> NDArray[np.float64]:
    """Probability 0.9 in the spans, 0.1 elsewhere, none in the first 3 s."""
    probability = np.full(LENGTH, 0.1)
    for start, end in spans:
        probability[start:end] = 0.9
    probability[:180] = np.nan
    return probability


def test_a_trigger_comes_with_the_third_positive_in_a_row() -> None:
    assert onsets(verdicts((500, 520)), PARAMETERS).tolist() == [502]


def test_two_positives_are_no_trigger() -> None:
    assert onsets(verdicts((500, 502), (503, 505)), PARAMETERS).size == 0


def test_a_verdict_at_the_threshold_is_positive() -> None:
    assert onsets(np.full(10, 0.5), PARAMETERS).tolist() == [2]


@pytest.mark.parametrize("length", [0, 1, 2])
def test_a_stretch_shorter_than_the_debounce_has_no_trigger(length: int) -> None:
    assert onsets(np.full(length, 0.9), PARAMETERS).size == 0


def test_triggers_within_a_second_are_one() -> None:
    assert onsets(verdicts((500, 510), (540, 560)), PARAMETERS).tolist() == [502]
    apart = onsets(verdicts((500, 510), (561, 571)), PARAMETERS)
    assert apart.tolist() == [502, 563]


def test_lead_is_crossing_minus_trigger() -> None:
    counts = judge(stretch(1200), verdicts((1078, 1200)), PARAMETERS)
    assert (counts.true, counts.early, counts.false) == (1, 0, 0)
    assert counts.leads == (2.0,)


def test_between_three_and_five_seconds_a_trigger_is_early() -> None:
    counts = judge(stretch(1200), verdicts((958, 1200)), PARAMETERS)
    assert (counts.true, counts.early, counts.false) == (0, 1, 0)
    assert counts.leads == (4.0,)


def test_a_trigger_without_crossing_is_false_and_a_crossing_without_missed() -> None:
    counts = judge(stretch(1200), verdicts((400, 450)), PARAMETERS)
    assert (counts.true, counts.early, counts.false) == (0, 0, 1)
    assert counts.leads == (0.0,)
    assert trigger_scores(counts)["missed"] == 1.0


def test_the_first_of_several_triggers_gives_the_lead() -> None:
    spans = ((998, 1010), (1098, 1200))
    counts = judge(stretch(1200), verdicts(*spans), PARAMETERS)
    assert counts.leads == (200 / 60,)
    assert (counts.true, counts.early) == (1, 1)


def test_a_crossing_to_the_other_side_makes_a_trigger_false() -> None:
    counts = judge(stretch(1200, side=1), verdicts((1078, 1200)), PARAMETERS)
    assert counts.false == 1


def test_a_crossing_before_any_verdict_is_not_missed() -> None:
    assert judge(stretch(100), verdicts(), PARAMETERS).leads == ()


def test_a_trigger_before_a_crossing_without_a_verdict_is_not_false() -> None:
    said = verdicts((1078, 1150))
    said[1150:1210] = np.nan  # the head was lost, say
    counts = judge(stretch(1200), said, PARAMETERS)
    assert (counts.true, counts.false, counts.leads) == (1, 0, ())
    driver = DriverVerdicts("a", [stretch(1200), stretch(1200)], [said, verdicts()])
    operating = operating_counts([driver], PARAMETERS, np.array([0.5]))
    # The other drive has one missed crossing, and it keeps its lead of 0.
    assert operating.false.sum() == 0
    assert operating.leads.tolist() == [[0.0]]


def test_rates_count_only_what_was_judged() -> None:
    counts = judge(stretch(None), verdicts((400, 450)), PARAMETERS)
    assert counts.kilometres == pytest.approx(0.54)
    assert counts.hours == pytest.approx(27.0 / 3600.0)
    assert trigger_scores(counts)["false_per_km"] == pytest.approx(1.0 / 0.54)


def test_the_total_of_drivers_is_their_sum() -> None:
    parts = [
        judge(stretch(1200), verdicts((1078, 1200)), PARAMETERS),
        judge(stretch(1200), verdicts((400, 450)), PARAMETERS),
    ]
    both = total(parts)
    assert (both.true, both.false, both.leads) == (1, 1, (2.0, 0.0))
    assert both.kilometres == pytest.approx(1.08)


def test_without_driving_rates_are_undefined() -> None:
    scores = trigger_scores(total([]))
    assert np.isnan(scores["false_per_km"])
    assert np.isnan(scores["lead_time_median"])
