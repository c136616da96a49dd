"""A wrong guidance is resisted: lane changes that the driver does not want.

Pilot drivers keep their lane under strong guidance on an empty road; the system starts
a lane change without their intending it. Once with the real system, which sees the
conflict and fades out (Table III), and once with one that never yields. Reported only:
nothing is tuned on it.

A trial has one such change, because a system that was not followed may keep wanting
another lane; each driver drives several trials with other noise and another time of
the trigger.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.controller.actuation import STRONG
from costeer.drivers.population import USUAL, Population
from costeer.loop.parameters import DT
from costeer.loop.scenario import PILOT_SEED, TrialSetup, trial_car
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import RoadParameters
from costeer.validation.pilot import UNDISPUTED
from costeer.validation.threads import in_threads

Columns = dict[str, NDArray[Any]]  # Any: as a record's

CHANGE_DURATIONS = (4.0, 6.0, 8.0)
"""Rapid, normal and gentle lane changes [s]."""

SYSTEMS = ("fades out", "never yields")
"""The real system, and one whose verdict is never inconsistent."""

TRIGGER_TIMES = (12.0, 15.0, 18.0, 21.0)
"""When the wrong lane change starts, one trial each [s]."""

AFTERWARDS = 4.0
"""How long beyond the planned change the driver is looked at [s]."""

PUSHING = 1.0
"""Guidance above this is a push, more than lane keeping asks for [N·m]."""

HOLDING = 0.2
"""The driver has overruled when the own torque stays larger so long [s]."""

YIELDED = 0.05
"""Haptic gain below which the guidance has faded out [-]."""

_SIDE = RoadParameters().overtaking_side


class Resistance(NamedTuple):
    """One duration and system, arrays of shape `(driver,)`: means over the trials.

    Attributes:
        change_duration: Of the lane change that the system starts [s].
        system: "fades out" or "never yields".
        deviation: Largest lateral distance towards the wrong lane from the place at
            the trigger [m].
        peak_torque: Largest of the driver [N·m].
        time_to_overrule: From the trigger until the driver's torque has opposed the
            pushing guidance and been larger for 0.2 s, when that began [s]; over the
            trials in which it did, NaN if in none.
        overruled: Share of the trials in which it did [-].
        crossed_line: Share of the trials in which a wheel crossed the line [-].
        least_gain: Smallest haptic gain [-].
        fading_time: From the trigger until the gain is below 0.05 [s]; over the
            trials in which it is, NaN if in none.
    """

    change_duration: Real
    system: str
    deviation: NDArray[np.float64]
    peak_torque: NDArray[np.float64]
    time_to_overrule: NDArray[np.float64]
    overruled: NDArray[np.float64]
    crossed_line: NDArray[np.float64]
    least_gain: NDArray[np.float64]
    fading_time: NDArray[np.float64]


class ResistanceRow(NamedTuple):
    """One quantity of one duration and system over the population.

    Attributes:
        change_duration: [s].
        system: "fades out" or "never yields".
        quantity: What it is.
        unit: Its unit.
        percentiles: 5, 50 and 95 % of the drivers, NaN if none has it.
        mean: Over the drivers that have it.
        num_drivers: How many have it.
    """

    change_duration: Real
    system: str
    quantity: str
    unit: str
    percentiles: tuple[Real, Real, Real]
    mean: Real
    num_drivers: int


QUANTITIES = {
    "deviation": ("largest deviation to the wrong side", "m"),
    "peak_torque": ("peak driver torque", "N·m"),
    "time_to_overrule": ("time to overrule", "s"),
    "overruled": ("wrong changes overruled", "-"),
    "crossed_line": ("wrong changes with a wheel over the line", "-"),
    "least_gain": ("smallest haptic gain", "-"),
    "fading_time": ("time until the gain is below 0.05", "s"),
}
"""What a row is called, and its unit, by field of `Resistance`."""


def wrong_change(
    seed: int,
    participant: int,
    change_duration: Real,
    system: str,
    trial: int,
    population: Population = USUAL,
) -> TrialSetup:
    """A trial with one lane change that the driver does not want.

    Both systems meet the same driver, of this population, with the same noise.

    Raises:
        ValueError: If the system is not known.
    """
    if system not in SYSTEMS:
        known = " or ".join(SYSTEMS)
        raise ValueError(f"system '{system}' is not known; choose {known}")
    trigger = TRIGGER_TIMES[trial]
    setup = TrialSetup(
        participant=participant,
        seed=seed,
        driver=population.name,
        condition=f"pilot-wrong-change-{trial}",
        strength_factor=STRONG,
        change_duration=change_duration,
        intention="off",
        events=False,
        trigger_times=(trigger,),
    )
    # A driver may be a tenth slower or faster than the speed that is suggested.
    longest = 1.3 * (trigger + change_duration + AFTERWARDS)
    setup = setup._replace(length=setup.speed * longest)
    if system == "never yields":
        return setup._replace(parameters=UNDISPUTED)
    return setup


def answer(columns: Columns, setup: TrialSetup) -> dict[str, Real]:
    """What one driver did in one trial, by field of `Resistance`.

    Args:
        columns: Of the trial's record.
        setup: With the trigger's time.
    """
    (trigger,) = setup.trigger_times
    first = round(trigger / DT)
    rows = slice(first, first + round((setup.change_duration + AFTERWARDS) / DT))
    across = _SIDE * columns["lateral_position"][rows]
    driver = -_SIDE * columns["driver_torque"][rows]
    push = _SIDE * columns["applied_torque"][rows]
    gain = columns["haptic_gain"][rows]
    overruled = time_to_overrule(driver, push)
    line = RoadParameters().lane_width / 2.0 - trial_car(setup).width / 2.0
    return {
        "deviation": float(across.max() - across[0]),
        "peak_torque": float(np.abs(driver).max()),
        "time_to_overrule": overruled,
        "overruled": float(np.isfinite(overruled)),
        "crossed_line": float(across.max() > line),
        "least_gain": float(gain.min()),
        "fading_time": _first(gain < YIELDED),
    }


def time_to_overrule(driver: NDArray[np.float64], push: NDArray[np.float64]) -> Real:
    """When the driver begins to outweigh the push for `HOLDING` on end [s].

    The guidance must push then; once it does, the driver wins also if it gives way.

    Args:
        driver: Torque of the driver towards the own lane, from the trigger on [N·m].
        push: Applied guidance towards the wrong lane, same samples [N·m].

    Returns:
        From the first sample; NaN if the driver never does.
    """
    wins = (driver > push) & (driver > 0.0)
    length = round(HOLDING / DT)
    lasting = np.convolve(wins, np.ones(length))[length - 1 :] > length - 0.5
    return _first(lasting & (push > PUSHING))


def _first(flags: NDArray[np.bool_]) -> Real:
    """Time of the first sample that is true [s], NaN if none is."""
    return float(flags.argmax() * DT) if flags.any() else np.nan


def _mean(values: NDArray[np.float64]) -> Real:
    """Mean of the values that are there, NaN if none is."""
    known = values[np.isfinite(values)]
    return float(known.mean()) if known.size else np.nan


def _driver_means(
    seed: int,
    participant: int,
    change_duration: Real,
    system: str,
    population: Population,
) -> list[Real]:
    """Means over one driver's trials, in the order of `QUANTITIES`."""
    setups = [
        wrong_change(seed, participant, change_duration, system, trial, population)
        for trial in range(len(TRIGGER_TIMES))
    ]
    given = [answer(simulate_trial(setup).columns, setup) for setup in setups]
    return [_mean(np.array([each[name] for each in given])) for name in QUANTITIES]


