"""Recordings as training and judging see them, from trial records or any table.

A table has the names of the trial record, at 60 Hz: `time`, `longitudinal_velocity`
and what else there is of the six signals of Eq. (1). `sequence` marks separate
stretches, `participant` the driver, `crossing` (-1, 0, +1) the samples of crossings;
without it they follow from `lane`. tables.py says what else a table may tell or lack.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import (
    ADJACENT_LEFT,
    ADJACENT_RIGHT,
    DISTANCE,
    FEATURES,
    SAMPLE_RATE,
    WINDOW_LENGTH,
    feature_series,
    mirrored,
)
from costeer.plant.parameters import DEFAULT_CAR, CarParameters
from costeer.plant.recorded import recorded_car
from costeer.records.adaptation import AS_IT_IS, Adaptation, adapted, cleaned
from costeer.records.checks import check_time, text_told
from costeer.records.contradictions import Lanes, contradictions, lanes_of, unwrapped
from costeer.records.names import empty_told, groups, names_of
from costeer.records.plausible import unit_doubts
from costeer.records.record import TrialRecord, read_noted
from costeer.records.tables import AS_FOUND, Reading
from costeer.records.times import no_time
from costeer.training.labels import Labels, labels
from costeer.training.tables import (
    Columns,
    absent_signals,
    bend_told,
    courses,
    crossings_of,
    remarks,
    resampled,
    uneven_told,
    with_distance,
    with_side,
    with_signals,
)

_NEEDED = ("time", "longitudinal_velocity")
_RATE_TOLERANCE = 0.02


class Recording(NamedTuple):
    """One uninterrupted stretch of driving.

    Attributes:
        driver: Who drove; splits and spreads go by it.
        name: Of the stretch, for messages.
        features: Signals of Eq. (1), facing right, in their units, `(time, feature)`;
            NaN where a signal is missing.
        side: Side of the adjacent lane, -1 or +1, `(time,)`.
        crossing: All crossings, -1 or +1 at the first sample in the new lane, else 0,
            `(time,)`.
        intended: Those that the driver meant, `(time,)`.
        labels: Truth at each sample.
        notes: What the reader should know before trusting a judgement.
        absent: Names of the signals that the recording does not have.
    """

    driver: str
    name: str
    features: NDArray[np.float64]
    side: NDArray[np.int8]
    crossing: NDArray[np.int8]
    intended: NDArray[np.int8]
    labels: Labels
    notes: tuple[str, ...] = ()
    absent: tuple[str, ...] = ()


def recording(driver: str, name: str, columns: Columns) -> Recording:
    """One stretch from its columns, for a network that runs once.

    Raises:
        ValueError: If a column is missing or holds what it cannot, the rate is not 60
            Hz, or the network has to run once for each side (`runs`).
    """
    found = runs(driver, name, columns)
    if len(found) > 1:
        raise ValueError(
            f"{name} has {len(found)} runs, one for each side; give the lane (0 right, "
            "1 left) or adjacent_side (-1 right, +1 left)"
        )
    return found[0]


def runs(
    driver: str,
    name: str,
    columns: Columns,
    lanes: Lanes | None = None,
    car: CarParameters = DEFAULT_CAR,
) -> list[Recording]:
    """The recordings of a stretch: one on two lanes, else one for each side.

    Args:
        driver: Who drove.
        name: For messages.
        columns: Of the stretch, shape `(time,)` each.
        lanes: Of the road that a record says it was driven on.
        car: That a record says was driven.

    Raises:
        ValueError: If a column is missing or holds what it cannot, or the rate is not
            60 Hz.
    """
    _check(name, columns)
    columns, told = unwrapped(columns)
    columns = with_distance(columns)
    crossing, seen = crossings_of(name, columns), with_signals(columns)
    return [
        Recording(
            driver=driver,
            name=name + course.words,
            features=feature_series(seen, course.side, car),
            side=course.side,
            crossing=crossing,
            intended=_intended(crossing, course.side, columns),
            labels=labels(crossing, course.side),
            notes=(
                *(f"{name}: {each}" for each in told),
                *_contradicting(name, columns, lanes),
                *_notes(name, columns),
            ),
            absent=absent_signals(columns),
        )
        for course in courses(name, columns)
    ]


def _notes(name: str, columns: Columns) -> tuple[str, ...]:
    """What should be known before a judgement is trusted."""
    units = (f"{name}: {each}" for each in unit_doubts(columns))
    return (*units, *remarks(name, columns))


def _contradicting(
    name: str, columns: Columns, lanes: Lanes | None = None
) -> list[str]:
    """What the columns of one stretch say against each other.

    Where a table gives the side of the adjacent lane, the lanes are not those of the
    two-lane road, and positions cannot be held against them.
    """
    if lanes is None and "adjacent_side" in columns:
        columns = {key: values for key, values in columns.items() if key != "lane"}
    return [f"{name}: {each}" for each in contradictions(columns, lanes or Lanes())]


def lacking(recording: Recording, absent: Sequence[str]) -> Recording:
    """The same recording without some more of its signals."""
    known = {*recording.absent, *absent}
    return recording._replace(absent=tuple(n for n in FEATURES if n in known))


def wide_views(recording: Recording, lane_width: float = 3.5) -> list[Recording]:
    """A two-lane recording as on a road with more lanes: one run per side.

    With lanes on both sides the network runs once per side. Such a run sees the lines
    of one side only, and cars that move away from them and cross on the other side.

    Args:
        recording: Of a road with two lanes.
        lane_width: Of that road [m].

    Returns:
        The run to the right and the run to the left.
    """
    crossing, features = recording.crossing, recording.features
    views = []
    for name, side in (("right", ADJACENT_RIGHT), ("left", ADJACENT_LEFT)):
        other = recording.side != side
        seen = np.where(other[:, None], mirrored(features), features)
        distance = features[:, DISTANCE]
        seen[:, DISTANCE] = np.where(other, lane_width - distance, distance)
        sides = np.full_like(recording.side, side)
        views.append(
            recording._replace(
                name=f"{recording.name} to the {name}",
                features=seen,
                side=sides,
                intended=np.where(recording.intended == side, side, 0).astype(np.int8),
                labels=labels(crossing, sides),
            )
        )
    return views


def _intended(
    crossing: NDArray[np.int8], side: NDArray[np.int8], columns: Columns
) -> NDArray[np.int8]:
    """Crossings to the adjacent side that a virtual driver meant; of people all count.

    Others are not the business of a run that looks to one side.
    """
    before = np.concatenate([side[:1], side[:-1]])
    decided = columns.get("driver_intention")
    meant = crossing == before
    if decided is not None:
        unknown = np.ma.getmaskarray(decided)
        meant &= unknown | (np.ma.getdata(decided) == crossing)
    return np.where(meant, crossing, 0).astype(np.int8)


def _check(name: str, columns: Columns) -> None:
    _check_names(name, columns)
    _check_rate(name, columns)


def _check_names(name: str, columns: Columns) -> None:
    """Refuse a table without what every stretch needs."""
    missing = [column for column in _NEEDED if column not in columns]
    if "time" in missing:
        raise ValueError(f"{name}: {no_time(columns)}")
    if missing:
        raise ValueError(
            f"{name} has no column {', '.join(missing)}; names are those of the trial "
            "record (on the command line: --rename YOURS=NAME)"
        )
    named = ("crossing", "lane", "adjacent_side", *FEATURES)
    for column in (*_NEEDED, *(n for n in named if n in columns)):
        _check_numbers(name, column, columns[column])


def _check_rate(name: str, columns: Columns) -> None:
    """Refuse rows that do not come at 60 Hz."""
    steps = np.diff(np.asarray(columns["time"], np.float64))
    wrong = np.flatnonzero(~(np.abs(steps * SAMPLE_RATE - 1.0) < _RATE_TOLERANCE))
    if wrong.size:
        if steps[wrong[0]] <= 0.0:
            check_time(np.asarray(columns["time"], np.float64))
        raise ValueError(
            f"{name}: {steps[wrong[0]]:.6g} s lie between rows {wrong[0]} and "
            f"{wrong[0] + 1}; the network needs {SAMPLE_RATE:g} rows a second without "
            "gaps: resample (--resample), and mark separate stretches "
            "in the column 'sequence'"
        )


def _check_numbers(name: str, column: str, values: NDArray[Any]) -> None:
    if values.dtype.kind == "U":
        raise ValueError(f"{name}: {text_told(column, values)}")


def recordings_of(
    record: TrialRecord,
    name: str,
    resample: bool = False,
    told: Sequence[str] = (),
    adaptation: Adaptation = AS_IT_IS,
) -> list[Recording]:
    """The stretches of a trial record or of a table.

    Args:
        record: As `read_recording` gives it.
        name: For messages.
        resample: Bring a table of another rate to 60 Hz; a row that repeats the time
            of the row before is left out.
        told: Notes on how the file was read.
        adaptation: Names, units and stretches of a foreign table.

    Returns:
        Notes on the whole table stand with the first.

    Raises:
        ValueError: As `runs` does, or if the adaptation does not fit the table.
    """
    columns, renamed = adapted(record.columns, adaptation)
    before = [f"{name}: {each}" for each in (*told, *renamed)]
    if record.metadata:
        driver = f"{record.metadata['seed']}-{record.metadata['participant']}"
        lanes = lanes_of(record.metadata)
        columns, dropped = cleaned(columns, adaptation, lanes)
        columns = with_side(columns, record.metadata)
        before += [f"{name}: {each}" for each in dropped]
        car = recorded_car(record.metadata)
        return _with_notes(runs(driver, name, columns, lanes, car), before)
    _check_names(name, columns)
    for key in (key for key in _KEYS if key in columns):
        before += [f"{name}: {each}" for each in empty_told(key, columns[key])]
    found: list[Recording] = []
    wanted = adaptation._replace(drop_repeated=resample or adaptation.drop_repeated)
    for label, part in _stretches(name, columns):
        ready, notes = _ready(label, cleaned(part, wanted), resample)
        before += notes
        found += runs(_driver(ready, label), label, ready)
    columns, wrapped = unwrapped(columns)
    before += [f"{name}: {each}" for each in wrapped]
    notes = [*before, *_notes(name, columns), *_too_short(name, found)]
    notes += [f"{name}: {each}" for each in bend_told(columns)]
    return [r._replace(notes=() if i else tuple(notes)) for i, r in enumerate(found)]


def _ready(
    label: str, part: tuple[dict[str, NDArray[Any]], list[str]], resample: bool
) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """A stretch at 60 Hz if wanted, and what its rows, as they were, say.

    What contradicts is looked for before: the 60 Hz rows lack all but the signals.
    """
    columns, told = part
    notes = [f"{label}: {each}" for each in told]
    notes += _contradicting(label, unwrapped(columns)[0])
    if not resample:
        return columns, notes
    even = resampled(label, with_distance(columns))
    return even, [*notes, *uneven_told(label, columns)]


def _with_notes(found: list[Recording], notes: Sequence[str]) -> list[Recording]:
    """Notes on a file before those of its recordings."""
    return [
        one._replace(notes=(*notes, *one.notes)) if i == 0 else one
        for i, one in enumerate(found)
    ]


def _too_short(name: str, found: Sequence[Recording]) -> list[str]:
    """Say how many stretches give no verdict at all."""
    short = sum(len(one.side) < WINDOW_LENGTH for one in found)
    if not short:
        return []
    return [
        f"{name}: {short} of {len(found)} stretches are shorter than a window of "
        f"{WINDOW_LENGTH} rows and give no verdict"
    ]


_KEYS = ("sequence", "participant")
"""Columns that tell stretches and drivers apart."""


def _stretches(
    name: str, columns: Columns
) -> list[tuple[str, dict[str, NDArray[Any]]]]:
    """Rows of each value of `sequence`, and of each driver, in order."""
    parts = [(name, dict(columns))]
    for key in _KEYS:
        split = []
        for label, part in parts:
            found = groups(part[key]) if key in part else []
            if key == "participant" and len(found) < 2:
                found = []
            split += [
                (f"{label}:{one}", {k: v[rows] for k, v in part.items()})
                for one, rows in found
            ] or [(label, part)]
        parts = split
    return parts


def _driver(columns: Columns, otherwise: str) -> str:
    """The participant, if the table names one; else each stretch is its own driver."""
    if "participant" in columns:
        return str(names_of(columns["participant"])[0])
    return otherwise


def read_recordings(
    paths: Sequence[Path],
    resample: bool = False,
    adaptation: Adaptation = AS_IT_IS,
    reading: Reading = AS_FOUND,
) -> list[Recording]:
    """Read trial records or tables, told by their content.

    Args:
        paths: The files.
        resample: Bring tables of another rate to 60 Hz.
        adaptation: Names, units and stretches of foreign tables.
        reading: How to read a text.

    Raises:
        ValueError: If a file cannot be understood or lacks columns, naming it.
        OSError: If a file cannot be read.
    """
    found = []
    for path in paths:
        record, told = read_noted(path, reading)
        try:
            found += recordings_of(record, str(path), resample, told, adaptation)
        except ValueError as error:
            why = str(error) if str(path) in str(error) else f"{path}: {error}"
            raise ValueError("; ".join([why, *told])) from error
    return found
