"""A study is run once, whatever stops it, and always to the same bytes."""

from __future__ import annotations

import csv
import errno
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from costeer.loop.scenario import TrialSetup
from costeer.plant.parameters import CarParameters
from costeer.records.record import TrialRecord, read_record, write_record
from costeer.study import trials
from costeer.study.configuration import StudySettings
from costeer.study.folder import record_path
from costeer.study.locks import locked
from costeer.study.run import (
    StudyInterrupted,
    full_report,
    remake_tables,
    run_study,
    study_command,
)
from costeer.study.trials import TrialDone
from tests.methods.rivals import FILE, example
from tests.study.fakes import (
    NUM_TRIALS,
    SMALL,
    contents,
    made_up,
    plain_report,
    run_small,
)

OWN = str(FILE)


class Stop(MemoryError):
    """A fault in the middle that is not of one trial."""


def after(calls: int, error: BaseException) -> Callable[..., TrialRecord]:
    """A simulation that fails when it is called once more than `calls` times."""
    count = 0

    def simulate(setup: TrialSetup) -> TrialRecord:
        nonlocal count
        count += 1
        if count > calls:
            raise error
        return made_up(setup)

    return simulate


def counted() -> tuple[list[tuple[int, str]], Callable[[TrialSetup], TrialRecord]]:
    """A list, and a simulation that enters what it was asked for."""
    asked: list[tuple[int, str]] = []

    def simulate(setup: TrialSetup) -> TrialRecord:
        asked.append((setup.participant, setup.condition))
        return made_up(setup)

    return asked, simulate


