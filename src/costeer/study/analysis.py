"""Measures of a file: a trial record, or any table with some of its columns."""

import os
from collections.abc import Iterable, Mapping
from math import isnan
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from costeer.records.adaptation import AS_IT_IS, Adaptation
from costeer.records.columns import TrialRecord
from costeer.records.contradictions import Lanes, contradictions, lanes_of, unwrapped
from costeer.records.plausible import unit_doubts
from costeer.records.record import read_noted
from costeer.records.tables import AS_FOUND, Reading
from costeer.study.definitions import DEFAULTS, Columns, Measure, MeasureParameters
from costeer.study.gaps import bridged
from costeer.study.measures import Row, lane_change_rows, parameters_of, prepared
from costeer.study.recordings import Stretch, stretches
from costeer.study.rounding import rounding
from costeer.study.sampling import EVEN_ENOUGH, Sampling, evened, sampling
from costeer.study.scenario import Surroundings, surroundings
from costeer.study.scenario_measures import (
    change_surroundings,
    has_surroundings,
    surrounding_measures,
    zone_measures,
)
from costeer.study.trial_measures import Trial, trial_measures

_TOO_SLOW = 6.0  # [Hz]: ten samples per period of the reversal rate's low-pass


class Analysis(NamedTuple):
    """What a recording, or one stretch of it, gave.

    Attributes:
        source: File it came from.
        sequence: Name of the stretch; empty if the file is one.
        num_rows: Samples.
        sampling: Rate and regularity.
        measures: By name as in `trials.csv`, and of other cars, curves and contacts
            where the recording tells of any; those without a value say why.
        lane_changes: Rows as in `lane_changes.csv`, with lanes and accepted gaps where
            there are other cars or curves.
        notes: What the reader should know before trusting the numbers.
        doubts: Those of the notes that name what looks wrong in the file.
        zones: Measures of each zone of the scenario, by its name.
    """

    source: str
    sequence: str
    num_rows: int
    sampling: Sampling
    measures: dict[str, Measure]
    lane_changes: list[Row]
    notes: tuple[str, ...]
    doubts: tuple[str, ...] = ()
    zones: Mapping[str, dict[str, Measure]] = MappingProxyType({})


def analyse_file(
    path: str | os.PathLike[str],
    adaptation: Adaptation = AS_IT_IS,
    parameters: MeasureParameters = DEFAULTS,
    reading: Reading = AS_FOUND,
) -> list[Analysis]:
    """Measure every stretch of a file.

    Args:
        path: Trial record, CSV, Parquet or Arrow, gzipped or not.
        adaptation: Names, units and stretches of a foreign table.
        parameters: Thresholds of the measures.
        reading: How to read a text.

    Raises:
        ValueError: If the file cannot be understood or is sampled too irregularly.
        OSError: If it cannot be read.
    """
    recording, notes = read_noted(path, reading)
    try:
        found = analyse(recording, adaptation, parameters, source=str(path))
    except ValueError as error:
        raise ValueError("; ".join([f"{path}: {error}", *notes])) from error
    return [each._replace(notes=(*notes, *each.notes)) for each in found]


def analyse(
    recording: TrialRecord,
    adaptation: Adaptation = AS_IT_IS,
    parameters: MeasureParameters = DEFAULTS,
    source: str = "",
) -> list[Analysis]:
    """Measure every stretch of a recording; see `analyse_file`."""
    parameters = parameters_of(recording, parameters)
    lanes = lanes_of(recording.metadata)
    parts = stretches(recording.columns, adaptation, lanes)
    return [_analysed(recording, part, parameters, source) for part in parts]


