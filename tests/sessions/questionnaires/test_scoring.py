"""Scores agree with values worked out by hand from the primary publications."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.sessions.questionnaires.definition import load_definition
from costeer.sessions.questionnaires.scoring import change, scores, stop_reason

TLX = (
    "mental_demand",
    "physical_demand",
    "temporal_demand",
    "performance",
    "effort",
    "frustration",
)
ORDER_OF_IMPORTANCE = TLX  # the first wins all five of its comparisons, the last none
SSQ = (  # in the order of Kennedy et al. (1993), Table 5
    "general_discomfort",
    "fatigue",
    "headache",
    "eyestrain",
    "difficulty_focusing",
    "increased_salivation",
    "sweating",
    "nausea",
    "difficulty_concentrating",
    "fullness_of_head",
    "blurred_vision",
    "dizziness_eyes_open",
    "dizziness_eyes_closed",
    "vertigo",
    "stomach_awareness",
    "burping",
)
POSITIVE_LEFT = (
    "useful_useless",
    "pleasant_unpleasant",
    "nice_annoying",
    "effective_superfluous",
    "assisting_worthless",
    "alerting_sleep_inducing",
)
POSITIVE_RIGHT = ("bad_good", "irritating_likeable", "undesirable_desirable")
ratings = st.lists(st.integers(0, 20).map(lambda n: 5.0 * n), min_size=6, max_size=6)


def pairs(order: tuple[str, ...]) -> dict[str, str]:
    """Answers of someone who always chooses the scale that comes first in `order`."""
    return {
        f"{a}_or_{b}": min(a, b, key=order.index)
        for a, b in itertools.combinations(TLX, 2)
    }


def test_tlx_with_weights_five_to_none() -> None:
    ratings = dict(zip(TLX, (100.0, 50.0, 40.0, 30.0, 20.0, 90.0), strict=True))
    found = scores("nasa-tlx", {**ratings, **pairs(ORDER_OF_IMPORTANCE)})
    # (5*100 + 4*50 + 3*40 + 2*30 + 1*20 + 0*90) / 15 = 900 / 15; mean 330 / 6
    assert found == {"tlx_raw": 55.0, "tlx_weighted": 60.0}


def test_a_failed_performance_is_load() -> None:
    answers: dict[str, float | str] = dict.fromkeys(TLX, 0.0)
    answers["performance"] = 90.0  # nearly Failure
    assert scores("nasa-tlx-raw", answers) == {"tlx_raw": 15.0}


@pytest.mark.slow
@given(ratings, st.permutations(TLX), st.randoms(use_true_random=False))
def test_order_of_the_comparisons_does_not_count(
    values: list[float], order: list[str], chance: object
) -> None:
    chosen = list(pairs(tuple(order)).items())
    chance.shuffle(chosen)  # type: ignore[attr-defined]  # hypothesis' own Random
    rated = dict(zip(TLX, values, strict=True))
    found = scores("nasa-tlx", {**dict(chosen), **rated})
    by_hand = sum((5 - place) * rated[name] for place, name in enumerate(order)) / 15
    assert found["tlx_weighted"] == pytest.approx(by_hand, abs=1e-12)


@given(ratings, st.lists(st.booleans(), min_size=15, max_size=15))
def test_both_tlx_scores_lie_between_the_ratings(
    values: list[float], sides: list[bool]
) -> None:
    chosen = {
        f"{a}_or_{b}": a if left else b
        for (a, b), left in zip(itertools.combinations(TLX, 2), sides, strict=True)
    }
    for score in scores(
        "nasa-tlx", {**dict(zip(TLX, values, strict=True)), **chosen}
    ).values():
        assert min(values) - 1e-9 <= score <= max(values) + 1e-9


@pytest.mark.parametrize("missing", [*pairs(TLX), "all"])
def test_weights_are_never_invented(missing: str) -> None:
    chosen = {k: v for k, v in pairs(TLX).items() if missing not in (k, "all")}
    found = scores("nasa-tlx", {**dict.fromkeys(TLX, 50.0), **chosen})
    assert found["tlx_raw"] == 50.0
    assert math.isnan(found["tlx_weighted"])


def test_a_missing_rating_leaves_no_score() -> None:
    found = scores("nasa-tlx", {**dict.fromkeys(TLX[1:], 50.0), **pairs(TLX)})
    assert all(math.isnan(value) for value in found.values())


def test_ssq_with_all_ones() -> None:
    # Seven items a list: 7 * 9.54, 7 * 7.58, 7 * 13.92, 21 * 3.74
    assert scores("ssq", dict.fromkeys(SSQ, 1.0)) == pytest.approx(
        {
            "ssq_nausea": 66.78,
            "ssq_oculomotor": 53.06,
            "ssq_disorientation": 97.44,
            "ssq_total": 78.54,
        }
    )


def test_ssq_at_its_most() -> None:
    assert scores("ssq", dict.fromkeys(SSQ, 3.0))["ssq_total"] == pytest.approx(235.62)


LISTS = [
    "NO",
    "O",
    "O",
    "O",
    "OD",
    "N",
    "N",
    "ND",
    "NO",
    "D",
    "OD",
    "D",
    "D",
    "D",
    "N",
    "N",
]
"""In which of the three lists each symptom is, in the order of `SSQ`."""


@pytest.mark.parametrize(("symptom", "lists"), list(zip(SSQ, LISTS, strict=True)))
def test_each_symptom_counts_where_kennedy_says(symptom: str, lists: str) -> None:
    answers = dict.fromkeys(SSQ, 0.0) | {symptom: 1.0}
    assert scores("ssq", answers) == pytest.approx(
        {
            "ssq_nausea": 9.54 * ("N" in lists),
            "ssq_oculomotor": 7.58 * ("O" in lists),
            "ssq_disorientation": 13.92 * ("D" in lists),
            "ssq_total": 3.74 * len(lists),
        }
    )


def test_change_of_the_ssq_from_its_baseline() -> None:
    before = scores("ssq", dict.fromkeys(SSQ, 0.0) | {"fatigue": 2.0})
    after = scores("ssq", dict.fromkeys(SSQ, 0.0) | {"fatigue": 1.0, "nausea": 1.0})
    assert change(before, after) == pytest.approx(
        {
            "ssq_nausea_change": 9.54,
            "ssq_oculomotor_change": -7.58,
            "ssq_disorientation_change": 13.92,
            "ssq_total_change": 3.74,  # (1 + 2) - 2 points
        }
    )


def test_the_ssq_stops_at_a_rise_and_the_fms_at_a_value() -> None:
    ssq, fms = load_definition("ssq"), load_definition("fms")
    ill = {"ssq_total": 60.0}
    assert "ssq_total is 60, the limit 40" in stop_reason(ssq, ill)
    assert "40 above the baseline" in stop_reason(ssq, ill, {"ssq_total": 20.0})
    assert stop_reason(ssq, ill, {"ssq_total": 20.1}) == ""
    assert stop_reason(fms, scores("fms", {"sickness": 14.0})) == ""
    assert "limit 15" in stop_reason(fms, scores("fms", {"sickness": 15.0}))
    assert stop_reason(load_definition("trust"), {"trust_score": 1.0}) == ""


def test_every_positive_pole_of_the_acceptance_counts_two() -> None:
    best = dict.fromkeys(POSITIVE_LEFT, -2.0) | dict.fromkeys(POSITIVE_RIGHT, 2.0)
    assert scores("acceptance", best) == {
        "acceptance_usefulness": 2.0,
        "acceptance_satisfying": 2.0,
    }


def test_the_left_end_of_every_line_is_no_opinion_of_everything() -> None:
    # Useful 1, 3, 5, 7, 9: four positive poles on the left, one on the right;
    # satisfying 2, 4, 6, 8: two and two.
    left = dict.fromkeys(POSITIVE_LEFT + POSITIVE_RIGHT, -2.0)
    assert scores("acceptance", left) == pytest.approx(
        {"acceptance_usefulness": (4 * 2 - 2) / 5, "acceptance_satisfying": 0.0}
    )


@given(st.data())
def test_mirrored_opinions_give_mirrored_acceptance(data: st.DataObject) -> None:
    places = st.integers(-2, 2).map(float)
    answers = {name: data.draw(places) for name in POSITIVE_LEFT + POSITIVE_RIGHT}
    ahead = scores("acceptance", answers)
    mirrored = scores("acceptance", {k: -v for k, v in answers.items()})
    for name, value in ahead.items():
        assert -2.0 <= value <= 2.0
        assert mirrored[name] == pytest.approx(-value)


def test_trust_turns_its_first_five_items_round() -> None:
    items = [item.name for item in load_definition("trust").items]
    distrust = dict.fromkeys(items[:5], 7.0) | dict.fromkeys(items[5:], 1.0)
    assert scores("trust", distrust) == {"trust_score": 1.0}
    # 8 - 2 = 6 five times and 2 seven times: 44 / 12
    found = scores("trust", dict.fromkeys(items, 2.0))
    assert found["trust_score"] == pytest.approx(44.0 / 12.0)


def test_likert_example_turns_a_complaint_round() -> None:
    answers: dict[str, float | str] = {
        "understood": 5.0,
        "in_control": 4.0,
        "worked_against_me": 2.0,
        "comment": "fine",
    }
    assert scores("likert", answers) == pytest.approx({"likert_mean": 13.0 / 3.0})


@pytest.mark.parametrize("name", ["demographics", "consent"])
def test_what_is_no_measure_has_no_score(name: str) -> None:
    assert scores(name, {}) == {}
