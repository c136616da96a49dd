"""Values, ranges and percentiles of a comparison with people."""

from __future__ import annotations

import math

import numpy as np
import pytest

from costeer.validation.people.findings import (
    MEAN,
    MEDIAN,
    SHARE,
    RealComparison,
    is_target,
    met,
    missed_by,
    people_value,
    percentiles,
    statistic_of,
    value,
)


def comparison(
    drivers: list[float], low: float = 1.0, high: float = 2.0, statistic: str = MEDIAN
) -> RealComparison:
    return RealComparison(
        name="R1",
        quantity="something",
        unit="s",
        source="nobody",
        people=np.array([]),
        drivers=np.array(drivers),
        published=(math.nan, 1.5, math.nan),
        low=low,
        high=high,
        statistic=statistic,
        reason="",
    )


def test_a_value_is_the_statistic_of_what_is_known() -> None:
    values = np.array([1.0, math.nan, 2.0, 6.0])
    assert statistic_of(values, MEDIAN) == 2.0
    assert statistic_of(values, MEAN) == 3.0
    assert statistic_of(np.array([0.0, 100.0, 100.0, 0.0]), SHARE) == 50.0


def test_an_unknown_statistic_is_named() -> None:
    with pytest.raises(ValueError, match="'mode' is not known; choose median"):
        statistic_of(np.array([1.0]), "mode")


@pytest.mark.parametrize(
    ("here", "inside", "missed"),
    [(1.0, True, 0.0), (2.0, True, 0.0), (0.5, False, 0.5), (2.25, False, 0.25)],
)
def test_a_value_is_held_to_its_range(here: float, inside: bool, missed: float) -> None:
    assert value(comparison([here])) == here
    assert met(comparison([here])) is inside
    assert missed_by(comparison([here])) == missed


def test_without_a_range_nothing_is_met_or_missed() -> None:
    reported = comparison([1.5], low=math.nan, high=math.nan)
    assert not is_target(reported)
    assert not met(reported)
    assert math.isnan(missed_by(reported))


def test_without_drivers_or_people_there_is_no_value() -> None:
    empty = comparison([])
    assert math.isnan(value(empty))
    assert not met(empty)
    assert math.isnan(missed_by(empty))
    assert math.isnan(people_value(empty))
    assert all(math.isnan(each) for each in percentiles(empty.people))


def test_percentiles_leave_out_the_unknown() -> None:
    values = np.append(np.arange(101.0), math.nan)
    assert percentiles(values) == (10.0, 50.0, 90.0)
