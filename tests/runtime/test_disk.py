"""A disk that is full, and a folder that is deleted, while a person drives."""

from __future__ import annotations

import errno
import shutil
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.ipc
import pyarrow.parquet as pq
import pytest

from costeer.cli import main
from costeer.export.markers import markers_of
from costeer.records.record import read_record, read_stream
from costeer.runtime import appended, keeper
from costeer.runtime.appended import AppendedFile
from costeer.runtime.frame import TRACE_COLUMNS
from costeer.runtime.keeper import Keeper
from costeer.runtime.markers import told
from costeer.runtime.states import Fault, RunState
from costeer.runtime.stream import CHECKSUM_KEY, RecordStream, record_paths
from tests.runtime.rig import Rig, of, wheel_setup
from tests.runtime.test_driving_wheel import HANDS
from tests.runtime.test_stream import METADATA, rows
from tests.waiting import wait_for


class Disk:
    """Takes half of each piece and refuses the rest while it is full."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.is_full = False
        whole = appended.append

        def append(file: object, place: int, piece: bytes) -> None:
            if not self.is_full:
                return whole(file, place, piece)  # type: ignore[arg-type]  # passed on
            whole(file, place, piece[: len(piece) // 2])  # type: ignore[arg-type]  # passed on
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(appended, "append", append)


@pytest.fixture
def disk(monkeypatch: pytest.MonkeyPatch) -> Disk:
    return Disk(monkeypatch)


class Kept:
    """A drive that is stepped, its keeper, and the way back from one to the other."""

    def __init__(self, record: Path) -> None:
        self.rig = Rig(wheel_setup(hands=HANDS._replace(amplitude=0.3)))
        self.told: list[str] = []
        self.keeper = Keeper(
            wheel_setup(),
            record,
            self.told.append,
            lambda why: self.rig.ask("unrecorded", bool(why)),
        )

    def ask(self, *command: object) -> None:
        """Ask the drive for something and pass on what it says of it."""
        self.rig.ask(*command)
        self.steps(1)

    def steps(self, number: int = 1) -> np.ndarray:  # type: ignore[type-arg]
        """Drive on; returns the frames."""
        frames = self.rig.steps(number)
        for marker, place in self.rig.told():
            self.keeper.mark(marker, self.rig.shared, place)
        return frames

    def until(self, fault: Fault) -> None:
        """Drive on until something is wrong, or is no more."""
        wait_for(lambda: of(self.steps(), "fault")[-1] == fault)


@pytest.fixture
def kept(tmp_path: Path) -> Iterator[Kept]:
    made = Kept(tmp_path / "out" / "t.parquet")
    yield made
    made.keeper.close()
    made.rig.close()


def test_half_a_piece_is_taken_back_and_tried_again(tmp_path: Path, disk: Disk) -> None:
    file = AppendedFile(tmp_path / "a")
    file.write(b"first")
    file.flush()
    disk.is_full = True
    file.write(b"second")
    with pytest.raises(OSError, match=r"No space left.*a'"):
        file.flush()
    assert (tmp_path / "a").read_bytes() == b"first"
    disk.is_full = False
    file.flush()
    assert file.is_whole
    file.close()
    assert (tmp_path / "a").read_bytes() == b"firstsecond"


def test_trial_waits_while_the_disk_is_full_and_loses_nothing(
    kept: Kept, disk: Disk
) -> None:
    kept.ask("start")
    kept.steps(60)
    disk.is_full = True
    kept.until(Fault.RECORD_STOPPED)
    assert of(kept.steps(), "run_state")[-1] == RunState.PAUSED
    kept.rig.ask("resume")  # nobody drives unrecorded
    assert of(kept.rig.steps(2), "run_state")[-1] == RunState.PAUSED
    assert Fault.RECORD_STOPPED.text in kept.rig.heard()[-1].note
    disk.is_full = False
    kept.until(Fault.RECORD_MENDED)
    kept.ask("acknowledge")
    kept.ask("resume")
    kept.steps(30)
    kept.keeper.close()
    assert kept.keeper.unkept == []
    record = read_record(kept.keeper.kept[0])
    np.testing.assert_allclose(np.diff(record.columns["time"]), 1 / 60)
    markers = markers_of(record.metadata)
    assert [marker[:2] for marker in markers][:2] == [
        ("started", ""),
        ("fault", "record_stopped"),
    ]
    assert markers[-1].kind == "resumed"


def test_disk_that_stays_full_leaves_a_stream_and_the_command_that_saves_it(
    kept: Kept, disk: Disk
) -> None:
    kept.ask("start")
    kept.steps(60)
    stream = record_paths(kept.keeper._record).stream  # type: ignore[arg-type]  # it has one
    recorder = kept.keeper._recorder
    assert recorder is not None
    wait_for(lambda: recorder.stream.kept_until > 0.95)
    disk.is_full = True
    kept.steps(30)
    kept.until(Fault.RECORD_STOPPED)
    kept.keeper.close()
    (left,) = kept.keeper.unkept
    assert "No space left" in left
    assert f"costeer export {stream} --to parquet" in left
    assert " s at its end" in left
    assert read_stream(stream).columns["time"][-1] == recorder.stream.kept_until


def test_record_that_cannot_begin_begins_as_soon_as_it_can(
    kept: Kept, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(keeper, "RecordStream", refuse)
    kept.ask("start")
    assert of(kept.steps(2), "fault")[-1] == Fault.RECORD_STOPPED
    kept.keeper.retry(kept.rig.shared)
    monkeypatch.undo()
    kept.keeper.retry(kept.rig.shared)
    assert of(kept.steps(2), "fault")[-1] == Fault.RECORD_MENDED
    kept.ask("acknowledge")
    kept.ask("resume")
    kept.steps(30)
    kept.keeper.close()
    record = read_record(kept.keeper.kept[0])
    assert record.columns["time"][0] == 0.0
    assert markers_of(record.metadata)[0].kind == "started"


def test_trial_that_never_could_be_recorded_is_told_at_the_end(
    kept: Kept, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(keeper, "RecordStream", refuse)
    kept.ask("start")
    kept.steps(5)
    kept.keeper.close()
    assert kept.keeper.unkept == ["nothing of a trial could be recorded"]


def test_folder_deleted_in_the_middle_comes_back_with_all_that_was_driven(
    kept: Kept,
) -> None:
    kept.ask("start")
    kept.steps(60)
    paths = record_paths(kept.keeper._record)  # type: ignore[arg-type]  # it has one
    wait_for(lambda: paths.stream.exists() and paths.stream.stat().st_size > 20_000)
    shutil.rmtree(paths.stream.parent)
    kept.steps(30)
    kept.keeper.close()
    assert len(read_record(kept.keeper.kept[0]).columns["time"]) == 91


def test_nothing_is_said_to_be_kept_in_a_file_that_is_gone(
    kept: Kept, monkeypatch: pytest.MonkeyPatch
) -> None:
    def gone(self: AppendedFile) -> None:
        shutil.rmtree(self.path.parent, ignore_errors=True)
        raise OSError(errno.EACCES, "Permission denied", str(self.path))

    kept.ask("start")
    kept.steps(60)
    monkeypatch.setattr(AppendedFile, "flush", gone)
    kept.keeper.close()
    (left,) = kept.keeper.unkept
    assert "is gone, and what was driven with it" in left
    assert "is in" not in left


def test_rows_that_were_overwritten_before_they_were_taken_are_marked(
    kept: Kept, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept.ask("start")
    kept.steps(30)
    recorder = kept.keeper._recorder
    assert recorder is not None
    wait_for(lambda: recorder._last_time > 0.4)
    with recorder._lock:  # a disk that takes its time
        recorder._next_frame += 30
    kept.steps(60)
    kept.keeper.close()
    markers = markers_of(read_record(kept.keeper.kept[0]).metadata)
    (gap,) = [marker for marker in markers if marker.kind == "gap"]
    assert gap.after == pytest.approx(31 / 60, abs=0.02)
    assert "could not be recorded" in told(gap)


def test_trace_goes_on_until_the_torque_is_zero(kept: Kept) -> None:
    kept.ask("start")
    kept.steps(90)
    kept.ask("pause", "driver")
    kept.steps(60)
    kept.ask("resume")
    kept.steps(30)
    kept.ask("restart")  # what the wheel does now is of no trial
    kept.ask("start")
    kept.steps(30)
    kept.keeper.close()
    assert kept.keeper.unkept == []
    first, then = sorted(kept.keeper.kept, key=lambda path: len(path.name))
    table = pq.read_table(record_paths(first).trace)
    time, torque = (table.column(name).to_numpy() for name in ("time", "wheel_torque"))
    stands = np.flatnonzero(np.diff(time) == 0.0)
    assert 0.2 * 960 < len(stands) < 0.4 * 960  # it fades out over 0.3 s
    assert torque[stands[-1] + 1] == 0.0
    assert (np.diff(time) >= 0.0).all()
    second = pq.read_table(record_paths(then).trace)
    assert second.column("time")[0].as_py() == 0.0


def test_marker_of_going_on_says_how_long_the_pause_was(kept: Kept) -> None:
    kept.ask("start")
    kept.steps(30)
    kept.ask("pause", "driver")
    kept.steps(59)
    kept.ask("resume")
    kept.keeper.close()
    marker = markers_of(read_record(kept.keeper.kept[0]).metadata)[-1]
    assert (marker.kind, marker.unit) == ("resumed", "s")
    assert marker.after == pytest.approx(1.0, abs=0.02)
    assert told(marker) == "resumed: after a pause of 1.0 s"


def checksums(path: Path) -> Iterator[tuple[bytes, int]]:
    """What stands beside each batch of a stream, and what its buffers give."""
    with pa.ipc.open_stream(path.read_bytes()) as reader:
        while True:
            try:
                batch, beside = reader.read_next_batch_with_custom_metadata()
            except StopIteration:
                return
            total = 0
            for column in batch.columns:
                for buffer in column.buffers():
                    total = total if buffer is None else zlib.crc32(buffer, total)
            yield beside[CHECKSUM_KEY], total


def test_each_batch_bears_the_checksum_of_what_a_reader_finds(tmp_path: Path) -> None:
    paths = record_paths(tmp_path / "t.parquet")
    stream = RecordStream(paths, METADATA)
    stream.write(rows(0, 15), np.arange(15) < 5, [])
    stream.write(rows(15, 7), np.full(7, True), [])
    stream.write(rows(22, 0), np.full(0, True), [])
    stream.add_trace(np.random.default_rng(1).normal(size=(33, len(TRACE_COLUMNS))))
    stream.close()
    found = [*checksums(paths.stream), *checksums(paths.trace_stream)]
    assert [int(told) for told, _ in found] == [total for _, total in found]
    assert len({total for _, total in found}) == 4


def test_trace_of_a_drive_that_was_cut_off_becomes_parquet(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paths = record_paths(tmp_path / "t.parquet")
    stream = RecordStream(paths, METADATA)
    stream.add_trace(np.ones((32, len(TRACE_COLUMNS))))
    stream.flush()
    stream._file.close()  # and no word of an end
    stream._trace_file.close()
    out = tmp_path / "saved.parquet"
    words = ["export", str(paths.trace_stream), "--to", "parquet", "--out", str(out)]
    assert main(words) == 0
    assert capsys.readouterr().out == f"{out}\n"
    table = pq.read_table(out)
    assert table.num_rows == 32
    assert b"strong-normal" in table.schema.metadata[b"costeer.wheel"]
