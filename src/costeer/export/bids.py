"""A study as a BIDS dataset: motion for trials, beh for answers.

Source: Brain Imaging Data Structure 1.10, Motion (Jeung et al., 2024, Scientific
Data 11, 716) and Behavioral experiments.
"""

from __future__ import annotations

import io
import json
import re
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from costeer.base.files import write_text
from costeer.export.markers import markers_of
from costeer.export.matlab import coded
from costeer.export.mcap import finite
from costeer.records.columns import COLUMNS, Column, TrialRecord
from costeer.records.record import read_record
from costeer.runtime.markers import told
from costeer.study.trial_tables import cell

BIDS_VERSION = "1.10.0"
RATE = 60.0
"""Rows of a record per second [Hz]."""

Rows = Sequence[Mapping[str, Any]]
"""Rows of a table by column; Any: cells."""


class BidsTrial(NamedTuple):
    """A trial of a dataset.

    Attributes:
        participant: Pseudonym.
        name: Of the trial among the participant's: names the task.
        record: Its file.
        files: What is kept of it in `sourcedata`: record, trace of the wheel.
    """

    participant: str
    name: str
    record: Path
    files: tuple[Path, ...]


class BidsTable(NamedTuple):
    """A table with what its columns are.

    Attributes:
        rows: By column.
        about: `{column: {"Description": ..., "Units": ...}}`.
    """

    rows: Rows
    about: Mapping[str, Mapping[str, str]]


class BidsStudy(NamedTuple):
    """What a dataset is made of.

    Attributes:
        name: Title of the study.
        version: Of costeer.
        readme: Text of README.
        participants: Rows with `participant`, for `participants.tsv`.
        answers: Rows with `participant`, in long form.
        trials: In the order of the tables.
        tables: CSV files that are kept under `derivatives`.
    """

    name: str
    version: str
    readme: str
    participants: BidsTable
    answers: BidsTable
    trials: Sequence[BidsTrial]
    tables: Sequence[Path]


def write_bids(study: BidsStudy, out: Path) -> None:
    """Write a dataset into a folder.

    Args:
        study: What it is made of.
        out: An empty folder.

    Raises:
        ValueError: If a record cannot be read, or a pseudonym is no label.
        OSError: If a file cannot be read or written.
    """
    _write_json(out / "dataset_description.json", _description(study, "raw"))
    write_text(out / "README", study.readme)
    _write_participants(study, out)
    for trial in study.trials:
        _write_trial(trial, out)
    for participant in dict.fromkeys(row["participant"] for row in study.answers.rows):
        _write_answers(study.answers, str(participant), out)
    derived = out / "derivatives" / "costeer"
    for table in study.tables:
        derived.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(table, derived / table.name)
    if study.tables:
        about = _description(study, "derivative")
        _write_json(derived / "dataset_description.json", about)


def _description(study: BidsStudy, kind: str) -> dict[str, object]:
    return {
        "Name": study.name,
        "BIDSVersion": BIDS_VERSION,
        "DatasetType": kind,
        "GeneratedBy": [{"Name": "costeer", "Version": study.version}],
    }


def label(text: str) -> str:
    """A label: letters and digits alone, as `strongRapid`.

    Raises:
        ValueError: If nothing is left.
    """
    first, *rest = re.split(r"[^A-Za-z0-9]+", text)
    found = first + "".join(word[:1].upper() + word[1:] for word in rest)
    if not found:
        raise ValueError(f"{text!r} cannot be a label of BIDS; use letters and digits")
    return found


def _stem(participant: str, condition: str) -> str:
    return f"sub-{label(participant)}_ses-01_task-{label(condition)}"


def _room(out: Path, participant: str, name: str) -> Path:
    room = out / f"sub-{label(participant)}" / "ses-01" / name
    room.mkdir(parents=True, exist_ok=True)
    return room


def _write_participants(study: BidsStudy, out: Path) -> None:
    rows = [
        {"participant_id": f"sub-{label(str(row['participant']))}"}
        | {name: value for name, value in row.items() if name != "participant"}
        for row in study.participants.rows
    ]
    names = list(study.participants.about)
    write_tsv(out / "participants.tsv", rows, ["participant_id", *names])
    _write_json(out / "participants.json", study.participants.about)


def _write_answers(answers: BidsTable, participant: str, out: Path) -> None:
    stem = (
        _room(out, participant, "beh") / f"{_stem(participant, 'questionnaires')}_beh"
    )
    own = [row for row in answers.rows if row["participant"] == participant]
    write_tsv(stem.with_suffix(".tsv"), own, list(answers.about))
    about = {"TaskName": "questionnaires", **answers.about}
    _write_json(stem.with_suffix(".json"), about)


