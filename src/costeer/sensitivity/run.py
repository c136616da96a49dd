"""All samples of the factors driven by the same pilot drivers; resumable."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.files import prepare_folder, read_whole, write_text
from costeer.loop.scenario import PILOT_SEED, TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.scale.jobs import JobsStoppedError, Pool, run_jobs
from costeer.scale.shard import WHOLE, Shard, part
from costeer.scale.worker import facts
from costeer.sensitivity.factors import AIMS, DURATION, FACTORS, STRENGTH, Factor
from costeer.study.measures import lane_change_rows, trial_row

SETTINGS_FILE = "sensitivity.json"
RESULTS = "results"
CONDITION = "sensitivity"
"""Name of the condition; it picks the noise, which is the same in all samples."""

Point = tuple[float, ...]
"""A value of each factor."""

Outcome = dict[str, float]
"""Means over drivers by measure; NaN where no driver has a value."""


class Settings(NamedTuple):
    """What decides the results.

    Attributes:
        base: Samples of the factors before Saltelli's scheme; a power of two.
        drivers: Pilot drivers who drive each sample.
        length: Of the course [m]; the first leader appears at 1 km.
        seed: Of the scrambled Sobol sequence and of the intervals.
    """

    base: int = 128
    drivers: int = 4
    length: float = 4000.0
    seed: int = 1


MOST_BASE, MOST_DRIVERS = 2**16, 1000


def check_settings(settings: Settings) -> Settings:
    """Return the settings, if they can be.

    Raises:
        ValueError: Naming the first value out of range.
    """
    base = settings.base
    if not 2 <= base <= MOST_BASE or base & (base - 1):
        raise ValueError(
            f"samples is {base}; give a power of two, 2 to {MOST_BASE}, as 128: the "
            "sequence is balanced at those alone"
        )
    if not 1 <= settings.drivers <= MOST_DRIVERS:
        raise ValueError(f"drivers is {settings.drivers}; give 1 to {MOST_DRIVERS}")
    if not 1500.0 <= settings.length <= 100_000.0:
        raise ValueError(
            f"length is {settings.length:g}; give 1500 to 100000 m: the first leader "
            "appears at 1000 m"
        )
    return settings


def problem() -> dict[str, Any]:  # Any: as SALib takes it
    """The factors and their bounds."""
    return {
        "num_vars": len(FACTORS),
        "names": [each.name for each in FACTORS],
        "bounds": [[each.low, each.high] for each in FACTORS],
    }


def points(settings: Settings) -> list[Point]:
    """All samples in Saltelli's scheme: base · (factors + 2) of them."""
    from SALib.sample import sobol

    drawn = sobol.sample(
        problem(), settings.base, calc_second_order=False, seed=settings.seed
    )
    return [
        tuple(map(_value, FACTORS, row)) for row in np.asarray(drawn, float).tolist()
    ]


def _value(factor: Factor, drawn: float) -> float:
    """The value that is driven."""
    return float(round(drawn)) if factor.whole else drawn


def setup_of(settings: Settings, point: Point, participant: int) -> TrialSetup:
    """The trial of a pilot driver at a sample of the factors."""
    values = dict(zip((each.place for each in FACTORS), point, strict=True))
    return TrialSetup(
        participant=participant,
        seed=PILOT_SEED,
        condition=CONDITION,
        strength_factor=values.pop(STRENGTH),
        change_duration=values.pop(DURATION),
        length=settings.length,
        parameters=tuple(values.items()),
    )


def driven(settings: Settings, point: Point) -> Outcome:
    """Drive one sample with every pilot driver; return the means over them."""
    found: list[Outcome] = []
    for participant in range(1, settings.drivers + 1):
        record = simulate_trial(setup_of(settings, point, participant))
        row, changes = trial_row(record), lane_change_rows(record)
        found.append(
            {
                aim.name: _mean([each[aim.name] for each in changes])
                if aim.of_changes
                else _number(row[aim.name])
                for aim in AIMS
            }
        )
    return {aim.name: _mean([each[aim.name] for each in found]) for aim in AIMS}


def _number(value: Any) -> float:  # Any: of a row
    return float(value) if isinstance(value, int | float) else math.nan


def _mean(values: Sequence[Any]) -> float:
    known = [x for x in map(_number, values) if math.isfinite(x)]
    return float(np.mean(known)) if known else math.nan


