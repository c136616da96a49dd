"""What each driver did twice: how personal the measures of manual driving are."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from costeer.drivers.population import USUAL
from costeer.pages.exhibit import Exhibit
from costeer.pages.numerals import number
from costeer.pages.style import (
    FULL_WIDTH_MM,
    INK,
    RULE,
    SMALL,
    Margins,
    new_figure,
    panels,
)
from costeer.validation.manual import ManualDriving
from costeer.validation.spread import TargetSpread, Values, driver_values
from costeer.validation.targets import DEVIATION, MEASURES, TARGETS

NAME = "test-retest"

_UNITS = {target.name: target.unit for target in TARGETS[USUAL.domain]}
_SHOWN = tuple(n for n, measure in MEASURES.items() if measure.statistic != DEVIATION)
_COLUMNS = 5
_MARGINS = Margins(
    left=13.0, right=3.0, top=9.0, bottom=10.0, between_columns=9.5, between_rows=19.0
)


def draw_twice(
    driving: ManualDriving, again: ManualDriving, spreads: list[TargetSpread]
) -> Exhibit:
    """Draw the second trial over the first, a point per driver; inside `styled`.

    Args:
        driving: First manual trials.
        again: Second ones of the same drivers.
        spreads: Of all targets.
    """
    retest = {each.name: each.retest for each in spreads}
    figure = new_figure(FULL_WIDTH_MM, 92.0)
    grid = panels(figure, 2, _COLUMNS, _MARGINS)
    for axes, name in zip([a for row in grid for a in row], _SHOWN, strict=True):
        measure = MEASURES[name]
        twice = [driver_values(each, measure) for each in (driving, again)]
        _twice(axes, *twice)
        axes.set_title(
            f"{name}  {measure.label}\nr = {number(retest[name], 2)}", size=SMALL
        )
        axes.set_xlabel(f"first [{_UNITS[name]}]", size=SMALL, labelpad=1.5)
    for row in grid:
        row[0].set_ylabel("second, same unit", size=SMALL, labelpad=1.5)
    return Exhibit(
        name=NAME,
        title="Every driver twice",
        caption="A point is a driver: its value in a second manual trial with other "
        "noise over that in the first; of lane changes the median of the trial, of "
        "glances the share. On the line both are the same; r is their correlation.",
        description="Scatter plots of second over first trial; correlations: "
        + ", ".join(f"{name} {number(retest[name], 2)}" for name in _SHOWN)
        + ".",
        figure=figure,
    )


def _twice(axes: Axes, first: Values, second: Values) -> None:
    both = np.concatenate([first, second])
    known = both[np.isfinite(both)]
    low, high = (known.min(), known.max()) if known.size else (0.0, 1.0)
    room = 0.06 * float(high - low) or 0.5
    ends = (float(low) - room, float(high) + room)
    axes.plot(ends, ends, color=RULE, linewidth=0.8, zorder=1)
    axes.plot(first, second, "o", color=INK, alpha=0.45, ms=2.0, mew=0.0, zorder=2)
    axes.set_xlim(*ends)
    axes.set_ylim(*ends)
    axes.set_aspect("equal")
    axes.locator_params(nbins=3)
