"""The page, the tables and what they say; rows of trials; the command."""

from __future__ import annotations

import csv
import math
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import costeer
from costeer.cli import main
from costeer.comparison.measures import COLUMNS, outcome_of
from costeer.comparison.run import run_comparison
from costeer.loop.scenario import TrialSetup
from costeer.records.columns import TrialRecord
from costeer.study.disputes import in_lane_change
from costeer.study.inconsistencies import find_inconsistencies
from costeer.study.measures import lane_change_rows, trial_row
from tests.comparison.fakes import SMALL, made_up
from tests.study.fakes import contents


def faulty(setup: TrialSetup) -> TrialRecord:
    """As made up; `ibhs` asks once for too much, and fails for one driver."""
    if (setup.method, setup.participant, setup.scenario) == ("ibhs", 2, "cut-in"):
        raise ValueError("the car's position is no number")
    record = made_up(setup)
    asked = setup.method == "ibhs" and setup.participant == 1
    return record._replace(metadata={**record.metadata, "torque_faults": 4 * asked})


@pytest.fixture(scope="module")
def reported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the small comparison with its report; read only."""
    folder = tmp_path_factory.mktemp("compared")
    run_comparison(folder, SMALL, jobs=1, simulate=faulty)
    return folder


@pytest.fixture(scope="module")
def page(reported: Path) -> str:
    return (reported / "report.html").read_text("utf-8")


def values(record: TrialRecord) -> dict[str, float]:
    return dict(zip(COLUMNS, outcome_of(1, record).values, strict=True))


def setup(
    method: str, scenario: str = "expressway", participant: int = 3
) -> TrialSetup:
    return TrialSetup(
        condition="strong-normal",
        method=method,
        scenario=scenario,
        participant=participant,
        length=1800.0,
    )


def test_a_row_has_the_measures_of_the_study() -> None:
    record = made_up(setup("ibhs"))
    found, study, changes = values(record), trial_row(record), lane_change_rows(record)
    for name in ("sdlp", "driver_torque_rms", "detection_lead_time", "missed_per_km"):
        assert found[name] == study[name]
    assert found["change_duration"] == pytest.approx(
        sum(float(str(row["duration"])) for row in changes) / len(changes)
    )
    assert found["num_collisions"] == 0.0


def test_a_trigger_of_nobody_annoys_and_helps_nobody() -> None:
    # In manual driving the intention is inferred, and moves nothing.
    found = values(made_up(setup("manual")))
    for name in ("false_triggers_per_km", "detection_lead_time", "opposing_torque_rms"):
        assert math.isnan(found[name])
    assert found["sdlp"] > 0.0


def test_a_collision_is_an_event_of_safety() -> None:
    found = values(made_up(setup("manual", "cut-in")))
    assert found["num_collisions"] == 1.0
    assert found["num_safety_events"] == 1.0 + found["num_lane_departures"]


def test_inconsistencies_are_placed_as_the_study_places_them() -> None:
    record = made_up(setup("ibhs"))
    begun = find_inconsistencies(record.columns)
    changes = pd.DataFrame(lane_change_rows(record))
    assert not isinstance(begun, str)
    assert begun
    wanted = [in_lane_change(each.start_time, changes) for each in begun]
    found = outcome_of(1, record).disputes
    assert np.array(found) == pytest.approx(np.array(wanted), nan_ok=True)
    # The shadow of manual driving disputes nothing.
    assert outcome_of(1, made_up(setup("manual"))).disputes is None


def test_the_page_says_what_one_must_know(page: str) -> None:
    for words in (
        "Thresholds and gains of all methods were set before, on manual and pilot",
        "calibrated on manual driving and for none of the methods",
        "Where the paper&#39;s method loses",
        "2 methods, 2 scenarios, 12 virtual drivers",
        "When inconsistencies come",
        "expressway and cut-in",
        "1 trial failed",
        "ValueError: the car&#39;s position is no number",
        "Asked for a torque not finite or over the limit: ibhs (8).",
        "0003-manual-cut_in-none-00003.parquet",
    ):
        assert words in " ".join(page.split()), words
    assert "http://" not in page.replace("http://www.w3.org", "")


def test_who_failed_is_not_ranked_there(reported: Path) -> None:
    with (reported / "winners.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    cut_in = [row for row in rows if row["scenario"] == "cut-in"]
    assert {row["verdict"] for row in cut_in} == {"not compared"}
    assert {row["not_ranked"] for row in cut_in if row["measure"] == "sdlp"} == {"ibhs"}


def test_every_column_of_every_table_is_explained(reported: Path) -> None:
    with (reported / "columns.csv").open(encoding="utf-8", newline="") as stream:
        told = {(r["file"], r["column"]): r["meaning"] for r in csv.DictReader(stream)}
    tables = [f for f in reported.glob("*.csv") if f.name != "columns.csv"]
    assert len(tables) == 6
    for file in tables:
        with file.open(encoding="utf-8", newline="") as stream:
            for name in next(csv.reader(stream)):
                assert told.get((file.name, name)), f"{file.name}: {name}"


@pytest.mark.slow
def test_the_report_is_made_again_from_the_results_alone(
    reported: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = contents(reported)
    for name in ("report.html", "effects.csv", "trials.csv", "winners.csv"):
        (reported / name).unlink()
    assert main(["report", str(reported)]) == 0
    assert capsys.readouterr().out.strip() == str(reported / "report.html")
    assert contents(reported) == before


@pytest.mark.usefixtures("undrawn")
def test_an_unfinished_comparison_has_a_report_that_says_so(
    reported: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = Path(shutil.copytree(reported, tmp_path / "part"))
    for file in (folder / "results").glob("*-00011.json"):
        file.unlink()
    assert main(["report", str(folder)]) == 0
    told = capsys.readouterr().err.splitlines()[-1]
    assert told.startswith("costeer: the report is without 8 trials not driven yet;")
    page = (folder / "report.html").read_text("utf-8")
    assert "8 trials are not driven yet" in page
    with (folder / "trials.csv").open(encoding="utf-8") as stream:
        assert len(stream.readlines()) == 1 + 4 * 10


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--methods", "manual,ibsh"], "did you mean ibhs"),
        (["--methods", ","], "--methods names nothing"),
        (["--scenarios", "expresway"], "did you mean expressway"),
        (["--mistakes", "nope"], "there is no mistake 'nope'"),
        (["--length", "3miles"], "'3miles' is not a length; give metres"),
        (["--participants", "0"], "participants is 0; give a whole number 1 to"),
        (["--jobs", "0"], "jobs is 0; give a whole number 1 to"),
    ],
)
def test_bad_input_is_one_line_and_leaves_no_folder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], told: str
) -> None:
    out = tmp_path / "none"
    usual = ["--methods", "manual,ibhs", "--scenarios", "cut-in"]
    assert main(["compare", "--out", str(out), *usual, *words]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1
    assert not out.exists()


def test_a_report_beside_a_comparison_is_refused(
    reported: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", str(reported), "--beside", str(reported)]) == 2
    assert "leave --beside out" in capsys.readouterr().err


@pytest.mark.slow
def test_two_methods_on_two_roads_with_two_drivers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = "--methods manual,ibhs --scenarios expressway,crosswind --participants 2"
    command = ["compare", *words.split(), "--length", "1.8km", "--out"]
    assert main([*command, str(tmp_path / "a")]) == 0
    assert "8 trials simulated, 0 were there" in capsys.readouterr().out
    costeer.compare(
        tmp_path / "b",
        methods=["manual", "ibhs"],
        scenarios=["expressway", "crosswind"],
        participants=2,
        length=1800,
        jobs=1,
    )
    ours, theirs = contents(tmp_path / "a"), contents(tmp_path / "b")
    assert ours.keys() == theirs.keys()
    assert [name for name in ours if ours[name] != theirs[name]] == []
    with (tmp_path / "a" / "trials.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert all(float(row["sdlp"]) > 0.0 for row in rows)
    assert [bool(row["detection_lead_time"]) for row in rows[:4]] == [False] * 2 + [
        True
    ] * 2


def test_who_is_refused_reads_the_refusal_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.txt").write_text("not a comparison")
    # That manual driving makes no mistake of a trigger is a note of its own.
    words = ["compare", "--out", str(tmp_path), "--methods", "manual,ibhs"]
    words += ["--mistakes", "late-trigger", "--participants", "1", "--length", "500"]
    assert main(words) == 2
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1
    assert "is not empty and holds no comparison" in told[0]


def test_a_line_that_is_never_near_is_not_farther_than_any() -> None:
    record = made_up(setup("manual"))
    still = np.full(len(record.columns["time"]), -1.75)
    # Ten micrometres a second towards a line that is 0.85 m away.
    drift = still + 1e-5 * np.asarray(record.columns["time"])
    kept = record._replace(columns={**record.columns, "lateral_position": drift})
    assert float(str(trial_row(kept)["line_crossing_time_minimum"])) > 1e4
    assert values(kept)["line_crossing_time_minimum"] == 20.0
