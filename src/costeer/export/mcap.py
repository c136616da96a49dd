"""A trial record as MCAP with Protobuf messages, for Foxglove, PlotJuggler and rerun.

The messages describe themselves: their descriptor is built here and stands in the file,
so no reader needs a `.proto`. Needs the packages `mcap` and `protobuf` (extra `drive`).
"""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.files import replacing
from costeer.export.markers import markers_of
from costeer.records.checks import check_time
from costeer.records.columns import COLUMNS, Column, TrialRecord
from costeer.runtime.markers import Marker, Value, told

SAMPLE = "costeer.TrialSample"
"""Type of the messages on `/trial`, one for each row of the record."""

MARKER = "costeer.Marker"
"""Type of the messages on `/markers`."""

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_LONGEST = 9e9
"""Latest time [s] whose nanoseconds fit into 63 bits."""


class _Topic(NamedTuple):
    """A channel of the file.

    Attributes:
        name: As shown by readers.
        kind: Type of its messages.
        fields: Name and kind, `double`, `bool` or `string`, in the order of numbers.
        units: Unit of each field that has one.
    """

    name: str
    kind: str
    fields: dict[str, str]
    units: dict[str, str]


def write_mcap(record: TrialRecord, path: str | os.PathLike[str]) -> None:
    """Write a record as MCAP, whole or not at all; the same record, the same bytes.

    Numbers are doubles, NaN where they are undefined; flags are bools, but doubles (0,
    1 or NaN) where they may be undefined; text stays text.

    Args:
        record: A trial, or any table with a column `time` [s] that begins at 0 or
            later.
        path: File to write or replace.

    Raises:
        ValueError: If times or the name of a column do not suit the format.
        OSError: If the file cannot be written; then nothing is left of it.
        ModuleNotFoundError: If `mcap` or `protobuf` is not installed.
    """
    _check(record)
    with replacing(Path(path)) as partial, partial.open("wb") as stream:
        _write(stream, record)


def _check(record: TrialRecord) -> None:
    """Refuse a record that MCAP cannot hold."""
    if "time" not in record.columns:
        raise ValueError("there is no column time; MCAP orders messages by time [s]")
    time = np.asarray(record.columns["time"], dtype=np.float64)
    check_time(time)
    if time.size and not (time[0] >= 0.0 and time[-1] <= _LONGEST):
        raise ValueError(
            f"time goes from {time[0]} to {time[-1]} s; MCAP takes 0 to {_LONGEST:g} s"
        )
    for name in record.columns:
        if not _IDENTIFIER.fullmatch(name):
            raise ValueError(
                f"column {name!r} cannot be the name of a field; use letters, digits "
                "and underscores, beginning with a letter"
            )


def _write(stream: Any, record: TrialRecord) -> None:  # Any: mcap takes any stream
    from mcap.writer import Writer

    writer: Any = Writer(stream)  # Any: some of its methods have no types
    writer.start(profile="", library="costeer")
    _write_samples(writer, record)
    markers = [m for m in markers_of(record.metadata) if 0.0 <= m.time <= _LONGEST]
    if markers:
        _write_markers(writer, markers)
    writer.add_metadata("costeer", {"trial": _json(record.metadata)})
    writer.finish()


def _write_samples(writer: Any, record: TrialRecord) -> None:  # Any: as above
    """One message for each row."""
    declared = {c.name: c for c in (*COLUMNS, *record.method_columns)}
    fields = {n: _kind(declared.get(n), array) for n, array in record.columns.items()}
    units = {name: declared[name].unit for name in fields if name in declared}
    topic = _Topic("/trial", SAMPLE, fields, units)
    values = [_plain(record.columns[name], kind) for name, kind in fields.items()]
    _write_topic(writer, topic, zip(*values, strict=True), list(fields).index("time"))


def _write_markers(writer: Any, markers: list[Marker]) -> None:  # Any: as above
    """One message for each marker."""
    topic = _Topic("/markers", MARKER, _MARKER_FIELDS, {"time": "s"})
    _write_topic(writer, topic, map(_marker_row, markers), 0)


