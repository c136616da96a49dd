"""Shards of a comparison share a folder, or have one each: together they are it."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from costeer.cli import main
from costeer.comparison.design import ComparisonSettings
from costeer.comparison.folder import read_comparison
from costeer.comparison.merge import Merged, merge_comparison, settings_in
from costeer.comparison.run import (
    ComparisonOutcome,
    Placement,
    prepared,
    run_comparison,
)
from costeer.loop.scenario import TrialSetup
from costeer.records.columns import TrialRecord
from costeer.scale.shard import Shard
from costeer.scenarios.reading import scenario_named
from costeer.study.locks import locked_shard
from tests.comparison.fakes import NUM_TRIALS, SMALL, counted, made_up
from tests.methods.rivals import FILE, example
from tests.study.fakes import contents

pytestmark = pytest.mark.slow


def run_shard(
    out: Path, number: int, total: int, settings: ComparisonSettings = SMALL
) -> ComparisonOutcome:
    placement = Placement(shard=Shard(number, total))
    return run_comparison(out, settings, jobs=1, placement=placement, simulate=made_up)


def merged(*folders: Path, out: Path | None = None) -> Merged:
    return merge_comparison(folders, out, simulate=made_up)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """What the small comparison holds, with its report, if one process runs it."""
    folder = tmp_path_factory.mktemp("whole")
    run_comparison(folder, SMALL, jobs=1, simulate=made_up)
    return contents(folder)


@pytest.mark.parametrize("total", [2, 3])
def test_shards_of_one_folder_make_the_same_comparison(
    tmp_path: Path, whole: dict[str, bytes], total: int
) -> None:
    sizes = [run_shard(tmp_path, n, total).num_trials for n in range(total, 0, -1)]
    assert sum(sizes) == NUM_TRIALS
    assert not (tmp_path / "trials.csv").exists()
    assert not (tmp_path / "report.html").exists()
    done = merged(tmp_path)
    assert (done.outcome.num_trials, done.repeated) == (NUM_TRIALS, ())
    assert contents(tmp_path) == whole


def test_shards_with_a_folder_each_are_put_together(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    for name, number in (("1", 1), ("again", 1), ("2", 2)):
        run_shard(tmp_path / name, number, 2)
    done = merged(*(tmp_path / n for n in ("1", "again", "2")), out=tmp_path / "all")
    assert contents(tmp_path / "all") == whole
    # Blocks 1, 3, 5 and 7 of eight: manual first, on both roads.
    assert done.repeated == (
        "0001-manual-expressway-none drivers 1 to 10",
        "0003-manual-cut_in-none drivers 1 to 10",
        "0001-manual-expressway-none drivers 11 to 12",
        "0003-manual-cut_in-none drivers 11 to 12",
    )


def test_records_are_put_together_too(tmp_path: Path) -> None:
    settings = SMALL._replace(keep_records=True, participants=2)
    for number in (1, 2):
        run_shard(tmp_path / str(number), number, 2, settings)
    run_comparison(tmp_path / "whole", settings, jobs=1, report=None, simulate=made_up)
    folders = [tmp_path / "1", tmp_path / "2"]
    merge_comparison(folders, tmp_path / "all", None, simulate=made_up)
    found = contents(tmp_path / "all")
    assert found == contents(tmp_path / "whole")
    assert len([name for name in found if name.startswith("records")]) == 8


def test_a_shard_goes_on_where_it_was(tmp_path: Path) -> None:
    run_shard(tmp_path, 1, 2)
    asked, simulate = counted()
    placement = Placement(shard=Shard(1, 2))
    done = run_comparison(tmp_path, SMALL, placement=placement, simulate=simulate)
    assert (done.num_trials, done.num_resumed, asked) == (24, 24, [])


def test_missing_blocks_are_named_and_nothing_is_written(tmp_path: Path) -> None:
    run_shard(tmp_path / "1", 1, 4)
    with pytest.raises(
        ValueError,
        match=r"6 of 8 blocks of drivers are missing: 0002-ibhs-expressway-none "
        "drivers 1 to 10, .* and 3 more; run their shards again",
    ):
        merged(tmp_path / "1", out=tmp_path / "all")
    assert not (tmp_path / "all").exists()


def test_a_block_with_other_results_is_refused(tmp_path: Path) -> None:
    def rounding(setup: TrialSetup) -> TrialRecord:
        """A machine that rounds differently."""
        made = made_up(setup)
        torque = made.columns["driver_torque"] * (1.0 + 1e-12)
        return made._replace(columns={**made.columns, "driver_torque": torque})

    run_shard(tmp_path / "1", 1, 1)
    run_comparison(tmp_path / "2", SMALL, jobs=1, report=None, simulate=rounding)
    with pytest.raises(ValueError, match="drivers 1 to 10 has different results in"):
        merged(tmp_path / "1", tmp_path / "2", out=tmp_path / "all")


def test_the_shard_of_another_comparison_is_refused(tmp_path: Path) -> None:
    run_shard(tmp_path / "1", 1, 2)
    run_shard(tmp_path / "2", 2, 2, SMALL._replace(seed=2))
    with pytest.raises(ValueError, match="2 holds another comparison: seed is 2 there"):
        merged(tmp_path / "1", tmp_path / "2", out=tmp_path / "all")


def test_a_block_that_failed_gives_way_to_one_that_did_not(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    def failing(setup: TrialSetup) -> TrialRecord:
        if setup.participant == 3:
            raise RuntimeError("out of luck")
        return made_up(setup)

    run_comparison(tmp_path / "1", SMALL, jobs=1, report=None, simulate=failing)
    assert merged(tmp_path / "1").outcome.num_failed == 4
    run_shard(tmp_path / "2", 1, 1)
    done = merged(tmp_path / "1", tmp_path / "2", out=tmp_path / "all")
    assert done.outcome.num_failed == 0
    assert contents(tmp_path / "all") == whole


def test_nobody_merges_while_a_shard_is_at_work(tmp_path: Path) -> None:
    run_shard(tmp_path, 1, 2)
    shutil.copytree(tmp_path, tmp_path / "copy")
    with (
        locked_shard(tmp_path / "copy", Shard(1, 2)),
        pytest.raises(ValueError, match="in use by shard 1/2"),
    ):
        merged(tmp_path / "copy", out=tmp_path / "all")


@pytest.mark.parametrize("length", [None, 1800.0])
def test_the_settings_of_a_folder_are_those_it_was_made_with(
    tmp_path: Path, length: float | None
) -> None:
    own = scenario_named("cut-in")._replace(name="mine")
    settings = ComparisonSettings(
        methods=("manual", str(FILE)),
        scenarios=("expressway", own),
        mistakes=("latency=0.05",),
        participants=1,
        length=length,
    )
    run_comparison(tmp_path, settings, jobs=1, report=None, simulate=made_up)
    there = read_comparison(tmp_path)
    _, plan = prepared(settings, made_up)
    _, again = prepared(settings_in(there), made_up)
    assert [(c.name, c.length, c.speed) for c in again.courses] == [
        (c.name, c.length, c.speed) for c in plan.courses
    ]
    assert merged(tmp_path).outcome.num_failed == 0


def test_methods_that_no_file_can_hold_are_asked_for(tmp_path: Path) -> None:
    settings = SMALL._replace(methods=("manual", example()), participants=1)
    run_shard(tmp_path, 1, 1, settings)
    with pytest.raises(ValueError, match=r"compares pi-keeping, given as an object"):
        merged(tmp_path)
    merge_comparison([tmp_path], settings=settings, simulate=made_up)
    assert (tmp_path / "report.html").exists()


def test_the_command_merges_what_the_folder_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run_shard(tmp_path, 1, 2)
    assert main(["merge", str(tmp_path)]) == 2
    assert "4 of 8 blocks of drivers are missing" in capsys.readouterr().err
