"""Tables of a session: who, what was answered and driven, and what does not count."""

from __future__ import annotations

import csv
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from costeer.cli import main
from costeer.records.columns import COLUMNS
from costeer.sessions.answered import answers_in
from costeer.sessions.attempts import Attempts
from costeer.sessions.log import clock_jump
from costeer.sessions.people import people_in
from costeer.sessions.questionnaires.definition import own_folder
from costeer.sessions.session import Session
from costeer.sessions.tables import write_all
from costeer.sessions.withdrawal import withdraw
from costeer.study.measures import trial_row
from costeer.study.quantities import WORKLOAD_ITEMS
from tests.sessions.conftest import DRIVEN
from tests.sessions.made_up import made_up_session, workload
from tests.study.synthetic import synthetic_record

Rows = list[dict[str, str]]


@pytest.fixture(scope="module")
def written(studied: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All tables of the study."""
    out = tmp_path_factory.mktemp("tables")
    write_all(studied, out)
    return out


def rows(folder: Path, name: str) -> Rows:
    with (folder / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_trials_have_the_columns_of_a_virtual_study_and_the_workload(
    written: Path,
) -> None:
    virtual = trial_row(synthetic_record(length=1800.0), 1)
    assert list(rows(written, "trials.csv")[0]) == [
        *virtual,
        "tlx_raw",
        "tlx_weighted",
        *("label", "scenario", "occasion", "ended_by"),
    ]


def test_what_counts_is_in_the_trials_once(written: Path) -> None:
    cells = [(r["participant"], r["condition"]) for r in rows(written, "trials.csv")]
    assert cells == [
        *(("P01", name) for name in DRIVEN),
        *(("P02", name) for name in DRIVEN[:2]),
        *(("P03", name) for name in DRIVEN),
    ]
    people = {each["participant"] for each in rows(written, "lane_changes.csv")}
    assert people == {"P01", "P02", "P03"}


def test_what_does_not_count_says_why(written: Path) -> None:
    log = [tuple(row.values())[:6] for row in rows(written, "exclusions.csv")]
    assert log[0][:5] == ("P02", "drive-weak-gentle", "weak-gentle", "1", "excluded")
    assert log[0][5] == "the screen went dark"
    missing = "P02", "drive-weak-gentle", "weak-gentle", "", "missing"
    assert (*missing, "every attempt is excluded") in log
    again = "P03", "drive-manual", "manual"
    assert (*again, "1", "excluded", "looked at the phone") in log
    assert (*again, "2", "aborted", "'=stopped") in log
    gone = [row for row in log if row[0] == "P04"]
    assert {row[4:] for row in gone} == {("dropped out", "felt sick")}
    assert len(gone) == len(DRIVEN)


def test_the_workload_is_that_of_the_answers(written: Path) -> None:
    for row in rows(written, "trials.csv"):
        given = workload(row["participant"], row["condition"])
        ratings = [float(str(given[item.name])) for item in WORKLOAD_ITEMS]
        assert float(row["tlx_raw"]) == pytest.approx(sum(ratings) / 6.0)
        # The first of two always wins: 5, 4, 3, 2, 1 and 0 times.
        weighted = np.dot(ratings, [5, 4, 3, 2, 1, 0]) / 15.0
        assert float(row["tlx_weighted"]) == pytest.approx(weighted)


def test_every_answer_is_a_row(written: Path) -> None:
    found = rows(written, "questionnaires.csv")
    # Consent 3, demographics 2, and 6 ratings with 15 comparisons for each of 3 trials;
    # P03 drove a trial again and its answers stay.
    assert len(found) == 4 * (3 + 2 + 3 * 21)
    one = next(row for row in found if row["item"] == "effort")
    assert (one["participant"], one["slot"], one["condition"]) == ("P01", "1", "manual")
    assert (one["instrument"], one["version"], one["language"]) == (
        *("nasa-tlx", "1", "en"),
    )
    assert one["value"] == f"{workload('P01', 'manual')['effort']}"
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z", one["answered_at"])
    assert float(one["monotonic"]) > 0.0


def test_a_note_that_looks_like_a_formula_is_quoted(written: Path) -> None:
    (note,) = [row for row in rows(written, "events.csv") if row["kind"] == "note"]
    assert note["text"] == "'=1+1, said P01"


def test_pauses_have_their_length_and_the_wall_clock(written: Path) -> None:
    pauses = [
        row
        for row in rows(written, "events.csv")
        if row["record"] == "records/P01-drive-manual.parquet"
    ]
    # The record says: begun at 09:30:00; 4.5 s at 10 s, then 2 s at 20 s of the trial.
    assert [
        (r["kind"], r["utc"][11:], r["length"], r["trial_time"]) for r in pauses
    ] == [
        ("paused", "09:30:10.000Z", "", "10.0"),
        ("resumed", "09:30:14.500Z", "4.5", "10.0"),
        ("paused", "09:30:24.500Z", "", "20.0"),
        ("resumed", "09:30:26.500Z", "2.0", "20.0"),
    ]


@pytest.mark.parametrize(
    ("second", "monotonic", "told"),
    [
        ("10.000", 110.0, None),
        ("10.900", 110.0, None),
        ("14.000", 110.0, ("clock jump", 4.0)),
        ("05.000", 110.0, ("clock jump", -5.0)),
        ("10.000", 3.0, ("clock restart", None)),
    ],
)
def test_clocks_that_disagree_are_told(
    second: str, monotonic: float, told: tuple[str, float | None] | None
) -> None:
    before = {"utc": "2026-01-31T09:30:00.000Z", "monotonic": 100.0}
    after = {"utc": f"2026-01-31T09:30:{second}Z", "monotonic": monotonic}
    row = clock_jump(before, after)
    assert (row and (row["kind"], row["length"])) == told


def test_devices_and_calibration_stand_beside_each_attempt(written: Path) -> None:
    found = rows(written, "attempts.csv")
    assert len(found) == 4 * (len(DRIVEN) + 1) + 2
    first = found[0]
    assert (first["kind"], first["state"]) == ("practise", "finished")
    assert first["wheel"] == "Simucube 2"
    assert first["wheel_calibration"] == '{"inertia": 0.05}'
    assert first["frame_rate"] == "58"
    aborted = [row for row in found if row["state"] == "aborted"]
    assert [row["participant"] for row in aborted] == ["P03"]


def test_participants_say_how_many_trials_count(written: Path) -> None:
    found = {row["participant"]: row for row in rows(written, "participants.csv")}
    counts = {who: row["num_trials"] for who, row in found.items()}
    assert counts == {"P01": "3", "P02": "2", "P03": "3", "P04": "0"}
    assert found["P04"]["status"] == "dropped"
    assert found["P01"]["finished_at"].endswith("Z")


def test_the_codebook_has_every_column_of_every_table(written: Path) -> None:
    book = rows(written, "codebook.csv")
    known = {(row["file"], row["column"]) for row in book}
    for table in written.glob("*.csv"):
        if table.name != "codebook.csv":
            head = table.read_text("utf-8").split("\n", 1)[0].split(",")
            assert {(table.name, name) for name in head} <= known
    assert {("records/*.parquet", each.name) for each in COLUMNS} <= known
    assert all(row["meaning"] and row["unit"] and row["range"] for row in book)
    about = {row["column"]: row for row in book if row["file"] == "questionnaires.csv"}
    effort = about["value of nasa-tlx.effort"]
    assert effort["range"] == "0 to 100 in steps of 5"
    assert "How hard did you have to work" in effort["meaning"]
    assert "Hart" in effort["source"]


def test_withdrawal_leaves_nothing_in_tables(studied: Path, tmp_path: Path) -> None:
    folder = tmp_path / "study"
    shutil.copytree(studied, folder)
    write_all(folder, folder)
    (folder / "report.html").write_text("P01")
    session = Session(folder)
    withdraw(session, "P01")
    session.close()
    assert not list(folder.glob("*.csv"))
    assert not (folder / "report.html").exists()
    out = tmp_path / "out"
    people = write_all(folder, out)
    assert people.num_withdrawn == 1
    texts = [file.read_text("utf-8") for file in out.iterdir()]
    assert len(texts) == 10
    assert not any("P01" in text for text in texts)
    assert all("P02" in text for text in texts if "P03" in text)


def test_a_pseudonym_of_digits_stays_one(tmp_path: Path) -> None:
    session = made_up_session(tmp_path / "s", ["007"], ["manual", "weak-gentle"])
    session.close()
    write_all(tmp_path / "s", tmp_path / "out")
    found = rows(tmp_path / "out", "trials.csv")
    assert [row["participant"] for row in found] == ["007", "007"]


def test_a_damaged_record_is_a_trial_that_is_missing(
    studied: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "study"
    shutil.copytree(studied, folder)
    record = folder / "records" / "P01-drive-manual.parquet"
    record.write_bytes(record.read_bytes()[:1000])
    write_all(folder, tmp_path / "out")
    found = rows(tmp_path / "out", "trials.csv")
    assert ("P01", "manual") not in {(r["participant"], r["condition"]) for r in found}
    (gap,) = [r for r in rows(tmp_path / "out", "exclusions.csv") if r["utc"] == ""][:1]
    assert (gap["participant"], gap["state"]) == ("P01", "missing")
    assert gap["reason"] == "its record is not there, or cannot be read"


def test_an_instrument_that_has_changed_gives_no_score(
    studied: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "study"
    shutil.copytree(studied, folder)
    (folder / "instruments").mkdir()
    shipped = own_folder("instruments") / "nasa-tlx.yaml"
    changed = shipped.read_text("utf-8").replace('version: "1"', 'version: "2"')
    (folder / "instruments" / "nasa-tlx.yaml").write_text(changed, encoding="utf-8")
    write_all(folder, tmp_path / "out")
    scores = rows(tmp_path / "out", "scores.csv")
    assert {row["value"] for row in scores if row["instrument"] == "nasa-tlx"} == {""}
    assert {row["tlx_raw"] for row in rows(tmp_path / "out", "trials.csv")} == {""}


def test_a_session_without_a_trial_is_refused_in_a_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made_up_session(tmp_path / "s", [], ["manual", "weak-gentle"]).close()
    assert main(["report", str(tmp_path / "s")]) == 2
    error = capsys.readouterr().err
    assert "has no trial that counts; drive one to its end" in error


def test_the_log_keeps_its_order_when_the_clock_is_set_back(
    studied: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "study"
    shutil.copytree(studied, folder)
    session = Session(folder)
    with session.store.transaction():  # by a day, in the middle
        session.store.run(
            "UPDATE events SET utc = '2020' || substr(utc, 5) WHERE number > 60"
        )
    told = session.store.rows("SELECT kind, text FROM events ORDER BY number")
    session.close()
    write_all(folder, tmp_path / "out")
    found = rows(tmp_path / "out", "events.csv")
    kinds = [row["kind"] for row in found if not row["record"]]
    assert kinds.count("clock jump") == 1
    kinds.remove("clock jump")
    assert kinds == [row["kind"] for row in told]


def test_of_two_whole_attempts_the_later_counts(studied: Path, tmp_path: Path) -> None:
    folder = tmp_path / "study"
    shutil.copytree(studied, folder)
    session = Session(folder)
    Attempts(session).exclude("P03", "drive-manual", 1, "it was well", out=False)
    with session.store.transaction():  # the computer was started anew in between
        session.store.run("UPDATE attempts SET monotonic = 1 WHERE attempt = 3")
    people = people_in(session, answers_in(session))
    (one,) = [d for d in people.drives if d[:2] == ("P03", "manual")]
    session.close()
    assert one.record.name == "P03-drive-manual-3.parquet"
