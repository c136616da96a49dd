"""A study that is not whole still gets a report, which names what is missing."""

from __future__ import annotations

import html
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from costeer.records.record import read_record, write_record
from costeer.study.material import find_records
from costeer.study.report import write_report
from costeer.study.trial_tables import LANE_CHANGES_FILE, TRIALS_FILE

pytestmark = pytest.mark.slow

Keep = Callable[[int, str], bool]


def part(study: Path, folder: Path, keep: Keep) -> Path:
    """A copy of the study with the trials to keep alone."""
    shutil.copytree(study, folder)
    for name in (TRIALS_FILE, LANE_CHANGES_FILE):
        table = pd.read_csv(folder / name)
        kept = [
            keep(*key)
            for key in zip(table["participant"], table["condition"], strict=True)
        ]
        table[kept].to_csv(folder / name, index=False)
    for (participant, condition), record in find_records(folder).items():
        if not keep(participant, condition):
            record.unlink()
    return folder


def words(folder: Path) -> str:
    """What the page says, without its drawings."""
    page = write_report(folder).read_text("utf-8")
    page = re.sub(r"<style>.*?</style>|<svg.*?</svg>", "", page, flags=re.DOTALL)
    return html.unescape(re.sub(r"<[^>]+>", " ", page))


@pytest.mark.slow  # a report of its own
def test_one_participant_is_reported_but_nothing_concluded(
    study_folder: Path, tmp_path: Path
) -> None:
    text = words(part(study_folder, tmp_path / "one", lambda who, _: who == 2))
    assert "1 virtual driver drove all seven conditions" in text
    assert "The study is not complete: 7 of 21 trials are there." in text
    assert "nothing is concluded" in text
    assert "one participant only, hence no band" in text


def test_manual_alone_is_reported(study_folder: Path, tmp_path: Path) -> None:
    folder = part(study_folder, tmp_path / "m", lambda _, name: name == "manual")
    (folder / "figures").mkdir()
    (folder / "figures" / "signals-weak.svg").write_text("of an earlier report")
    text = words(folder)
    assert not (folder / "figures" / "signals-weak.svg").exists()
    assert "drove the condition manual" in text
    assert "No verdict was inconsistent" in text
    assert "No trial with strong guidance" in text
    assert "There is no verdict on inconsistency" in text


@pytest.mark.slow  # a report of its own
def test_without_manual_there_is_nothing_to_compare_with(
    study_folder: Path, tmp_path: Path
) -> None:
    text = words(part(study_folder, tmp_path / "a", lambda _, name: "weak" in name))
    assert text.count("No manual driving to compare with.") == 7
    assert "This participant has no manual trial to compare with." in text


@pytest.fixture(scope="module")
def with_a_gap(study_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    """Words of a study without one trial, and with two crossings dropped of another."""
    folder = tmp_path_factory.mktemp("gap") / "study"
    part(study_folder, folder, lambda *key: key != (3, "weak-rapid"))
    trials = pd.read_csv(folder / TRIALS_FILE)
    dropped = pd.Series([None] * len(trials), dtype=object)
    dropped[4] = "9.50 s: started before the record; 99.25 s: crossed back within 3 s"
    trials.assign(dropped_changes=dropped).to_csv(folder / TRIALS_FILE, index=False)
    return " ".join(words(folder).split())


def test_a_participant_without_a_cell_is_named(with_a_gap: str) -> None:
    assert "20 of 21 trials" in with_a_gap
    assert "Mixed models with participant as random effect" in with_a_gap
    assert "Dropped data" in with_a_gap


def test_a_crossing_that_is_no_lane_change_is_named_with_its_reason(
    with_a_gap: str, study_folder: Path
) -> None:
    trials = pd.read_csv(study_folder / TRIALS_FILE)
    where = f"{trials['participant'][4]} {trials['condition'][4]}, crossing at"
    assert f"{where} 9.50 s started before the record" in with_a_gap
    assert f"{where} 99.25 s crossed back within 3 s" in with_a_gap
    assert "No data had to be dropped" not in with_a_gap


def test_the_page_says_what_is_made_again(with_a_gap: str) -> None:
    assert "makes all but the records again; with people it leaves" in with_a_gap


def test_nobody_changing_lanes_is_reported(study_folder: Path, tmp_path: Path) -> None:
    folder = part(study_folder, tmp_path / "n", lambda who, _: who == 1)
    changes = pd.read_csv(folder / LANE_CHANGES_FILE)
    changes.iloc[:0].to_csv(folder / LANE_CHANGES_FILE, index=False)
    text = words(folder)
    assert "No trial of this study holds a lane change." in text
    assert text.count("no trial has a value") == 4
    assert "No completed lane change was intended by the driver." in text


@pytest.fixture
def people(study_folder: Path, tmp_path: Path) -> Path:
    """Two people with the same records, who answered the NASA-TLX."""
    folder = part(study_folder, tmp_path / "people", lambda who, _: who < 3)
    for path in find_records(folder).values():
        record = read_record(path)
        metadata = {**record.metadata, "driver_kind": "person"}
        write_record(path, record._replace(metadata=metadata))
    trials = pd.read_csv(folder / TRIALS_FILE)
    trials["tlx_raw"] = 40.0 + trials["participant"] + trials["order"]
    trials["tlx_weighted"] = float("nan")
    trials.to_csv(folder / TRIALS_FILE, index=False)
    return folder


@pytest.mark.slow  # a report of its own
def test_workload_of_people_is_drawn_tested_and_no_prediction(people: Path) -> None:
    text = words(people)
    assert (people / "figures" / "tlx-raw.svg").exists()
    assert not (people / "figures" / "tlx-weighted.svg").exists()
    assert "NASA-TLX, raw: differences" in text
    assert "2 participants drove" in text
    assert "virtual" not in text
    assert "prediction" not in text


def test_a_folder_that_is_no_study_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"not a study folder: it has no study\.yaml"):
        write_report(tmp_path)


def test_a_study_without_a_finished_trial_is_refused(
    study_folder: Path, tmp_path: Path
) -> None:
    shutil.copy(study_folder / "study.yaml", tmp_path)
    with pytest.raises(ValueError, match=r"has no trials\.csv: not one trial"):
        write_report(tmp_path)


def test_a_table_that_is_none_is_refused(study_folder: Path, tmp_path: Path) -> None:
    folder = part(study_folder, tmp_path / "t", lambda who, _: who == 1)
    (folder / TRIALS_FILE).write_bytes(b"\xff\xfe\x00participant")
    with pytest.raises(ValueError, match=r"trials\.csv is not a table of a study"):
        write_report(folder)


def test_an_empty_table_is_refused(study_folder: Path, tmp_path: Path) -> None:
    folder = part(study_folder, tmp_path / "e", lambda who, _: who == 1)
    (folder / TRIALS_FILE).write_bytes(b"")
    with pytest.raises(ValueError, match="no trial"):
        write_report(folder)


def test_a_truncated_record_is_named(study_folder: Path, tmp_path: Path) -> None:
    folder = part(study_folder, tmp_path / "cut", lambda who, _: who == 1)
    record = folder / "records" / "01-strong-rapid.parquet"
    record.write_bytes(record.read_bytes()[:-100])
    with pytest.raises(ValueError, match="01-strong-rapid"):
        write_report(folder)