def prepare(folder: Path, settings: Settings) -> str:
    """Make the folder, or find that it is of the same settings; return their hash.

    Raises:
        ValueError: If it is of others, or holds something else.
        OSError: If it cannot be written.
    """
    prepare_folder(folder, SETTINGS_FILE, "sensitivity analysis")
    content = {
        "settings": settings._asdict(),
        "factors": [each._asdict() for each in FACTORS],
        "sources": facts().sources,
    }
    text = json.dumps(content, indent=1, ensure_ascii=False)
    file = folder / SETTINGS_FILE
    if file.exists() and read_whole(file).decode() != text:
        raise ValueError(
            f"{folder} holds an analysis with other settings, factors or sources of "
            "costeer; choose another folder, or give the same"
        )
    write_text(file, text)
    (folder / RESULTS).mkdir(exist_ok=True)
    return hashlib.sha256(text.encode()).hexdigest()


def drive_all(
    folder: Path,
    settings: Settings,
    pool: Pool,
    advance: Callable[[int], None],
    work: Callable[[Point], Outcome] | None = None,
    shard: Shard = WHOLE,
) -> list[Outcome]:
    """Drive every sample that is not on disk; return the outcomes of all in order.

    Args:
        folder: Of the analysis.
        settings: Of the analysis.
        pool: Threads, or the workers of a cluster.
        advance: Called with the number of samples that are done.
        work: Drives a sample; `driven` if None.
        shard: Part of the samples; the others are neither driven nor returned.

    Raises:
        BaseException: What stopped a sample; those that are done are kept.
    """
    key = prepare(folder, settings)
    every = points(settings)
    own = part(range(len(every)), shard)
    there = {
        place: known
        for place in own
        if (known := read_outcome(folder, key, place)) is not None
    }
    advance(len(there))
    waiting = [place for place in own if place not in there]
    work = partial(driven, settings) if work is None else work

    def keep(place: int, outcome: Outcome) -> Outcome:
        _write(folder, key, place, outcome)
        return outcome

    try:
        found = run_jobs(
            partial(_at, work, every), waiting, pool, lambda _: advance(1), keep
        )
    except JobsStoppedError as stopped:
        raise (stopped.__cause__ or stopped) from None
    there |= dict(zip(waiting, found, strict=True))
    return [there[place] for place in own]


def _at(
    work: Callable[[Point], Outcome], every: Sequence[Point], place: int
) -> Outcome:
    return work(every[place])


def outcome_file(folder: Path, place: int) -> Path:
    """Where the outcome of a sample lies."""
    return folder / RESULTS / f"{place:06d}.json"


def _write(folder: Path, key: str, place: int, outcome: Outcome) -> None:
    values = {n: None if math.isnan(value) else value for n, value in outcome.items()}
    write_text(outcome_file(folder, place), json.dumps({"key": key, "values": values}))


def read_outcome(folder: Path, key: str, place: int) -> Outcome | None:
    """The outcome of a sample; None if there is none to believe."""
    try:
        content: Any = json.loads(read_whole(outcome_file(folder, place)))
        values: Mapping[str, Any] = content["values"]
        if content["key"] != key:
            return None
        return {
            aim.name: math.nan if (value := values[aim.name]) is None else float(value)
            for aim in AIMS
        }
    except (FileNotFoundError, ValueError, KeyError, TypeError):
        return None


class Index(NamedTuple):
    """A row of `indices.csv`: what share of a measure's variance a factor has.

    Attributes:
        measure: As in the tables of a study.
        factor: Name.
        first_order: Share by the factor alone [-].
        first_order_half_width: Of its 95 % interval, bootstrapped [-].
        total: Share with all that it does together with others [-].
        total_half_width: Of its 95 % interval [-].
    """

    measure: str
    factor: str
    first_order: float
    first_order_half_width: float
    total: float
    total_half_width: float


def indices_of(
    settings: Settings, measure: str, values: NDArray[np.float64]
) -> list[Index] | str:
    """Sobol indices of a measure, or why there are none.

    Args:
        settings: Of the analysis.
        measure: Its name.
        values: One for each sample, in order.
    """
    if not np.isfinite(values).all():
        missing = int((~np.isfinite(values)).sum())
        return f"{missing} of {len(values)} samples have no value"
    if float(np.ptp(values)) <= 1e-12 * max(1.0, float(np.abs(values).max())):
        return "all samples have the same value"
    from SALib.analyze import sobol

    found: Mapping[str, Any] = sobol.analyze(
        problem(),
        values,
        calc_second_order=False,
        num_resamples=1000,
        conf_level=0.95,
        seed=settings.seed,
    )
    columns = (found[name] for name in ("S1", "S1_conf", "ST", "ST_conf"))
    return [
        Index(measure, factor.name, *map(float, row))
        for factor, *row in zip(FACTORS, *columns, strict=True)
    ]
