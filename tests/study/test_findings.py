"""What came out is said by fixed rules: never more than the tests say."""

from __future__ import annotations

import math

import pytest

from costeer.methods.conditions import CONDITION_NAMES
from costeer.study.material import StudyMaterial, pair
from costeer.study.outcome import PUBLISHED, WITHIN, PairRow, StudyTests
from costeer.study.quantities import QUANTITIES, Quantity
from costeer.study.reporting.findings import meaning, measure_sentences

ASSISTED = CONDITION_NAMES[1:]
OVERSHOOT = next(each for each in QUANTITIES if each.name == "overshoot")
SDLP = next(each for each in QUANTITIES if each.name == "sdlp")
P_VALUES = {"***": 1e-4, "": 0.5, "?": math.nan}


def told(
    material: StudyMaterial,
    within: dict[str, tuple[float, str]],
    pooled: dict[str, tuple[float, str]],
    quantity: Quantity = OVERSHOOT,
) -> StudyMaterial:
    """The study as if these differences and marks had come out, and no others."""
    rows: list[PairRow] = []
    for analysis, found in ((WITHIN, within), (PUBLISHED, pooled)):
        for level, (difference, mark) in found.items():
            row = pair(material, quantity.name, analysis, level, "manual")
            assert row is not None
            changed = {"mean_difference": difference, "p_corrected": P_VALUES[mark]}
            rows.append(row._replace(**changed, mark=mark.removesuffix("?")))
    tests = StudyTests((), tuple(rows), material.tests.summaries, ())
    return material._replace(tests=tests)


def alike(difference: float, mark: str) -> dict[str, tuple[float, str]]:
    return dict.fromkeys(ASSISTED, (difference, mark))


def after_manual(material: StudyMaterial, quantity: Quantity = OVERSHOOT) -> str:
    return measure_sentences(material, quantity).split("in manual driving. ")[1]


def test_what_both_analyses_find_everywhere_is_said_once(
    material: StudyMaterial,
) -> None:
    study = told(material, alike(-0.1, "***"), alike(-0.1, "***"))
    assert after_manual(study) == (
        "Lower in all six assisted conditions (−0.100 to −0.100 m), by both analyses."
    )


@pytest.mark.parametrize(
    ("within", "pooled", "sentence"),
    [
        ("***", "", "Higher {}, within subjects only."),
        ("", "***", "Higher {}, in the pooled analysis only."),
        ("", "", "No significant difference {}."),
        ("***", "?", "Higher {} within subjects (pooled not tested)."),
        ("", "?", "No significant difference {} within subjects (pooled not tested)."),
        ("?", "***", "Higher {} in the pooled analysis (within subjects not tested)."),
        ("?", "?", "Not tested {}."),
    ],
)
def test_doubt_between_the_analyses_is_said(
    material: StudyMaterial, within: str, pooled: str, sentence: str
) -> None:
    study = told(material, alike(0.1, within), alike(0.1, pooled))
    where = "in all six assisted conditions (+0.100 to +0.100 m)"
    assert after_manual(study) == sentence.format(where)


def test_analyses_that_contradict_are_not_smoothed_over(
    material: StudyMaterial,
) -> None:
    study = told(material, alike(0.1, "***"), alike(-0.1, "***"))
    assert "contradict each other" in after_manual(study)


def test_a_few_conditions_are_named_with_their_differences(
    material: StudyMaterial,
) -> None:
    found = alike(0.0, "") | {"weak-rapid": (-0.2, "***")}
    study = told(material, found, found)
    assert after_manual(study).startswith(
        "Lower with weak-rapid (−0.200 m), by both analyses. No significant difference"
    )


def test_lane_keeping_is_compared_by_strength(material: StudyMaterial) -> None:
    found = {"strong": (-0.05, "***"), "weak": (0.0, "")}
    study = told(material, found, found, SDLP)
    assert after_manual(study, SDLP) == (
        "Lower with strong (−0.050 m) guidance, by both analyses. "
        "No significant difference with weak (0.000 m) guidance."
    )


def test_the_meaning_follows_the_test_within_subjects(material: StudyMaterial) -> None:
    found = meaning(told(material, alike(-0.1, "***"), alike(-0.1, "")))
    assert found.clauses == (
        "overshot the new lane less in all six assisted conditions "
        "(not confirmed by the pooled analysis)",
    )
    assert found.without == ()


def test_what_only_the_pooled_analysis_finds_has_no_meaning(
    material: StudyMaterial,
) -> None:
    found = meaning(told(material, alike(-0.1, ""), alike(-0.1, "***")))
    assert found.clauses == ()
    assert found.without == ("Overshoot",)
    assert found.tested


def test_opposite_directions_are_both_said(material: StudyMaterial) -> None:
    found = alike(-0.1, "***") | {"strong-rapid": (0.1, "***")}
    (clause,) = meaning(told(material, found, found)).clauses
    assert clause.endswith("they overshot the new lane more with strong-rapid")


def test_doubt_about_some_conditions_names_them(material: StudyMaterial) -> None:
    pooled = alike(-0.1, "***") | {"weak-rapid": (-0.1, "")}
    (clause,) = meaning(told(material, alike(-0.1, "***"), pooled)).clauses
    assert clause.endswith("(not confirmed by the pooled analysis for weak-rapid)")


def test_without_a_test_nothing_is_meant(material: StudyMaterial) -> None:
    assert not meaning(told(material, {}, {})).tested


def test_no_value_at_all_is_said(material: StudyMaterial) -> None:
    none = material._replace(tests=StudyTests((), (), (), ()))
    assert measure_sentences(none, OVERSHOOT) == "No trial has a value."


def test_factors_among_the_assisted_conditions_are_judged_by_both_analyses(
    material: StudyMaterial,
) -> None:
    rows = [
        row._replace(p_corrected=0.001, mark="**" if row.analysis == WITHIN else "")
        for row in material.tests.tests
        if row.measure == "overshoot" and row.effect in ("strength", "change_duration")
    ]
    study = told(material, alike(0.1, ""), alike(0.1, ""))
    study = study._replace(tests=study.tests._replace(tests=tuple(rows)))
    assert after_manual(study).endswith(
        "Among the assisted conditions: strength and planned duration significant "
        "within subjects only."
    )


def test_many_but_not_all_conditions_share_a_range(material: StudyMaterial) -> None:
    found = alike(-0.1, "***") | {"weak-gentle": (-0.01, "")}
    assert after_manual(told(material, found, found)).startswith(
        "Lower with strong-rapid, strong-normal, strong-gentle, weak-rapid and "
        "weak-normal (−0.100 to −0.100 m), by both analyses."
    )
