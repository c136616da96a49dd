"""How much drivers differ from each other, and each of them from time to time.

A value is the population's mean, plus what a driver adds, plus chance. Variance
components are those of the one-way analysis with drivers as random effect, by the
method of moments for groups of different sizes (Searle, Casella and McCulloch 1992,
*Variance Components*, section 3.6).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.validation.manual import ManualDriving, rows_of
from costeer.validation.targets import (
    CHANGES,
    MEASURES,
    Measure,
    target_statistic,
)

Values = NDArray[np.float64]

RESAMPLES = 1000
_SEED = 20_230_917
"""Of the resampling of drivers, so that the same driving gives the same interval."""


class Components(NamedTuple):
    """Standard deviations of the two parts of a value.

    Attributes:
        between: Of what drivers add; 0 where chance alone explains their differences.
        within: Of chance within a driver.
    """

    between: Real
    within: Real


class TargetSpread(NamedTuple):
    """How certain and how personal the value of one target is, in its unit.

    Attributes:
        name: M1 to M12.
        low: Of the 95 % interval of the value, drivers resampled.
        high: Of the same.
        between: Standard deviation between drivers.
        within: Standard deviation within drivers.
        retest: Correlation of drivers' values in two trials [-].
    """

    name: str
    low: Real
    high: Real
    between: Real
    within: Real
    retest: Real


def components(groups: Sequence[Values]) -> Components:
    """Variance components of values by driver.

    Args:
        groups: Values of each driver, shape `(value,)` each; drivers without any do
            not count.

    Returns:
        NaN where no two drivers have values or none has two.
    """
    filled = [group for group in groups if group.size]
    sizes = np.array([group.size for group in filled], dtype=np.float64)
    total, amount = float(sizes.sum()), len(filled)
    if amount < 2 or total <= amount:
        return Components(math.nan, math.nan)
    means = np.array([group.mean() for group in filled])
    grand = float(np.concatenate(filled).mean())
    inside = sum(float(((g - g.mean()) ** 2).sum()) for g in filled) / (total - amount)
    among = float((sizes * (means - grand) ** 2).sum()) / (amount - 1)
    usual_size = (total - float((sizes**2).sum()) / total) / (amount - 1)
    between = max(0.0, among - inside) / usual_size
    return Components(math.sqrt(between), math.sqrt(inside))


def correlation(first: Values, second: Values) -> Real:
    """Pearson's correlation of pairs that are both known; NaN under three pairs.

    Args:
        first: Shape `(driver,)`.
        second: Shape `(driver,)`.
    """
    known = np.isfinite(first) & np.isfinite(second)
    one, two = first[known], second[known]
    if one.size < 3 or not (np.ptp(one) > 0.0 and np.ptp(two) > 0.0):
        return math.nan
    return float(np.corrcoef(one, two)[0, 1])


def by_driver(driving: ManualDriving, measure: Measure) -> list[Values]:
    """Known values of a measure, those of each driver together, in the table's unit.

    Returns:
        As many as there are trials, in their order; empty where a driver has none.
    """
    own: dict[object, list[Real]] = {t["participant"]: [] for t in driving.trials}
    for row in rows_of(driving, measure):
        own[row["participant"]].append(float(row[measure.column]))
    found = [np.array(values, dtype=np.float64) for values in own.values()]
    return [values[np.isfinite(values)] for values in found]


def driver_values(driving: ManualDriving, measure: Measure) -> Values:
    """One value of each driver as printed, NaN without any, shape `(driver,)`.

    Shares are means, else it is the median of what the driver did.
    """
    reduce = np.mean if measure.statistic == "mean" else np.median
    return np.array(
        [
            measure.factor * float(reduce(own)) if own.size else math.nan
            for own in by_driver(driving, measure)
        ]
    )


def target_spreads(driving: ManualDriving, again: ManualDriving) -> list[TargetSpread]:
    """Intervals, components and test-retest correlations of all targets.

    What is measured once per lane change has its components from the lane changes of
    the first trial; what is measured once per trial from the two trials.

    Args:
        driving: First manual trials.
        again: Second ones of the same drivers with other noise.
    """
    return [_spread(name, driving, again) for name in MEASURES]


def _spread(name: str, driving: ManualDriving, again: ManualDriving) -> TargetSpread:
    measure = MEASURES[name]
    first, second = (by_driver(each, measure) for each in (driving, again))
    pairs = zip(first, second, strict=True)
    groups = first if measure.table == CHANGES else [np.concatenate(p) for p in pairs]
    parts = components(groups)
    low, high = interval(measure, first)
    return TargetSpread(
        name=name,
        low=low,
        high=high,
        between=measure.factor * parts.between,
        within=measure.factor * parts.within,
        retest=correlation(
            driver_values(driving, measure), driver_values(again, measure)
        ),
    )


def interval(measure: Measure, groups: Sequence[Values]) -> tuple[Real, Real]:
    """95 % interval of a target's value, whole drivers resampled with replacement.

    Args:
        measure: Of the target.
        groups: Values of each driver.

    Returns:
        NaN with fewer than three drivers.
    """
    if len(groups) < 3:
        return math.nan, math.nan
    generator = np.random.Generator(np.random.PCG64(_SEED))
    drawn = generator.integers(len(groups), size=(RESAMPLES, len(groups)))
    found = [
        target_statistic(measure, np.concatenate([groups[k] for k in places]))
        for places in drawn.tolist()
    ]
    low, high = np.nanpercentile(found, [2.5, 97.5])
    return float(low), float(high)
