"""Measures of one trial in a small file, for studies that keep no records.

A file is there whole or not at all, and names the study it belongs to. It holds the
cells of the trial's rows as the tables do, and what the trial's record would say of
itself in plain values. A trial that failed has one, too: its reason.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from costeer.base.files import read_whole, write_text
from costeer.records.columns import TrialRecord
from costeer.study.design import Trial
from costeer.study.folder import StudyFolder, result_path
from costeer.study.trial_tables import Row, TrialRows, cell

FORMAT = 1

_LARGEST = 50_000_000
"""No trial has as many bytes of measures."""

_OF_THE_ROAD = ("lane_width", "num_lanes", "overtaking_side")
"""What measures and report take from a record's configuration."""


class TrialResult(NamedTuple):
    """What is kept of a trial without a record.

    Attributes:
        rows: Of the tables, cells as texts; None if it failed.
        driver_seconds: Its length [s].
        about: What its record would say of itself.
        failure: Why it failed; empty if it did not.
    """

    rows: TrialRows | None
    driver_seconds: float
    about: Mapping[str, Any]  # as JSON gives it back
    failure: str


def description(record: TrialRecord) -> dict[str, Any]:  # Any: of JSON
    """What a record says of its trial in plain values, and the road's lanes."""
    told: dict[str, Any] = {
        name: value
        for name, value in record.metadata.items()
        if value is None or isinstance(value, str | int | float | bool)
    }
    configuration = record.metadata.get("configuration")
    road = configuration.get("road") if isinstance(configuration, Mapping) else None
    if isinstance(road, Mapping):
        lanes = {name: road[name] for name in _OF_THE_ROAD if name in road}
        told["configuration"] = {"road": lanes}
    return told


def write_result(folder: StudyFolder, trial: Trial, result: TrialResult) -> None:
    """Write the result of a trial, whole or not at all.

    Raises:
        OSError: If it cannot be written.
    """
    content = {
        "format": FORMAT,
        "study_hash": folder.hash,
        "participant": trial.participant,
        "condition": trial.condition,
        "failure": result.failure,
        "driver_seconds": result.driver_seconds,
        "about": result.about,
        **cells_of(result.rows),
    }
    file = result_path(folder.path, trial.participant, trial.condition)
    file.parent.mkdir(exist_ok=True)
    write_text(file, json.dumps(content, ensure_ascii=False, separators=(",", ":")))


def cells_of(rows: TrialRows | None) -> dict[str, Any]:
    """The cells of a trial's rows by table, as the tables have them."""
    return {
        "measures": _table([] if rows is None else [rows.measures]),
        "lane_changes": _table(() if rows is None else rows.lane_changes),
        "triggers": _table(() if rows is None else rows.triggers),
        "scenario": _table(() if rows is None else rows.scenario),
    }


def _table(rows: Sequence[Row]) -> dict[str, list[Any]]:
    names = list(rows[0]) if rows else []
    cells = [[cell(row[name]) for name in names] for row in rows]
    return {"columns": names, "cells": cells}


def read_result(folder: StudyFolder, trial: Trial) -> TrialResult | None:
    """Return the result of a trial; None if there is none to believe.

    Raises:
        OSError: If it is there and cannot be read.
    """
    file = result_path(folder.path, trial.participant, trial.condition)
    try:
        content = json.loads(read_whole(file, _LARGEST))
        wanted = FORMAT, folder.hash, trial.participant, trial.condition
        names = "format", "study_hash", "participant", "condition"
        if tuple(content[name] for name in names) != wanted:
            return None
        return _result(content)
    except FileNotFoundError:
        return None
    except (ValueError, KeyError, TypeError, IndexError, AttributeError):
        return None  # cut short, or damaged


def _result(content: Mapping[str, Any]) -> TrialResult:
    failure = str(content["failure"])
    rows = TrialRows(
        measures={} if failure else _rows(content["measures"])[0],
        lane_changes=_rows(content["lane_changes"]),
        triggers=_rows(content["triggers"]),
        scenario=_rows(content["scenario"]),
    )
    return TrialResult(
        rows=None if failure else rows,
        driver_seconds=float(content["driver_seconds"]),
        about=dict(content["about"]),
        failure=failure,
    )


def _rows(table: Mapping[str, Any]) -> list[Row]:
    names = table["columns"]
    return [dict(zip(names, cells, strict=True)) for cells in table["cells"]]


def remove_result(folder: StudyFolder, trial: Trial) -> None:
    """Remove the result of a trial that has a record now."""
    result_path(folder.path, trial.participant, trial.condition).unlink(missing_ok=True)
