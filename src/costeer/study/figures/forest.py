"""The answer in one figure: every measure against manual driving, in one unit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from costeer.methods.conditions import DURATIONS, MANUAL, STRENGTHS, condition
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.series import say
from costeer.pages.style import (
    FULL_WIDTH_MM,
    INK,
    RULE,
    STRENGTH_COLOURS,
    Margins,
    new_figure,
    panels,
)
from costeer.study.material import StudyMaterial, conditions_driven, pair
from costeer.study.outcome import WITHIN, PairRow
from costeer.study.quantities import QUANTITIES, WORKLOAD, Quantity

NAME = "effects"
TITLE = "Effects on all measures"

_MARKERS = {"": "D", "rapid": "^", "normal": "o", "gentle": "v"}
_ROW_MM = 11.0
_APART = 0.2
"""Between two marks of a measure, of its row."""


class Compared(NamedTuple):
    """One mark: a comparison within subjects, standardised.

    Attributes:
        duration: Of the lane change; empty for all conditions of a strength.
        effect: Hedges' g_av [-], and the ends of its 95 % interval.
        significant: Whether p < 0.05 after the correction.
        words: What was compared.
    """

    duration: str
    effect: tuple[float, float, float]
    significant: bool
    words: str


Rows = dict[Quantity, list[Compared]]


def draw(material: StudyMaterial) -> Exhibit:
    """Draw each strength against manual, and the strengths where the paper does."""
    found = {title: rows for title, rows in _panels(material) if rows}
    if not found:
        lacking = (
            "A standardised effect within subjects needs three participants who drove "
            "manually and with guidance."
        )
        return not_drawn(NAME, TITLE, lacking)
    shown = [q for q in (*QUANTITIES, *WORKLOAD) if any(q in r for r in found.values())]
    figure = new_figure(FULL_WIDTH_MM, 22.0 + _ROW_MM * len(shown))
    margins = Margins(left=39.0, right=3.0, top=11.0, bottom=11.0, between_columns=4.0)
    shares = [0.6 if title == _BETWEEN else 1.0 for title in found]
    axes = panels(figure, 1, len(found), margins, shares)[0]
    for panel, (title, rows) in zip(axes, found.items(), strict=True):
        _draw(panel, shown, rows, _COLOURS[title])
        panel.set_title(title)
        panel.tick_params(labelleft=panel is axes[0])
    _share_scale(axes, list(found))
    handles = _legend(list(found.values()))
    figure.legend(
        handles=handles, ncols=len(handles), loc="upper right", handletextpad=0.1
    )
    caption = _caption(material, _BETWEEN in found)
    return Exhibit(NAME, TITLE, caption, _DESCRIPTION, figure)


_BETWEEN = "strong − weak"
_COLOURS = {f"{each} − manual": STRENGTH_COLOURS[each] for each in STRENGTHS}
_COLOURS[_BETWEEN] = INK
_DESCRIPTION = (
    "Forest plot with a row for each measure and a panel for each strength of "
    "guidance: standardised differences from manual driving with 95 % intervals. The "
    "differences themselves stand in the tables of pairs."
)


def _panels(material: StudyMaterial) -> Iterator[tuple[str, Rows]]:
    """Each panel with what is compared in it."""
    for strength in STRENGTHS:
        conditions = [
            each
            for each in conditions_driven(material)
            if condition(each).strength == strength
        ]
        yield f"{strength} − manual", _rows(material, [strength, *conditions], MANUAL)
    strong, weak = STRENGTHS
    yield _BETWEEN, _rows(material, [strong], weak)


def _rows(material: StudyMaterial, levels: Sequence[str], second: str) -> Rows:
    """By measure, the levels whose difference from the second is known."""
    rows: Rows = {}
    for quantity in (*QUANTITIES, *WORKLOAD):
        found = [pair(material, quantity.name, WITHIN, each, second) for each in levels]
        marks = [
            _compared(each) for each in found if each is not None and _is_known(each)
        ]
        if marks:
            rows[quantity] = marks
    return rows


def _is_known(row: PairRow) -> bool:
    """Whether there is an interval, and with two participants an unbiased estimate."""
    return math.isfinite(row.d_av_low + row.d_av_high) and row.hedges_correction > 0.0


def _compared(row: PairRow) -> Compared:
    unbiased = row.hedges_correction
    values = (row.d_av, row.d_av_low, row.d_av_high)
    is_strength = row.first in STRENGTHS
    return Compared(
        duration="" if is_strength else condition(row.first).duration,
        effect=(values[0] * unbiased, values[1] * unbiased, values[2] * unbiased),
        significant=bool(row.mark),
        words=f"{row.first} − {row.second}",
    )


def _draw(axes: Axes, shown: Sequence[Quantity], rows: Rows, colour: str) -> None:
    """Draw the marks of a panel, those of a measure below each other."""
    axes.axvline(0.0, color=INK, linewidth=0.6, zorder=1.0)
    for place, quantity in enumerate(shown):
        marks = rows.get(quantity, [])
        for order, mark in enumerate(marks):
            y = place + _APART * (order - (len(marks) - 1) / 2.0)
            value, low, high = mark.effect
            axes.plot([low, high], [y, y], color=colour, linewidth=0.9, zorder=2.0)
            (drawn,) = axes.plot(
                [value],
                [y],
                linestyle="none",
                marker=_MARKERS[mark.duration],
                markersize=3.6,
                markeredgewidth=0.8,
                color=colour,
                markerfacecolor=colour if mark.significant else "white",
                zorder=3.0,
            )
            told = {"low": (low,), "high": (high,), "points": (quantity.title,)}
            say(drawn, mark.words, across=True, **told)
    for place in range(1, len(shown)):
        axes.axhline(place - 0.5, color=RULE, linewidth=0.4, zorder=0.5)
    axes.set_yticks(range(len(shown)), [_label(each) for each in shown])
    axes.set_ylim(len(shown) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0.0)


def _label(quantity: Quantity) -> str:
    return quantity.title.replace("Steering wheel r", "Steering wheel\nr").replace(
        "RMS steering ", "RMS steering\n"
    )


def _share_scale(axes: Sequence[Axes], titles: Sequence[str]) -> None:
    """One range for the panels against manual; the narrow one shows a part as wide."""
    wide = [a for a, title in zip(axes, titles, strict=True) if title != _BETWEEN]
    ends = [end for each in wide or axes for end in each.dataLim.intervalx]
    low, high = 1.05 * min(*ends, 0.0), 1.05 * max(*ends, 0.0)
    for each in wide:
        each.set_xlim(low, high)
    for each in axes:
        each.margins(x=0.08)
        each.xaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 5, 10]))
        each.set_xlabel(r"less ← $g_\mathrm{av}$ [–] → more")


def _legend(panels_found: Sequence[Rows]) -> list[Line2D]:
    marks = [m for rows in panels_found for each in rows.values() for m in each]
    drawn = {mark.duration for mark in marks}
    return [
        Line2D(
            [],
            [],
            color=INK,
            marker=marker,
            linestyle="none",
            markersize=3.6,
            label=f"{name} ({DURATIONS[name]:g} s)" if name else "all conditions",
        )
        for name, marker in _MARKERS.items()
        if name in drawn
    ]


def _caption(material: StudyMaterial, between: bool) -> str:
    participants = material.trials["participant"].nunique()
    both = (
        " At the right the two strengths in lane keeping, which the paper compares by "
        "strength."
        if between
        else ""
    )
    return (
        f"Differences within {participants} participants, in standard deviations "
        "(Hedges' g_av: mean difference over the root of the two conditions' mean "
        "variance, corrected for small samples), with 95 % intervals. Left of zero is "
        "less than in manual driving, right of it more. Filled: p < 0.05 after "
        f"Benjamini-Hochberg over the comparisons of a measure; open: not.{both}"
    )
