"""What happened in a trial, pauses and changed gains for example, by its metadata."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import get_args

from costeer.runtime.markers import Kind, Marker, Value

_KINDS: dict[str, Kind] = {kind: kind for kind in get_args(Kind)}


def markers_of(metadata: Mapping[str, object]) -> list[Marker]:
    """The markers that a record's metadata lists, by time.

    Args:
        metadata: Of a record. What has no finite time is left out.
    """
    entries = metadata.get("markers")
    if not isinstance(entries, list | tuple):
        return []
    found = [marker for each in entries if (marker := _marker(each))]
    return sorted(found, key=lambda marker: marker.time)


def _marker(entry: object) -> Marker | None:
    """An entry as a marker; what no field takes is put into the note."""
    if not isinstance(entry, Mapping):
        return None
    time, word = entry.get("time"), str(entry.get("kind", ""))
    if not isinstance(time, int | float) or not math.isfinite(time):
        return None
    if "text" in entry:
        return _old(word, str(entry["text"]), float(time))
    rest = [f"{k} {v}" for k, v in entry.items() if k not in Marker._fields]
    noted = [str(entry["note"])] if entry.get("note") else []
    return Marker(
        kind=_KINDS.get(word, "note"),
        name=str(entry.get("name", "" if word in _KINDS else word)),
        before=_value(entry.get("before")),
        after=_value(entry.get("after")),
        unit=str(entry.get("unit", "")),
        time=float(time),
        note=", ".join(noted + rest),
    )


def _value(value: object) -> Value:
    """A number, a name or nothing, out of JSON."""
    if isinstance(value, int | float):
        return float(value)
    return None if value is None else str(value)


_NUMBER = r"(-?\d+(?:\.\d+)?(?:e[+-]?\d+)?)"
_OLD_GAIN = re.compile(rf"(\S+) {_NUMBER} -> {_NUMBER} (\S+)")
_OLD_CHOICE = re.compile(r"(\S+) -> (\S+)")


def _old(kind: str, text: str, time: float) -> Marker:
    """A marker of a record from when there were only kind, text and time."""
    if kind == "gain" and (gain := _OLD_GAIN.fullmatch(text)):
        name, before, after, unit = gain.groups()
        return Marker("parameter", name, float(before), float(after), unit, time)
    if kind in ("condition", "method") and (choice := _OLD_CHOICE.fullmatch(text)):
        before, after = choice.groups()
        return Marker(_KINDS[kind], before=before, after=after, time=time)
    if kind == "indicator":
        return Marker("indicator", after=text, time=time)
    name = "" if kind in _KINDS else kind
    return Marker(_KINDS.get(kind, "note"), name, time=time, note=text)
