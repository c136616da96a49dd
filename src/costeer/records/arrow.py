"""Trial records and foreign tables as Arrow tables: conversion, without files.

Undefined floats stay NaN, undefined integers and flags are nulls. The units stand in
the fields' metadata, the description of the trial in the schema's, as JSON.
"""

import json
import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from costeer.records.columns import (
    COLUMNS,
    COLUMNS_BY_NAME,
    METADATA_FIELDS,
    MODES,
    Column,
    TrialRecord,
    check_time,
)

METADATA_KEY = b"costeer"

_ARROW_TYPES = {
    "float64": pa.float64(),
    "int8": pa.int8(),
    "bool": pa.bool_(),
    "string": pa.string(),
}


def to_table(record: TrialRecord) -> pa.Table:
    """The Arrow table of a validated record.

    Raises:
        ValueError: If a mode is unknown or the metadata does not fit into JSON.
    """
    arrays = [_to_arrow(column, record.columns[column.name]) for column in COLUMNS]
    return pa.Table.from_arrays(arrays, schema=record_schema(record.metadata))


def record_schema(metadata: dict[str, object]) -> pa.Schema:
    """Schema of a record: units in the fields, the trial's description in its own.

    Raises:
        ValueError: If the metadata does not fit into JSON.
    """
    fields = [
        pa.field(
            column.name,
            _ARROW_TYPES[column.kind],
            nullable=column.nullable,
            metadata={"unit": column.unit, "description": column.description},
        )
        for column in COLUMNS
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
        return _modes_to_arrow(values)
    plain = np.ma.getdata(values)
    data = _packed(plain) if column.kind == "bool" else pa.py_buffer(plain)
    valid = _packed(~np.ma.getmaskarray(values)) if column.nullable else None
    return _from_buffers(column.kind, plain.size, [valid, data])


def _from_buffers(kind: str, num_rows: int, buffers: list[Any]) -> pa.Array:
    # Not `pa.array`, which copies and imports pandas, almost a second.
    return pa.Array.from_buffers(_ARROW_TYPES[kind], num_rows, buffers)


def _packed(flags: NDArray[np.bool_]) -> pa.Buffer:
    return pa.py_buffer(np.packbits(flags, bitorder="little"))


def _modes_to_arrow(mode: NDArray[np.str_]) -> pa.Array:
    codes = _mode_codes(mode)
    texts = [name.encode() for name in MODES]
    lengths = np.array([len(text) for text in texts], np.int32)[codes]
    offsets = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32)
    characters = b"".join([texts[code] for code in codes.tolist()])
    buffers = [None, pa.py_buffer(offsets), pa.py_buffer(characters)]
    return _from_buffers("string", mode.size, buffers)


def _mode_codes(mode: NDArray[np.str_]) -> NDArray[np.int8]:
    codes = np.full(mode.shape, -1, np.int8)
    for code, name in enumerate(MODES):
        codes[mode == name] = code
    if (codes < 0).any():
        row = int(np.flatnonzero(codes < 0)[0])
        raise ValueError(
            f"mode is {str(mode[row])!r} in row {row}, expected one of "
            f"{', '.join(MODES)}"
        )
    return codes


def from_table(table: pa.Table, wanted: list[str]) -> TrialRecord:
    """The record in an Arrow table, with the wanted columns.

    Raises:
        ValueError: If the description or a column is missing, a column is of the
            wrong kind, or time is not finite and increasing.
    """
    metadata = _metadata(table.schema)
    _refuse_missing("columns", wanted, table.schema.names)
    columns = {
        name: _from_arrow(COLUMNS_BY_NAME[name], table.column(name)) for name in wanted
    }
    check_time(columns["time"])
    return TrialRecord(metadata=metadata, columns=columns)


def _metadata(schema: pa.Schema) -> dict[str, object]:
    described = (schema.metadata or {}).get(METADATA_KEY)
    if described is None:
        raise ValueError(
            "it has no 'costeer' metadata, so it is a plain table and no trial "
            "record; `costeer analyse` reads plain tables"
        )
    try:
        metadata: dict[str, object] = json.loads(described)
    except ValueError as error:
        raise ValueError("its 'costeer' metadata is not JSON") from error
    _refuse_missing("metadata fields", METADATA_FIELDS, metadata)
    return metadata


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

    Numbers with gaps become floats with NaN, flags with gaps masked arrays. Columns
    of another type, times of day for example, are left out.

    Raises:
        ValueError: If a name stands twice.
    """
    for name in table.column_names:
        if table.column_names.count(name) > 1:
            raise ValueError(
                f"{table.column_names.count(name)} columns have the name {name!r}; the "
                "first row names the columns, each differently"
            )
    arrays = {name: _plain_column(table.column(name)) for name in table.column_names}
    return {name: array for name, array in arrays.items() if array is not None}


def _plain_column(values: pa.ChunkedArray) -> NDArray[Any] | None:
    array = values.combine_chunks()
    if pa.types.is_dictionary(array.type):
        array = array.cast(array.type.value_type)
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
