"""Whatever was driven is kept, also when the process is killed in the middle."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from costeer.export.markers import markers_of
from costeer.loop.scenario import TrialSetup
from costeer.records.columns import Column
from costeer.records.record import (
    read_record,
    read_recording,
    read_stream,
    write_record,
)
from costeer.records.row import ROW_COLUMNS
from costeer.runtime.frame import TRACE_COLUMNS
from costeer.runtime.markers import Marker
from costeer.runtime.recorder import drive_metadata
from costeer.runtime.setup import DriveSetup
from costeer.runtime.stream import (
    RecordStream,
    check_free,
    finish,
    next_free,
    record_paths,
)
from costeer.study.again import holds_human_trials
from tests.study.synthetic import synthetic_record

METADATA = drive_metadata(DriveSetup(trial=TrialSetup(condition="strong-normal")))


def rows(first: int, number: int) -> np.ndarray:  # type: ignore[type-arg]
    """Rows of a car that drives straight on at 20 m/s."""
    made = np.zeros((number, len(ROW_COLUMNS)))
    time_now = np.arange(first, first + number) / 60.0
    made[:, ROW_COLUMNS.index("time")] = time_now
    made[:, ROW_COLUMNS.index("longitudinal_position")] = 20.0 * time_now
    made[:, ROW_COLUMNS.index("mode")] = 1.0
    made[:, ROW_COLUMNS.index("haptic_gain")] = 1.0
    made[:, ROW_COLUMNS.index("driver_intention")] = np.nan
    return made


def test_streams_become_the_record_with_its_markers_and_the_trace(
    tmp_path: Path,
) -> None:
    paths = record_paths(tmp_path / "trial.parquet")
    stream = RecordStream(paths, METADATA)
    stream.write(rows(0, 15), np.full(15, True), [])
    gain = Marker("parameter", "preview_time", 1.5, 2.0, "s", 0.25)
    stream.write(rows(15, 15), np.arange(15) < 5, [gain])
    ended = Marker("ended", "course", time=0.5)
    stream.write(rows(30, 0), np.full(0, True), [ended])
    stream.add_trace(np.ones((32, len(TRACE_COLUMNS))))
    stream.close()
    assert finish(paths, stream.num_rows)
    record = read_record(paths.record)
    assert markers_of(record.metadata) == [gain, ended]
    assert record.metadata["condition"] == "strong-normal"
    np.testing.assert_array_equal(record.columns["time"], np.arange(30) / 60.0)
    # Ten rows were driven in manual: no guidance is claimed there.
    assert (record.columns["mode"][-10:] == "manual").all()
    assert np.isnan(record.columns["haptic_gain"][-10:]).all()
    assert (record.columns["haptic_gain"][:20] == 1.0).all()
    assert record.columns["driver_intention"].mask.all()
    assert pq.read_table(paths.trace).num_rows == 32
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "trial.parquet",
        "trial.wheel.parquet",
    ]


def test_record_of_a_drive_says_when_in_utc(tmp_path: Path) -> None:
    noon = datetime(2026, 1, 31, 12, 0, 0, 100_000, tzinfo=UTC)
    # Batches a quarter of a second after their first row, then one of a marker alone.
    clock = iter(noon + timedelta(seconds=after) for after in (0.0, 60.0, 65.0))
    paths = record_paths(tmp_path / "trial.parquet")
    stream = RecordStream(paths, METADATA, now=clock.__next__)
    stream.write(rows(0, 15), np.full(15, True), [])
    stream.write(rows(15, 15), np.full(15, True), [])
    stream.write(rows(30, 0), np.full(0, True), [Marker("ended", time=0.5)])
    stream.close()
    told = read_stream(paths.stream).metadata  # also of a drive that is cut off
    assert finish(paths, stream.num_rows)
    assert read_record(paths.record).metadata == {**told, "torque_faults": 0}
    assert told["started_at"] == "2026-01-31T11:59:59+00:00"
    assert told["ended_at"] == "2026-01-31T12:01:00+00:00"


def test_study_knows_what_a_person_drove(tmp_path: Path) -> None:
    assert METADATA["driver_kind"] == "person"
    paths = record_paths(tmp_path / "records" / "01-strong-normal.parquet")
    stream = RecordStream(paths, METADATA)
    stream.write(rows(0, 15), np.full(15, True), [])
    stream.close()
    assert finish(paths, stream.num_rows)
    assert holds_human_trials(tmp_path)
    write_record(paths.record, synthetic_record("strong-normal", length=900.0))
    assert not holds_human_trials(tmp_path)


def test_drive_whose_method_has_columns_of_its_own_keeps_them(tmp_path: Path) -> None:
    integral = Column("method_integral", "m·s", "float64", "of the error", stepped=True)
    made = np.column_stack([rows(0, 15), np.arange(15.0), np.full(15, 7.0)])
    paths = record_paths(tmp_path / "trial.parquet")
    stream = RecordStream(paths, METADATA, [integral])
    stream.write(made, np.full(15, True), [])
    stream.close()
    assert finish(paths, stream.num_rows)
    record = read_record(paths.record)
    assert record.method_columns == (integral,)
    np.testing.assert_array_equal(record.columns["method_integral"], np.arange(15.0))


def test_drive_that_never_began_leaves_nothing(tmp_path: Path) -> None:
    paths = record_paths(tmp_path / "trial.parquet")
    stream = RecordStream(paths, METADATA)
    marker = Marker("condition", before="strong-normal", after="manual")
    stream.write(rows(0, 0), np.full(0, True), [marker])
    stream.close()
    assert not finish(paths, stream.num_rows)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("cut", [1, 7, 100, 1000])
def test_stream_that_is_cut_anywhere_gives_all_whole_batches(
    tmp_path: Path, cut: int
) -> None:
    paths = record_paths(tmp_path / "trial.parquet")
    stream = RecordStream(paths, METADATA)
    for k in range(8):
        stream.write(rows(15 * k, 15), np.full(15, True), [])
    size = paths.stream.stat().st_size
    whole = paths.stream.read_bytes()
    stream.write(rows(120, 15), np.full(15, True), [])
    stream.close()
    paths.stream.write_bytes(whole + paths.stream.read_bytes()[size : size + cut])
    assert len(read_stream(paths.stream).columns["time"]) == 120
    assert len(read_recording(paths.stream).columns["time"]) == 120


KILLED = """
import sys, time
from pathlib import Path
import numpy as np
from tests.runtime.test_stream import METADATA, RecordStream, record_paths, rows
stream = RecordStream(record_paths(Path(sys.argv[1])), METADATA)
for k in range(1000):
    stream.write(rows(15 * k, 15), np.full(15, True), [])
    print(15 * (k + 1), flush=True)
    time.sleep(0.02)
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="there is no kill -9")
def test_killed_process_leaves_all_that_it_had_flushed(tmp_path: Path) -> None:
    path = tmp_path / "trial.parquet"
    command = [sys.executable, "-c", KILLED, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for _ in range(6):
            flushed = int(process.stdout.readline())
        time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
    assert len(read_stream(path.with_suffix(".arrow")).columns["time"]) >= flushed


def test_nothing_that_a_person_drove_is_written_over(tmp_path: Path) -> None:
    path = tmp_path / "trial.parquet"
    check_free(path)
    path.with_suffix(".arrow").touch()
    with pytest.raises(ValueError, match=r"cut off.*costeer export"):
        check_free(path)
    path.touch()
    with pytest.raises(ValueError, match="exists; choose another --record"):
        check_free(path)
    assert next_free(path) == tmp_path / "trial-2.parquet"
    # The wheel's trace alone, after its record was moved away, is kept as well.
    (tmp_path / "trial-2.wheel.parquet").touch()
    assert next_free(path) == tmp_path / "trial-3.parquet"
    with pytest.raises(ValueError, match=r"wheel\.parquet exists"):
        check_free(tmp_path / "trial-2.parquet")


def test_damaged_stream_is_kept_and_told(tmp_path: Path) -> None:
    paths = record_paths(tmp_path / "trial.parquet")
    stream = RecordStream(paths, METADATA)
    stream.write(rows(0, 15), np.full(15, True), [])
    stream.close()
    paths.stream.write_bytes(b"not a stream")
    with pytest.raises(ValueError, match="no row"):
        finish(paths, stream.num_rows)
    assert paths.stream.exists()


def test_record_must_be_named_parquet(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"ends in \.parquet"):
        record_paths(tmp_path / "trial.csv")
