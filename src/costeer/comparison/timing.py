"""When the verdicts of each method turn inconsistent, around a crossing of the line."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from costeer.comparison.figures import LETTERS, looks, panel_grid
from costeer.comparison.measures import Moment
from costeer.comparison.mistakes import NONE
from costeer.comparison.results import Results
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.style import FAINT, SMALL, Margins, panel_letter
from costeer.study.disputes import FARTHEST

NAME = "inconsistency-timing"
TITLE = "When inconsistencies come"

_BINS = np.arange(-FARTHEST, FARTHEST + 0.5, 1.0)
_MARGINS = Margins(
    left=13.0,
    right=3.0,
    top=8.0,
    bottom=10.0,
    between_columns=12.0,
    between_rows=17.0,
)


def inconsistency_timing(results: Results) -> Exhibit:
    """A histogram for each method that gives a verdict, all scenarios together."""
    found = {m: moments for m in results.methods if (moments := _of(results, m))}
    if not found:
        why = "No verdict of any method was inconsistent in a drive without a mistake."
        return not_drawn(NAME, TITLE, why)
    dashes = (0, (6, 4))
    crossing = Line2D([], [], color=FAINT, linestyle=dashes, label="crossing")
    grid = panel_grid(len(found), 32.0, _MARGINS, [crossing])
    looked = looks(results.methods)
    for place, (axes, method) in enumerate(zip(grid.panels, found, strict=True)):
        _histogram(axes, found[method], looked[method].colour)
        axes.axvline(0.0, color=FAINT, linewidth=0.7, linestyle=dashes)
        axes.set_title(f"{method}: {len(found[method])} in all", fontsize=SMALL)
        if place % grid.num_columns == 0:
            axes.set_ylabel("Inconsistencies [–]")
        panel_letter(axes, LETTERS[place])
    judging = {key[2] for key in results.disputes}
    silent = [m for m in results.methods if m in judging and m not in found]
    described = (
        f"Histograms of the time from the crossing, for {', '.join(found)}; the dashed "
        "line is the crossing."
    )
    return Exhibit(NAME, TITLE, _caption(found, silent), described, grid.figure)


def _of(results: Results, method: str) -> list[Moment]:
    """The inconsistencies of a method without mistakes, over all scenarios."""
    return [
        moment
        for (_, mistake, name), moments in results.disputes.items()
        if name == method and mistake == NONE
        for moment in moments
    ]


def _histogram(axes: Axes, moments: list[Moment], colour: str) -> None:
    near = [m.from_crossing for m in moments if np.isfinite(m.from_crossing)]
    axes.hist(near, bins=_BINS.tolist(), color=colour, rwidth=0.92)
    axes.set_xlim(-FARTHEST, FARTHEST)
    axes.set_xlabel("Time from crossing [s]")
    axes.yaxis.set_major_locator(MaxNLocator(integer=True, nbins=4))


def _caption(found: dict[str, list[Moment]], silent: list[str]) -> str:
    """What is shown, and what is not in the panels."""
    told = []
    for method, moments in found.items():
        within = sum(bool(np.isfinite(each.share)) for each in moments)
        far = sum(bool(np.isnan(each.from_crossing)) for each in moments)
        told.append(f"{method}: {within} in a lane change, {far} far from any")
    none = f" None in any drive: {', '.join(silent)}." if silent else ""
    return (
        "First inconsistent verdicts by their time from the nearest crossing of the "
        "lane line, in all drives of all scenarios without a mistake; each panel has a "
        f"scale of its own, and what is farther than {FARTHEST:g} s from any crossing "
        f"is in none. {'; '.join(told)}.{none} What inconsistent means is the method's "
        "own affair; those that give no verdict have no panel."
    )
