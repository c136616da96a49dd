"""Lane departures as a table and a figure: counted, and of Gaussian positions."""

from __future__ import annotations

import numpy as np

from costeer.pages.exhibit import Exhibit
from costeer.pages.numerals import count, number
from costeer.pages.style import COLUMN_WIDTH_MM, INK, SMALL, Margins, new_figure, panels
from costeer.pages.tables import Table
from costeer.validation.departures import Departures, DepartureSummary
from costeer.validation.look import OURS
from costeer.validation.reporting.words import short

NAME = "departures"

ALLOWED = 0.02
"""Lane departures that are accepted in manual driving [1/km]."""

_SMALLEST_SHOWN = 1e-6


def departures_table(told: DepartureSummary) -> Table:
    """Return both rates of all drivers."""
    low, high = told.interval
    rows = (
        ("Driven", "km", number(told.kilometres, 0)),
        ("Departures counted", "–", count(told.num_departures)),
        ("Departures counted", "1/km", short(told.counted_per_km, 2)),
        ("95 % interval (Garwood)", "1/km", f"{short(low, 2)} to {short(high, 2)}"),
        ("Accepted", "1/km", f"at most {number(ALLOWED, 2)}"),
        (
            "Gaussian lane position of each driver, mean",
            "1/km",
            short(told.gaussian_per_km, 2),
        ),
        (
            "Gaussian lane position of the usual driver",
            "1/km",
            short(told.usual_per_km, 2),
        ),
    )
    return Table(
        name=NAME,
        title="Lane departures in manual driving",
        note="A wheel over a line outside a lane change. Gaussian: what a lane "
        "position of the same mean, SDLP and lateral speed would give (Rice 1944).",
        header=("Quantity", "Unit", "Value"),
        rows=rows,
        num_labels=2,
    )


def draw_departures(found: Departures, told: DepartureSummary) -> Exhibit:
    """Draw what Gaussian positions would give over SDLP; call inside `styled`."""
    figure = new_figure(COLUMN_WIDTH_MM, 68.0)
    margins = Margins(left=15.0, right=4.0, top=4.0, bottom=10.0)
    ((axes,),) = panels(figure, 1, 1, margins)
    shown = np.maximum(found.gaussian_per_km, _SMALLEST_SHOWN)
    axes.semilogy(
        found.sdlp, shown, "o", color=OURS, ms=3.0, mew=0.0, label="Gaussian, a driver"
    )
    if told.num_departures:
        axes.axhline(told.counted_per_km, color=INK, label="counted, all drivers")
        axes.axhspan(*told.interval, color=INK, alpha=0.12, lw=0.0)
    axes.axhline(ALLOWED, color=INK, ls=":", lw=0.8, label="accepted")
    axes.set_xlabel("SDLP [m]")
    axes.set_ylabel("Lane departures [1/km]")
    axes.margins(x=0.05)
    axes.legend(loc="lower right", fontsize=SMALL)
    return Exhibit(
        name=NAME,
        title="Lane departures and the spread of the lane position",
        caption="A point is a driver: departures that a Gaussian lane position of the "
        "same mean, SDLP and lateral speed would give (not below 10⁻⁶). Line and "
        "grey ground: departures counted over all drivers with their 95 % interval.",
        description="Expected departures of each driver rise steeply with SDLP; "
        f"counted over all drivers: {short(told.counted_per_km, 2)} per km, expected "
        f"on average {short(told.gaussian_per_km, 2)} per km.",
        figure=figure,
    )
