"""Trial records on disk: Parquet with units, and a JSON description of the trial.

A file appears under its name only when it is complete, every page has a checksum, and
the same record gives the same bytes. Floats are kept bit for bit.
"""

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import pyarrow as pa
import pyarrow.ipc
import pyarrow.parquet as pq

from costeer.base.files import read_whole, replacing
from costeer.records.arrow import (
    METADATA_KEY,
    described,
    from_table,
    plain_columns,
    to_table,
)
from costeer.records.checks import refuse_unknown, validated
from costeer.records.columns import (
    ADDED_PREFIXES,
    COLUMN_NAMES,
    COLUMNS,
    MODES,
    Column,
    TrialRecord,
    with_method_columns,
)
from costeer.records.kinds import ARROW_FILE, PARQUET, STREAM, kind_of, unpacked
from costeer.records.metadata import METADATA_FIELDS
from costeer.records.stream import Stream, sound_batches
from costeer.records.tables import (
    AS_FOUND,
    Found,
    Reading,
    text_table,
    understood,
)
from costeer.records.times import seconds

__all__ = [
    "COLUMNS",
    "COLUMN_NAMES",
    "METADATA_FIELDS",
    "MODES",
    "Column",
    "TrialRecord",
    "read_record",
    "read_recording",
    "read_stream",
    "write_record",
]

MARKERS_KEY = b"markers"
"""Where a stream keeps the markers of a batch, as JSON."""

DAMAGE_KEY = "damage"
"""Where the description of a drive says what of its stream could not be read."""

CLOCK_KEY = b"clock"
"""Where a stream says when its trial began and until when it was driven, as JSON."""


def write_record(
    path: str | os.PathLike[str], record: TrialRecord, durable: bool = False
) -> None:
    """Write one trial as Parquet, whole or not at all.

    The columns are checked and put in the order of `COLUMNS`. NaN in the metadata
    becomes null, because JSON has no NaN.

    Args:
        path: File to write or replace.
        record: The trial.
        durable: Whether it is on the disk when this returns, as people's drives are.

    Raises:
        ValueError: If the record is not valid, see `checks.validated`.
        OSError: If the file cannot be written; then nothing is left of it.

    Example:
        >>> import costeer, tempfile
        >>> record = costeer.simulate("manual", length=200, intention="off")
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     costeer.write_record(folder + "/a.parquet", record)
        ...     again = costeer.load_record(folder + "/a.parquet")
        >>> len(again.columns["time"]) == len(record.columns["time"])
        True
    """
    declared = with_method_columns(record.method_columns)
    _replace_with_table(Path(path), to_table(validated(record)), declared, durable)


def _replace_with_table(
    path: Path, table: pa.Table, declared: Sequence[Column], durable: bool
) -> None:
    floats = [column.name for column in declared if column.kind == "float64"]
    repetitive = [c.name for c in declared if c.kind in ("int8", "string")]
    with replacing(path, durable) as partial:
        # Byte-stream split and zstd give two thirds of the plain size and read back
        # faster than plain pages; dictionaries and statistics of floats only cost.
        pq.write_table(
            table,
            partial,
            compression="zstd",
            compression_level=1,
            use_dictionary=repetitive,
            column_encoding=dict.fromkeys(floats, "BYTE_STREAM_SPLIT"),
            write_statistics=False,
            write_page_checksum=True,
        )


def read_record(
    path: str | os.PathLike[str], columns: Sequence[str] | None = None
) -> TrialRecord:
    """Read a trial record.

    Args:
        path: File that `write_record` made.
        columns: Names to read; all if None. `time` always comes along.

    Returns:
        The trial, with just those columns in the order of `COLUMNS`, then those that
        its method has added.

    Raises:
        ValueError: If the file is no Parquet, cut short or damaged, has no
            description of the trial, or columns are missing or of the wrong kind.
        OSError: If the file cannot be read.
    """
    names = None if columns is None else ("time", *columns)
    refuse_unknown(
        name
        for name in names or ()
        if name not in COLUMN_NAMES and not name.startswith(ADDED_PREFIXES)
    )
    return _record_in(_opened(read_whole(Path(path)), path), path, names)


def read_recording(path: str | os.PathLike[str]) -> TrialRecord:
    """Read a trial record or any table: CSV, Parquet or Arrow, gzipped or not.

    Args:
        path: The file, told by its content. The stream of a drive may have been cut
            off.

    Returns:
        A trial record; of a plain table its columns as they are, without metadata.

    Raises:
        ValueError: If the file cannot be understood.
        OSError: If it cannot be read.
    """
    return read_noted(path).record


class Noted(NamedTuple):
    """A recording and what was assumed of its file.

    Attributes:
        record: As `read_recording` gives it.
        notes: What a reader should know of how it was read.
    """

    record: TrialRecord
    notes: tuple[str, ...] = ()


