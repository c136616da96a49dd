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
import pyarrow.csv
import pyarrow.ipc
import pyarrow.parquet as pq

from costeer.base.files import replacing
from costeer.records.arrow import (
    METADATA_KEY,
    described,
    from_table,
    plain_columns,
    to_table,
)
from costeer.records.checks import refuse_unknown, validated
from costeer.records.columns import (
    COLUMN_NAMES,
    COLUMNS,
    METHOD_PREFIX,
    MODES,
    Column,
    TrialRecord,
    with_method_columns,
)
from costeer.records.metadata import METADATA_FIELDS

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
        if name not in COLUMN_NAMES and not name.startswith(METHOD_PREFIX)
    )
    return _record_in(_opened(Path(path)), path, names)


def read_recording(path: str | os.PathLike[str]) -> TrialRecord:
    """Read a trial record or any table: CSV, gzipped CSV, Parquet or Arrow stream.

    Args:
        path: The file. A name that ends in `.csv` or `.csv.gz` is read as CSV, one in
            `.arrow` as the stream of a drive, which may have been cut off.

    Returns:
        A trial record; of a plain table its columns as they are, without metadata.

    Raises:
        ValueError: If the file cannot be understood.
        OSError: If it cannot be read.
    """
    if str(path).endswith((".csv", ".csv.gz")):
        return _plain_recording(_csv_table(Path(path)), path)
    if str(path).endswith(".arrow"):
        return read_stream(path)
    file = _opened(Path(path))
    if METADATA_KEY in (file.schema_arrow.metadata or {}):
        return _record_in(file, path, None)
    return _plain_recording(_rows(file, path, file.schema_arrow.names), path)


def read_stream(path: str | os.PathLike[str]) -> TrialRecord:
    """Read the Arrow stream that a drive writes while it goes on.

    A drive that was cut off leaves a stream without an end; all of its whole batches
    are read. What lies beside the batches comes into the metadata: `markers`,
    `started_at` and `ended_at`.

    Raises:
        ValueError: If there is not one whole batch of a trial in it.
        OSError: If it cannot be read.
    """
    stream = whole_batches(Path(path))
    table = pa.Table.from_batches(stream.batches)
    try:
        record = from_table(table, described(table.schema))
        beside = _told_beside(stream)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    return record._replace(metadata=record.metadata | beside)


class Stream(NamedTuple):
    """What can be read of an Arrow stream.

    Attributes:
        batches: All that are whole.
        beside: What lies beside each of them.
    """

    batches: list[pa.RecordBatch]
    beside: list[dict[bytes, bytes]]


def whole_batches(path: Path) -> Stream:
    """All whole batches of an Arrow stream.

    Raises:
        ValueError: If there is none.
        OSError: If it cannot be read.
    """
    content = path.read_bytes()
    stream = Stream([], [])
    try:
        reader = pa.ipc.open_stream(pa.BufferReader(content))
        while True:
            batch, beside = reader.read_next_batch_with_custom_metadata()
            stream.batches.append(batch)
            stream.beside.append(dict(beside or {}))
    except (StopIteration, pa.ArrowException, OSError):
        pass  # the end, or what a killed process left of a batch
    if not any(batch.num_rows for batch in stream.batches):
        raise ValueError(f"{path} holds no row of a drive; it had not begun")
    return stream


def _told_beside(stream: Stream) -> dict[str, object]:
    """Markers, and the clock as the last batch told it."""
    markers: list[object] = []
    clock: dict[str, object] = {}
    for beside in stream.beside:
        markers += json.loads(beside.get(MARKERS_KEY, b"[]"))
        clock |= json.loads(beside.get(CLOCK_KEY, b"{}"))
    return {"markers": markers, **clock}


def _plain_recording(table: pa.Table, path: str | os.PathLike[str]) -> TrialRecord:
    try:
        return TrialRecord(metadata={}, columns=plain_columns(table))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _opened(path: Path) -> pq.ParquetFile:
    source = path.read_bytes()
    try:
        return pq.ParquetFile(pa.BufferReader(source), page_checksum_verification=True)
    except (pa.ArrowException, OSError) as error:
        raise ValueError(
            f"{path} is not a Parquet file, or was cut short: {_first_line(error)}"
        ) from error


def _record_in(
    file: pq.ParquetFile, path: str | os.PathLike[str], names: Sequence[str] | None
) -> TrialRecord:
    there = file.schema_arrow.names
    try:
        about = described(file.schema_arrow)
        present = there if names is None else [name for name in there if name in names]
        return from_table(_rows(file, path, present), about, names)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _rows(
    file: pq.ParquetFile, path: str | os.PathLike[str], names: list[str]
) -> pa.Table:
    try:
        return file.read(columns=names)
    except (pa.ArrowException, OSError) as error:
        raise ValueError(f"{path} is damaged: {_first_line(error)}") from error


def _csv_table(path: Path) -> pa.Table:
    # Opened here first, so that a file that cannot be read stays an OSError.
    with path.open("rb"):
        pass
    try:
        return pyarrow.csv.read_csv(path)
    except (pa.ArrowException, OSError) as error:
        raise ValueError(
            f"{path} is no CSV table: {_first_line(error)}; give UTF-8 with commas "
            "between columns, decimal points, and names in the first row"
        ) from error


def _first_line(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]
