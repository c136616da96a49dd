"""How well virtual drivers agree with people, measure by measure and condition."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from costeer.methods.conditions import CONDITION_NAMES
from costeer.study.material import StudyMaterial, summary
from costeer.study.outcome import SummaryRow
from costeer.study.quantities import CONFIDENCE, QUANTITIES


class AgreementRow(NamedTuple):
    """A row of `agreement.csv`: people and virtual drivers in a measure and condition.

    Attributes:
        measure: As in `trials.csv` or `lane_changes.csv`.
        condition: Of Table IV.
        n_people: Number of people.
        mean_people: Mean over people of their own means, in the measure's unit.
        low_people: Lower end of its 95 % interval.
        high_people: Upper end of it.
        n_virtual: Number of virtual drivers.
        mean_virtual: Mean over virtual drivers of their own means.
        low_virtual: Lower end of its 95 % interval.
        high_virtual: Upper end of it.
        difference: People less virtual drivers.
        difference_low: Lower end of its 95 % interval after Welch (1947).
        difference_high: Upper end of it.
        prediction_low: Lower end of the 95 % prediction interval of the virtual
            drivers for the mean of as many others as there are people.
        prediction_high: Upper end of it.
        inside: Whether the mean of people lies in it; empty where there is none.
        correlation: Pearson's r of both means over the conditions [-].
        num_conditions: Conditions that it is over.
    """

    measure: str
    condition: str
    n_people: int
    mean_people: float
    low_people: float
    high_people: float
    n_virtual: int
    mean_virtual: float
    low_virtual: float
    high_virtual: float
    difference: float
    difference_low: float
    difference_high: float
    prediction_low: float
    prediction_high: float
    inside: bool | None
    correlation: float
    num_conditions: int


def agreement(people: StudyMaterial, virtual: StudyMaterial) -> list[AgreementRow]:
    """Rows of every measure and condition of which both have a mean."""
    rows = []
    for quantity in QUANTITIES:
        both = [
            pair
            for name in CONDITION_NAMES
            if (pair := _both(people, virtual, quantity.name, name)) is not None
        ]
        r = _correlation(both)
        rows += [_row(*pair, r, len(both)) for pair in both]
    return rows


def _both(
    people: StudyMaterial, virtual: StudyMaterial, measure: str, name: str
) -> tuple[SummaryRow, SummaryRow] | None:
    found = [summary(each, measure, "condition", name) for each in (people, virtual)]
    first, second = found
    if first is None or second is None:
        return None
    known = math.isfinite(first.mean) and math.isfinite(second.mean)
    return (first, second) if known else None


def _correlation(both: list[tuple[SummaryRow, SummaryRow]]) -> float:
    """Pearson's r; NaN of fewer than three conditions or where nothing differs."""
    means = np.array([[one.mean, other.mean] for one, other in both])
    if len(both) < 3 or (np.ptp(means, axis=0) == 0.0).any():
        return math.nan
    return float(np.corrcoef(means.T)[0, 1])


def _row(
    people: SummaryRow, virtual: SummaryRow, correlation: float, num_conditions: int
) -> AgreementRow:
    half = welch_half_width((people.sd, people.n), (virtual.sd, virtual.n))
    reach = prediction_half_width(virtual.sd, virtual.n, people.n)
    difference = people.mean - virtual.mean
    return AgreementRow(
        people.measure,
        people.level,
        people.n,
        *(people.mean, people.low, people.high),
        virtual.n,
        *(virtual.mean, virtual.low, virtual.high),
        *(difference, difference - half, difference + half),
        *(virtual.mean - reach, virtual.mean + reach),
        abs(difference) <= reach if math.isfinite(reach) else None,
        correlation,
        num_conditions,
    )


def welch_half_width(first: tuple[float, int], second: tuple[float, int]) -> float:
    """Half of the 95 % interval of a difference of two means; NaN of single values.

    Args:
        first: Standard deviation and number of the first.
        second: Of the second.

    Source: Welch (1947), Biometrika 34, 28 to 35.
    """
    if min(first[1], second[1]) < 2:
        return math.nan
    parts = [sd**2 / n for sd, n in (first, second)]
    error = sum(parts)
    if error == 0.0:
        return 0.0
    spread = sum(
        p**2 / (n - 1) for p, (_, n) in zip(parts, (first, second), strict=True)
    )
    return _quantile(error**2 / spread) * math.sqrt(error)


def prediction_half_width(sd: float, n: int, num_new: int) -> float:
    """Half of the 95 % prediction interval for the mean of new values.

    Args:
        sd: Standard deviation of the values known.
        n: Their number; NaN comes out of fewer than two.
        num_new: Number of the new ones.
    """
    if n < 2:
        return math.nan
    return _quantile(n - 1.0) * sd * math.sqrt(1.0 / n + 1.0 / num_new)


def _quantile(df: float) -> float:
    from scipy.special import stdtrit

    return float(stdtrit(df, 0.5 + CONFIDENCE / 2.0))
