"""Answers are complete and in range, or refused in one go; they are only data."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.sessions.questionnaires.answers import (
    AnswersError,
    checked_answers,
    cleaned,
    personal,
)
from costeer.sessions.questionnaires.definition import load_definition

ABOUT_ME = {
    "age": 31,
    "gender": "prefer_not_to_say",
    "licence_years": 12,
    "km_per_year": "from_5000",
    "simulator_experience": "never",
    "handedness": "left",
    "vision_correction": "none",
}
LIKERT = {"understood": 5, "in_control": 1, "worked_against_me": 3}


def codes(name: str, given: dict[str, object]) -> dict[str, str]:
    """What is wrong with answers, by item."""
    with pytest.raises(AnswersError) as refused:
        checked_answers(load_definition(name), given)
    return refused.value.codes()


def test_good_answers_come_back() -> None:
    found = checked_answers(load_definition("demographics"), ABOUT_ME)
    assert found == ABOUT_ME
    assert type(found["age"]) is float


def test_what_may_be_left_out_is_not_there() -> None:
    definition = load_definition("likert")
    for comment in (None, "", "  \u0000 "):
        assert checked_answers(definition, {**LIKERT, "comment": comment}) == LIKERT


def test_everything_wrong_is_named_at_once() -> None:
    given = ABOUT_ME | {"age": 15, "gender": "x", "licence_years": 1.5, "name": "Jo"}
    del given["handedness"]
    with pytest.raises(AnswersError) as refused:
        checked_answers(load_definition("demographics"), given)
    assert refused.value.codes() == {
        "age": "out_of_range",
        "gender": "not_an_option",
        "licence_years": "off_step",
        "handedness": "missing",
        "name": "unknown",
    }
    assert "age is 15; give 16 to 110" in str(refused.value)
    assert "handedness has no answer" in str(refused.value)


@pytest.mark.parametrize("value", [math.nan, math.inf, -5, 105, 10**400])
def test_a_scale_has_ends(value: float) -> None:
    assert codes("nasa-tlx-raw", {"effort": value})["effort"] == "out_of_range"


@pytest.mark.parametrize("value", ["50", True, [50], {"a": 1}])
def test_a_number_is_a_number(value: object) -> None:
    assert codes("nasa-tlx-raw", {"effort": value})["effort"] == "not_a_number"


@given(st.floats(0, 100))
def test_only_ticks_of_a_scale_are_kept(value: float) -> None:
    item = load_definition("nasa-tlx-raw").items[0]
    definition = load_definition("nasa-tlx-raw")._replace(items=(item,))
    nearest = 5.0 * round(value / 5.0)
    if abs(value - nearest) < 1e-6:
        assert checked_answers(definition, {item.name: value}) == {item.name: nearest}
    elif abs(value - nearest) > 1e-5:
        with pytest.raises(AnswersError, match="in steps of 5"):
            checked_answers(definition, {item.name: value})


def test_a_comparison_is_won_by_one_of_its_two() -> None:
    given: dict[str, object] = {"mental_demand_or_effort": "frustration"}
    assert codes("nasa-tlx", given)["mental_demand_or_effort"] == "not_an_option"


def test_consent_is_agreed_to_in_every_point() -> None:
    agreed: dict[str, object] = {
        "informed": "yes",
        "voluntary": "yes",
        "recording": "yes",
        "fit_to_drive": "yes",
        "experimenter_initials": "AB",
    }
    assert checked_answers(load_definition("consent"), agreed) == agreed
    assert codes("consent", agreed | {"recording": "no"}) == {"recording": "must_agree"}
    wordy = agreed | {"experimenter_initials": "A. Baker"}
    assert codes("consent", wordy) == {"experimenter_initials": "too_long"}


@pytest.mark.parametrize("given", [None, [], "yes", 3])
def test_what_is_no_set_of_answers_is_refused(given: object) -> None:
    with pytest.raises(AnswersError, match="fms: answers are none"):
        checked_answers(load_definition("fms"), given)


def test_html_stays_text() -> None:
    comment = "<script>alert(1)</script> & <b>bold</b>"
    found = checked_answers(load_definition("likert"), {**LIKERT, "comment": comment})
    assert found["comment"] == comment


def test_a_text_is_a_text_and_not_too_long() -> None:
    assert codes("likert", {**LIKERT, "comment": ["a"]}) == {"comment": "not_text"}
    assert codes("likert", {**LIKERT, "comment": "x" * 2001}) == {"comment": "too_long"}
    checked_answers(load_definition("likert"), {**LIKERT, "comment": "x" * 2000})


def test_many_and_long_unknown_names_make_a_short_message() -> None:
    given: dict[str, object] = {f"{n}" + "x" * 10_000: n for n in range(3)}
    with pytest.raises(AnswersError) as refused:
        checked_answers(load_definition("fms"), given)
    assert len(str(refused.value)) < 1000


@given(st.text())
def test_no_control_character_is_kept(text: str) -> None:
    kept = cleaned(text)
    assert all(c == "\n" or ord(c) >= 32 for c in kept)
    kept.encode("utf-8")  # a lone surrogate could not be written to a file
    assert cleaned(kept) == kept


def test_lines_and_letters_of_every_language_are_kept() -> None:
    assert cleaned("a\r\nb\tc\x1b[31m\u202ed") == "a\nb c[31md"
    assert cleaned("Größe、良い 👩‍🔬") == "Größe、良い 👩‍🔬"


@pytest.mark.parametrize(
    "text",
    [
        "me@lab.example",
        "write to a.b+c@d.co.jp",
        "me＠lab．example",
        "me (at) lab.example",
    ],
)
def test_an_address_is_not_kept(text: str) -> None:
    assert personal(text) == "an e-mail address"
    assert codes("likert", {**LIKERT, "comment": text}) == {"comment": "personal"}


@pytest.mark.parametrize(
    "text",
    [
        "+49 89 1234567",
        "call (089) 123 45 67",
        "090-1234-5678",
        "０９０－１２３４－５６７８",
        "555-123-4567",
        "1-800-555-1234",
        "0171/1234567.",
        "12345678",
    ],
)
def test_a_phone_number_is_not_kept(text: str) -> None:
    assert personal(text) == "a phone number"


@pytest.mark.parametrize(
    "text",
    [
        "on 2026-11-29 and 29.11.2026",
        "between 80 100 120 130 km/h",
        "3.1415926",
        "1,000,000 km in 20 years",
        "at 10:30 and 11:45",
        "I @ the wheel",
        "lanes 1 2 3, 100 % of 12 trials",
    ],
)
def test_harmless_numbers_are_kept(text: str) -> None:
    assert personal(text) == ""


@given(st.text("(@. -)0123456789at[]", max_size=2000))
def test_looking_for_addresses_ends(text: str) -> None:
    assert personal(text) in ("", "an e-mail address", "a phone number")
