"""What a drawing shows, as numbers: for a table of its data, and for a hovering mouse.

A figure names those of its lines, marks and bars that are data. The table of the figure
and what the page tells where one points are both read off from them.
"""

from __future__ import annotations

import csv
import io
import itertools
import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path
from numpy.typing import ArrayLike, NDArray

from costeer.pages.numerals import MINUS

HEADER = ("panel", "x_axis", "y_axis", "series", "point", "x", "y", "low", "high")
_KEY = "costeer_series"
_BRACKETS = re.compile(r"\[([^\]]*)\]")
_POINTS_PER_INCH = 72.0  # of an SVG of matplotlib
_TENTHS = 10.0
"""Paths are written in tenths of a point, finer than a screen."""

Values = NDArray[np.float64]


class Series(NamedTuple):
    """What an artist shows.

    Attributes:
        name: Of the series, as a reader knows it.
        points: Names of its points; empty if their place tells them.
        low: Lower ends of their intervals; empty without.
        high: Upper ends of them.
        across: Whether the values lie along x.
        key: By which another participant's values replace these; empty if none can.
    """

    name: str
    points: tuple[str, ...] = ()
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()
    across: bool = False
    key: str = ""


class Other(NamedTuple):
    """The same figure of another participant.

    Attributes:
        name: Of the participant.
        caption: Of the figure.
        values: By key of the series, x and y of a line, or starts and ends of spans.
    """

    name: str
    caption: str
    values: Mapping[str, tuple[ArrayLike, ArrayLike]]


def say(artist: Artist, name: str, **more: Any) -> None:  # Any: fields of a series
    """Name what a line, marks or a bar show; `more` are fields of `Series`."""
    vars(artist)[_KEY] = Series(name, **more)


def spans(
    axes: Axes, starts: ArrayLike, ends: ArrayLike, colour: str, key: str = ""
) -> None:
    """Shade a panel from each start to its end along x; `key` as of a `Series`."""
    shape = axes.get_xaxis_transform()
    patch = PathPatch(_boxes(starts, ends), facecolor=colour, linewidth=0.0, zorder=-1)
    patch.set_transform(shape)
    axes.add_patch(patch)
    say(patch, "", key=key)


def _boxes(starts: ArrayLike, ends: ArrayLike) -> Path:
    """A box as high as the panel for each span."""
    corners = [
        [(a, 0.0), (b, 0.0), (b, 1.0), (a, 1.0), (a, 0.0)]
        for a, b in zip(np.atleast_1d(starts), np.atleast_1d(ends), strict=True)
    ]
    codes = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY]
    points = np.array(corners, dtype=np.float64).reshape(-1, 2)
    return Path(points, codes * len(corners))


def _named(figure: Figure) -> Iterator[tuple[int, Axes, Artist, Series]]:
    """Every artist that was named, panel by panel in the order of drawing."""
    for number, axes in enumerate(figure.axes):
        for artist in (*axes.lines, *axes.patches):
            if _KEY in vars(artist):
                yield number, axes, artist, vars(artist)[_KEY]


def _values(artist: Artist, across: bool) -> tuple[Values, Values]:
    """The points of an artist in the units of its axes."""
    if isinstance(artist, Line2D):
        x, y = artist.get_data()
        return np.asarray(x, np.float64), np.asarray(y, np.float64)
    if not isinstance(artist, Rectangle):  # shading
        return np.zeros(0), np.zeros(0)
    x, y = artist.get_x(), artist.get_y()
    width, height = artist.get_width(), artist.get_height()
    middle = (width, y + height / 2.0) if across else (x + width / 2.0, height)
    return np.array([middle[0]]), np.array([middle[1]])


