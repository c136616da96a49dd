"""A figure for a journal: at its width, as PDF, PNG, SVG, or its data as CSV."""

from __future__ import annotations

import io
import itertools
import math

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from costeer.pages.exhibit import Exhibit
from costeer.pages.series import table
from costeer.pages.style import MM_PER_INCH, Margins, margins_of, place_panels, svg_text

FORMATS = ("pdf", "png", "svg", "csv")
NARROWEST_MM, WIDEST_MM = 60.0, 210.0
"""Widths that are taken [mm]: from a narrow column to a page of A4."""

_DPI = 600
"""Of a PNG: what journals ask of drawings of lines."""

_STEP_MM, _HIGHEST_MM = 5.0, 240.0
_STACKED_BELOW = 0.62
"""Share of its own width under which panels in a row are put below each other."""


def published(exhibit: Exhibit, width_mm: float | None, kind: str) -> bytes:
    """Return the file of a figure; type keeps its size, whatever the width.

    Args:
        exhibit: Drawn inside `styled`, and still in it.
        width_mm: Of the figure; its own if None.
        kind: One of `FORMATS`.

    Raises:
        ValueError: If it is not drawn, has no data, or is not legible at that width.
    """
    figure = exhibit.figure
    if figure is None:
        raise ValueError(f"figure {exhibit.name} is not drawn: {exhibit.missing}")
    if kind == "csv":
        if not (data := table(figure)):
            raise ValueError(f"figure {exhibit.name} has no data to write")
        return data.encode()
    if width_mm is not None:
        _fit(exhibit.name, figure, width_mm)
    if kind == "svg":
        return svg_text(figure, exhibit.name, exhibit.title).encode()
    undated = "CreationDate" if kind == "pdf" else "Software"
    told: dict[str, str | None] = {"Title": exhibit.title, undated: None}
    file = io.BytesIO()
    with mpl.rc_context({"pdf.fonttype": 42}):  # letters that journals can search
        figure.savefig(file, format=kind, dpi=_DPI, metadata=told)
    return file.getvalue()


def _fit(name: str, figure: Figure, width_mm: float) -> None:
    """Give a figure its width.

    Raises:
        ValueError: If words then lie over each other or leave the figure.
    """
    own = float(figure.get_figwidth()) * MM_PER_INCH
    set_width(figure, width_mm)
    if width_mm >= own or legible(figure):
        return
    narrow, wide = width_mm, own
    while wide - narrow > _STEP_MM:
        middle = (narrow + wide) / 2.0
        set_width(figure, middle)
        narrow, wide = (narrow, middle) if legible(figure) else (middle, wide)
    raise ValueError(
        f"figure {name} is not legible at {width_mm:g} mm: its words would meet; "
        f"it needs {math.ceil(wide)} mm"
    )


def set_width(figure: Figure, width_mm: float) -> None:
    """Change the width of a figure; its margins keep their millimetres.

    Panels side by side go below each other where they would become too narrow.
    """
    grid = _grid(figure)
    margins = margins_of(figure, grid)
    old = float(figure.get_figwidth()) * MM_PER_INCH
    height = float(figure.get_figheight()) * MM_PER_INCH
    figure.set_figwidth(width_mm / MM_PER_INCH)
    narrow = grid.nrows == 1 and width_mm < _STACKED_BELOW * old
    if narrow and 1 < grid.ncols <= _HIGHEST_MM / height:
        _stack(figure, margins, height)
    else:
        place_panels(figure, grid, margins)
        for each in figure.axes:
            if (place := each.get_subplotspec()) is not None:
                each.set_subplotspec(place)


def _grid(figure: Figure) -> GridSpec:
    """The grid that the panels of a figure stand in."""
    (grid,) = {each.get_gridspec() for each in figure.axes}
    assert isinstance(grid, GridSpec)
    return grid


def _stack(figure: Figure, margins: Margins, height: float) -> None:
    """Put the panels of a row below each other, each as high as before."""
    axes = figure.axes
    between = margins.top + margins.bottom
    figure.set_figheight(height * len(axes) / MM_PER_INCH)
    grid = figure.add_gridspec(len(axes), 1)
    place_panels(figure, grid, margins._replace(between_rows=between))
    for place, each in enumerate(axes):
        each.set_subplotspec(grid[place, 0])


def legible(figure: Figure) -> bool:
    """Whether all words are inside the figure, and none lies over another."""
    FigureCanvasAgg(figure)  # measures words as it draws them
    figure.draw_without_rendering()
    boxes = [each.get_window_extent() for each in _words(figure)]
    whole = figure.bbox
    inside = all(
        box.x0 >= -1.0
        and box.y0 >= -1.0
        and box.x1 <= whole.x1 + 1.0
        and box.y1 <= whole.y1 + 1.0
        for box in boxes
    )
    return inside and not any(
        _meet(first, second) for first, second in itertools.combinations(boxes, 2)
    )


def _words(figure: Figure) -> list[Text]:
    """All words that are seen; ticks beyond the limits keep theirs unseen."""
    unseen = {text for axes in figure.axes for text in _beyond(axes)}
    found = figure.findobj(Text)
    return [
        each
        for each in found
        if isinstance(each, Text)
        and each.get_visible()
        and each.get_text().strip()
        and each not in unseen
    ]


def _beyond(axes: Axes) -> list[Text]:
    hidden: list[Text] = []
    for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        low, high = sorted(limits)
        for tick in axis.get_major_ticks():
            if not low - 1e-9 <= float(tick.get_loc()) <= high + 1e-9:
                hidden += [tick.label1, tick.label2]
    return hidden


def _meet(first: Bbox, second: Bbox) -> bool:
    """Whether two boxes overlap by more than the white that letters bring along."""
    across = min(first.x1, second.x1) - max(first.x0, second.x0)
    up = min(first.y1, second.y1) - max(first.y0, second.y0)
    return bool(across > 1.0 and up > 0.25 * min(first.height, second.height))
