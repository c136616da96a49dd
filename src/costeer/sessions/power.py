"""How many participants a planned study needs: a prediction by virtual drivers.

Virtual drivers drive the plan once each. Studies of different sizes are then drawn from
them with replacement and tested as the report tests: paired t-tests of each assisted
condition against manual, Benjamini-Hochberg over the conditions of a measure. How
uncertain the power is because so few drivers were simulated is told by drawing the
drivers themselves anew (bootstrap of the bootstrap).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.methods.conditions import MANUAL
from costeer.scale.jobs import default_jobs, run_jobs
from costeer.sessions.plan import Plan, Step, session_steps, trial_of
from costeer.sessions.scenarios import scenario_beside
from costeer.study.measures import lane_change_rows, trial_row
from costeer.study.statistics import MEASURES

Numbers = NDArray[np.float64]

SIZES = (6, 8, 10, 12, 16, 20, 24, 30, 36, 48)
"""Participants of the studies that are drawn."""

SIGNIFICANT = 0.05
"""Of a corrected p."""

WANTED_POWER = 0.8
"""Share of studies that find an effect, to say how many participants that takes."""

_STREAM = 5


class Power(NamedTuple):
    """What studies of a size would find of one difference.

    Attributes:
        measure: That is compared.
        condition: Label of the trial that is compared with the manual one.
        effect: Mean difference over its standard deviation, d_z [-].
        effect_low: Of its 95 % interval over the simulated drivers [-].
        effect_high: The same.
        sizes: Participants, shape `(size,)`.
        power: Share of studies that find it, shape `(size,)`.
        low: Of its 95 % interval over the simulated drivers, shape `(size,)`.
        high: The same.
    """

    measure: str
    condition: str
    effect: float
    effect_low: float
    effect_high: float
    sizes: tuple[int, ...]
    power: Numbers
    low: Numbers
    high: Numbers

    @property
    def needed(self) -> int | None:
        """Smallest size that finds it in 80 % of studies; None if none does."""
        enough = np.flatnonzero(self.power >= WANTED_POWER)
        return self.sizes[int(enough[0])] if enough.size else None


class PowerSettings(NamedTuple):
    """How much is simulated.

    Attributes:
        drivers: Virtual drivers who drive the plan.
        studies: Drawn for each size.
        redrawn: How often the drivers are drawn anew for the intervals.
        sizes: Participants of the studies.
        seed: Of drivers and draws.
        intention: `network` or `scripted`.
    """

    drivers: int = 40
    studies: int = 1000
    redrawn: int = 100
    sizes: tuple[int, ...] = SIZES
    seed: int = 1
    intention: str = "network"


def planned_power(
    plan: Plan,
    settings: PowerSettings,
    progress: Callable[[int, int], None] = lambda done, of: None,
    folder: Path = Path(),
) -> list[Power]:
    """Power of a planned study for each measure and condition.

    Each first trial of a condition is compared with the first manual one on its
    scenario; nobody learns here, so that driving again would show nothing.

    Args:
        plan: Of the study.
        settings: How much is simulated.
        progress: Is told how many trials are done, and of how many.
        folder: Of the plan and its scenarios.

    Raises:
        ValueError: If the plan drives no manual trial, or a setting cannot be.
    """
    _check(settings)
    steps = compared_steps(plan)
    measured = simulated_measures(plan, steps, settings, progress, folder)
    generator = np.random.Generator(
        np.random.PCG64(np.random.SeedSequence([settings.seed, _STREAM]))
    )
    found = []
    for measure, columns in measured.items():
        for scenario in dict.fromkeys(step.scenario for step in steps):
            own = [step for step in steps if step.scenario == scenario]
            (manual,) = [step.label for step in own if step.condition == MANUAL]
            if len(own) == 1:
                continue
            names = [step.label for step in own if step.label != manual]
            apart = np.column_stack([columns[n] - columns[manual] for n in names])
            known = np.isfinite(apart).all(axis=1)
            if known.sum() >= 3:
                found += _powers(measure, names, apart[known], settings, generator)
    return found


def compared_steps(plan: Plan) -> list[Step]:
    """First trials of each condition on scenarios where something is compared.

    Raises:
        ValueError: If there is no manual trial to compare with.
    """
    first = [each for each in session_steps(plan, 1) if each.occasion == 1]
    driven: dict[str, set[str]] = {}
    for step in first:
        driven.setdefault(step.scenario, set()).add(step.condition)
    whole = {where for where, names in driven.items() if MANUAL in names}
    compared = [each for each in first if each.scenario in whole]
    if not compared:
        raise ValueError("the plan drives no manual trial to compare with")
    return compared


def _check(settings: PowerSettings) -> None:
    """Refuse what would tell nothing.

    Raises:
        ValueError: Naming the setting.
    """
    ranges = {"drivers": (5, 2000), "studies": (100, 20_000), "redrawn": (20, 2000)}
    for name, (low, high) in ranges.items():
        value = getattr(settings, name)
        if not low <= value <= high:
            raise ValueError(f"{name} is {value}; give {low} to {high}")


def simulated_measures(
    plan: Plan,
    steps: Sequence[Step],
    settings: PowerSettings,
    progress: Callable[[int, int], None],
    folder: Path = Path(),
) -> dict[str, dict[str, Numbers]]:
    """Measures of virtual drivers: measure, label of the trial, shape `(driver,)`."""
    scenarios = [scenario_beside(step.scenario, folder) for step in steps]
    tasks = [
        trial_of(plan, step, number, scenario)._replace(
            seed=settings.seed, intention=settings.intention
        )
        for number in range(1, settings.drivers + 1)
        for step, scenario in zip(steps, scenarios, strict=True)
    ]
    done: list[Mapping[str, float]] = []

    def tell(result: Mapping[str, float]) -> None:
        done.append(result)
        progress(len(done), len(tasks))

    rows = run_jobs(_measured, tasks, default_jobs(), tell)
    names = [step.label for step in steps]
    table = np.array([[row[m.name] for m in MEASURES] for row in rows])
    shaped = table.reshape(settings.drivers, len(names), len(MEASURES))
    return {
        measure.name: {name: shaped[:, k, m] for k, name in enumerate(names)}
        for m, measure in enumerate(MEASURES)
    }


def _measured(setup: TrialSetup) -> dict[str, float]:
    """A trial's measures; of lane changes their mean."""
    record = simulate_trial(setup)
    row, changes = trial_row(record), lane_change_rows(record)
    told = {}
    for measure in MEASURES:
        if measure.per_lane_change:
            values = [_number(change.get(measure.name)) for change in changes]
            known = [value for value in values if math.isfinite(value)]
            told[measure.name] = float(np.mean(known)) if known else math.nan
        else:
            told[measure.name] = _number(row.get(measure.name))
    return told


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float | np.number) else math.nan


