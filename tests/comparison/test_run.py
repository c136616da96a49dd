"""A comparison is run once, whatever stops it, and always to the same bytes."""

from __future__ import annotations

import csv
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from costeer.comparison.design import BLOCK, ComparisonSettings
from costeer.comparison.run import Placement, comparison_command, run_comparison
from costeer.comparison.worst import HASH_FIELD
from costeer.loop.scenario import TrialSetup
from costeer.records.columns import TrialRecord
from costeer.records.record import read_record
from costeer.study.run import StudyInterrupted
from tests.comparison.fakes import (
    NUM_BLOCKS,
    NUM_TRIALS,
    SMALL,
    after,
    counted,
    made_up,
)
from tests.study.fakes import contents


def run_small(
    out: Path,
    settings: ComparisonSettings = SMALL,
    jobs: int = 1,
    simulate: Callable[[TrialSetup], TrialRecord] = made_up,
) -> int:
    """Run the small comparison; return how many of its trials were there before."""
    done = run_comparison(out, settings, jobs=jobs, report=None, simulate=simulate)
    return done.num_resumed


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "trials.csv").open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The small comparison when nothing disturbs it; read only."""
    folder = tmp_path_factory.mktemp("whole")
    run_small(folder)
    return folder


@pytest.fixture(scope="module")
def whole(finished: Path) -> dict[str, bytes]:
    """What the small comparison holds when nothing disturbs it."""
    return contents(finished)


@pytest.fixture
def again(finished: Path, tmp_path: Path) -> Path:
    """A copy of the finished comparison, to be changed and run again."""
    return Path(shutil.copytree(finished, tmp_path / "again"))


def test_there_is_a_row_for_each_method_road_and_driver(finished: Path) -> None:
    found = [
        (r["method"], r["scenario"], r["mistake"], r["participant"])
        for r in rows(finished)
    ]
    assert found == [
        (method, scenario, "none", str(participant))
        for scenario in ("expressway", "cut-in")
        for method in ("manual", "ibhs")
        for participant in range(1, 13)
    ]


def test_methods_meet_the_same_driver_seed_noise_and_road(tmp_path: Path) -> None:
    asked, simulate = counted()
    run_small(tmp_path, simulate=simulate)
    pairs: dict[tuple[object, ...], set[object]] = {}
    for setup in asked[:NUM_TRIALS]:
        # All that a trial is but its method.
        same = setup._replace(method="")
        pairs.setdefault(tuple(same), set()).add(setup.method)
    assert len(pairs) == NUM_TRIALS // 2
    assert all(each == {"manual", "ibhs"} for each in pairs.values())


@pytest.mark.slow
def test_jobs_do_not_change_a_byte(tmp_path: Path, whole: dict[str, bytes]) -> None:
    run_small(tmp_path, jobs=3)
    assert contents(tmp_path) == whole


def test_a_finished_comparison_runs_no_trial_again(
    again: Path, whole: dict[str, bytes]
) -> None:
    asked, simulate = counted()
    assert run_small(again, simulate=simulate) == NUM_TRIALS
    assert asked == []
    assert contents(again) == whole


@pytest.mark.slow
def test_an_interruption_keeps_whole_blocks_and_no_part_of_one(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    # In the middle of the second block.
    stop = after(BLOCK + 4, KeyboardInterrupt())
    with pytest.raises(StudyInterrupted, match=f"of {NUM_BLOCKS} blocks are done and"):
        run_small(tmp_path, simulate=stop)
    assert len(list((tmp_path / "results").iterdir())) == 1
    assert run_small(tmp_path) == BLOCK
    assert contents(tmp_path) == whole


def cut_short(file: Path) -> None:
    file.write_bytes(file.read_bytes()[:-20])


def sealed(results: dict[str, object]) -> str:
    """Results as they are written, with the digest that they then have."""
    text = json.dumps(results, separators=(",", ":"))
    digest = hashlib.sha256(text.encode()).hexdigest()
    return json.dumps({"sha256": digest, "results": results})


def results_in(file: Path) -> dict[str, Any]:
    return dict(json.loads(file.read_text())["results"])


def of_another_comparison(file: Path) -> None:
    file.write_text(sealed({**results_in(file), "comparison": "0"}))


def with_another_number(file: Path) -> None:
    told = json.loads(file.read_text())
    told["results"]["trials"][0]["torque_faults"] += 1
    file.write_text(json.dumps(told))


def nested_too_deeply(file: Path) -> None:
    file.write_text("[" * 200_000)


def of_another_cell(file: Path) -> None:
    others = [each for each in file.parent.glob("*-00001.json") if each != file]
    file.write_bytes(others[0].read_bytes())


def with_a_driver_less(file: Path) -> None:
    results = results_in(file)
    file.write_text(sealed({**results, "trials": results["trials"][:-1]}))


@pytest.mark.parametrize(
    "damage",
    [
        cut_short,
        of_another_comparison,
        of_another_cell,
        with_a_driver_less,
        with_another_number,
        nested_too_deeply,
    ],
)
def test_results_that_are_not_the_block_s_are_not_believed(
    again: Path, whole: dict[str, bytes], damage: Callable[[Path], None]
) -> None:
    damage(min((again / "results").iterdir()))
    asked, simulate = counted()
    assert run_small(again, simulate=simulate) == NUM_TRIALS - BLOCK
    assert len(asked) == BLOCK
    assert contents(again) == whole


KILLED = """
import os, signal, sys
from tests.comparison.fakes import SMALL, counted
from costeer.comparison.run import run_comparison
asked, simulate = counted()
def killed(setup):
    if len(asked) == int(sys.argv[2]):
        os.kill(os.getpid(), signal.SIGKILL)
    return simulate(setup)
