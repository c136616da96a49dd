"""What a trial record says of its trial, and how older records said it.

Version 1 named the kind of driver in a text only. It is read as version 2, so that
nothing else has to know the old one.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

RECORD_VERSION = 2
"""Of the description; records without a number are of version 1."""

VIRTUAL, PERSON, HANDS_OFF = "virtual", "person", "hands-off"
DRIVER_KINDS = (VIRTUAL, PERSON, HANDS_OFF)
"""Who held the wheel: a virtual driver, a person, nobody."""

ARRIVED, COLLISION, STOPPED, OUT_OF_TIME = OUTCOMES = (
    "arrived",
    "collision",
    "stopped",
    "out of time",
)
"""How a simulated trial ended; `stopped`: the car stood and did not drive on."""

METADATA_FIELDS: tuple[str, ...] = (
    "version",
    "seed",
    "participant",
    "condition",
    "strength_factor",
    "change_duration",
    "method",
    "car",
    "speed",
    "driver",
    "intention_model_hash",
    "inconsistency_threshold",
    "replan_gain",
    "torque_limit",
    "configuration",
    "configuration_hash",
    "driver_torque_source",
    "git_revision",
    "driver_kind",
    "record_version",
)
"""What every record says of its trial."""

CLOCK_FIELDS = ("started_at", "ended_at")
"""When a person drove, in UTC as ISO 8601. A simulated trial has no date: it would not
be the same bytes again."""

_LARGEST = 1e15
"""No number of a description is larger. Source: assumed, far beyond any."""

_UTC = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?(Z|\+00:00)")


def check_metadata(metadata: Mapping[str, object]) -> None:
    """Refuse a description that is not whole.

    Raises:
        ValueError: If a field is missing, the kind of driver is unknown, or a moment is
            not in UTC or stands in the record of a trial that no person drove.
    """
    missing = [name for name in METADATA_FIELDS if name not in metadata]
    if missing:
        raise ValueError(f"missing metadata fields: {', '.join(missing)}")
    if metadata["record_version"] != RECORD_VERSION:
        raise ValueError(
            f"record_version is {metadata['record_version']!r}; records are written "
            f"as {RECORD_VERSION}"
        )
    kind = metadata["driver_kind"]
    if kind not in DRIVER_KINDS:
        raise ValueError(
            f"driver_kind is {kind!r}; choose from {', '.join(DRIVER_KINDS)}"
        )
    for name in CLOCK_FIELDS:
        if metadata.get(name) is not None:
            _check_moment(name, metadata[name], kind == PERSON)


def _check_moment(name: str, moment: object, allowed: bool) -> None:
    """Refuse a moment that is not UTC, or in the record of a simulated trial."""
    if not allowed:
        raise ValueError(
            f"{name} is given for a trial that no person drove; leave it out, so that "
            "the same trial gives the same bytes"
        )
    if not _UTC.fullmatch(str(moment)):
        raise ValueError(
            f"{name} is {moment!r}; give a moment in UTC, as 2026-01-31T09:30:00+00:00"
        )


_NUMBERS = (
    "strength_factor",
    "change_duration",
    "speed",
    "inconsistency_threshold",
    "replan_gain",
    "torque_limit",
)


def upgraded(metadata: object) -> dict[str, object]:
    """The description of a record of any version as one of `RECORD_VERSION`.

    Raises:
        ValueError: If it is none, or the version is not known.
    """
    if not isinstance(metadata, dict):
        raise ValueError(
            f"its description is damaged: {type(metadata).__name__} where names and "
            "values of the trial should stand; restore the file"
        )
    _check_numbers(metadata)
    version = metadata.get("record_version", 1)
    if version == RECORD_VERSION:
        return metadata
    if version != 1:
        raise ValueError(
            f"its record_version is {version!r}; this costeer reads 1 to "
            f"{RECORD_VERSION}: install a newer one"
        )
    kind = driver_kind_of(str(metadata.get("driver", "")))
    return {**metadata, "driver_kind": kind, "record_version": RECORD_VERSION}


def _check_numbers(metadata: Mapping[str, object]) -> None:
    """Refuse a description whose numbers are none that a computer calculates with."""
    for name in _NUMBERS:
        value = metadata.get(name)
        if isinstance(value, int | float) and abs(value) > _LARGEST:
            raise ValueError(
                f"its description is damaged: {name} is too large a number; "
                "restore the file"
            )


def driver_kind_of(driver: str) -> str:
    """The kind of driver that the text of a record of version 1 tells.

    Whoever is neither virtual nor hands off counts as a person: what people drove is
    neither replaced nor measured again.
    """
    kinds = (kind for kind in (VIRTUAL, HANDS_OFF) if driver.startswith(kind))
    return next(kinds, PERSON)
