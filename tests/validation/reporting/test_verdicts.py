"""What is said of targets and quantities: met, missed by how much, why."""

from __future__ import annotations

import math

import pytest

from costeer.drivers.population import TRAFFIC
from costeer.validation.manual import TargetCheck
from costeer.validation.reporting.verdicts import (
    largest_miss,
    target_reason,
    target_verdict,
)
from costeer.validation.reporting.words import (
    real_verdict,
    real_verdict_told,
    short,
    span,
)
from costeer.validation.spread import TargetSpread
from costeer.validation.targets import TARGETS
from tests.validation.reporting.made_up import people

SDLP = TARGETS[TRAFFIC][0]  # 0.15 to 0.25 m


def spread(low: float, high: float) -> TargetSpread:
    return TargetSpread("M1", low, high, 0.03, 0.02, 0.7)


def test_a_miss_is_told_in_its_unit_and_as_a_share_of_the_limit() -> None:
    told = target_verdict(TargetCheck(SDLP, 0.30, False))
    assert told == "missed by 0.050 m (20 %)"
    assert target_verdict(TargetCheck(SDLP, 0.12, False)) == "missed by 0.030 m (20 %)"


def test_what_is_met_needs_no_reason() -> None:
    met = TargetCheck(SDLP, 0.2, True)
    assert target_verdict(met) == "met"
    assert target_reason(met, spread(0.18, 0.22)) == ""


def test_a_miss_whose_interval_reaches_the_range_may_be_chance() -> None:
    missed = TargetCheck(SDLP, 0.26, False)
    assert "chance" in target_reason(missed, spread(0.24, 0.28))
    assert "chance" not in target_reason(missed, spread(0.255, 0.265))
    assert SDLP.set_by in target_reason(missed, spread(0.255, 0.265))


def test_a_value_that_is_not_known_is_neither_met_nor_missed() -> None:
    unknown = TargetCheck(SDLP, math.nan, False)
    assert target_verdict(unknown) == "no value"
    assert largest_miss([unknown]) is None


def test_the_largest_miss_is_the_largest_share_of_its_limit() -> None:
    torque = TARGETS[TRAFFIC][6]  # 0.2 to 0.7 N·m
    by_tenth = TargetCheck(SDLP, 0.275, False)
    by_fifth = TargetCheck(torque, 0.84, False)
    assert largest_miss([by_tenth, by_fifth]) == by_fifth


def test_quantities_of_people_are_met_missed_or_reported() -> None:
    assert [real_verdict(each) for each in people()] == ["met", "missed", "reported"]
    # 14 of 20 are 70 %, 10 below the range.
    assert real_verdict_told(people()[1]) == "missed by 10"


def test_a_range_of_another_domain_is_neither_met_nor_missed() -> None:
    duration, share, torque = people()
    for each in (duration, share._replace(domain="traffic")):
        assert real_verdict_told(each._replace(elsewhere=True)) == "another domain"
    nothing = torque._replace(drivers=torque.drivers[:0], elsewhere=True)
    assert real_verdict(nothing) == "no value"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.01234, "0.0123"),
        (1.2345, "1.23"),
        (123.45, "123"),
        (-0.5, "\u22120.500"),
        (0.9999, "1.00"),
        (math.nan, "–"),
    ],
)
def test_numbers_have_three_digits_and_no_power(value: float, text: str) -> None:
    assert short(value) == text


def test_a_range_without_an_end_is_a_dash() -> None:
    assert span(3.0, 10.0) == "3 to 10"
    assert span(math.nan, 1.0) == "–"
