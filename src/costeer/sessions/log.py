"""What happened in a session: the store's events, pauses, clocks that jump."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from costeer.export.markers import markers_of
from costeer.records.record import read_record
from costeer.runtime.markers import Marker, told
from costeer.sessions.attempts import listed_attempts
from costeer.sessions.session import Session
from costeer.sessions.store import Row, seconds_of, utc_of

SMALLEST_JUMP = 1.0
"""By which the two clocks must disagree between two events [s]. Source: assumed, far
above what a time server corrects by slewing."""

_KEPT = ("paused", "resumed", "gap", "fault", "error", "lost", "parameter", "condition")
"""Kinds of markers that stand in the log of a study."""


def event_rows(session: Session) -> list[dict[str, Any]]:
    """Rows of `events.csv` in the order in which things happened; Any: cells.

    A wall clock that was set on the way does not change the order.
    """
    rows: list[tuple[float, dict[str, Any]]] = []
    ahead: dict[tuple[str, str, str], float] = {}
    set_by, before = 0.0, None
    for event in session.store.rows("SELECT * FROM events ORDER BY number"):
        jump = None if before is None else clock_jump(before, event)
        if before is not None and jump is not None:
            set_by += _set_by(before, event, jump["length"])
            rows.append((seconds_of(event["utc"]) - set_by, jump))
        rows.append((seconds_of(event["utc"]) - set_by, _of_store(event)))
        if event["kind"] == "attempt":
            ahead[event["participant"], event["step"], event["text"]] = set_by
        before = event
    for attempt in listed_attempts(session.store):
        key = attempt["participant"], attempt["step"], f"attempt {attempt['attempt']}"
        for row in _of_record(session.folder, attempt):
            moment = seconds_of(row["utc"]) if row["utc"] else -math.inf
            rows.append((moment - ahead.get(key, 0.0), row))
    return [row for _, row in sorted(rows, key=lambda each: each[0])]


def _set_by(before: Row, after: Row, jump: float | None) -> float:
    """How far the wall clock was set between two events [s]; at a restart at least."""
    if jump is not None:
        return jump
    return min(0.0, seconds_of(after["utc"]) - seconds_of(before["utc"]))


def _of_store(event: Row) -> dict[str, Any]:
    names = ("utc", "monotonic", "participant", "step", "kind", "text", "data")
    row = {name: event[name] for name in names}
    data = "" if row["data"] == "{}" else row["data"]
    return row | {"data": data, "length": None, "trial_time": None, "record": ""}


def clock_jump(before: Row, after: Row) -> dict[str, Any] | None:
    """The row of a clock that was set between two events; None if it was not."""
    wall = seconds_of(after["utc"]) - seconds_of(before["utc"])
    steady = after["monotonic"] - before["monotonic"]
    if steady < 0.0:
        return _clock_row(after, "clock restart", "the computer was started anew", None)
    ahead = round(wall - steady, 3)
    if abs(ahead) <= SMALLEST_JUMP:
        return None
    way = "forward" if ahead > 0 else "back"
    text = f"the wall clock went {way} by {abs(ahead):g} s: it was set, or the "
    return _clock_row(after, "clock jump", f"{text}computer slept", ahead)


def _clock_row(
    event: Row, kind: str, text: str, length: float | None
) -> dict[str, Any]:
    return {
        "utc": event["utc"],
        "monotonic": event["monotonic"],
        "participant": "",
        "step": "",
        "kind": kind,
        "text": text,
        "length": length,
        "trial_time": None,
        "record": "",
        "data": "",
    }


def _of_record(folder: Path, attempt: Row) -> list[dict[str, Any]]:
    """Pauses and faults of a drive, from the markers of its record."""
    file = folder / attempt["record"]
    if not attempt["record"] or not file.is_file():
        return []
    try:
        metadata = read_record(file, ()).metadata
    except ValueError:
        return []  # the log of exclusions tells of it
    rows, stood = [], 0.0
    for marker in markers_of(metadata):
        if marker.kind == "resumed" and isinstance(marker.after, float):
            stood += marker.after
        if marker.kind in _KEPT:
            began = str(metadata.get("started_at") or "")
            rows.append(
                _marker_row(attempt, marker, _later(began, marker.time + stood))
            )
    return rows


def _marker_row(attempt: Row, marker: Marker, utc: str) -> dict[str, Any]:
    is_length = marker.kind in ("resumed", "gap") and isinstance(marker.after, float)
    return {
        "utc": utc,
        "monotonic": None,
        "participant": attempt["participant"],
        "step": attempt["step"],
        "kind": marker.kind,
        "text": told(marker),
        "length": marker.after if is_length else None,
        "trial_time": marker.time,
        "record": attempt["record"],
        "data": "",
    }


def _later(utc: str, seconds: float) -> str:
    """A moment so many seconds later; empty if it is not known."""
    if not utc or not math.isfinite(seconds):
        return ""
    return utc_of(seconds_of(utc) + seconds)
