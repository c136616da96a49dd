"""Each trial has a record of its own, which says what held when it started."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from costeer.records.columns import TrialRecord
from costeer.records.record import read_record
from costeer.runtime import keeper as rooms
from costeer.runtime.keeper import Keeper
from costeer.runtime.setup import DriveSetup
from costeer.runtime.stream import record_paths
from tests.runtime.rig import Rig, drive_setup, wheel_setup
from tests.waiting import wait_for


class Kept:
    """A drive that is stepped, and the keeper of its records."""

    def __init__(self, setup: DriveSetup, record: Path) -> None:
        self.rig = Rig(setup)
        self.told: list[str] = []
        self.keeper = Keeper(setup, record, self.told.append, self.told.append)

    def ask(self, *command: object) -> None:
        """Ask the drive for something and pass on what it says of it."""
        self.rig.ask(*command)
        self.steps(1)

    def steps(self, number: int) -> None:
        """Drive on."""
        self.rig.steps(number)
        for marker, rows in self.rig.told():
            self.keeper.mark(marker, self.rig.shared, rows)

    def records(self) -> list[TrialRecord]:
        """Everything that was kept, whole."""
        self.keeper.close()
        return [read_record(path) for path in self.keeper.kept]


@pytest.fixture
def drive(tmp_path: Path) -> Iterator[Callable[[DriveSetup], Kept]]:
    made: list[Kept] = []

    def make(setup: DriveSetup) -> Kept:
        made.append(Kept(setup, tmp_path / "out" / "t.parquet"))
        return made[-1]

    yield make
    for each in made:
        each.keeper.close()
        each.rig.close()


def kinds(record: TrialRecord) -> list[str]:
    """Kinds of the markers of a record."""
    markers: Any = record.metadata["markers"]
    return [marker["kind"] for marker in markers]


def controller(record: TrialRecord) -> Any:
    """What the record says of the controller."""
    configuration: Any = record.metadata["configuration"]
    return configuration["controller"]


def test_what_was_chosen_before_the_start_describes_the_record(
    drive: Callable[[DriveSetup], Kept],
) -> None:
    kept = drive(drive_setup("strong-normal"))
    kept.ask("set", "condition", "weak-gentle")
    kept.ask("set", "lateral_error_gain", 2.0)
    kept.ask("start")
    kept.steps(40)
    kept.ask("set", "preview_time", 2.0)
    kept.steps(10)
    (record,) = kept.records()
    assert record.metadata["condition"] == "weak-gentle"
    assert record.metadata["strength_factor"] == 0.4
    assert record.metadata["change_duration"] == 8.0
    assert controller(record)["guidance"]["lateral_error_gain"] == 2.0
    assert controller(record)["preview"]["preview_time"] == 1.5  # changed later
    assert kinds(record) == ["started", "parameter"]
    times = record.columns["time"]
    assert times[0] == 0.0
    np.testing.assert_allclose(np.diff(times), 1 / 60)
    assert len(times) == 52


def test_restart_begins_a_record_with_its_first_row_and_what_was_tuned(
    drive: Callable[[DriveSetup], Kept],
) -> None:
    kept = drive(drive_setup())
    kept.ask("start")
    kept.steps(60)
    kept.ask("set", "lateral_error_gain", 2.0)
    kept.ask("restart")
    kept.ask("start")
    kept.steps(30)
    first, second = sorted(kept.records(), key=lambda r: -len(r.columns["time"]))
    assert kinds(first) == ["started", "parameter"]
    assert kinds(second) == ["started"]
    assert second.columns["time"][0] == 0.0
    assert len(second.columns["time"]) == 31
    assert controller(first)["guidance"]["lateral_error_gain"] == 1.5
    assert controller(second)["guidance"]["lateral_error_gain"] == 2.0


@pytest.mark.parametrize("taken", [False, True])
def test_server_that_hears_late_of_a_restart_mixes_no_two_trials(
    drive: Callable[[DriveSetup], Kept], taken: bool
) -> None:
    kept = drive(wheel_setup())
    kept.ask("start")
    recorder = kept.keeper._recorder
    assert recorder is not None
    kept.rig.steps(60)
    kept.rig.ask("restart")
    kept.rig.ask("start")
    kept.rig.steps(90)  # and nobody has passed on what it said
    if taken:  # the recorder has seen rows of both
        wait_for(lambda: recorder._next_frame == kept.rig.shared.frames.written)
    kept.steps(1)
    first, second = sorted(kept.records(), key=lambda r: len(r.columns["time"]))
    np.testing.assert_allclose(first.columns["time"], np.arange(61) / 60)
    np.testing.assert_allclose(second.columns["time"], np.arange(91) / 60)
    assert (kinds(first), kinds(second)) == (["started"], ["started"])
    traces = [read_trace(path) for path in sorted(kept.keeper.kept)]
    assert sorted(len(np.unique(time)) for time in traces) == [61 * 16, 91 * 16]
    assert all((np.diff(time) >= 0.0).all() for time in traces)


def read_trace(record: Path) -> np.ndarray:  # type: ignore[type-arg]
    """Times of the trace beside a record."""
    time: np.ndarray = pq.read_table(record_paths(record).trace)["time"].to_numpy()  # type: ignore[type-arg]
    return time


def test_record_says_what_was_changed_from_what_to_what_in_which_unit_and_when(
    drive: Callable[[DriveSetup], Kept],
) -> None:
    kept = drive(drive_setup("strong-normal"))
    kept.ask("start")
    kept.steps(59)
    kept.ask("set", "condition", "weak-normal")
    kept.steps(59)
    kept.ask("set", "lateral_error_gain", 2.25)
    kept.steps(59)
    kept.ask("set", "method", "manual")
    kept.ask("pause", "driver")
    (record,) = kept.records()
    markers: Any = record.metadata["markers"]
    times = [marker.pop("time") for marker in markers]
    strength = {"kind": "parameter", "name": "strength_factor", "unit": "-"}
    assert markers == [
        {"kind": "started"},
        {"kind": "condition", "before": "strong-normal", "after": "weak-normal"},
        {**strength, "before": 1.0, "after": 0.4},
        {
            "kind": "parameter",
            "name": "lateral_error_gain",
            "before": 1.5,
            "after": 2.25,
            "unit": "N·m/m",
        },
        {"kind": "method", "before": "ibhs", "after": "manual"},
        {**strength, "before": 0.4, "after": 0.0},
        {"kind": "paused", "name": "driver"},
    ]
    # A command is heard before the next row is computed: one row after its second.
    np.testing.assert_allclose(times, np.repeat([0, 1, 2, 3], [1, 2, 1, 3]), atol=0.02)


def test_manual_start_says_manual_and_a_condition_after_it_is_a_marker(
    drive: Callable[[DriveSetup], Kept],
) -> None:
    kept = drive(drive_setup("manual"))
    kept.ask("start")
    kept.ask("set", "condition", "strong-rapid")
    kept.steps(20)
    (record,) = kept.records()
    assert record.metadata["condition"] == "manual"
    assert np.isnan(record.metadata["change_duration"] or np.nan)
    assert kinds(record) == ["started", "condition", "parameter", "parameter"]
    assert record.columns["mode"][0] == "manual"
    assert record.columns["mode"][-1] == "lane_keeping"


def test_record_holds_the_row_in_which_the_course_ends_and_nothing_after_it(
    drive: Callable[[DriveSetup], Kept],
) -> None:
    kept = drive(drive_setup(length=100.0))
    kept.ask("start")
    kept.steps(400)
    (record,) = kept.records()
    position = record.columns["longitudinal_position"]
    assert position[-2] < 100.0 <= position[-1]
    np.testing.assert_allclose(np.diff(record.columns["time"]), 1 / 60)
    assert kinds(record) == ["started", "ended"]


def test_drive_that_never_starts_leaves_no_file(
    drive: Callable[[DriveSetup], Kept], tmp_path: Path
) -> None:
    kept = drive(drive_setup())
    kept.ask("set", "condition", "manual")
    kept.steps(10)
    assert kept.records() == []
    assert list((tmp_path / "out").iterdir()) == []


def test_record_that_cannot_be_begun_is_told_once(
    drive: Callable[[DriveSetup], Kept], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    kept = drive(drive_setup())
    monkeypatch.setattr(rooms, "RecordStream", full)
    kept.ask("start")
    kept.steps(5)
    assert len(kept.told) == 1
    assert "No space left" in kept.told[0]


def test_record_that_cannot_be_finished_is_told_with_where_the_rest_is(
    drive: Callable[[DriveSetup], Kept], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    kept = drive(drive_setup())
    kept.ask("start")
    kept.steps(5)
    monkeypatch.setattr(rooms, "finish", full)
    assert kept.records() == []
    assert "what was driven is in" in kept.told[0]
    assert "t.arrow" in kept.told[0]


def test_folder_that_cannot_be_written_to_is_refused_at_once(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("a file")
    with pytest.raises(OSError, match="out"):
        Keeper(drive_setup(), tmp_path / "out" / "t.parquet", print)