def resist(
    seed: int = PILOT_SEED,
    num_drivers: int = 40,
    jobs: int = 2,
    progress: Callable[[int], None] | None = None,
    population: Population = USUAL,
) -> list[Resistance]:
    """Let pilot drivers resist wrong lane changes of 4, 6 and 8 s.

    Args:
        seed: Of the drivers: that of the pilot drivers, never of a study.
        num_drivers: How many.
        jobs: Threads.
        progress: Called with the number of drivers just done, six times for each.
        population: Who is drawn from.
    """
    cells = [(time, system) for time in CHANGE_DURATIONS for system in SYSTEMS]
    tasks = [(n, *cell) for cell in cells for n in range(1, num_drivers + 1)]
    means = in_threads(
        lambda task: _driver_means(seed, *task, population), tasks, jobs, progress
    )
    table = np.array(means).reshape(len(cells), num_drivers, len(QUANTITIES))
    return [
        Resistance(time, system, *np.transpose(values))
        for (time, system), values in zip(cells, table, strict=True)
    ]


def resistance_rows(found: Sequence[Resistance]) -> list[ResistanceRow]:
    """The results as a table: a row per duration, system and quantity."""
    return [_row(each, name) for each in found for name in QUANTITIES]


def _row(found: Resistance, name: str) -> ResistanceRow:
    values = getattr(found, name)
    known = values[np.isfinite(values)]
    low, middle, high = (
        np.percentile(known, [5, 50, 95]) if known.size else [np.nan] * 3
    )
    quantity, unit = QUANTITIES[name]
    return ResistanceRow(
        change_duration=found.change_duration,
        system=found.system,
        quantity=quantity,
        unit=unit,
        percentiles=(float(low), float(middle), float(high)),
        mean=_mean(values),
        num_drivers=int(known.size),
    )
