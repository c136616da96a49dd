"""What happened in a trial, pauses and changed gains for example, by its metadata."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple


class Marker(NamedTuple):
    """Something that happened in a trial.

    Attributes:
        time: Since the start of the trial [s].
        kind: What sort of thing: `paused`, `gain`, `condition`.
        text: What exactly.
    """

    time: float
    kind: str
    text: str


_LISTS = {"markers": "marker", "changes": "change"}
"""Where the metadata of a record lists them, and the kind of an entry without one."""


def markers_of(metadata: Mapping[str, object]) -> list[Marker]:
    """The markers and changes that a record's metadata lists, by time.

    Args:
        metadata: Of a record. What has no finite time is left out.
    """
    found: list[Marker] = []
    for name, kind in _LISTS.items():
        entries = metadata.get(name)
        if isinstance(entries, list | tuple):
            found += [m for each in entries if (m := _marker(each, kind))]
    return sorted(found)


def _marker(entry: object, usual_kind: str) -> Marker | None:
    """An entry as a marker; what it says besides is put into the text."""
    if not isinstance(entry, Mapping):
        return None
    time = entry.get("time")
    if not isinstance(time, int | float) or not math.isfinite(time):
        return None
    said = [str(entry["text"])] if entry.get("text") else []
    rest = [f"{k} {v}" for k, v in entry.items() if k not in Marker._fields]
    kind = str(entry.get("kind") or usual_kind)
    return Marker(time=float(time), kind=kind, text=", ".join(said + rest))
