"""The record of a drive while it goes on: Arrow streams that survive a kill.

Every quarter of a second a batch is written and flushed, so a process that is killed
loses no more than that; beside each batch stands its checksum. At the end the streams
become Parquet, the trial record of the studies and beside it the wheel at the plant's
rate.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.ipc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from costeer.base.files import replacing
from costeer.records.arrow import METADATA_KEY, batch_checksum, record_schema, to_table
from costeer.records.checks import validated
from costeer.records.columns import Column, TrialRecord, with_method_columns
from costeer.records.metadata import CLOCK_FIELDS, PERSON
from costeer.records.record import (
    CLOCK_KEY,
    MARKERS_KEY,
    read_stream,
    whole_batches,
    write_record,
)
from costeer.records.row import record_columns
from costeer.records.stream import CHECKSUM_KEY
from costeer.runtime.appended import AppendedFile
from costeer.runtime.frame import TRACE
from costeer.runtime.markers import Marker, as_json

TRACE_KEY = b"costeer.wheel"
"""In the schema of the wheel's trace: the description of the trial, as JSON."""


class RecordPaths(NamedTuple):
    """Where the record of a drive lies, during and after it.

    Attributes:
        record: The trial record, Parquet.
        stream: The same while the drive goes on.
        trace: The wheel at the plant's rate, Parquet.
        trace_stream: The same while the drive goes on.
    """

    record: Path
    stream: Path
    trace: Path
    trace_stream: Path


def record_paths(record: Path) -> RecordPaths:
    """All files of a record.

    Raises:
        ValueError: If the name does not end in `.parquet`.
    """
    if record.suffix != ".parquet":
        raise ValueError(
            f"--record is {str(record)!r}; give a name that ends in .parquet"
        )
    return RecordPaths(
        record=record,
        stream=record.with_suffix(".arrow"),
        trace=record.with_suffix(".wheel.parquet"),
        trace_stream=record.with_suffix(".wheel.arrow"),
    )


def next_free(record: Path) -> Path:
    """The path itself, or with a number, if a trial has already been recorded there."""
    number, candidate = 1, record
    while any(path.exists() for path in record_paths(candidate)):
        number += 1
        candidate = record.with_stem(f"{record.stem}-{number}")
    return candidate


def check_free(record: Path) -> None:
    """Refuse to write over what a person has driven.

    Raises:
        ValueError: If there is a record, or what is left of one.
    """
    paths = record_paths(record)
    for path in (paths.record, paths.trace):
        if path.exists():
            raise ValueError(f"{path} exists; choose another --record")
    if paths.stream.exists() or paths.trace_stream.exists():
        raise ValueError(
            f"{paths.stream} is what a drive left that was cut off; {rescue(paths)}, "
            "or choose another --record"
        )


def rescue(paths: RecordPaths) -> str:
    """The command that makes a record of what a drive left, in words."""
    return (
        f"make a record of it with: costeer export {paths.stream} --to parquet --out "
        "NAME.parquet"
    )