def read_noted(path: str | os.PathLike[str], reading: Reading = AS_FOUND) -> Noted:
    """As `read_recording`, with what was assumed.

    Args:
        path: The file.
        reading: How to read a text.

    Raises:
        ValueError: If the file cannot be understood.
        OSError: If it cannot be read.
    """
    content = unpacked(Path(path))
    kind = kind_of(content, Path(path))
    if kind == STREAM:
        return _of_stream(content, path)
    if kind == PARQUET:
        file = _opened(content, path)
        if METADATA_KEY in (file.schema_arrow.metadata or {}):
            return Noted(_record_in(file, path, None))
        return _plain_recording(Found(_rows(file, path, file.schema_arrow.names)), path)
    if kind == ARROW_FILE:
        with understood(path):
            found = Found(pa.ipc.open_file(pa.BufferReader(content)).read_all())
    else:
        with understood(path, "is no CSV table"):
            found = text_table(content, reading)
    return _plain_recording(found, path)


def _of_stream(content: bytes, path: str | os.PathLike[str]) -> Noted:
    """A drive, or another table in an Arrow stream."""
    stream = _with_rows(sound_batches(content), path)
    damage = (stream.damage,) if stream.damage else ()
    table = pa.Table.from_batches(stream.batches)
    if METADATA_KEY not in (table.schema.metadata or {}):
        return _plain_recording(Found(table, damage), path)
    unchecked = () if stream.checked else (_UNCHECKED,)
    return Noted(_record_of(stream, path), (*damage, *unchecked))


_UNCHECKED = (
    "the stream has no checksums: numbers that damage has changed cannot be told"
)


def read_stream(path: str | os.PathLike[str]) -> TrialRecord:
    """Read the Arrow stream that a drive writes while it goes on.

    A drive that was cut off leaves a stream without an end; all of its whole batches
    are read; of a damaged one those before the damage, which the metadata name as
    `damage`. What lies beside the batches comes into the metadata: `markers`,
    `started_at` and `ended_at`.

    Raises:
        ValueError: If there is not one whole batch of a trial in it.
        OSError: If it cannot be read.
    """
    return _record_of(whole_batches(Path(path)), path)


def _record_of(stream: Stream, path: str | os.PathLike[str]) -> TrialRecord:
    table = pa.Table.from_batches(stream.batches)
    with understood(path):
        record = from_table(table, described(table.schema))
        beside = _told_beside(stream)
    if stream.damage:
        beside[DAMAGE_KEY] = stream.damage
    return record._replace(metadata=record.metadata | beside)


def whole_batches(path: Path) -> Stream:
    """All whole batches of an Arrow stream.

    Raises:
        ValueError: If there is none.
        OSError: If it cannot be read.
    """
    return _with_rows(sound_batches(read_whole(path)), path)


def _with_rows(stream: Stream, path: str | os.PathLike[str]) -> Stream:
    if not any(batch.num_rows for batch in stream.batches):
        why = f"it is damaged: {stream.damage}" if stream.damage else "it had not begun"
        raise ValueError(f"{path} holds no row of a drive; {why}")
    return stream


def _told_beside(stream: Stream) -> dict[str, object]:
    """Markers, and the clock as the last batch told it."""
    markers: list[object] = []
    clock: dict[str, object] = {}
    for beside in stream.beside:
        markers += json.loads(beside.get(MARKERS_KEY, b"[]"))
        clock |= json.loads(beside.get(CLOCK_KEY, b"{}"))
    return {"markers": markers, **clock}


def _plain_recording(found: Found, path: str | os.PathLike[str]) -> Noted:
    with understood(path):
        found.table.validate(full=True)
        columns = plain_columns(found.table)
    left = [name for name in found.table.column_names if name not in columns]
    notes = [f"columns of a kind that is not read: {', '.join(left)}"] if left else []
    if "time" in columns:
        columns["time"], told = seconds(columns["time"])
        notes += [told] if told else []
    record = TrialRecord(metadata={}, columns=columns)
    return Noted(record, (*found.notes, *notes))


def _opened(content: bytes, path: str | os.PathLike[str]) -> pq.ParquetFile:
    with understood(path, "is not a Parquet file, or was cut short"):
        return pq.ParquetFile(pa.BufferReader(content), page_checksum_verification=True)


def _record_in(
    file: pq.ParquetFile, path: str | os.PathLike[str], names: Sequence[str] | None
) -> TrialRecord:
    there = file.schema_arrow.names
    with understood(path):
        about = described(file.schema_arrow)
        present = there if names is None else [name for name in there if name in names]
        return from_table(_rows(file, path, present), about, names)


def _rows(
    file: pq.ParquetFile, path: str | os.PathLike[str], names: list[str]
) -> pa.Table:
    with understood(path):
        table = file.read(columns=names)
        table.validate(full=True)
        return table
