"""How the study went is said with the numbers of its tables."""

from __future__ import annotations

import math

import pandas as pd
import pytest

from costeer.methods.conditions import CONDITION_NAMES
from costeer.pages.numerals import NOTHING
from costeer.scenarios.definition import Actor, Event, Overtaking, Scenario, Stream
from costeer.scenarios.reading import scenario_named
from costeer.study.material import StudyMaterial
from costeer.study.reporting import overview
from costeer.study.reporting.event_tables import lane_changes_table
from costeer.study.reporting.overview import planned_changes, tallies, total
from costeer.study.reporting.traffic_tables import zones_table


@pytest.mark.parametrize(
    ("length", "planned"),
    [(8000.0, 8), (1800.0, 2), (1000.0, 0), (20_000.0, 8), (math.nan, 0)],
)
def test_two_lane_changes_are_planned_for_each_event(
    length: float, planned: int
) -> None:
    assert planned_changes(length) == planned


@pytest.mark.parametrize(
    ("scenario", "planned"),
    [
        ("expressway", 8.0),
        (Scenario("x", overtaking=Overtaking(cars=3, first=200.0, spacing=500.0)), 6.0),
        (Scenario("x"), math.nan),
        ("cut-in", math.nan),
        ("dense-traffic", math.nan),
        (Scenario("x", overtaking=Overtaking(), stream=Stream(cars=4)), math.nan),
        (
            Scenario("x", overtaking=Overtaking(), actors=(Actor("a", at=90.0),)),
            math.nan,
        ),
        (
            Scenario(
                "x",
                overtaking=Overtaking(),
                events=(Event("lane-change", 500.0, side="right"),),
            ),
            math.nan,
        ),
    ],
)
def test_the_scenario_says_what_is_planned(
    scenario: str | Scenario, planned: float
) -> None:
    found = planned_changes(8000.0, scenario_named(scenario))
    assert found == pytest.approx(planned, nan_ok=True)


def test_nobody_planned_what_the_scenario_does_not(material: StudyMaterial) -> None:
    study = with_settings(material, scenario="cut-in")._replace(metadata=())
    completed = len(material.lane_changes)
    (sentence,) = [e for e in overview.run_sentences(study) if "lane change" in e]
    assert sentence.startswith(f"{completed} lane changes were completed; ")
    table = lane_changes_table(study)
    assert {row[2] for row in table.rows} == {row[4] for row in table.rows} == {NOTHING}


def test_angles_in_zones_are_in_degrees(material: StudyMaterial) -> None:
    measures = {"sdlp": 0.25, "steering_beyond_curve_rms": math.pi / 18.0}
    rows = [("bend", "manual", name, each) for name, each in measures.items()]
    told = pd.DataFrame(rows, columns=["zone", "condition", "measure", "value"])
    table = zones_table(material._replace(scenario=told))
    assert table is not None
    (row,) = [each for each in table.rows if each[1] == "manual"]
    cells = dict(zip(table.header, row, strict=True))
    assert cells["Angle beyond curve, RMS [deg]"].startswith("10.00")
    assert cells["SDLP [m]"].startswith("0.250")


def test_the_whole_is_the_sum_of_its_conditions(material: StudyMaterial) -> None:
    parts = tallies(material)
    assert [each.name for each in parts] == list(CONDITION_NAMES)
    whole = total(parts)
    assert (whole.trials, whole.planned) == (21, 42)
    assert whole.completed == len(material.lane_changes)


def with_trials(material: StudyMaterial, **columns: object) -> StudyMaterial:
    return material._replace(trials=material.trials.assign(**columns))


def with_settings(material: StudyMaterial, **settings: object) -> StudyMaterial:
    configuration = {**material.study.configuration, **settings}
    return material._replace(study=material.study._replace(configuration=configuration))


