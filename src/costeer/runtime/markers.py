"""What happened in a trial and what was changed in it, as one kind of record.

Loop, server, pages, records and exports pass it on as it is and go by its fields.
Words for people are made of it by `told` alone, and nothing reads them back.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from costeer.runtime.states import Contact, Fault, Loss

Kind = Literal[
    "started",
    "resumed",
    "paused",
    "ended",
    "restarted",
    "condition",
    "method",
    "parameter",
    "indicator",
    "contact",
    "fault",
    "gap",
    "lost",
    "error",
    "note",
]
"""What can happen; `gap` is a stretch that could not be recorded, `lost` a helper that
has ended, `note` what this version does not know."""

Value = float | str | None


class Marker(NamedTuple):
    """Something that happened in a trial, or was changed in it.

    Attributes:
        kind: What sort of thing.
        name: Which one, where the kind does not say it: the parameter, the fault, who
            paused it or what ended it.
        before: What a change replaced: a name or a number.
        after: What holds since; of `resumed` and `gap` how long it took.
        unit: Of the numbers; "-" if they have none.
        time: Of the trial [s].
        note: What only words can say: an error, what other programs wrote.
    """

    kind: Kind
    name: str = ""
    before: Value = None
    after: Value = None
    unit: str = ""
    time: float = 0.0
    note: str = ""


_REASONS = {
    "driver": "by the driver",
    "experimenter": "by the experimenter",
    "stop": "stopped by the experimenter",
    "watchdog": "nobody watches the wheel any more",
    "course": "the end of the course is reached",
    "collision": "the car has hit something",
    "server": "the drive was stopped",
}

_LENGTHS = {
    "resumed": "after a pause of {:.1f} s",
    "gap": "the next {:.3f} s could not be recorded",
}


def told(marker: Marker) -> str:
    """The marker in words, for people."""
    what = marker.name if marker.kind == "parameter" else marker.kind
    said = ", ".join(part for part in (_said(marker), marker.note) if part)
    return f"{what}: {said}" if said else what


def _said(marker: Marker) -> str:
    """What fields say besides the kind."""
    if marker.kind in _LENGTHS and isinstance(marker.after, float):
        return _LENGTHS[marker.kind].format(marker.after)
    if marker.after is not None:
        unit = "" if marker.unit in ("", "-") else f" {marker.unit}"
        before = "" if marker.before is None else f"{_shown(marker.before)} → "
        return f"{before}{_shown(marker.after)}{unit}"
    if marker.kind == "fault":
        texts = {fault.word: fault.text for fault in Fault}
        return texts.get(marker.name, marker.name)
    if marker.kind == "contact":
        words = {contact.word: contact.text for contact in Contact}
        return words.get(marker.name, marker.name)
    if marker.kind == "lost":
        texts = {loss.word: loss.text for loss in Loss}
        return texts.get(marker.name, marker.name)
    return _REASONS.get(marker.name, marker.name)


def _shown(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.9g}"


def as_json(marker: Marker) -> dict[str, object]:
    """The marker as a JSON object of the fields that it has."""
    fields = marker._asdict().items()
    return {name: value for name, value in fields if value not in ("", None)}