def _write_trial(trial: BidsTrial, out: Path) -> None:
    record = read_record(trial.record)
    room = _room(out, trial.participant, "motion")
    stem = _stem(trial.participant, trial.name)
    tracked = f"{stem}_tracksys-wheel"
    declared = [
        c for c in (*COLUMNS, *record.method_columns) if c.name in record.columns
    ]
    _write_motion(room / f"{tracked}_motion.tsv", record, declared)
    _write_json(room / f"{tracked}_motion.json", _sidecar(trial, record, declared))
    write_tsv(
        room / f"{tracked}_channels.tsv",
        [_channel(column) for column in declared],
        list(_channel(declared[0])),
    )
    events = [
        {
            "onset": each.time,
            "duration": None,
            "trial_type": each.kind,
            "value": told(each),
        }
        for each in markers_of(record.metadata)
    ]
    if events:
        write_tsv(room / f"{stem}_events.tsv", events, list(events[0]))
        _write_json(room / f"{stem}_events.json", _EVENTS)
    kept = out / "sourcedata" / f"sub-{label(trial.participant)}"
    kept.mkdir(parents=True, exist_ok=True)
    for file in trial.files:
        shutil.copyfile(file, kept / file.name)


_EVENTS = {
    "trial_type": {
        "Description": "what happened: a pause, a changed parameter, a fault"
    },
    "value": {"Description": "the same in words"},
}


_TYPES = [
    "ACCEL",
    "ANGACCEL",
    "GYRO",
    "JNTANG",
    "LATENCY",
    "MAGN",
    "MISC",
    "ORNT",
    "POS",
    "VEL",
]
"""Types of channels that BIDS knows of motion, used here or not."""


def _sidecar(
    trial: BidsTrial, record: TrialRecord, columns: Sequence[Column]
) -> dict[str, object]:
    kinds = [_channel(column)["type"] for column in columns]
    counts = {f"{name}ChannelCount": kinds.count(name) for name in _TYPES}
    rows = next(iter(record.columns.values())).size
    about = record.metadata
    return {
        "TaskName": trial.name,
        "TaskDescription": f"Drive in condition {trial.name}",
        "SamplingFrequency": RATE,
        "TrackingSystemName": "wheel",
        "DeviceSerialNumber": "n/a",
        "SoftwareVersions": str(about.get("version")),
        "ManufacturersModelName": str(about.get("driver", "n/a")),
        "RecordingType": "continuous",
        "RecordingDuration": round(rows / RATE, 3),
        "MotionChannelCount": len(columns),
        "TrackedPointsCount": 2,
        **counts,
        "SpatialAxes": "FLU",
        "RotationRule": "right-hand",
        "RotationOrder": "ZYX",
        "MissingValues": "n/a",
        "Metadata": about,
    }


def _channel(column: Column) -> dict[str, str]:
    """What BIDS says of a channel; what is no motion is MISC."""
    kind, component, point = _MOTION.get(column.name, ("MISC", "n/a", "n/a"))
    words = column.description
    if column.labels:
        codes = (f"{place}: {word}" for place, word in enumerate(column.labels))
        words = f"{words}; {', '.join(codes)}"
    return {
        "name": column.name,
        "component": component,
        "type": kind,
        "tracked_point": point,
        "units": _UNITS.get(column.unit, column.unit),
        "sampling_frequency": f"{RATE:g}",
        "description": words,
    }


_UNITS = {"-": "n/a", "m/s²": "m/s^2", "N·m": "N*m", "N²·m²": "N^2*m^2"}

_MOTION = {
    "time": ("LATENCY", "n/a", "n/a"),
    "longitudinal_position": ("POS", "x", "car"),
    "lateral_position": ("POS", "y", "car"),
    "yaw_angle": ("ORNT", "z", "car"),
    "yaw_rate": ("GYRO", "z", "car"),
    "longitudinal_velocity": ("VEL", "x", "car"),
    "lateral_velocity": ("VEL", "y", "car"),
    "longitudinal_acceleration": ("ACCEL", "x", "car"),
    "lateral_acceleration": ("ACCEL", "y", "car"),
    "steering_wheel_angle": ("JNTANG", "x", "wheel"),
    "steering_wheel_rate": ("GYRO", "x", "wheel"),
}
"""Type, component and tracked point of what moves: the car, and the steering wheel."""


def _write_motion(file: Path, record: TrialRecord, columns: Sequence[Column]) -> None:
    """Numbers without a head, a column for each channel; texts as codes."""
    from pandas import DataFrame

    plain = {}
    for column in columns:
        values = record.columns[column.name]
        if column.labels:
            plain[column.name] = coded(values, list(column.labels))
            continue
        numbers = np.ma.getdata(values).astype(np.float64)
        numbers[np.ma.getmaskarray(values)] = np.nan
        plain[column.name] = numbers
    text = io.StringIO()
    DataFrame(plain).to_csv(
        text, sep="\t", header=False, index=False, na_rep="n/a", lineterminator="\n"
    )
    write_text(file, text.getvalue())


def write_tsv(file: Path, rows: Rows, names: Sequence[str]) -> None:
    """Write a table as BIDS has it: tabs between cells, n/a where there is nothing."""
    lines = ["\t".join(names)]
    lines += ["\t".join(_cell(row.get(name)) for name in names) for row in rows]
    write_text(file, "\n".join(lines) + "\n")


def _cell(value: object) -> str:
    """One cell; no text of people breaks the table or is run by a spreadsheet."""
    if value is None or value == "" or (isinstance(value, float) and np.isnan(value)):
        return "n/a"
    return cell(" ".join(str(value).split()) if isinstance(value, str) else value)


def _write_json(file: Path, content: Mapping[str, object]) -> None:
    text = json.dumps(finite(content), ensure_ascii=False, indent=2)
    write_text(file, f"{text}\n")
