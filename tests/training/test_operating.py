"""Triggers over all thresholds, and the best point among them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.training.bootstrap import resamplings
from costeer.training.operating import (
    OperatingCounts,
    best_place,
    operating_counts,
    operating_curve,
    resampled_leads,
    weighted_medians,
)
from costeer.training.triggers import TriggerParameters, judge, total
from costeer.training.verdicts import DriverVerdicts
from tests.training.synthetic import drive

PARAMETERS = TriggerParameters()


def noisy(driver: int) -> DriverVerdicts:
    """Two stretches with verdicts that wander, and a gap."""
    rng = np.random.default_rng(driver)
    stretches = [drive(driver, num_changes=2), drive(driver + 50, num_changes=1)]
    said = []
    for one in stretches:
        knots = rng.normal(size=len(one.side) // 20 + 2)
        logit = np.interp(np.arange(len(one.side)) / 20, np.arange(len(knots)), knots)
        probability = 1.0 / (1.0 + np.exp(-3.0 * logit))
        probability[:179] = np.nan
        probability[900:950] = np.nan
        said.append(probability)
    return DriverVerdicts(f"driver {driver}", stretches, said)


DRIVERS = [noisy(driver) for driver in range(3)]
COUNTS = operating_counts(DRIVERS, PARAMETERS)


@pytest.mark.parametrize("place", [0, 120, 200, 260, 400])
def test_counts_are_those_of_each_threshold_by_itself(place: int) -> None:
    parameters = PARAMETERS._replace(threshold=float(COUNTS.thresholds[place]))
    for k, one in enumerate(DRIVERS):
        pairs = zip(one.recordings, one.probabilities, strict=True)
        alone = total([judge(r, p, parameters) for r, p in pairs])
        found = (COUNTS.true, COUNTS.early, COUNTS.false)
        assert [c[place, k] for c in found] == [alone.true, alone.early, alone.false]
        own = COUNTS.leads[place][COUNTS.driver == k]
        assert own.tolist() == list(alone.leads)
        assert COUNTS.kilometres[k] == pytest.approx(alone.kilometres)
        assert COUNTS.hours[k] == pytest.approx(alone.hours)


def by_hand() -> OperatingCounts:
    """Two drivers of 10 km; false triggers fall, rise and fall with the threshold."""
    leads = [[4.0, 3.0], [3.0, 3.0], [2.5, 1.5], [2.0, 1.0], [0.0, 0.0]]
    false = [[9.0, 9.0], [1.0, 0.0], [2.0, 1.0], [1.0, 0.0], [0.0, 0.0]]
    nothing = np.zeros((5, 2))
    return OperatingCounts(
        thresholds=np.array([0.1, 0.3, 0.5, 0.7, 0.9]),
        true=nothing,
        early=nothing,
        false=np.array(false),
        leads=np.array(leads),
        driver=np.array([0, 1]),
        kilometres=np.array([10.0, 10.0]),
        hours=np.array([0.2, 0.2]),
    )


def test_the_largest_lead_wins_though_a_higher_threshold_breaks_the_rate() -> None:
    # 1 in 20 km is allowed; 0.5 gives 3, 0.3 below it gives 1 again.
    assert best_place(by_hand(), 0.05) == 1
    assert best_place(by_hand(), 0.04) == 4
    assert best_place(by_hand(), 1.0) == 0


def test_equal_leads_go_to_the_fewest_false_then_to_the_highest_threshold() -> None:
    counts = by_hand()
    counts.leads[1:4] = 2.0
    counts.false[2] = 0.0
    assert best_place(counts, 0.05) == 2
    counts.false[3] = 0.0
    assert best_place(counts, 0.05) == 3


def test_each_drawing_chooses_its_own_threshold() -> None:
    times = np.array([[1, 1], [2, 0], [0, 2]])
    # The first driver alone has 2 false in 20 km at 0.3: only silence is left. The
    # second one alone has none at 0.3 and 0.7.
    drawn = resampled_leads(by_hand(), times, 0.05)
    assert drawn.tolist() == [3.0, 0.0, 3.0]


def brute(times: NDArray[np.int64], rate: float) -> list[float]:
    found = []
    for row in times:
        best = 0.0
        for k in range(len(COUNTS.thresholds)):
            false = (row * COUNTS.false[k]).sum() / (row * COUNTS.kilometres).sum()
            leads = np.repeat(COUNTS.leads[k], row[COUNTS.driver])
            if false <= rate:
                best = max(best, float(np.median(leads)))
        found.append(best)
    return found


@pytest.mark.parametrize("rate", [0.3, 2.0])
def test_drawings_are_those_of_brute_force(rate: float) -> None:
    times = resamplings(3, 20, 1)
    assert resampled_leads(COUNTS, times, rate).tolist() == brute(times, rate)


def test_weighted_medians_are_those_of_repeated_values() -> None:
    rng = np.random.default_rng(2)
    values, weights = rng.random(9), rng.integers(0, 4, (9, 30)).astype(np.int32)
    expected = [np.median(np.repeat(values, weights[:, i])) for i in range(30)]
    assert weighted_medians(values, weights).tolist() == expected
    nothing = weighted_medians(values, np.zeros((9, 1), np.int32))
    assert np.isnan(nothing).all()


def test_the_curve_leaves_out_what_repeats() -> None:
    counts = by_hand()
    assert [p.threshold for p in operating_curve(counts)] == [0.1, 0.3, 0.5, 0.7, 0.9]
    counts.leads[2], counts.false[2] = counts.leads[1], counts.false[1]
    assert [p.threshold for p in operating_curve(counts)] == [0.1, 0.3, 0.7, 0.9]


def test_without_a_crossing_there_is_no_best_point() -> None:
    quiet = DriverVerdicts("a", [drive(1, num_changes=0)], [np.full(900, 0.9)])
    counts = operating_counts([quiet], PARAMETERS)
    assert best_place(counts, 1000.0) is None
    assert np.isnan(resampled_leads(counts, np.array([[1]]), 1.0)).all()
