"""One quantity of people beside the same of virtual drivers."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real

Values = NDArray[np.float64]

MEDIAN = "median"
MEAN = "mean"
SHARE = "share"


class RealComparison(NamedTuple):
    """What virtual drivers do beside what people did.

    Attributes:
        name: R1, R2, ...
        quantity: What it is.
        unit: Of all values.
        source: Name of the recordings.
        people: A value per lane change, window or driver, shape `(person,)`; empty
            where the recordings are absent.
        drivers: The same of virtual drivers, shape `(driver,)`.
        published: 10 %, 50 % and 90 % as printed elsewhere, NaN where nothing is.
        low: Smallest accepted `value`, NaN where it is reported only.
        high: Largest accepted `value`, NaN where it is reported only.
        statistic: "median", "mean" or "share"; a share is the mean of values that are
            0 or 100 %.
        reason: Why drivers and people may differ; may be empty.
        domain: Of driving, if the quantity depends on it; else empty.
        elsewhere: Whether the drivers are of another domain: then the range is told,
            and nobody is held to it.
    """

    name: str
    quantity: str
    unit: str
    source: str
    people: Values
    drivers: Values
    published: tuple[Real, Real, Real]
    low: Real
    high: Real
    statistic: str
    reason: str
    domain: str = ""
    elsewhere: bool = False


def known(values: Values) -> Values:
    """The values that are not NaN."""
    return values[np.isfinite(values)]


def statistic_of(values: Values, statistic: str) -> Real:
    """Median or mean of the values that are not NaN; NaN if there are none.

    Raises:
        ValueError: If the statistic is none of median, mean and share.
    """
    if statistic not in (MEDIAN, MEAN, SHARE):
        raise ValueError(
            f"statistic '{statistic}' is not known; choose {MEDIAN}, {MEAN} or {SHARE}"
        )
    finite = known(values)
    if not finite.size:
        return math.nan
    return float(np.median(finite) if statistic == MEDIAN else finite.mean())


def value(comparison: RealComparison) -> Real:
    """What the range is held against: of the virtual drivers."""
    return statistic_of(comparison.drivers, comparison.statistic)


def people_value(comparison: RealComparison) -> Real:
    """The same statistic of people; NaN without recordings."""
    return statistic_of(comparison.people, comparison.statistic)


def is_target(comparison: RealComparison) -> bool:
    """Whether there is a range to meet; others are reported only."""
    ends = math.isfinite(comparison.low) and math.isfinite(comparison.high)
    return ends and not comparison.elsewhere


def met(comparison: RealComparison) -> bool:
    """Whether the drivers' value lies in its range; false if it has none."""
    return comparison.low <= value(comparison) <= comparison.high


def missed_by(comparison: RealComparison) -> Real:
    """How far the value lies outside its range, in its unit.

    Returns:
        0 inside; NaN without a range or without a value.
    """
    here = value(comparison)
    if not is_target(comparison) or math.isnan(here):
        return math.nan
    return max(comparison.low - here, here - comparison.high, 0.0)


def percentiles(values: Values) -> tuple[Real, Real, Real]:
    """10 %, 50 % and 90 % of the values that are not NaN; NaN if there are none."""
    finite = known(values)
    if not finite.size:
        return math.nan, math.nan, math.nan
    low, middle, high = np.percentile(finite, [10, 50, 90])
    return float(low), float(middle), float(high)