def rows(file: Path) -> list[dict[str, str]]:
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The small study when nothing disturbs it; read only."""
    folder = tmp_path_factory.mktemp("whole") / "study"
    run_small(folder)
    return folder


@pytest.fixture(scope="module")
def whole(undisturbed: Path) -> dict[str, bytes]:
    """What it holds."""
    return contents(undisturbed)


@pytest.fixture
def finished(undisturbed: Path, tmp_path: Path) -> Path:
    """A copy of it."""
    return shutil.copytree(undisturbed, tmp_path / "study")


def test_a_study_leaves_what_the_guide_says(whole: dict[str, bytes]) -> None:
    assert list(whole) == [
        "lane_changes.csv",
        *(
            f"records/0{participant}-{name}.parquet"
            for participant in (1, 2)
            for name in sorted(SMALL.conditions)
        ),
        "report.html",
        "study.yaml",
        "trials.csv",
        "triggers.csv",
    ]


def test_the_outcome_counts_trials_and_seconds(tmp_path: Path) -> None:
    outcome = run_small(tmp_path)
    assert (outcome.num_trials, outcome.num_resumed) == (NUM_TRIALS, 0)
    # 1800 m at 70 km/h are 92.6 s; the made-up car varies its speed a little.
    assert outcome.driver_seconds == pytest.approx(NUM_TRIALS * 92.6, rel=0.05)
    again = run_small(tmp_path)
    assert (again.num_resumed, again.driver_seconds) == (NUM_TRIALS, 0.0)


def test_jobs_do_not_change_a_byte(tmp_path: Path, whole: dict[str, bytes]) -> None:
    run_small(tmp_path, jobs=3)
    assert contents(tmp_path) == whole


def test_a_finished_study_runs_no_trial_again(
    finished: Path, whole: dict[str, bytes]
) -> None:
    asked, simulate = counted()
    run_study(finished, SMALL, report=plain_report, simulate=simulate)
    assert asked == []
    assert contents(finished) == whole


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_fault_in_the_middle_keeps_what_is_finished(
    tmp_path: Path, whole: dict[str, bytes], jobs: int
) -> None:
    with pytest.raises(Stop):
        run_study(tmp_path, SMALL, jobs=jobs, simulate=after(3, Stop()))
    kept = set(contents(tmp_path)) - {"study.yaml"}
    assert len(kept) == 3
    asked, simulate = counted()
    run_study(tmp_path, SMALL, jobs=1, report=plain_report, simulate=simulate)
    assert len(asked) == NUM_TRIALS - 3
    assert contents(tmp_path) == whole


def test_a_plug_in_that_does_not_run_is_refused_before_there_is_a_folder(
    tmp_path: Path,
) -> None:
    out = tmp_path / "study"
    own = SMALL._replace(method=OWN)
    refusal = ValueError("it does not run")
    with pytest.raises(ValueError, match="it does not run"):
        run_study(out, own, report=None, simulate=after(0, refusal))
    assert not out.exists()


def cut_short(file: Path) -> None:
    file.write_bytes(file.read_bytes()[:-500])


def of_another_study(file: Path) -> None:
    record = read_record(file)
    write_record(
        file, TrialRecord({**record.metadata, "study_hash": 0}, record.columns)
    )


def of_another_participant(file: Path) -> None:
    file.write_bytes(file.with_name("02-strong-rapid.parquet").read_bytes())


@pytest.mark.parametrize(
    "damage", [cut_short, of_another_study, of_another_participant]
)
def test_a_record_that_is_not_the_trial_s_is_not_believed(
    finished: Path, whole: dict[str, bytes], damage: Callable[[Path], None]
) -> None:
    damage(record_path(finished, 1, "strong-rapid"))
    asked, simulate = counted()
    run_study(finished, SMALL, report=plain_report, simulate=simulate)
    assert asked == [(1, "strong-rapid")]
    assert contents(finished) == whole


def test_a_full_disk_is_told_and_nothing_is_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, whole: dict[str, bytes]
) -> None:
    written: list[Path] = []

    def full(path: Path, record: TrialRecord) -> None:
        if len(written) == 2:
            raise OSError(errno.ENOSPC, "No space left on device", str(path))
        written.append(path)
        write_record(path, record)

    with monkeypatch.context() as patch:
        patch.setattr(trials, "write_record", full)
        with pytest.raises(
            OSError,
            match=r"participant 1, weak-gentle: No space left on device .*01-weak-g"
            r".*; free some space; 2 of 6 trials are done and kept in .*; run the same",
        ):
            run_small(tmp_path)
    assert run_small(tmp_path).num_resumed == 2
    assert contents(tmp_path) == whole


def test_an_interruption_says_how_to_go_on(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    done: list[TrialDone] = []

    def interrupt(trial: TrialDone) -> None:
        done.append(trial)
        if len(done) == 2:
            raise KeyboardInterrupt

    with pytest.raises(StudyInterrupted, match=r"of 6 trials are done and kept in"):
        run_study(tmp_path, SMALL, jobs=1, progress=interrupt, simulate=made_up)
    # The trial that runs at the interruption is finished too.
    assert 2 <= run_small(tmp_path).num_resumed <= 3
    assert contents(tmp_path) == whole


def test_an_interruption_of_the_report_keeps_all_trials(tmp_path: Path) -> None:
    def interrupted(_: Path) -> None:
        raise KeyboardInterrupt

    with pytest.raises(StudyInterrupted, match="all 6 trials are done and kept"):
        run_study(tmp_path, SMALL, report=interrupted, simulate=made_up)
    assert run_small(tmp_path).num_resumed == NUM_TRIALS


def test_a_fault_of_the_progress_display_is_not_a_trial_s(tmp_path: Path) -> None:
    def broken(_: TrialDone) -> None:
        raise OSError("terminal gone")

    with pytest.raises(OSError, match=r"^terminal gone; "):
        run_study(tmp_path, SMALL, progress=broken, simulate=made_up)


def test_a_second_study_in_the_folder_is_refused(finished: Path) -> None:
    with pytest.raises(ValueError, match="participants is 2 there, 1 here"):
        run_small(finished, SMALL._replace(participants=1))


def test_a_folder_in_use_is_refused(tmp_path: Path) -> None:
    with locked(tmp_path), pytest.raises(ValueError, match="in use by another"):
        run_small(tmp_path)


@pytest.mark.parametrize("jobs", [0, -1, 257])
def test_a_wrong_number_of_jobs_is_refused(tmp_path: Path, jobs: int) -> None:
    with pytest.raises(ValueError, match=f"jobs is {jobs}; give a whole number 1 to"):
        run_small(tmp_path / "none", jobs=jobs)
    assert not (tmp_path / "none").exists()


def test_tables_stand_in_the_order_of_table_4_with_the_order_driven(
    finished: Path,
) -> None:
    table = rows(finished / "trials.csv")
    assert [(r["participant"], r["condition"], r["order"]) for r in table] == [
        ("1", "manual", "1"),
        ("1", "strong-rapid", "2"),
        ("1", "weak-gentle", "3"),
        ("2", "manual", "1"),
        ("2", "strong-rapid", "3"),
        ("2", "weak-gentle", "2"),
    ]
    assert table[0]["change_duration"] == ""
    assert table[2]["change_duration"] == "8.0"


def test_there_is_a_row_per_lane_change(finished: Path) -> None:
    counts = [int(r["num_lane_changes"]) for r in rows(finished / "trials.csv")]
    assert sum(counts) > 0
    assert len(rows(finished / "lane_changes.csv")) == sum(counts)


def test_tables_can_be_made_again_from_records(
    finished: Path, whole: dict[str, bytes]
) -> None:
    (finished / "trials.csv").unlink()
    (finished / "lane_changes.csv").write_text("lost")
    assert remake_tables(finished) == NUM_TRIALS
    assert contents(finished) == whole


def test_tables_of_an_unfinished_study_have_fewer_rows(finished: Path) -> None:
    cut_short(record_path(finished, 1, "manual"))
    assert remake_tables(finished, jobs=1) == NUM_TRIALS - 1
    assert len(rows(finished / "trials.csv")) == NUM_TRIALS - 1


def test_tables_need_a_record(tmp_path: Path) -> None:
    with pytest.raises(Stop):
        run_study(tmp_path, SMALL, jobs=1, simulate=after(0, Stop()))
    with pytest.raises(ValueError, match=r"no trial of the study .* complete record"):
        remake_tables(tmp_path)


@pytest.mark.parametrize(
    ("changes", "options"),
    [
        ({}, ""),
        ({"seed": 4, "speed": 25.0}, " --seed 4 --speed 25.0"),
        ({"conditions": ("manual", "weak-rapid")}, " --conditions manual,weak-rapid"),
    ],
)
def test_the_command_in_the_folder_names_what_is_not_usual(
    changes: dict[str, Any], options: str
) -> None:
    settings = StudySettings(**changes)
    assert study_command(settings) == f"costeer study --out FOLDER{options}"


def test_what_no_command_can_name_is_run_in_python() -> None:
    assert study_command(StudySettings(method=example())) == (
        "costeer.study(FOLDER, ...) in Python, with the same arguments; method "
        "pi-keeping given as objects"
    )


def test_the_files_of_a_study_are_read_once(tmp_path: Path) -> None:
    file = tmp_path / "car.yaml"
    file.write_text("mass: 1500")
    masses = set()

    def simulate(setup: TrialSetup) -> TrialRecord:
        assert isinstance(setup.car, CarParameters)
        masses.add(setup.car.mass)
        file.write_text("mass: 1720")
        return made_up(setup)

    settings = SMALL._replace(car=str(file))
    run_study(tmp_path / "a", settings, jobs=1, report=None, simulate=simulate)
    assert masses == {1500.0}


def test_the_report_is_written_by_the_report_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[Path] = []
    monkeypatch.setattr(
        "costeer.study.report.write_report", lambda folder, _: seen.append(folder)
    )
    full_report(tmp_path)
    assert seen == [tmp_path]


def test_what_a_killed_worker_had_half_written_is_gone_at_the_end(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    half = tmp_path / "records" / "02-manual.parquet.77.tmp"

    def killed(_: TrialDone) -> None:
        half.write_bytes(b"PAR1 half")

    run_study(tmp_path, SMALL, report=plain_report, progress=killed, simulate=made_up)
    assert contents(tmp_path) == whole