_MARKER_FIELDS = {
    "time": "double",
    "kind": "string",
    "name": "string",
    "before": "double",
    "after": "double",
    "unit": "string",
    "before_name": "string",
    "after_name": "string",
    "text": "string",
}


def _marker_row(marker: Marker) -> tuple[float | str, ...]:
    """A marker in the order of `_MARKER_FIELDS`."""
    return (
        marker.time,
        marker.kind,
        marker.name,
        _number(marker.before),
        _number(marker.after),
        marker.unit,
        _name(marker.before),
        _name(marker.after),
        told(marker),
    )


def _number(value: Value) -> float:
    return value if isinstance(value, float) else math.nan


def _name(value: Value) -> str:
    return value if isinstance(value, str) else ""


def _write_topic(
    writer: Any,  # Any: as above
    topic: _Topic,
    rows: Iterable[tuple[Any, ...]],  # Any: floats, flags and text
    time_at: int,
) -> None:
    """A channel and its messages; the time stands in each row at `time_at`."""
    make, described = _message_class(topic)
    schema = writer.register_schema(topic.kind, "protobuf", described)
    channel = writer.register_channel(topic.name, "protobuf", schema, topic.units)
    for number, row in enumerate(rows):
        moment = round(row[time_at] * 1e9)
        message = make(**dict(zip(topic.fields, row, strict=True)))
        data = message.SerializeToString(deterministic=True)
        writer.add_message(channel, moment, data, moment, number)


def _message_class(topic: _Topic) -> tuple[Any, bytes]:  # Any: a class made at run time
    """The class of a topic's messages, and the descriptor that stands in the file.

    Raises:
        ValueError: If two names of fields are the same to Protobuf.
    """
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    package, _, name = topic.kind.rpartition(".")
    file = descriptor_pb2.FileDescriptorProto(
        name=f"{package}/{name}.proto", package=package, syntax="proto3"
    )
    message = file.message_type.add(name=name)
    kinds = descriptor_pb2.FieldDescriptorProto
    types = {
        "double": kinds.TYPE_DOUBLE,
        "bool": kinds.TYPE_BOOL,
        "string": kinds.TYPE_STRING,
    }
    for number, (field, kind) in enumerate(topic.fields.items(), 1):
        message.field.add(
            name=field, number=number, type=types[kind], label=kinds.LABEL_OPTIONAL
        )
    pool = descriptor_pool.DescriptorPool()
    try:
        pool.Add(file)
        found = pool.FindMessageTypeByName(topic.kind)
    except (TypeError, KeyError) as error:
        told = (str(error).splitlines() or ["unknown reason"])[-1].strip()
        raise ValueError(f"Protobuf refuses the names of the columns: {told}") from None
    described = descriptor_pb2.FileDescriptorSet(file=[file])
    return message_factory.GetMessageClass(found), described.SerializeToString()


# Any: the element type differs from column to column.
def _kind(known: Column | None, values: NDArray[Any]) -> str:
    """Kind of the field that holds a column; decided by the column, not its values."""
    if values.dtype.kind in "US":
        return "string"
    nullable = known.nullable if known else isinstance(values, np.ma.MaskedArray)
    return "bool" if values.dtype.kind == "b" and not nullable else "double"


def _plain(values: NDArray[Any], kind: str) -> list[Any]:  # Any: as above
    """A column as Python's own values; undefined samples are NaN."""
    if kind == "string":
        texts: list[Any] = values.astype(str).tolist()
        return texts
    data = np.ma.getdata(values)
    if kind == "bool":
        flags: list[Any] = data.astype(bool).tolist()
        return flags
    numbers = data.astype(np.float64)
    numbers[np.ma.getmaskarray(values)] = math.nan
    plain: list[Any] = numbers.tolist()
    return plain


def _json(metadata: Mapping[str, object]) -> str:
    """The description of the trial as JSON, which has no NaN."""
    return json.dumps(
        finite(metadata), sort_keys=True, ensure_ascii=False, allow_nan=False
    )


def finite(value: object) -> object:
    """The value with null where a number is not finite."""
    if isinstance(value, np.generic):
        return finite(value.item())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return value
