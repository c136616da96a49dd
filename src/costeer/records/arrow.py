"""Trial records and foreign tables as Arrow tables: conversion, without files.

Undefined floats stay NaN, undefined integers and flags are nulls. The units stand in
the fields' metadata, the description of the trial in the schema's, as JSON.
"""

import json
import math
import zlib
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple, cast

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from costeer.records.checks import check_time, refuse_unknown
from costeer.records.columns import (
    ADDED_PREFIXES,
    COLUMN_NAMES,
    COLUMNS,
    Column,
    Kind,
    Mirrored,
    TrialRecord,
    with_method_columns,
)
from costeer.records.metadata import METADATA_FIELDS, upgraded

METADATA_KEY = b"costeer"

_ARROW_TYPES: dict[Kind, pa.DataType] = {
    "float64": pa.float64(),
    "int8": pa.int8(),
    "bool": pa.bool_(),
    "string": pa.string(),
}


class Described(NamedTuple):
    """What a schema says of a trial.

    Attributes:
        metadata: Of the record, in the words of this version.
        columns: That a record has, and those of the method in this file.
    """

    metadata: dict[str, object]
    columns: tuple[Column, ...]


def to_table(record: TrialRecord) -> pa.Table:
    """The Arrow table of a validated record.

    Raises:
        ValueError: If a label is unknown or the metadata does not fit into JSON.
    """
    declared = with_method_columns(record.method_columns)
    arrays = [_to_arrow(column, record.columns[column.name]) for column in declared]
    schema = record_schema(record.metadata, record.method_columns)
    return pa.Table.from_arrays(arrays, schema=schema)


def record_schema(
    metadata: dict[str, object], method_columns: Sequence[Column] = ()
) -> pa.Schema:
    """Schema of a record: declarations in the fields, the trial's story in its own.

    Raises:
        ValueError: If the metadata does not fit into JSON, or a column cannot be one of
            a method.
    """
    fields = [
        pa.field(
            column.name,
            _ARROW_TYPES[column.kind],
            nullable=column.nullable,
            metadata={
                "unit": column.unit,
                "description": column.description,
                "source": column.source,
                "assisted_only": json.dumps(column.assisted_only),
                "stepped": json.dumps(column.stepped),
                "mirrored": column.mirrored,
                "labels": "\n".join(column.labels),
            },
        )
        for column in with_method_columns(method_columns)
    ]
    return pa.schema(fields, metadata={METADATA_KEY: _to_json(metadata)})


def _to_json(metadata: dict[str, object]) -> str:
    return json.dumps(
        _plain(metadata), sort_keys=True, ensure_ascii=False, allow_nan=False
    )


def _plain(value: object) -> object:
    """The value in JSON's own types; numpy scalars unwrapped, NaN as None."""
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float):
        return _plain_float(value)
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return _plain(value._asdict())
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [_plain(item) for item in value]
    return value


def _plain_float(value: float) -> float | None:
    if math.isinf(value):
        raise ValueError(
            "metadata holds an infinite number, which JSON cannot; use NaN or None "
            "for undefined"
        )
    return None if math.isnan(value) else value


# Any, here and below: the element type differs from column to column.
def _to_arrow(column: Column, values: NDArray[Any]) -> pa.Array:
    if column.kind == "string":
        return _texts_to_arrow(column, values)
    plain = np.ma.getdata(values)
    data = _packed(plain) if column.kind == "bool" else pa.py_buffer(plain)
    valid = _packed(~np.ma.getmaskarray(values)) if column.nullable else None
    return _from_buffers(column.kind, plain.size, [valid, data])


def _from_buffers(kind: Kind, num_rows: int, buffers: list[Any]) -> pa.Array:
    # Not `pa.array`, which copies and imports pandas, almost a second.
    return pa.Array.from_buffers(_ARROW_TYPES[kind], num_rows, buffers)


def _packed(flags: NDArray[np.bool_]) -> pa.Buffer:
    return pa.py_buffer(np.packbits(flags, bitorder="little"))


def _texts_to_arrow(column: Column, values: NDArray[np.str_]) -> pa.Array:
    codes = _codes(column, values)
    texts = [label.encode() for label in column.labels]
    lengths = np.array([len(text) for text in texts], np.int32)[codes]
    offsets = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32)
    characters = b"".join([texts[code] for code in codes.tolist()])
    buffers = [None, pa.py_buffer(offsets), pa.py_buffer(characters)]
    return _from_buffers("string", values.size, buffers)