def _powers(
    measure: str,
    names: Sequence[str],
    differences: Numbers,
    settings: PowerSettings,
    generator: np.random.Generator,
) -> list[Power]:
    """Power of a measure for each condition.

    Args:
        measure: Its name.
        names: Of the conditions.
        differences: From manual, shape `(driver, condition)`.
        settings: How much is drawn.
        generator: Of the draws.
    """
    drivers = len(differences)
    power = np.array(
        [
            found(differences, size, settings.studies, generator)
            for size in settings.sizes
        ]
    )
    inner = max(50, settings.studies // 10)
    again, effects = [], []
    for _ in range(settings.redrawn):
        drawn = differences[generator.integers(0, drivers, drivers)]
        again.append([found(drawn, n, inner, generator) for n in settings.sizes])
        effects.append(effect_size(drawn))
    low, high = np.quantile(np.array(again), (0.025, 0.975), axis=0)
    least, most = np.quantile(np.array(effects), (0.025, 0.975), axis=0)
    own = effect_size(differences)
    return [
        Power(
            measure,
            name,
            *(float(own[k]), float(least[k]), float(most[k])),
            settings.sizes,
            power[:, k],
            low[:, k],
            high[:, k],
        )
        for k, name in enumerate(names)
    ]


def effect_size(differences: Numbers) -> Numbers:
    """d_z of each condition: mean difference over its standard deviation [-].

    Args:
        differences: Shape `(driver, condition)`.
    """
    spread = differences.std(axis=0, ddof=1)
    mean = differences.mean(axis=0)
    own: Numbers = np.divide(mean, spread, out=np.zeros_like(mean), where=spread > 0.0)
    return own


def found(
    differences: Numbers, size: int, studies: int, generator: np.random.Generator
) -> Numbers:
    """Share of studies that find each difference, shape `(condition,)`.

    Args:
        differences: Of all simulated drivers, shape `(driver, condition)`.
        size: Participants of a study.
        studies: That are drawn.
        generator: Of the draws.
    """
    drawn = differences[generator.integers(0, len(differences), (studies, size))]
    mean = drawn.mean(axis=1)
    error = drawn.std(axis=1, ddof=1) / math.sqrt(size)
    t = np.divide(mean, error, out=np.zeros_like(mean), where=error > 0.0)
    p = 2.0 * stats.t.sf(np.abs(t), size - 1)
    corrected = stats.false_discovery_control(p, axis=1, method="bh")
    share: Numbers = (corrected < SIGNIFICANT).mean(axis=0)
    return share