def _analysed(
    recording: TrialRecord, part: Stretch, parameters: MeasureParameters, source: str
) -> Analysis:
    part, doubts, notes = _mended(part, parameters)
    found = _sampling(part)
    even = recording._replace(columns=dict(evened(part.columns, found)))
    trial, around = prepared(even, parameters), surroundings(recording)
    measures = trial_measures(trial)
    changes = lane_change_rows(even, parameters)
    if has_surroundings(even.columns):
        measures |= surrounding_measures(trial, around)
        changes = _with_gaps(trial, around, changes)
    return Analysis(
        source=source,
        sequence=part.name,
        num_rows=int(part.columns["time"].size),
        sampling=found,
        measures=measures,
        lane_changes=changes,
        notes=(
            *part.notes,
            *doubts,
            *notes,
            *_notes(even.columns, found, measures, part.ignored),
        ),
        doubts=tuple(doubts),
        zones={zone.name: zone_measures(trial, around, zone) for zone in around.zones},
    )


def _with_gaps(trial: Trial, around: Surroundings, changes: list[Row]) -> list[Row]:
    """Rows of lane changes with their lanes and the gaps that were accepted."""
    if isinstance(trial.segments, str):
        return changes
    more = [
        change_surroundings(trial, around, change) for change in trial.segments.changes
    ]
    return [
        row | {name: each.value for name, each in found.items()}
        for row, found in zip(changes, more, strict=True)
    ]


def _mended(
    part: Stretch, parameters: MeasureParameters
) -> tuple[Stretch, list[str], list[str]]:
    """A stretch whose yaw is unwrapped and whose short gaps are bridged.

    Returns:
        Beside it what looks wrong in it, and notes on its gaps.
    """
    _sampling(part)
    columns, told = unwrapped(part.columns)
    lanes = Lanes(parameters.lane_width, int(parameters.num_lanes))
    doubts = [*told, *contradictions(columns, lanes)]
    doubts += unit_doubts(columns)
    columns, gaps = bridged(columns)
    return part._replace(columns=columns), doubts, gaps


def _sampling(part: Stretch) -> Sampling:
    try:
        return sampling(part.columns["time"])
    except ValueError as error:
        name = f"sequence {part.name}: " if part.name else ""
        raise ValueError(f"{name}{error}") from error


def _notes(
    columns: Columns,
    found: Sampling,
    measures: dict[str, Measure],
    ignored: Iterable[str],
) -> list[str]:
    notes = []
    if found.unevenness > EVEN_ENOUGH:
        notes.append(
            f"unevenly sampled, steps up to {found.longest_step:.3g} s: interpolated "
            f"to {found.rate:.4g} samples per second"
        )
    if found.rate < _TOO_SLOW:
        notes.append(
            f"{found.rate:.3g} samples per second are few for a reversal rate; "
            f"give {_TOO_SLOW:g}"
        )
    if not measures["swrr"].reason and measures["sdlp"].reason:
        notes.append("swrr is of the whole recording, as lane keeping is not known")
    if not measures["sdlp"].reason and "event" not in columns:
        notes.append("there is no column event, so no overtaking events are left out")
    step = rounding(columns.get("lateral_position", np.zeros(2)))
    if step > 0.0:
        notes.append(
            f"lateral_position is rounded to {step:.3g} m: its rate is taken over "
            "several steps"
        )
    if any(ignored):
        notes.append(f"columns not used: {', '.join(ignored)}")
    return notes


def as_json(analyses: Iterable[Analysis]) -> list[dict[str, object]]:
    """The analyses in JSON's own types; what is not known is null and says why."""
    return [
        {
            "source": each.source,
            "sequence": each.sequence,
            "num_rows": each.num_rows,
            "sampling": each.sampling._asdict(),
            "measures": {k: _measure(v) for k, v in each.measures.items()},
            "zones": {
                name: {k: _measure(v) for k, v in found.items()}
                for name, found in each.zones.items()
            },
            "lane_changes": [_plain_row(row) for row in each.lane_changes],
            "notes": list(each.notes),
        }
        for each in analyses
    ]


def _measure(measure: Measure) -> dict[str, object]:
    return {
        "value": _plain(measure.value),
        "unit": measure.unit,
        **({"reason": measure.reason} if measure.reason else {}),
    }


def _plain_row(row: Row) -> dict[str, object]:
    return {name: _plain(value) for name, value in row.items()}


def _plain(value: object) -> object:
    """The value without numpy, NaN and infinity as None."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and (isnan(value) or np.isinf(value)):
        return None
    return value