class RecordStream:
    """The two streams of one trial.

    Args:
        paths: Where they lie.
        metadata: Of the trial, as its record will have it.
        method_columns: What the method adds to the columns of every record.
        now: The wall clock; a test has its own.

    Raises:
        OSError: If they cannot be written.
    """

    def __init__(
        self,
        paths: RecordPaths,
        metadata: dict[str, object],
        method_columns: Sequence[Column] = (),
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
    ) -> None:
        self.paths = paths
        self._metadata = metadata
        self._added = tuple(method_columns)
        self._columns = with_method_columns(method_columns)
        self._now = now
        self._started: datetime | None = None
        self.num_rows = 0
        self.kept_until = self._given_until = 0.0
        paths.stream.parent.mkdir(parents=True, exist_ok=True)
        self._schema = record_schema(metadata, method_columns)
        self._trace_schema = trace_schema(self._schema.metadata[METADATA_KEY])
        self._file = AppendedFile(paths.stream)
        try:
            self._writer = pa.ipc.new_stream(self._file, self._schema)
            self._trace_file = AppendedFile(paths.trace_stream)
            self._trace = pa.ipc.new_stream(self._trace_file, self._trace_schema)
            self.flush()
        except OSError:
            for path in (paths.stream, paths.trace_stream):
                path.unlink(missing_ok=True)
            raise

    def write(
        self,
        rows: NDArray[np.float64],
        assisted: NDArray[np.bool_],
        markers: list[Marker],
    ) -> None:
        """Append a batch and flush it.

        Raises:
            OSError: If it cannot be written; it waits for the next `flush`.
        """
        self.add(rows, assisted, markers)
        self.flush()

    def add(
        self,
        rows: NDArray[np.float64],
        assisted: NDArray[np.bool_],
        markers: list[Marker],
    ) -> None:
        """Append a batch, which waits to be flushed.

        Args:
            rows: Of the loop, more columns may follow, shape `(time, column)`; may be
                none if there are markers.
            assisted: Whether the guidance had strength, shape `(time,)`.
            markers: What happened since the last batch.
        """
        batch = self._batch(rows[:, : len(self._columns)], assisted)
        told = json.dumps([as_json(marker) for marker in markers])
        beside = {CHECKSUM_KEY: checksum(batch)}
        if markers:
            beside[MARKERS_KEY] = told.encode()
        if len(rows):
            if self._metadata["driver_kind"] == PERSON:
                beside[CLOCK_KEY] = json.dumps(self._clock(batch)).encode()
            self._given_until = batch.column("time")[-1].as_py()
        self._writer.write_batch(batch, custom_metadata=beside)
        self.num_rows += len(rows)

    def flush(self) -> None:
        """Write what waits.

        Raises:
            OSError: If it cannot be written; it goes on waiting.
        """
        self._file.flush()
        self.kept_until = self._given_until
        self._trace_file.flush()

    @property
    def missing(self) -> str:
        """What could not be written, in words; "" if there is nothing."""
        if self._file.is_whole:
            return ""
        lacking = self._given_until - self.kept_until
        return f"it lacks {lacking:.1f} s at its end" if lacking else "it lacks markers"

    def _batch(
        self, rows: NDArray[np.float64], assisted: NDArray[np.bool_]
    ) -> pa.RecordBatch:
        """The rows as one batch of a record."""
        if len(rows) == 0:
            return pa.RecordBatch.from_pylist([], schema=self._schema)
        columns = record_columns(rows, assisted, self._columns)
        record = TrialRecord(self._metadata, columns, self._added)
        return to_table(validated(record)).combine_chunks().to_batches()[0]

    def _clock(self, batch: pa.RecordBatch) -> dict[str, str]:
        """When the trial began, and until when it was driven."""
        now = self._now()
        if self._started is None:  # the rows have waited since the trial began
            waited = batch.column("time")[-1].as_py()
            self._started = now - timedelta(seconds=waited)
        moments = zip(CLOCK_FIELDS, (self._started, now), strict=True)
        return {name: each.isoformat(timespec="seconds") for name, each in moments}

    def add_trace(self, rows: NDArray[np.float64]) -> None:
        """Append rows of the wheel, which wait to be flushed."""
        # Not `pa.array`, which imports pandas: seconds, in the middle of a drive.
        arrays = [
            pa.Array.from_buffers(pa.float64(), len(rows), [None, pa.py_buffer(column)])
            for column in np.ascontiguousarray(rows.T)
        ]
        batch = pa.record_batch(arrays, schema=self._trace_schema)
        beside = {CHECKSUM_KEY: checksum(batch)}
        self._trace.write_batch(batch, custom_metadata=beside)

    def close(self) -> None:
        """End the streams; the files stay as they are.

        Raises:
            OSError: If something still waits that cannot be written; it is lost.
        """
        try:
            self.flush()
            for writer in (self._writer, self._trace):
                writer.close()
            self.flush()
        finally:
            for file in (self._file, self._trace_file):
                file.close()


def checksum(batch: pa.RecordBatch) -> bytes:
    """Checksum of a batch as a reader of the stream will find it.

    Arrow leaves out the mask of a column without gaps as it writes.
    """
    found = pa.ipc.read_record_batch(batch.serialize(), batch.schema)
    return str(batch_checksum(found)).encode()


def trace_schema(trial: bytes) -> pa.Schema:
    """Schema of the wheel's trace, with units and the description of the trial."""
    return pa.schema(
        [
            pa.field(
                column.name,
                pa.float64(),
                nullable=False,
                metadata={"unit": column.unit, "description": column.description},
            )
            for column in TRACE
        ],
        metadata={TRACE_KEY: trial},
    )


def finish(paths: RecordPaths, num_rows: int) -> bool:
    """Make Parquet of the streams and remove them; the last thing of a drive.

    Args:
        paths: Of the record.
        num_rows: That were written to the stream.

    Returns:
        Whether there was a trial to keep; a drive that never began leaves nothing.

    Raises:
        ValueError: If the stream is damaged; it stays.
        OSError: If the record cannot be written; the streams stay.
    """
    if num_rows == 0:
        paths.stream.unlink()
        paths.trace_stream.unlink(missing_ok=True)
        return False
    record = read_stream(paths.stream)
    faults = int(np.count_nonzero(record.columns["torque_fault"]))
    about = {**record.metadata, "torque_faults": faults}
    write_record(paths.record, record._replace(metadata=about), durable=True)
    _finish_trace(paths)
    paths.stream.unlink()
    paths.trace_stream.unlink(missing_ok=True)
    return True


def _finish_trace(paths: RecordPaths) -> None:
    """The wheel's trace as Parquet, whole or not at all."""
    with suppress(ValueError, FileNotFoundError):  # there was no wheel to trace
        save_trace(paths.trace_stream, paths.trace)


def save_trace(stream_file: Path, out: Path) -> None:
    """Make Parquet of the stream of a wheel's trace, also of one that was cut off.

    Raises:
        ValueError: If there is no row in it.
        OSError: If it cannot be read or written.
    """
    stream = whole_batches(stream_file)
    with replacing(out, durable=True) as partial:
        table = pa.Table.from_batches(stream.batches)
        pq.write_table(table, partial, compression="zstd")
