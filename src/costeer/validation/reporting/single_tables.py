"""Tables of tests of single drivers: arms, wrong guidance, stability."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.pages.numerals import NOTHING, number, percent, plural
from costeer.pages.tables import Table
from costeer.validation.arms import ArmRow, ArmTest, arm_rows
from costeer.validation.reporting.words import short
from costeer.validation.resistance import (
    QUANTITIES,
    Resistance,
    ResistanceRow,
    resistance_rows,
)
from costeer.validation.stability import (
    Stability,
    StabilityBounds,
    leaves_road,
    oscillates,
)

_PERCENTILES = (5.0, 50.0, 95.0)


def arms_table(tests: Sequence[ArmTest]) -> Table:
    """Return the admittance of each task at each frequency."""
    return Table(
        name="arms",
        title="Admittance of hands and arms",
        note="Magnitude [rad/(N·m)] over the drivers, the assumed range of people's "
        "arms, and the share of drivers within it.",
        header=("Task", "Frequency [Hz]", "5 %", "Median", "95 %", "Range", "Within"),
        rows=tuple(_arm_row(each) for each in arm_rows(tests)),
    )


def _arm_row(row: ArmRow) -> tuple[str, ...]:
    return (
        row.task,
        f"{row.frequency:g}",
        *(short(each) for each in row.percentiles),
        f"{short(row.low)} to {short(row.high)}",
        percent(row.share_inside, 1.0),
    )


def resistance_table(found: Sequence[Resistance]) -> Table:
    """Return what drivers did against lane changes that they did not want."""
    cells: dict[tuple[str, float], list[str]] = {}
    for row in resistance_rows(found):
        cells.setdefault((row.system, row.change_duration), []).append(_told(row))
    drivers = len(found[0].deviation)
    return Table(
        name="resistance",
        title="A lane change that the driver does not want",
        note=f"Strong guidance, {drivers} pilot drivers, four trials each, on an empty "
        "road. Medians over drivers, below them 5 and 95 %; shares of all trials. "
        "Never yields: a system whose verdict is always consistent.",
        header=(
            "System",
            "Duration [s]",
            *(_titled(quantity, unit) for quantity, unit in QUANTITIES.values()),
        ),
        rows=tuple(
            (system, f"{duration:g}", *texts)
            for (system, duration), texts in sorted(cells.items())
        ),
    )


_SHARES = {QUANTITIES[name][0] for name in ("overruled", "crossed_line")}


def _told(row: ResistanceRow) -> str:
    """Median and ends over the drivers, or the share of all trials."""
    if row.quantity in _SHARES:
        return number(100.0 * row.mean, 1)
    low, middle, high = row.percentiles
    return f"{short(middle)}\n{_ends(low, high)}".rstrip()


def _titled(quantity: str, unit: str) -> str:
    shown = "%" if quantity in _SHARES else unit.replace("-", NOTHING)
    return f"{quantity[0].upper()}{quantity[1:]} [{shown}]"


def _ends(low: float, high: float) -> str:
    text = f"{short(low)} to {short(high)}"
    return "" if NOTHING in text else text


class _Look(NamedTuple):
    """One row of the table of stability.

    Attributes:
        title: With the unit.
        values: Of all drivers, shape `(driver,)`.
        bound: In words.
        beyond: Who is beyond it; None without a bound.
        digits: Significant ones.
    """

    title: str
    values: NDArray[np.float64]
    bound: str = NOTHING
    beyond: NDArray[np.bool_] | None = None
    digits: int = 3


def stability_table(found: Stability) -> Table:
    """Return percentiles of damping and drift, bounds, and who is beyond them."""
    swinging, gone = int(oscillates(found).sum()), int(leaves_road(found).sum())
    return Table(
        name="stability",
        title=f"Stability of {plural(len(found.damping_ratio), 'driver')}",
        note=f"{found.speed * 3.6:.0f} km/h, manual. The first two rows: the linear "
        "loop of driver and car. Then runs without noise after an offset; the last "
        f"row: a manual trial each. {plural(swinging, 'driver')} oscillate, "
        f"{gone} leave the road.",
        header=(
            "Quantity [unit]",
            "Smallest",
            "5 %",
            "Median",
            "95 %",
            "Largest",
            "Bound",
            "Beyond",
        ),
        rows=tuple(map(_stable_row, _looks(found, StabilityBounds()))),
    )


def _looks(found: Stability, bounds: StabilityBounds) -> list[_Look]:
    return [
        _Look(
            "Least damping ratio of a swing [–]",
            found.damping_ratio,
            f"at least {bounds.damping_ratio:g}",
            found.damping_ratio < bounds.damping_ratio,
        ),
        _Look(
            "Largest eigenvalue of a control step [–]",
            found.largest_modulus,
            "below 1",
            found.largest_modulus >= 1.0,
            digits=5,
        ),
        _Look(
            "A swing over the one before it [–]",
            found.swing_ratio,
            f"at most {bounds.swing_ratio:g}",
            found.swing_ratio > bounds.swing_ratio,
        ),
        _Look(
            "From 0.5 to 0.1 m beyond what is let go [s]",
            found.settling_time,
            f"at most {bounds.settling_time:g}",
            found.settling_time > bounds.settling_time,
        ),
        _Look("Hunting with dry friction [m]", found.hunting),
        _Look(
            "Least distance of a wheel from the road's edge lines [m]",
            found.edge_margin,
            f"at least {number(-bounds.edge_strip, 1)}",
            leaves_road(found, bounds),
        ),
    ]


def _stable_row(look: _Look) -> tuple[str, ...]:
    values = look.values
    low, middle, high = np.percentile(values, _PERCENTILES, method="nearest")
    points = (values.min(), low, middle, high, values.max())
    return (
        look.title,
        *(short(float(each), look.digits) for each in points),
        look.bound,
        NOTHING if look.beyond is None else str(np.count_nonzero(look.beyond)),
    )