def _codes(column: Column, values: NDArray[np.str_]) -> NDArray[np.int8]:
    codes = np.full(values.shape, -1, np.int8)
    for code, label in enumerate(column.labels):
        codes[values == label] = code
    if (codes < 0).any():
        row = int(np.flatnonzero(codes < 0)[0])
        raise ValueError(
            f"{column.name} is {str(values[row])!r} in row {row}, expected one of "
            f"{', '.join(column.labels)}"
        )
    return codes


def batch_checksum(batch: pa.RecordBatch) -> int:
    """CRC-32 over every buffer of every column, in order.

    The flags of what is defined are left out where everything is, as in a stream.
    """
    found = 0
    for column in batch.columns:
        flags, *data = column.buffers()
        for buffer in (flags if column.null_count else None, *data):
            found = zlib.crc32(buffer, found) if buffer is not None else found
    return found


def described(schema: pa.Schema) -> Described:
    """What a schema says of the trial and its columns.

    Raises:
        ValueError: If it is none of a record, of a newer version, or has columns that
            no record has.
    """
    metadata = _metadata(schema)
    refuse_twice(schema.names)
    others = [field for field in schema if field.name not in COLUMN_NAMES]
    refuse_unknown(f.name for f in others if not f.name.startswith(ADDED_PREFIXES))
    added = [_declared(field) for field in others]
    return Described(metadata, with_method_columns(added))


def _declared(field: pa.Field) -> Column:
    """A method's column as the file declares it."""
    told = {k.decode(): v.decode() for k, v in (field.metadata or {}).items()}
    kinds = [kind for kind, each in _ARROW_TYPES.items() if each == field.type]
    if not kinds:
        raise ValueError(
            f"column {field.name!r} holds {field.type}; a method's columns hold "
            f"{', '.join(_ARROW_TYPES)}"
        )
    return Column(
        name=field.name,
        unit=told.get("unit", "-"),
        kind=kinds[0],
        description=told.get("description", ""),
        source=told.get("source", ""),
        nullable=field.nullable,
        assisted_only=told.get("assisted_only") == "true",
        stepped=told.get("stepped") == "true",
        mirrored=cast("Mirrored", told.get("mirrored", "same")),
        labels=tuple(told.get("labels", "").splitlines()),
    )


def from_table(
    table: pa.Table, about: Described, names: Sequence[str] | None = None
) -> TrialRecord:
    """The record in an Arrow table.

    Args:
        table: With the columns, or some of them.
        about: What the schema of the file says.
        names: Of the columns to take; all if None.

    Raises:
        ValueError: If a column is missing or of the wrong kind, or time is not finite
            and increasing.
    """
    wanted = [c for c in about.columns if names is None or c.name in names]
    asked = dict.fromkeys([*(c.name for c in wanted), *(names or ())])
    late = {c.name: c for c in wanted if c.before is not None}
    _refuse_missing("columns", asked, [*table.schema.names, *late])
    columns = {
        c.name: _from_arrow(c, table.column(c.name))
        if c.name in table.schema.names
        else np.full(table.num_rows, c.before).astype(c.kind)
        for c in wanted
    }
    check_time(columns["time"])
    added = tuple(column for column in wanted if column not in COLUMNS)
    return TrialRecord(about.metadata, columns, added)


def _metadata(schema: pa.Schema) -> dict[str, object]:
    text = (schema.metadata or {}).get(METADATA_KEY)
    if text is None:
        raise ValueError(
            "it has no 'costeer' metadata, so it is a plain table and no trial "
            "record; `costeer analyse` reads plain tables"
        )
    try:
        metadata = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError("its 'costeer' metadata is not JSON") from error
    present = upgraded(metadata)
    _refuse_missing("metadata fields", METADATA_FIELDS, present)
    return present


def _refuse_missing(what: str, wanted: Iterable[str], given: Iterable[str]) -> None:
    present = set(given)
    missing = [name for name in wanted if name not in present]
    if missing:
        raise ValueError(
            f"it lacks the {what} {', '.join(missing)}; it was written by another "
            "program or another version"
        )