run_comparison(sys.argv[1], SMALL, jobs=1, report=None, simulate=killed)
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="needs SIGKILL")
def test_a_killed_comparison_goes_on_where_it_was(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    words = [sys.executable, "-c", KILLED, str(tmp_path), str(BLOCK + 7)]
    done = subprocess.run(words, check=False, cwd=Path(__file__).parents[2])
    assert done.returncode == -signal.SIGKILL
    assert run_small(tmp_path) == BLOCK
    assert contents(tmp_path) == whole


def test_a_trial_that_breaks_is_a_row_with_its_reason(tmp_path: Path) -> None:
    def breaking(setup: TrialSetup) -> TrialRecord:
        if (setup.method, setup.participant) == ("ibhs", 5):
            raise ZeroDivisionError("by\nzero")
        return made_up(setup)

    done = run_comparison(tmp_path, SMALL, jobs=1, report=None, simulate=breaking)
    assert done.num_failed == 2
    broken = [row for row in rows(tmp_path) if row["failure"]]
    assert [row["scenario"] for row in broken] == ["expressway", "cut-in"]
    assert {row["failure"] for row in broken} == {"ZeroDivisionError: by zero"}
    assert {row["sdlp"] for row in broken} == {""}


def test_a_full_disk_stops_and_is_no_result(tmp_path: Path) -> None:
    full = after(3, OSError(28, "No space left on device"))
    with pytest.raises(
        OSError, match=r"No space left .*0 of 8 blocks are done and kept"
    ):
        run_small(tmp_path, simulate=full)
    assert list((tmp_path / "results").iterdir()) == []


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"participants": 3}, "participants is 12 there, 3 here"),
        ({"length": 2000.0}, r"expressway, cut-in \(of the scenarios\) had other"),
        ({"methods": ("ibhs",)}, "methods are manual, ibhs there, ibhs here"),
        ({"intention": "off"}, "intention is scripted there, off here"),
    ],
)
def test_the_folder_of_another_comparison_is_refused(
    again: Path, changed: dict[str, object], told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        run_small(again, SMALL._replace(**changed))


def test_an_edited_compare_yaml_is_refused(again: Path) -> None:
    file = again / "compare.yaml"
    file.write_text(file.read_text().replace("seed: 1", "seed: 2"))
    with pytest.raises(ValueError, match="was edited: its hash does not fit"):
        run_small(again, SMALL._replace(seed=2))


def test_the_worst_drive_is_kept_as_a_record(finished: Path) -> None:
    # Of the made-up drives manual ones of a cut-in hit; driver 3 is the first of them.
    with (finished / "worst.csv").open(encoding="utf-8", newline="") as stream:
        first = next(csv.DictReader(stream))
    assert (first["method"], first["scenario"], first["participant"]) == (
        "manual",
        "cut-in",
        "3",
    )
    assert first["what"] == "car"
    record = read_record(finished / "worst" / first["record"])
    assert record.metadata["participant"] == 3
    assert HASH_FIELD in record.metadata
    assert float(first["time"]) == record.columns["time"][-30]


@pytest.mark.slow
def test_records_are_kept_if_asked_for(tmp_path: Path) -> None:
    run_small(tmp_path, SMALL._replace(keep_records=True))
    assert len(list((tmp_path / "records").rglob("*.parquet"))) == NUM_TRIALS


def test_the_command_is_the_comparison() -> None:
    assert comparison_command(ComparisonSettings()) == "costeer compare --out FOLDER"
    assert comparison_command(SMALL._replace(keep_records=True)) == (
        "costeer compare --out FOLDER --methods manual,ibhs --scenarios "
        "expressway,cut-in --participants 12 --length 1800.0 --keep-records"
    )


@pytest.mark.slow
def test_workers_elsewhere_write_the_same_bytes(tmp_path: Path) -> None:
    short = SMALL._replace(participants=3, length=400.0, mistakes=("none", "latency"))
    run_comparison(tmp_path / "threads", short, jobs=2, report=None)
    run_comparison(
        tmp_path / "workers", short, placement=Placement("local:2"), report=None
    )
    assert contents(tmp_path / "workers") == contents(tmp_path / "threads")


@pytest.mark.slow
def test_a_trial_that_failed_is_tried_again(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    def failing(setup: TrialSetup) -> TrialRecord:
        if setup.participant == 3 and setup.length == SMALL.length:
            raise RuntimeError("out of luck")
        return made_up(setup)

    first = run_comparison(tmp_path, SMALL, jobs=1, report=None, simulate=failing)
    assert first.num_failed == 4
    again = run_comparison(tmp_path, SMALL, jobs=1, report=None, simulate=made_up)
    assert (again.num_failed, again.num_resumed) == (0, NUM_TRIALS - 4 * BLOCK)
    found = contents(tmp_path)
    assert {n: c for n, c in found.items() if n.startswith("results")} == {
        n: c for n, c in whole.items() if n.startswith("results")
    }
