"""One look for every figure: sizes, colours, type, and how an SVG is written.

Colours are those of Okabe and Ito, which people with colour-vision deficiency tell
apart. Strength is a hue, duration a shade of it; manual driving is grey everywhere.
"""

from __future__ import annotations

import gc
import io
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec

COLUMN_WIDTH_MM = 88.0
FULL_WIDTH_MM = 180.0
"""Widths of one and of two columns of a journal page [mm]."""

MM_PER_INCH = 25.4
_SCREEN_DPI = 120.0
SMALL, NORMAL = 6.5, 7.5
"""Sizes of type [pt]."""

INK = "#1a1a1a"
FAINT = "#8c8c8c"
RULE = "#d0d0d0"
SHADE = "#ececec"

STRENGTH_COLOURS = {"manual": "#5f5f5f", "strong": "#0072B2", "weak": "#D55E00"}
STRENGTH_LINES: dict[str, tuple[float, tuple[float, ...]]] = {
    "manual": (0.0, (1.0, 1.2)),
    "strong": (0.0, ()),
    "weak": (0.0, (4.0, 1.5)),
}
"""Offset and dashes: the three are told apart without colour too."""

SIGNAL_COLOURS = {"driver": "#009E73", "guidance": "#CC79A7", "gap": "#1a1a1a"}
"""Two agents at one wheel, distinct from the colours of the conditions."""

_FONT = "DejaVu Sans"
_QUOTED_FONT = re.compile(rf"'{_FONT}[^']*'")
_FALLBACK = "Verdana, Geneva, sans-serif"
"""Text of an SVG stays text, laid out in DejaVu Sans; the first two are as wide."""

_RC: dict[Any, Any] = {  # Any: matplotlib's keys are one long Literal
    "font.family": [_FONT],
    "font.size": NORMAL,
    "axes.titlesize": NORMAL,
    "axes.labelsize": NORMAL,
    "axes.titleweight": "regular",
    "axes.titlelocation": "left",
    "axes.titlepad": 3.0,
    "axes.labelpad": 2.5,
    "axes.linewidth": 0.6,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.unicode_minus": True,
    "axes.xmargin": 0.0,
    "xtick.labelsize": SMALL,
    "ytick.labelsize": SMALL,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.2,
    "ytick.major.size": 2.2,
    "xtick.major.pad": 2.0,
    "ytick.major.pad": 2.0,
    "lines.linewidth": 1.0,
    "legend.fontsize": SMALL,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "legend.borderaxespad": 0.2,
    "text.color": INK,
    "mathtext.fontset": "dejavusans",
    "svg.fonttype": "none",
    "path.simplify": True,
}


class Margins(NamedTuple):
    """White space of a grid of panels [mm]: around it and between its panels."""

    left: float = 12.0
    right: float = 2.0
    top: float = 5.0
    bottom: float = 9.0
    between_columns: float = 6.0
    between_rows: float = 4.0


@contextmanager
def styled() -> Iterator[None]:
    """Apply the style; draw and write a figure inside.

    Meanwhile nobody looks for objects that hold each other: figures are made of many,
    and the looking took a twentieth of the time of a report.
    """
    looked = gc.isenabled()
    gc.disable()
    try:
        with mpl.rc_context():
            mpl.rcdefaults()
            mpl.rcParams.update(_RC)
            yield
    finally:
        if looked:
            gc.enable()


class ShownFigure(Figure):
    """A figure that a notebook shows, also if nobody has imported pyplot."""

    def _repr_png_(self) -> bytes:
        picture = io.BytesIO()
        self.savefig(picture, format="png", dpi=_SCREEN_DPI)
        return picture.getvalue()


def new_figure(width_mm: float, height_mm: float) -> Figure:
    """Return an empty figure of that size on a white ground."""
    size = (width_mm / MM_PER_INCH, height_mm / MM_PER_INCH)
    figure = ShownFigure(figsize=size, facecolor="white")
    FigureCanvasSVG(figure)
    return figure