def _from_arrow(column: Column, values: pa.ChunkedArray) -> NDArray[Any]:
    if values.type != _ARROW_TYPES[column.kind]:
        raise ValueError(
            f"column {column.name!r} holds {values.type}, expected {column.kind}"
        )
    if values.null_count and not column.nullable:
        raise ValueError(f"column {column.name!r} has undefined samples")
    array = values.combine_chunks()
    if column.kind == "string":
        return _strings(array)
    return _with_gaps(array) if column.nullable else _plain_copy(array)


def _plain_copy(array: pa.Array) -> NDArray[Any]:
    # From the buffer, because `to_numpy` imports pandas; a copy, because Arrow's
    # memory is read-only.
    window = slice(array.offset, array.offset + len(array))
    data = array.buffers()[1] if len(array) else pa.py_buffer(b"")
    if pa.types.is_boolean(array.type):
        return _unpacked(data)[window]
    return np.frombuffer(data, array.type.to_pandas_dtype())[window].copy()


def _unpacked(bits: pa.Buffer) -> NDArray[np.bool_]:
    return np.unpackbits(np.frombuffer(bits, np.uint8), bitorder="little").astype(bool)


def _with_gaps(array: pa.Array) -> np.ma.MaskedArray[Any, np.dtype[Any]]:
    values, undefined = _plain_copy(array), np.zeros(len(array), bool)
    if array.null_count:
        window = slice(array.offset, array.offset + len(array))
        undefined = ~_unpacked(array.buffers()[0])[window]
        values[undefined] = 0
    return np.ma.MaskedArray(values, mask=undefined)


def _strings(array: pa.Array) -> NDArray[np.str_]:
    filled = array.fill_null("") if array.null_count else array
    coded = filled.dictionary_encode()
    names = np.array(coded.dictionary.to_pylist(), dtype=np.str_)
    return np.asarray(names[_plain_copy(coded.indices)])


def plain_columns(table: pa.Table) -> dict[str, NDArray[Any]]:
    """The columns of a foreign table that hold numbers, flags or text.

    Numbers with gaps become floats with NaN, flags with gaps masked arrays. Days
    become text, moments and durations stay such. Columns of another type, lists for
    example, are left out.

    Raises:
        ValueError: If a name stands twice.
    """
    refuse_twice(table.column_names)
    arrays = {name: _plain_column(table.column(name)) for name in table.column_names}
    return {name: array for name, array in arrays.items() if array is not None}


def _moments(array: pa.Array) -> NDArray[Any]:
    """Moments and durations in nanoseconds; undefined ones are NaT."""
    of_day = pa.types.is_time(array.type)
    kind = "M8[ns]" if pa.types.is_timestamp(array.type) else "m8[ns]"
    if of_day:
        array = array.cast(pa.time64("ns"))
    else:
        unit = pa.timestamp("ns") if kind == "M8[ns]" else pa.duration("ns")
        array = array.cast(unit, safe=False)
    numbers = _with_gaps(array.cast(pa.int64()))
    return np.asarray(numbers.filled(np.iinfo(np.int64).min).view(kind))


def refuse_twice(names: Sequence[str]) -> None:
    """Refuse names that do not tell columns apart.

    Raises:
        ValueError: Naming one that stands twice.
    """
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise ValueError(
            f"{names.count(twice)} columns have the name {twice!r}; the "
            "first row names the columns, each differently"
        )


def _plain_column(values: pa.ChunkedArray) -> NDArray[Any] | None:
    array = values.combine_chunks()
    if pa.types.is_dictionary(array.type):
        array = array.cast(array.type.value_type)
    if pa.types.is_date(array.type):
        array = array.cast(pa.string())
    if pa.types.is_decimal(array.type):
        array = array.cast(pa.float64())
    if pa.types.is_temporal(array.type):
        return _moments(array)
    if pa.types.is_string(array.type) or pa.types.is_large_string(array.type):
        return _strings(array.cast(pa.string()))
    if pa.types.is_boolean(array.type):
        return _with_gaps(array)
    if pa.types.is_integer(array.type) and not array.null_count:
        return _plain_copy(array)
    if pa.types.is_floating(array.type) or pa.types.is_integer(array.type):
        numbers = _with_gaps(array.cast(pa.float64()))
        return np.asarray(numbers.filled(np.nan))
    return np.full(len(array), np.nan) if pa.types.is_null(array.type) else None
