"""A plain folder of drive records with pseudonyms, as `costeer drive` leaves them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from costeer.methods.conditions import CONDITION_NAMES
from costeer.records.record import read_record
from costeer.study.folder import RECORDS, STUDY_FILE
from costeer.study.people import Drive, Exclusion, People, in_order, people_study

_TRACE = ".wheel.parquet"
_Metadata = dict[str, Any]
"""Any: as JSON gives it back."""


def people_of_records(folder: Path) -> People:
    """The drives of a folder of records, or of its folder `records`.

    Participant and condition are those that the records say. A record that cannot be
    read is named in the log of exclusions.

    Args:
        folder: That holds the records; the report is written into it.

    Raises:
        ValueError: If there is no record, a record says no participant or no condition
            of Table IV, or two claim the same cell.
        OSError: If a file cannot be read.
    """
    drives, unread, about = [], [], []
    for file in _files(folder):
        try:
            metadata = read_record(file, ()).metadata
        except ValueError as error:
            unread.append(Exclusion("", "", "", "", "unreadable", str(error)))
            continue
        drives.append(_drive(file, metadata))
        about.append(metadata)
    if not drives:
        raise ValueError(
            f"{folder} has no trial record that can be read: {_told(unread)}"
        )
    ordered = in_order(_in_time(drives, about))
    study = people_study(folder, _configuration(ordered, about))
    return People(study, ordered, (*unread, *_missing(ordered)))


def _files(folder: Path) -> list[Path]:
    """Records of the folder; those of its folder `records` if it has none.

    Raises:
        ValueError: If there is none.
    """
    for place in (folder, folder / RECORDS):
        found = [f for f in sorted(place.glob("*.parquet")) if not _is_trace(f)]
        if found:
            return found
    raise ValueError(
        f"{folder} is not a study folder: it has no {STUDY_FILE}, no session and no "
        "trial records (*.parquet)"
    )


def _is_trace(file: Path) -> bool:
    return file.name.endswith(_TRACE)


def _told(unread: list[Exclusion]) -> str:
    return unread[0].reason if unread else "it is empty"


def _drive(file: Path, metadata: _Metadata) -> Drive:
    """The trial that a record says it is.

    Raises:
        ValueError: If it says no participant, or no condition of Table IV.
    """
    who, condition = metadata.get("participant"), metadata.get("condition")
    if who is None or not str(who).strip():
        raise ValueError(
            f"{file} says no participant; record with --participant P01, or move it "
            "out of the folder"
        )
    if condition not in CONDITION_NAMES:
        raise ValueError(
            f"{file} is of condition {condition!r}, which is none of "
            f"{', '.join(CONDITION_NAMES)}; move it out of the folder"
        )
    return Drive(str(who).strip(), str(condition), file)


def _in_time(drives: list[Drive], about: list[_Metadata]) -> list[Drive]:
    """The drives with their places, for participants whose records all have a date."""
    began = {
        d.record: str(m.get("started_at") or "")
        for d, m in zip(drives, about, strict=True)
    }
    undated = {each.participant for each in drives if not began[each.record]}
    places: Counter[str] = Counter()
    ordered = []
    for each in sorted(drives, key=lambda each: began[each.record]):
        places[each.participant] += 1
        known = each.participant not in undated
        ordered.append(each._replace(order=places[each.participant] if known else None))
    return ordered


def _missing(drives: Iterable[Drive]) -> list[Exclusion]:
    """Conditions that somebody drove and a participant did not."""
    there = {(each.participant, each.condition) for each in drives}
    people = dict.fromkeys(who for who, _ in sorted(there))
    driven = [name for name in CONDITION_NAMES if any(c == name for _, c in there)]
    return [
        Exclusion(who, "", name, "", "missing", "there is no record of it")
        for who in people
        for name in driven
        if (who, name) not in there
    ]


def _configuration(drives: Iterable[Drive], about: list[_Metadata]) -> dict[str, Any]:
    """What the records agree on, for the report."""
    names = {each.condition for each in drives}
    configuration: dict[str, Any] = {
        "participants": len({each.participant for each in drives}),
        "conditions": [name for name in CONDITION_NAMES if name in names],
    }
    read: dict[str, Callable[[_Metadata], object]] = {
        "method": lambda m: m.get("method") if m.get("condition") != "manual" else None,
        "car": lambda m: m.get("car"),
        "speed": lambda m: m.get("speed"),
        "length": _course,
        "seed": lambda m: m.get("seed"),
        "intention": lambda m: m.get("intention_source"),
        "intention_model_hash": lambda m: m.get("intention_model_hash"),
    }
    for name, of in read.items():
        values = {value for each in about if (value := of(each)) is not None}
        if len(values) == 1:
            configuration[name] = values.pop()
    return configuration


def _course(metadata: _Metadata) -> float | None:
    """Length of the road [m]; None if it is not known."""
    try:
        return float(metadata["configuration"]["road"]["length"])
    except (KeyError, TypeError, ValueError):
        return None
