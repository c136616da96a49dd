"""The report's table of what triggers cost says what `triggers.csv` says."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import pandas as pd
import pytest

from costeer.methods.conditions import CONDITION_NAMES
from costeer.pages.tables import Table
from costeer.study.material import StudyMaterial, read_material
from costeer.study.reporting.event_tables import detection_table
from costeer.study.reporting.sections import page_sections
from costeer.study.reporting.trigger_tables import (
    counted_once,
    rate_text,
    trigger_costs_table,
)
from costeer.study.trial_tables import TRIGGER_COLUMNS, TRIGGERS_FILE


def event(kind: str, crossing_time: float = math.nan, **costs: object) -> dict:
    """A row of `triggers.csv` in strong-rapid."""
    same = {"participant": 1, "condition": "strong-rapid", "kind": kind}
    empty = dict.fromkeys(TRIGGER_COLUMNS, math.nan)
    return empty | same | {"crossing_time": crossing_time} | costs


def with_events(material: StudyMaterial, *events: dict) -> StudyMaterial:
    table = pd.DataFrame(list(events), columns=list(TRIGGER_COLUMNS))
    return material._replace(triggers=table)


def shown(material: StudyMaterial) -> Table:
    table = trigger_costs_table(material)
    assert table is not None
    return table


def cells(material: StudyMaterial, condition: str, title: str) -> dict[str, str]:
    table = shown(material)
    (line,) = [row for row in table.rows if row[:2] == (condition, title)]
    return dict(zip(table.header, line, strict=True))


def test_every_condition_and_the_assisted_together_have_each_event(
    material: StudyMaterial,
) -> None:
    rows = shown(material).rows
    assert [row[0] for row in rows[::4]] == [*CONDITION_NAMES, "all assisted"]
    titles = ["false", "missed", "early", "in time"]
    assert [row[1] for row in rows] == titles * 8


def test_each_crossing_of_the_study_is_counted_once(material: StudyMaterial) -> None:
    # Three drivers with two lane changes each; all of them are seen.
    rows = shown(material).rows
    number = {row[:2]: int(row[2]) for row in rows}
    titles = ("missed", "early", "in time")
    for name in CONDITION_NAMES:
        assert sum(number[name, title] for title in titles) == 6
    false = [int(row[4]) for row in detection_table(material).rows]
    assert [number[name, "false"] for name in CONDITION_NAMES] == false


def test_a_crossing_that_was_announced_twice_counts_by_its_first_trigger(
    material: StudyMaterial,
) -> None:
    events = with_events(
        material,
        event("early", 20.0, overshoot=0.1),
        event("true", 20.0, overshoot=0.1),
        event("false", largest_deviation=0.7),
        event("false", largest_deviation=0.5),
    )
    assert events.triggers is not None
    once = counted_once(events.triggers)
    assert list(once["kind"]) == ["early", "false", "false"]
    assert list(once["deviation"]) == [0.1, 0.7, 0.5]


def test_costs_are_median_and_percentiles(material: StudyMaterial) -> None:
    events = [
        event(
            "false",
            largest_deviation=0.1 * place,
            inconsistent=place > 2,
            replanned=place > 5,
            time_to_recover=3.0 if place > 2 else math.nan,
        )
        for place in range(11)
    ]
    found = cells(with_events(material, *events), "strong-rapid", "false")
    assert found["Number"] == "11"
    assert found["Deviation [m]"] == "0.50\n0.10 to 0.90"
    assert found["Conflict, new plan"] == "8, 5\nof 11"
    assert found["Gain back after [s]"] == "3.0\n3.0 to 3.0"
    assert found["Left lane"] == "–"


def test_where_there_is_none_the_table_says_how_rare_they_are(
    material: StudyMaterial,
) -> None:
    found = cells(with_events(material), "strong-rapid", "missed")
    driven = material.trials[material.trials["condition"] == "strong-rapid"]
    kilometres = driven["distance"].sum() / 1000.0
    most = -math.log(0.025) / kilometres * 100.0
    told = f"none in {kilometres:.1f} km\nat most {most:.2f}"
    assert found["Per 100 km"] == told
    assert found["Number"] == "0"
    assert found["Deviation [m]"] == "–"


def test_a_rate_has_its_interval() -> None:
    # Garwood's table for 5: 1.623 to 11.668.
    assert rate_text(5, 50.0) == "10.00\n[3.25, 23.34]"


def test_where_triggers_are_not_judged_nothing_is_said(
    material: StudyMaterial,
) -> None:
    unknown = material.trials["num_triggers"].where(
        material.trials["condition"] == "manual"
    )
    people = material._replace(trials=material.trials.assign(num_triggers=unknown))
    names = {row[0] for row in shown(people).rows}
    assert names == {"manual"}


@pytest.mark.slow
def test_of_a_folder_without_the_file_the_page_claims_nothing(
    study_folder: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "older"
    shutil.copytree(study_folder, folder)
    (folder / TRIGGERS_FILE).unlink()
    older = read_material(folder)
    assert older.triggers is None
    (section,) = [s for s in page_sections(older, {}) if s.name == "intention"]
    assert "trigger-costs" not in [item.name for item in section.items]


@pytest.mark.slow
def test_a_trial_without_a_row_has_no_triggers(
    study_folder: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "less"
    shutil.copytree(study_folder, folder)
    trials = pd.read_csv(folder / "trials.csv")
    trials[trials["participant"] < 3].to_csv(folder / "trials.csv", index=False)
    triggers = read_material(folder).triggers
    assert triggers is not None
    assert set(triggers["participant"]) == {1, 2}


def test_an_event_counts_in_its_condition_and_among_all(
    material: StudyMaterial,
) -> None:
    table = shown(with_events(material, event("missed", 20.0)))
    number = {row[0]: row[2] for row in table.rows if row[1] == "missed"}
    assert number.pop("strong-rapid") == number.pop("all assisted") == "1"
    assert set(number.values()) == {"0"}


@pytest.mark.slow
def test_a_study_without_any_trigger_is_reported(
    study_folder: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "study"
    shutil.copytree(study_folder, folder)
    (folder / TRIGGERS_FILE).write_text(",".join(TRIGGER_COLUMNS) + "\n")
    rows = shown(read_material(folder)).rows
    assert {row[2] for row in rows} == {"0"}
