"""Numbers read the same wherever they are printed."""

from __future__ import annotations

import math

import pytest

from costeer.pages import numerals


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.1234, "0.123"), (-0.1234, "−0.123"), (-0.0001, "0.000"), (math.nan, "–")],
)
def test_numbers_have_a_true_minus_and_no_minus_zero(value: float, text: str) -> None:
    assert numerals.number(value, 3) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.5, "+0.5"), (-0.5, "−0.5"), (0.01, "0.0"), (math.inf, "–")],
)
def test_differences_have_their_sign(value: float, text: str) -> None:
    assert numerals.signed(value, 1) == text


def test_an_interval_without_an_end_is_left_out() -> None:
    assert numerals.interval(-1.0, 2.0, 1) == "[−1.0, 2.0]"
    assert numerals.interval(math.nan, 2.0, 1) == ""


@pytest.mark.parametrize(
    ("p", "text"), [(0.0004, "<0.001"), (0.0123, "0.012"), (math.nan, "–")]
)
def test_p_values_are_never_printed_as_zero(p: float, text: str) -> None:
    assert numerals.p_value(p) == text


@pytest.mark.parametrize(
    ("df", "text"), [(11.0, "11"), (43.1417, "43.14"), (math.nan, "–")]
)
def test_whole_degrees_of_freedom_have_no_decimals(df: float, text: str) -> None:
    assert numerals.degrees_of_freedom(df) == text


def test_a_share_of_nothing_is_not_a_number() -> None:
    assert numerals.percent(3, 4) == "75.0 %"
    assert numerals.percent(0, 0) == "–"


def test_words_are_listed_as_one_says_them() -> None:
    assert numerals.listed(["a"]) == "a"
    assert numerals.listed(["a", "b", "c"]) == "a, b and c"


def test_one_is_not_a_plural() -> None:
    assert numerals.plural(1, "driver") == "1 driver"
    assert numerals.plural(0, "driver") == "0 drivers"
    assert numerals.plural(2, "inconsistency", "inconsistencies") == "2 inconsistencies"
