"""Conditions driven again, other scenarios, several plans: each by itself."""

from __future__ import annotations

import csv
import html
import re
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from costeer.cli import main
from costeer.sessions.answered import answers_in
from costeer.sessions.export import export_session
from costeer.sessions.people import people_in
from costeer.sessions.session import Session
from costeer.sessions.withdrawal import withdraw
from tests.sessions.made_up import planned_session

PEOPLE = ("P01", "P02", "P03", "P04")
PLAN = """
title: Before and after
participants: 4
length: 1800
steps:
  - {kind: drive, condition: manual}
  - {kind: ask, instrument: nasa-tlx}
  - {kind: trials, conditions: [strong-rapid, weak-gentle]}
  - {kind: drive, condition: manual, label: after}
  - {kind: ask, instrument: nasa-tlx}
  - {kind: trials, conditions: [manual, weak-gentle], scenario: obstacle}
"""
LABELS = [
    *("manual", "strong-rapid", "weak-gentle", "manual-after"),
    *("manual-obstacle", "weak-gentle-obstacle"),
]


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("again") / "study"
    planned_session(folder, PEOPLE, PLAN).close()
    return folder


def rows(folder: Path, name: str) -> list[dict[str, str]]:
    with (folder / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_every_trial_stands_in_the_tables_with_what_tells_it_from_others(
    driven: Path, tmp_path: Path
) -> None:
    people = export_session(driven, "csv", tmp_path / "out")
    trials = rows(tmp_path / "out", "trials.csv")
    own = {r["label"]: r for r in trials if r["participant"] == "P02"}
    assert sorted(own) == sorted(LABELS)
    after = own["manual-after"]
    told = after["condition"], after["scenario"], after["occasion"]
    assert told == ("manual", "expressway", "2")
    there = own["weak-gentle-obstacle"]
    told = there["condition"], there["scenario"], there["occasion"]
    assert told == ("weak-gentle", "obstacle", "1")
    assert {row["label"] for row in rows(tmp_path / "out", "lane_changes.csv")} == {
        *LABELS
    }
    asked = rows(tmp_path / "out", "scores.csv")
    assert {row["label"] for row in asked} == {"manual", "manual-after"}
    persons = rows(tmp_path / "out", "participants.csv")
    assert {row["num_trials"] for row in persons} == {"6"}
    assert {each.label for each in people.drives} == set(LABELS[:3])
    assert {each.label for each in people.again} == {"manual-after"}
    assert {each.label for each in people.apart["obstacle"].drives} == set(LABELS[4:])


@pytest.mark.slow
def test_other_programs_get_a_file_for_every_trial(
    driven: Path, tmp_path: Path
) -> None:
    export_session(driven, "matlab", tmp_path / "out")
    names = {file.stem for file in (tmp_path / "out").glob("P01-*.mat")}
    assert names == {f"P01-{label}" for label in LABELS}


def words(page: Path) -> str:
    text = re.sub(r"<style>.*?</style>|<svg.*?</svg>", "", page.read_text(), flags=re.S)
    return " ".join(html.unescape(re.sub(r"<[^>]+>", " ", text)).split())


@pytest.mark.slow
def test_report_tests_first_trials_and_lays_later_ones_beside_them(
    tmp_path: Path,
) -> None:
    folder = tmp_path / "study"
    planned_session(folder, PEOPLE, PLAN).close()
    assert main(["report", str(folder)]) == 0
    trials = rows(folder, "trials.csv")
    (pair,) = [r for r in rows(folder, "again.csv") if r["measure"] == "sdlp"]
    assert (pair["first"], pair["second"]) == ("manual-after", "manual")
    sdlp = {
        label: np.array([float(r["sdlp"]) for r in trials if r["label"] == label])
        for label in ("manual", "manual-after")
    }
    assert float(pair["mean_first"]) == pytest.approx(sdlp["manual-after"].mean())
    assert int(pair["n_first"]) == 4
    found = stats.ttest_rel(sdlp["manual-after"], sdlp["manual"])
    assert float(pair["statistic"]) == pytest.approx(found.statistic)
    told = words(folder / "report.html")
    assert "Conditions that were driven again" in told
    assert "All 12 trials are there" in told
    levels = {row["second"] for row in rows(folder, "pairs.csv")}
    assert "manual-after" not in levels
    apart = folder / "reports" / "obstacle"
    assert {row["label"] for row in rows(apart, "trials.csv")} == set(LABELS[4:])
    assert "reports/obstacle/report.html" in told
    assert "Only trials on the scenario obstacle" in words(apart / "report.html")
    session = Session(folder)
    withdraw(session, "P01")
    session.close()
    assert not list(folder.rglob("*.csv"))
    assert not list(folder.rglob("report.html"))


def said(folder: Path) -> str:
    session = Session(folder)
    try:
        return " ".join(people_in(session, answers_in(session)).said)
    finally:
        session.close()


TWO = """
title: Two plans
participants: 4
length: {length}
speed_kmh: {speed}
steps:
  - {{kind: drive, condition: manual}}
  - {{kind: trials, order: {order}, conditions: [strong-rapid, weak-gentle]}}
"""


def test_each_plan_is_described_by_itself_with_who_drove_under_it(
    tmp_path: Path,
) -> None:
    first = TWO.format(length=1800, speed=70, order="williams")
    planned_session(tmp_path, ["P01", "P02"], first).close()
    second = TWO.format(length=2500, speed=90, order="random")
    planned_session(tmp_path, ["P03"], second).close()
    (tmp_path / "plan.yaml").write_text(TWO.format(length=999, speed=80, order="given"))
    told = said(tmp_path)
    one, two = told.split("Under version 2 (P03):")
    assert "2 versions were driven" in one
    assert "Under version 1 (P01 and P02):" in one
    assert "Williams square" in one
    assert "1.8 km at a suggested 70 km/h" in one
    assert "an order drawn for each participant" in two
    assert "2.5 km at a suggested 90 km/h" in two
    assert "same order for everybody" not in told  # nobody drove under today's plan
    session = Session(tmp_path)
    configuration = people_in(session, answers_in(session)).study.configuration
    session.close()
    assert configuration["plan_versions"] == [1, 2]
    assert not {"length", "speed"} & set(configuration)


def test_a_plan_that_everybody_drove_is_described_once(tmp_path: Path) -> None:
    first = TWO.format(length=1800, speed=70, order="williams")
    planned_session(tmp_path, ["P01"], first).close()
    (tmp_path / "plan.yaml").write_text(TWO.format(length=999, speed=80, order="given"))
    told = said(tmp_path)
    assert "Under version" not in told
    assert "1.8 km at a suggested 70 km/h" in told
    assert "0.999" not in told


def test_editions_of_a_scenario_of_the_lab_are_told_apart(tmp_path: Path) -> None:
    plan = "title: a\nscenario: mine.yaml\nsteps: [{kind: drive, condition: manual}]\n"
    scenario = "name: mine\nroad: {length: 1800}\nspeed: 70 km/h\n"
    (tmp_path / "mine.yaml").write_text(scenario)
    planned_session(tmp_path, ["P01"], plan).close()
    (tmp_path / "mine.yaml").write_text(f"{scenario}about: edited\n")
    planned_session(tmp_path, ["P02"], plan).close()
    editions = re.findall(r"mine \(mine.yaml, (\w{8})\)", said(tmp_path))
    assert len(set(editions)) == 2