def table(figure: Figure) -> str:
    """The data of a figure as CSV, a row for each point; empty if nothing was named."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    several = len(figure.axes) > 1
    for number, axes, artist, series in _named(figure):
        axis_names = _axis_name(figure, axes, "x"), _axis_name(figure, axes, "y")
        panel = f"{number + 1} {axes.get_title()}".strip() if several else ""
        for place, (x, y) in enumerate(
            zip(*_values(artist, series.across), strict=True)
        ):
            ends = [_at(each, place) for each in (series.low, series.high)]
            numbers = [_digits(value) for value in (x, y, *ends)]
            point = series.points[place] if series.points else ""
            writer.writerow([panel, *axis_names, series.name, point, *numbers])
    return text.getvalue() if text.getvalue().count("\n") > 1 else ""


def _at(values: Sequence[float], place: int) -> float:
    return values[place] if values else math.nan


def _digits(value: float) -> str:
    return f"{value:.6g}" if math.isfinite(value) else ""


def _axis_name(figure: Figure, axes: Axes, which: str) -> str:
    """Name of an axis; a panel inside a grid has that of its column's or row's end."""
    own = axes.get_xlabel() if which == "x" else axes.get_ylabel()
    place = axes.get_subplotspec()
    for other in figure.axes if not own and place is not None else ():
        spec = other.get_subplotspec()
        if spec is None or place is None:
            continue
        if spec.get_gridspec() is not place.get_gridspec():
            continue
        if which == "x" and spec.colspan == place.colspan:
            own = other.get_xlabel() or own
        if which == "y" and spec.rowspan == place.rowspan:
            own = own or other.get_ylabel()
    return " ".join(own.replace("$K_h$", "K_h").split())


def name_parts(figure: Figure) -> None:
    """Name the artists of a figure in its SVG, before that is written."""
    for place, (_, _, artist, _) in enumerate(_named(figure)):
        artist.set_gid(f"s{place}")


def page_values(figure: Figure, others: Sequence[Other] = ()) -> str:
    """What the page knows of a figure as JSON.

    Args:
        figure: Written as SVG, which lays it out a last time.
        others: The same of other participants.

    Returns:
        `panels` (box [pt], limits and names of the axes), `curves` (id, panel, name),
        `marks` (x and y [pt], words) and `others`; empty if nothing was named.
    """
    curves: list[list[object]] = []
    marks: list[list[object]] = []
    known: dict[str, tuple[str, Artist, Axes]] = {}
    for place, (number, axes, artist, series) in enumerate(_named(figure)):
        name = f"s{place}"
        if series.key:
            known[series.key] = (name, artist, axes)
        if _is_curve(artist):
            curves.append([name, number, series.name])
        elif not isinstance(artist, PathPatch):
            marks += _marks(figure, axes, artist, series)
    if not (curves or marks):
        return ""
    told = {
        "panels": [_panel(figure, axes) for axes in figure.axes],
        "curves": curves,
        "marks": marks,
        "others": [_other(figure, known, each) for each in others],
    }
    return json.dumps(told, ensure_ascii=False, separators=(",", ":"))


def _is_curve(artist: Artist) -> bool:
    return isinstance(artist, Line2D) and artist.get_linestyle() != "None"


def _panel(figure: Figure, axes: Axes) -> dict[str, object]:
    box = axes.bbox
    corners = [_places(figure, np.array([end]))[0] for end in (box.p0, box.p1)]
    (left, bottom), (right, top) = corners
    return {
        "box": [round(float(v), 2) for v in (left, top, right, bottom)],
        "x": [float(v) for v in axes.get_xlim()],
        "y": [float(v) for v in axes.get_ylim()],
        "names": [_axis_name(figure, axes, which) for which in "xy"],
    }


def _places(figure: Figure, pixels: Values) -> Values:
    """Places in the SVG [pt], shape `(points, 2)`; y runs downwards."""
    points = pixels * _POINTS_PER_INCH / figure.dpi
    height = figure.get_figheight() * _POINTS_PER_INCH
    return np.column_stack([points[:, 0], height - points[:, 1]])


def _marks(
    figure: Figure, axes: Axes, artist: Artist, series: Series
) -> Iterator[list[object]]:
    x, y = _values(artist, series.across)
    ends = np.column_stack([x, y])
    places = _places(figure, axes.transData.transform(ends))
    unit = _unit(_axis_name(figure, axes, "x" if series.across else "y"))
    for place, (at, point) in enumerate(zip(places, ends, strict=True)):
        if not np.isfinite(at).all():
            continue
        value = point[0 if series.across else 1]
        low, high = _at(series.low, place), _at(series.high, place)
        names = [series.name, *series.points[place : place + 1]]
        words = f"{', '.join(n for n in names if n)}: {_short(value)}{unit}"
        if math.isfinite(low) and math.isfinite(high):
            words += f" [{_short(low)}, {_short(high)}]"
        yield [*(round(float(each), 1) for each in at), words]


def _unit(axis_name: str) -> str:
    """What stands in brackets in an axis' name, after a space."""
    units = _BRACKETS.findall(axis_name)
    return f" {units[-1]}" if units and units[-1] not in ("–", "-") else ""


def _short(value: float) -> str:
    return f"{value:.3g}".replace("-", MINUS)


def _other(
    figure: Figure, known: Mapping[str, tuple[str, Artist, Axes]], other: Other
) -> dict[str, object]:
    """Path of each artist for another participant; empty where nothing is drawn."""
    paths = {
        name: _path(figure, axes, artist, other.values.get(key, ((), ())))
        for key, (name, artist, axes) in known.items()
    }
    return {"name": other.name, "caption": other.caption, "paths": paths}


def _path(
    figure: Figure, axes: Axes, artist: Artist, values: tuple[ArrayLike, ArrayLike]
) -> str:
    """The `d` of a path in an SVG, in tenths of a point."""
    if isinstance(artist, PathPatch):
        whole, transform = _boxes(*values), axes.get_xaxis_transform()
    else:
        whole, transform = Path(np.column_stack(values)), axes.transData
    if not np.size(whole.vertices):
        return ""
    whole = transform.transform_path(whole)
    whole.simplify_threshold = 0.3
    drawn = whole.cleaned(simplify=True, remove_nans=True)
    places = np.round(_TENTHS * _places(figure, np.asarray(drawn.vertices)))
    letters = {Path.MOVETO: "M", Path.LINETO: "L"}
    parts = [
        f"{letters[code]}{x / _TENTHS:g} {y / _TENTHS:g}"
        for code, (x, y) in zip(np.asarray(drawn.codes), places.tolist(), strict=True)
        if code in letters
    ]
    # Simplifying repeats the last point.
    parts = [each for each, _ in itertools.groupby(parts)]
    return "".join(parts)
