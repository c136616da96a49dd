"""Trials that fail or keep no record: what is left of them, and the same tables."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import pytest

from costeer.loop.scenario import TrialSetup
from costeer.records.record import TrialRecord
from costeer.study.report import write_report
from costeer.study.run import Scale, remake_tables, run_study
from tests.study.fakes import (
    NUM_TRIALS,
    SMALL,
    contents,
    made_up,
    plain_report,
    run_small,
)

MEASURES_ALONE = Scale(records=False)


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


def tables(held: dict[str, bytes]) -> dict[str, bytes]:
    """The tables of a study."""
    return {name: held[name] for name in held if name.endswith(".csv")}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """What the small study holds when nothing disturbs it."""
    folder = tmp_path_factory.mktemp("whole") / "study"
    run_small(folder)
    return contents(folder)


@pytest.mark.parametrize("records", [True, False])
def test_a_failed_trial_is_a_row_and_the_others_go_on(
    tmp_path: Path, whole: dict[str, bytes], records: bool
) -> None:
    def wrong(setup: TrialSetup) -> TrialRecord:
        if (setup.participant, setup.condition) == (1, "weak-gentle"):
            raise ValueError("the car left\nthe road")
        return made_up(setup)

    scale = Scale(records=records)
    outcome = run_study(
        tmp_path, SMALL, jobs=1, report=plain_report, simulate=wrong, scale=scale
    )
    [failed] = outcome.failed
    assert failed == (1, "weak-gentle", 3, "the car left the road")
    assert rows(tmp_path / "failures.csv") == [
        {
            "participant": "1",
            "condition": "weak-gentle",
            "order": "3",
            "reason": "the car left the road",
        }
    ]
    assert len(rows(tmp_path / "trials.csv")) == NUM_TRIALS - 1
    asked, simulate = counted()
    run_study(tmp_path, SMALL, report=plain_report, simulate=simulate, scale=scale)
    assert asked == [(1, "weak-gentle")]
    now = contents(tmp_path)
    assert {name: now.get(name) for name in tables(whole)} == tables(whole)
    assert "failures.csv" not in now
    if records:
        assert now == whole


def test_a_study_in_which_every_trial_fails_says_why(tmp_path: Path) -> None:
    def wrong(_: TrialSetup) -> TrialRecord:
        raise ZeroDivisionError("by what")

    with pytest.raises(
        ValueError, match="all 6 trials failed, the first with: ZeroDivisionError: by"
    ):
        run_study(tmp_path, SMALL, jobs=1, simulate=wrong)


def test_other_code_than_the_study_s_stops_it(tmp_path: Path) -> None:
    def edited(setup: TrialSetup) -> TrialRecord:
        made = made_up(setup)
        other = {**made.metadata, "method_source_hash": "another"}
        return made._replace(metadata=other)

    with pytest.raises(ValueError, match="has another method than this study was"):
        run_study(tmp_path, SMALL, jobs=1, simulate=edited)


def test_measures_alone_give_the_same_tables(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    run_study(
        tmp_path, SMALL, report=plain_report, simulate=made_up, scale=MEASURES_ALONE
    )
    held = contents(tmp_path)
    assert not [name for name in held if name.endswith(".parquet")]
    assert tables(held) == tables(whole)
    asked, simulate = counted()
    run_study(
        tmp_path, SMALL, report=plain_report, simulate=simulate, scale=MEASURES_ALONE
    )
    assert (asked, contents(tmp_path)) == ([], held)
    (tmp_path / "trials.csv").unlink()
    assert remake_tables(tmp_path) == NUM_TRIALS
    assert contents(tmp_path) == held


def test_a_damaged_result_is_not_believed(tmp_path: Path) -> None:
    run_study(tmp_path, SMALL, report=None, simulate=made_up, scale=MEASURES_ALONE)
    held = contents(tmp_path)
    file = tmp_path / "results" / "02-manual.json"
    file.write_bytes(file.read_bytes()[:-3])
    asked, simulate = counted()
    run_study(tmp_path, SMALL, report=None, simulate=simulate, scale=MEASURES_ALONE)
    assert asked == [(2, "manual")]
    assert contents(tmp_path) == held


def test_records_that_are_wanted_later_take_the_place_of_results(
    tmp_path: Path, whole: dict[str, bytes]
) -> None:
    run_study(tmp_path, SMALL, report=None, simulate=made_up, scale=MEASURES_ALONE)
    run_small(tmp_path)
    assert contents(tmp_path) == whole


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn")
def test_a_report_without_records_says_which_figures_need_them(tmp_path: Path) -> None:
    run_study(tmp_path, SMALL, report=None, simulate=made_up, scale=MEASURES_ALONE)
    page = write_report(tmp_path).read_text("utf-8")
    drawn = {file.stem for file in (tmp_path / "figures").glob("*.svg")}
    assert "sdlp" in drawn
    assert not drawn & {"trajectories", "signals-strong", "gain-adjustment"}
    assert "this study was run with --no-records" in page
    assert "No verdict was inconsistent" not in page
