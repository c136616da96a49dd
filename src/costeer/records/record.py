"""Trial records on disk: Parquet with units, and a JSON description of the trial.

A file appears under its name only when it is complete, every page has a checksum, and
the same record gives the same bytes. Floats are kept bit for bit.
"""

import json
import os
from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.csv
import pyarrow.ipc
import pyarrow.parquet as pq

from costeer.records.arrow import METADATA_KEY, from_table, plain_columns, to_table
from costeer.records.columns import (
    COLUMN_NAMES,
    COLUMNS,
    METADATA_FIELDS,
    MODES,
    Column,
    TrialRecord,
    validated,
)

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

_FLOATS = [column.name for column in COLUMNS if column.kind == "float64"]
_REPETITIVE = [c.name for c in COLUMNS if c.kind in ("int8", "string")]


def write_record(path: str | os.PathLike[str], record: TrialRecord) -> None:
    """Write one trial as Parquet, whole or not at all.

    The columns are checked and put in the order of `COLUMNS`. NaN in the metadata
    becomes null, because JSON has no NaN.

    Args:
        path: File to write or replace.
        record: The trial.

    Raises:
        ValueError: If the record is not valid, see `columns.validated`.
        OSError: If the file cannot be written; then nothing is left of it.
    """
    _replace_with_table(Path(path), to_table(validated(record)))


def _replace_with_table(path: Path, table: pa.Table) -> None:
    partial = path.with_name(path.name + ".tmp")
    try:
        # Byte-stream split and zstd give two thirds of the plain size and read back
        # faster than plain pages; dictionaries and statistics of floats only cost.
        pq.write_table(
            table,
            partial,
            compression="zstd",
            compression_level=1,
            use_dictionary=_REPETITIVE,
            column_encoding=dict.fromkeys(_FLOATS, "BYTE_STREAM_SPLIT"),
            write_statistics=False,
            write_page_checksum=True,
        )
        partial.replace(path)
    except BaseException as error:
        partial.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.errno and not error.filename:
            raise OSError(error.errno, os.strerror(error.errno), str(path)) from error
        raise


def read_record(
    path: str | os.PathLike[str], columns: Sequence[str] | None = None
) -> TrialRecord:
    """Read a trial record.

    Args:
        path: File that `write_record` made.
        columns: Names to read; all if None. `time` always comes along.

    Returns:
        The trial, with just those columns in the order of `COLUMNS`.

    Raises:
        ValueError: If the file is no Parquet, cut short or damaged, has no
            description of the trial, or columns are missing or of the wrong kind.
        OSError: If the file cannot be read.
    """
    wanted = _wanted_columns(columns)
    return _record_in(_opened(Path(path)), path, wanted)


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
        return _record_in(file, path, list(COLUMN_NAMES))
    return _plain_recording(_rows(file, path, file.schema_arrow.names), path)


def read_stream(path: str | os.PathLike[str]) -> TrialRecord:
    """Read the Arrow stream that a drive writes while it goes on.

    A drive that was cut off leaves a stream without an end; all of its whole batches
    are read. Markers lie beside the batches and come as `markers` in the metadata.

    Raises:
        ValueError: If there is not one whole batch of a trial in it.
        OSError: If it cannot be read.
    """
    table, markers = stream_table(Path(path))
    try:
        record = from_table(table, list(COLUMN_NAMES))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    return TrialRecord({**record.metadata, "markers": markers}, record.columns)


def stream_table(path: Path) -> tuple[pa.Table, list[object]]:
    """All whole batches of an Arrow stream, and the markers beside them.

    Raises:
        ValueError: If there is none.
        OSError: If it cannot be read.
    """
    content = path.read_bytes()
    batches: list[pa.RecordBatch] = []
    markers: list[object] = []
    try:
        reader = pa.ipc.open_stream(pa.BufferReader(content))
        while True:
            batch, beside = reader.read_next_batch_with_custom_metadata()
            batches.append(batch)
            markers += json.loads(beside[MARKERS_KEY]) if beside else []
    except (StopIteration, pa.ArrowException, OSError):
        pass  # the end, or what a killed process left of a batch
    if not any(batch.num_rows for batch in batches):
        raise ValueError(f"{path} holds no row of a drive; it had not begun")
    return pa.Table.from_batches(batches), markers


def _plain_recording(table: pa.Table, path: str | os.PathLike[str]) -> TrialRecord:
    try:
        return TrialRecord(metadata={}, columns=plain_columns(table))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _wanted_columns(columns: Sequence[str] | None) -> list[str]:
    unknown = [name for name in columns or () if name not in COLUMN_NAMES]
    if unknown:
        raise ValueError(
            f"unknown columns: {', '.join(unknown)}; a trial record has "
            f"{', '.join(COLUMN_NAMES)}"
        )
    chosen = COLUMN_NAMES if columns is None else ("time", *columns)
    return [name for name in COLUMN_NAMES if name in chosen]


def _opened(path: Path) -> pq.ParquetFile:
    source = path.read_bytes()
    try:
        return pq.ParquetFile(pa.BufferReader(source), page_checksum_verification=True)
    except (pa.ArrowException, OSError) as error:
        raise ValueError(
            f"{path} is not a Parquet file, or was cut short: {_first_line(error)}"
        ) from error


def _record_in(
    file: pq.ParquetFile, path: str | os.PathLike[str], wanted: list[str]
) -> TrialRecord:
    present = [name for name in wanted if name in file.schema_arrow.names]
    try:
        return from_table(_rows(file, path, present), wanted)
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
