"""A trial record as people see it: a line, a table, a data frame, a figure."""

from __future__ import annotations

import difflib
import html
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from pandas import DataFrame

# Any: the element type differs from column to column.
Columns = Mapping[str, NDArray[Any]]

USUAL = (
    "lateral_position",
    "steering_wheel_angle",
    "driver_torque",
    "applied_torque",
    "haptic_gain",
    "crossing_probability",
)
"""Signals that a figure shows, as far as the record has them."""

_ALONG = ("longitudinal_velocity", "lead_velocity")
"""Speeds in km/h; sideways metres per second say more."""
_PANEL_MM, _AROUND_MM = 21.0, 14.0
_CHANGING = "lane_changing"
_UNIT_RANGE = ("haptic_gain", "crossing_probability")


class Facts(NamedTuple):
    """What a line about a trial says: participant, condition, method, driver, size."""

    participant: object
    condition: object
    method: object
    driver: object
    rows: int
    seconds: float


def facts(metadata: Mapping[str, object], columns: Columns) -> Facts:
    """What there is to say of a trial in a line; "-" where nothing is known."""
    time = columns.get("time", np.zeros(0))
    return Facts(
        participant=metadata.get("participant", "-"),
        condition=metadata.get("condition", "-"),
        method=metadata.get("method", "-"),
        driver=metadata.get("driver_kind", "-"),
        rows=len(time),
        seconds=float(time[-1] - time[0]) if len(time) else 0.0,
    )


def line(metadata: Mapping[str, object], columns: Columns) -> str:
    """A trial in one line."""
    told = facts(metadata, columns)
    return (
        f"<costeer record: participant {told.participant}, {told.condition}, "
        f"{told.method}, {told.driver}, {told.rows} rows, {told.seconds:.1f} s>"
    )


def table(metadata: Mapping[str, object], columns: Columns) -> str:
    """A trial as a small table of HTML."""
    told = facts(metadata, columns)._asdict() | {"columns": len(columns)}
    told["seconds"] = f"{told['seconds']:.1f}"
    rows = "".join(
        f"<tr><th>{name}</th><td>{html.escape(str(value))}</td></tr>"
        for name, value in told.items()
    )
    return f"<table><caption>costeer record</caption>{rows}</table>"


def frame(
    metadata: Mapping[str, object], columns: Columns, units: Mapping[str, str]
) -> DataFrame:
    """The columns as a data frame; units and description in its `attrs`."""
    import pandas as pd

    made = pd.DataFrame({name: _plain(each) for name, each in columns.items()})
    made.attrs = {"units": dict(units), "metadata": dict(metadata)}
    return made


def _plain(values: NDArray[Any]) -> Any:  # Any: an array or one of pandas
    """A column as pandas takes it: what is masked is missing."""
    if not isinstance(values, np.ma.MaskedArray):
        return values
    import pandas as pd

    kind = "boolean" if values.dtype.kind == "b" else values.dtype.name.capitalize()
    return pd.array(
        [None if value is np.ma.masked else value for value in values], dtype=kind
    )


def figure(
    metadata: Mapping[str, object],
    columns: Columns,
    units: Mapping[str, str],
    signals: Sequence[str] | None,
) -> Figure:
    """Signals against time, one panel each; lane changes of the system are shaded.

    Raises:
        ValueError: If the record has no such signal, or none that can be drawn.
    """
    from costeer.pages.style import FULL_WIDTH_MM, Margins, new_figure, panels, styled

    names = _chosen(columns, signals)
    told = facts(metadata, columns)
    with styled():
        drawn = new_figure(FULL_WIDTH_MM, _AROUND_MM + _PANEL_MM * len(names))
        margins = Margins(left=20.0, top=6.0, bottom=9.0)
        grid = [row[0] for row in panels(drawn, len(names), 1, margins)]
        for name, axes in zip(names, grid, strict=True):
            _panel(axes, columns, name, units.get(name, ""))
        for axes in grid[:-1]:
            axes.tick_params(labelbottom=False)
        grid[-1].set_xlabel("Time [s]")
        grid[0].set_title(
            f"Participant {told.participant}, {told.condition}, {told.method}"
        )
        drawn.align_ylabels(grid)
    return drawn


def _chosen(columns: Columns, signals: Sequence[str] | None) -> list[str]:
    """Names of the columns to draw.

    Raises:
        ValueError: If one is not there, holds words, or there is none.
    """
    if signals is None:
        shown = [n for n in USUAL if n in columns and _says_something(columns[n])]
    else:
        shown = [signals] if isinstance(signals, str) else list(signals)
    numbers = [n for n, values in columns.items() if values.dtype.kind in "fiub"]
    for name in shown:
        if name in columns and name not in numbers:
            raise ValueError(
                f"signal {name!r} holds words and cannot be drawn; choose from "
                f"{', '.join(numbers)}"
            )
        if name not in numbers:
            near = difflib.get_close_matches(name, numbers, n=1)
            guess = f" (did you mean {near[0]}?)" if near else ""
            raise ValueError(
                f"the record has no signal {name!r}{guess}; choose from "
                f"{', '.join(numbers)}"
            )
    if not shown or "time" not in columns:
        raise ValueError("nothing to draw; name signals of a record that has a time")
    return shown


def _says_something(values: NDArray[Any]) -> bool:
    return bool(np.isfinite(np.ma.filled(values.astype(float), np.nan)).any())


def _panel(axes: Axes, columns: Columns, name: str, unit: str) -> None:
    """Draw one signal in people's units, whole numbers and flags as steps."""
    from costeer.pages import units
    from costeer.pages.style import INK, RULE, SHADE

    time, values = columns["time"], columns[name]
    shown = np.ma.filled(values.astype(float), np.nan)
    if unit != "m/s" or name in _ALONG:
        unit, factor = units.shown(unit)
        shown = shown * factor
    style = "default" if values.dtype.kind == "f" else "steps-post"
    if "mode" in columns:
        changing = columns["mode"] == _CHANGING
        across = axes.get_xaxis_transform()
        axes.fill_between(
            time, 0.0, 1.0, changing, transform=across, color=SHADE, linewidth=0.0
        )
    if np.nanmin(shown, initial=0.0) < 0.0 < np.nanmax(shown, initial=0.0):
        axes.axhline(0.0, color=RULE, linewidth=0.6, zorder=1.0)
    # Signals that begin undefined would have an axis of their own.
    axes.set_xlim(float(time[0]), float(time[-1]))
    axes.plot(time, shown, color=INK, linewidth=0.8, drawstyle=style)
    if name in _UNIT_RANGE:
        axes.set_ylim(-0.05, 1.05)
    axes.set_ylabel(f"{_label(name)}\n[{'–' if unit in ('-', '') else unit}]")


def _label(name: str) -> str:
    """A column's name as words, on two lines if it is long."""
    words = name.replace("_", " ").capitalize()
    first, space, rest = words.partition(" ")
    return f"{first}\n{rest}" if space and len(words) > 12 else words
