"""Shards share a folder, or have one each; together they are the whole study."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from costeer.cli import main
from costeer.loop.scenario import TrialSetup
from costeer.records.record import TrialRecord
from costeer.scale.shard import Shard
from costeer.study.folder import record_path
from costeer.study.locks import locked
from costeer.study.merge import Merged, merge_study
from costeer.study.run import Scale, StudyOutcome, run_study
from tests.study.fakes import (
    NUM_TRIALS,
    SMALL,
    contents,
    made_up,
    plain_report,
    run_small,
)

HOLD = """
import sys, time
from pathlib import Path
from costeer.scale.shard import Shard
from costeer.study.locks import locked_shard
with locked_shard(Path(sys.argv[1]), Shard(1, 2)):
    print("held", flush=True)
    time.sleep(60)
"""


def run_shard(out: Path, number: int, total: int, records: bool = True) -> StudyOutcome:
    """One shard of the small study."""
    scale = Scale(shard=Shard(number, total), records=records)
    return run_study(out, SMALL, jobs=1, simulate=made_up, scale=scale)


def merged(*folders: Path, out: Path | None = None) -> Merged:
    return merge_study(folders, out, plain_report)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """What the small study holds if one process runs it."""
    folder = tmp_path_factory.mktemp("whole") / "study"
    run_small(folder)
    return contents(folder)


@pytest.mark.parametrize(
    "total",
    [
        2,
        pytest.param(3, marks=pytest.mark.slow),
        pytest.param(8, marks=pytest.mark.slow),
    ],
)
def test_shards_of_one_folder_make_the_same_study(
    tmp_path: Path, whole: dict[str, bytes], total: int
) -> None:
    sizes = [run_shard(tmp_path, n, total).num_trials for n in range(total, 0, -1)]
    assert sum(sizes) == NUM_TRIALS
    assert not (tmp_path / "trials.csv").exists()
    done = merged(tmp_path)
    assert (done.outcome.num_trials, done.repeated) == (NUM_TRIALS, ())
    assert contents(tmp_path) == whole


def test_a_shard_goes_on_where_it_was(tmp_path: Path) -> None:
    run_shard(tmp_path, 1, 2)
    record_path(tmp_path, 1, "manual").unlink()
    outcome = run_shard(tmp_path, 1, 2)
    assert (outcome.num_trials, outcome.num_resumed) == (3, 2)


@pytest.mark.slow
def test_shards_with_a_folder_each_are_put_together(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    folders = [tmp_path / str(number) for number in (1, 2)]
    for number, folder in enumerate(folders, 1):
        run_shard(folder, number, 2)
    merged(*folders, out=tmp_path / "all")
    assert contents(tmp_path / "all") == whole


def test_measures_and_records_are_put_together(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    run_shard(tmp_path / "1", 1, 2)
    run_shard(tmp_path / "2", 2, 2, records=False)
    run_shard(tmp_path / "3", 2, 2)
    merged(tmp_path / "1", tmp_path / "2", out=tmp_path / "some")
    some = contents(tmp_path / "some")
    assert some["trials.csv"] == whole["trials.csv"]
    assert some["lane_changes.csv"] == whole["lane_changes.csv"]
    assert len([name for name in some if name.endswith(".parquet")]) == 3
    done = merged(*(tmp_path / name for name in "123"), out=tmp_path / "all")
    assert len(done.repeated) == 3
    assert contents(tmp_path / "all") == whole


def test_missing_trials_are_named_and_nothing_is_written(tmp_path: Path) -> None:
    run_shard(tmp_path, 2, 2)
    with pytest.raises(
        ValueError,
        match="3 of 6 trials are missing: participant 1 manual, participant 1 weak-gen"
        "tle, participant 2 strong-rapid; run their shards again",
    ):
        merged(tmp_path)
    with pytest.raises(ValueError, match="3 of 6 trials are missing"):
        merged(tmp_path, out=tmp_path / "out")
    assert not (tmp_path / "trials.csv").exists()
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_repeated_shard_of_equal_bytes_is_told(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    for folder in ("1", "again"):
        run_shard(tmp_path / folder, 1, 2)
    run_shard(tmp_path / "2", 2, 2)
    folders = [tmp_path / name for name in ("1", "again", "2")]
    done = merged(*folders, out=tmp_path / "all")
    assert [trial[:2] for trial in done.repeated] == [
        (1, "manual"),
        (1, "weak-gentle"),
        (2, "strong-rapid"),
    ]
    assert contents(tmp_path / "all") == whole


def other_world(setup: TrialSetup) -> TrialRecord:
    """A machine that rounds differently."""
    made = made_up(setup)
    columns = {**made.columns, "yaw_rate": made.columns["yaw_rate"] + 1e-9}
    return made._replace(columns=columns)


@pytest.mark.parametrize("records", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_a_repeated_shard_of_other_bytes_is_refused(
    tmp_path: Path, records: bool
) -> None:
    def drifting(setup: TrialSetup) -> TrialRecord:
        made = other_world(setup)
        position = made.columns["lateral_position"] * (1.0 + 1e-12)
        return made._replace(columns={**made.columns, "lateral_position": position})

    run_study(tmp_path / "1", SMALL, jobs=1, report=None, simulate=made_up)
    scale = Scale(records=records)
    run_study(
        tmp_path / "2", SMALL, jobs=1, report=None, simulate=drifting, scale=scale
    )
    with pytest.raises(
        ValueError,
        match=r"participant 1 manual has different results in \S+1 and \S+2, as of dif",
    ):
        merged(tmp_path / "1", tmp_path / "2", out=tmp_path / "all")
    assert not (tmp_path / "all").exists()


def test_shards_of_another_study_are_refused(tmp_path: Path) -> None:
    run_shard(tmp_path / "1", 1, 2)
    other = SMALL._replace(seed=2)
    scale = Scale(shard=Shard(2, 2))
    run_study(tmp_path / "2", other, jobs=1, simulate=made_up, scale=scale)
    with pytest.raises(ValueError, match="another study: seed is 2 there, 1 here"):
        merged(tmp_path / "1", tmp_path / "2", out=tmp_path / "all")


def test_several_folders_need_a_place(tmp_path: Path) -> None:
    run_shard(tmp_path / "1", 1, 2)
    shutil.copytree(tmp_path / "1", tmp_path / "2")
    with pytest.raises(ValueError, match="2 folders need one to be put together in"):
        merged(tmp_path / "1", tmp_path / "2")
    with pytest.raises(ValueError, match="there is nothing to merge"):
        merged()


@pytest.mark.slow
def test_failed_trials_are_rows_and_make_way_for_done_ones(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    def failing(setup: TrialSetup) -> TrialRecord:
        if setup.condition == "manual":
            raise ValueError("no")
        return made_up(setup)

    run_study(tmp_path / "1", SMALL, jobs=1, report=None, simulate=failing)
    done = merged(tmp_path / "1")
    assert [each.condition for each in done.outcome.failed] == ["manual", "manual"]
    run_study(tmp_path / "2", SMALL, jobs=1, report=None, simulate=made_up)
    done = merged(tmp_path / "1", tmp_path / "2", out=tmp_path / "all")
    assert done.outcome.failed == ()
    assert contents(tmp_path / "all") == whole


@pytest.mark.slow
def test_a_shard_at_work_lets_others_work_but_nobody_merge(tmp_path: Path) -> None:
    run_shard(tmp_path, 2, 2)
    command = [sys.executable, "-c", HOLD, str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "held\n"
            with pytest.raises(ValueError, match=r"in use by shard 1/2 \(process \d+"):
                merged(tmp_path)
            with pytest.raises(ValueError, match="is in use by another costeer"):
                run_shard(tmp_path, 1, 2)
            with pytest.raises(ValueError, match="at work need the same number, and"):
                run_shard(tmp_path, 1, 3)
            run_shard(tmp_path, 2, 2)
        finally:
            process.kill()
    run_shard(tmp_path, 1, 2)
    merged(tmp_path)


def test_no_shard_begins_while_somebody_has_the_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_shard(tmp_path, 1, 2)
    monkeypatch.setattr("costeer.study.locks._START", 0.01)
    with locked(tmp_path), pytest.raises(ValueError, match="in use by another costeer"):
        run_shard(tmp_path, 2, 2)


def test_a_folder_of_other_things_takes_no_shard(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(ValueError, match="holds no study"):
        run_shard(tmp_path, 1, 2)
    assert list(contents(tmp_path)) == ["thesis.txt"]
    with pytest.raises(ValueError, match="is a file; give a new or empty folder"):
        run_shard(tmp_path / "thesis.txt", 1, 2)


def test_the_command_ends_with_the_report(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for number in (1, 2):
        run_shard(tmp_path / "a", number, 2)
    shutil.copytree(tmp_path / "a", tmp_path / "b")
    words = ["merge", str(tmp_path / "a"), str(tmp_path / "b"), "--no-report"]
    assert main([*words, "--out", str(tmp_path / "all")]) == 0
    told = capsys.readouterr()
    assert told.out == f"{tmp_path / 'all' / 'trials.csv'}\n"
    assert "6 trials are in more than one folder, with the same bytes: part" in told.err


def test_the_command_tells_of_failed_trials(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def failing(setup: TrialSetup) -> TrialRecord:
        if setup.participant == 2:
            raise ValueError("no road")
        return made_up(setup)

    run_study(tmp_path, SMALL, jobs=1, report=None, simulate=failing)
    assert main(["merge", str(tmp_path), "--no-report"]) == 1
    assert (
        "3 of 6 trials failed: participant 2, manual: no road, and 2 more; the same "
        "command tries them again"
    ) in capsys.readouterr().err