def panels(
    figure: Figure,
    rows: int,
    columns: int,
    margins: Margins,
    column_widths: Sequence[float] | None = None,
    row_heights: Sequence[float] | None = None,
) -> list[list[Axes]]:
    """Return a grid of panels placed to the millimetre.

    Args:
        figure: Figure to divide.
        rows: Number of rows.
        columns: Number of columns.
        margins: White space [mm].
        column_widths: Shares of the width, equal if None.
        row_heights: Shares of the height, equal if None.
    """
    grid = figure.add_gridspec(
        rows, columns, width_ratios=column_widths, height_ratios=row_heights
    )
    place_panels(figure, grid, margins)
    return [
        [figure.add_subplot(grid[row, column]) for column in range(columns)]
        for row in range(rows)
    ]


def place_panels(figure: Figure, grid: GridSpec, margins: Margins) -> None:
    """Place a grid of panels to the millimetre in a figure of any size."""
    width, height = (float(size) * MM_PER_INCH for size in figure.get_size_inches())
    inner_width = width - margins.left - margins.right
    inner_height = height - margins.top - margins.bottom
    grid.update(
        left=margins.left / width,
        right=1.0 - margins.right / width,
        top=1.0 - margins.top / height,
        bottom=margins.bottom / height,
        wspace=_relative(margins.between_columns, inner_width, grid.ncols),
        hspace=_relative(margins.between_rows, inner_height, grid.nrows),
    )


def margins_of(figure: Figure, grid: GridSpec) -> Margins:
    """Return the white space that a grid of panels was placed with."""
    width, height = (float(size) * MM_PER_INCH for size in figure.get_size_inches())
    at = grid.get_subplot_params(figure)
    return Margins(
        left=at.left * width,
        right=(1.0 - at.right) * width,
        top=(1.0 - at.top) * height,
        bottom=at.bottom * height,
        between_columns=_gap(at.wspace, (at.right - at.left) * width, grid.ncols),
        between_rows=_gap(at.hspace, (at.top - at.bottom) * height, grid.nrows),
    )


def _relative(gap: float, inner: float, number: int) -> float:
    """The gap as a share of the mean panel, which is what the grid wants."""
    return gap * number / (inner - gap * (number - 1))


def _gap(share: float, inner: float, number: int) -> float:
    """The gap of a share of the mean panel: `_relative` turned round."""
    return share * inner / (number + share * (number - 1))


def panel_letter(axes: Axes, letter: str) -> None:
    """Put a bold letter above the upper left corner of a panel's labels."""
    axes.annotate(
        letter,
        xy=(0.0, 1.0),
        xycoords="axes fraction",
        xytext=(-26.0, 5.0),
        textcoords="offset points",
        fontsize=NORMAL + 0.5,
        fontweight="bold",
        ha="left",
        va="bottom",
    )


def interval_bar(
    axes: Axes,
    at: tuple[float, float],
    vertical: bool,
    lower: float,
    upper: float,
) -> None:
    """Draw an interval in ink on a white edge, so that it stands out on any bar.

    Args:
        axes: Panel.
        at: Place of the mean.
        vertical: Whether it extends along y, else along x.
        lower: Length below the mean.
        upper: Length above the mean.
    """
    length = [[lower], [upper]]
    for colour, width in (("white", 1.9), (INK, 0.9)):
        axes.errorbar(
            *at,
            yerr=length if vertical else None,
            xerr=None if vertical else length,
            fmt="none",
            ecolor=colour,
            capsize=2.0,
            capthick=width,
            elinewidth=width,
            zorder=3.0,
        )


def svg_text(figure: Figure, name: str, title: str) -> str:
    """Return a figure as SVG, its text as text; the same figure gives the same bytes.

    Args:
        figure: Drawn inside `styled`.
        name: Salt of the ids inside.
        title: Text for those who do not see the figure.
    """
    text = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": name}):
        figure.savefig(
            text,
            format="svg",
            metadata={"Date": None, "Creator": None, "Title": title},
        )
    return _QUOTED_FONT.sub(rf"\g<0>, {_FALLBACK}", text.getvalue())