def test_the_condition_with_most_missing_is_named(material: StudyMaterial) -> None:
    lost = material.trials["num_lane_changes"].mask(
        material.trials["condition"] == "weak-gentle", 1.0
    )
    study = with_trials(material, num_lane_changes=lost, num_dropped_changes=1)
    (sentence,) = [each for each in overview.run_sentences(study) if "planned" in each]
    assert sentence == (
        "Of 42 planned lane changes 39 were completed (92.9 %); 21 crossings of the "
        "line made no lane change and dropped out. Fewest were completed in "
        "weak-gentle: 3 of 6."
    )


def test_all_conditions_with_most_missing_are_named(material: StudyMaterial) -> None:
    lost = material.trials["num_lane_changes"].mask(
        material.trials["condition"].isin(["strong-normal", "weak-gentle"]), 1.0
    )
    text = " ".join(
        overview.run_sentences(with_trials(material, num_lane_changes=lost))
    )
    assert (
        "Fewest were completed in strong-normal and weak-gentle: each 3 of 6." in text
    )


def test_departures_are_told_beside_the_time_they_were_counted_in(
    material: StudyMaterial,
) -> None:
    # Departures count in the whole record: 3 or 9 trials of half an hour a strength.
    study = with_trials(
        material, num_lane_departures=1, duration=1800.0, lane_keeping_duration=60.0
    )
    assert overview.departure_sentence(study) == (
        "A wheel over a line outside lane changes: manual 3 in 1.50 h, strong 9 in "
        "4.50 h and weak 9 in 4.50 h of driving."
    )


def test_a_short_course_has_no_lane_change_planned(material: StudyMaterial) -> None:
    text = " ".join(overview.run_sentences(with_settings(material, length=900.0)))
    assert "too short for an overtaking event" in text


def test_the_network_is_named_by_its_hash(material: StudyMaterial) -> None:
    study = with_settings(
        material, intention="network", intention_model_hash="0123456789abcdef"
    )
    text = " ".join(overview.run_sentences(study))
    assert "read by the network with weights 0123456789ab" in text


def test_without_triggers_nothing_is_judged(material: StudyMaterial) -> None:
    study = with_trials(material, num_false_triggers=math.nan)
    assert overview.detection_sentence(study) == "No trial has triggers to judge."


def test_when_every_lane_change_is_missed_it_is_said(material: StudyMaterial) -> None:
    changes = material.lane_changes.assign(detection_lead_time=0.0)
    text = overview.detection_sentence(material._replace(lane_changes=changes))
    assert text.startswith("Of 42 intended lane changes none was announced.")


def test_false_triggers_are_told_per_kilometre(material: StudyMaterial) -> None:
    study = with_trials(material, num_false_triggers=2, distance=1000.0)
    assert (
        "42 false triggers in 21 km (2.000 per km, 95 % interval 1.441 to 2.703)"
        in overview.detection_sentence(study)
    )


def test_no_false_trigger_is_no_proof_of_none(material: StudyMaterial) -> None:
    study = with_trials(material, num_false_triggers=0, distance=1000.0)
    # Without an event the exact upper limit is -ln(0.025) = 3.689 events.
    told = "0 false triggers in 21 km (0.000 per km, 95 % interval 0.000 to 0.176)"
    assert told in overview.detection_sentence(study)


def test_no_inconsistency_needs_no_more_words(material: StudyMaterial) -> None:
    study = with_trials(material, num_inconsistencies=0)
    assert overview.inconsistency_sentence(study) == (
        "0 inconsistencies in 21 assisted trials with 42 lane changes."
    )


def test_means_per_trial_weigh_as_many_inconsistencies_as_they_hold(
    material: StudyMaterial,
) -> None:
    trials = material.trials.iloc[:2].assign(
        num_inconsistencies=[1, 3], recovery_time=[2.0, 4.0]
    )
    assert overview.weighted(trials, "recovery_time") == pytest.approx(3.5, rel=1e-12)
    none = trials.assign(num_inconsistencies=0)
    assert math.isnan(overview.weighted(none, "recovery_time"))
