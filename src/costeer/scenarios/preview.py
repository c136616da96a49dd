"""A scenario as a figure: plan of the road, curvature, who is where in which lane."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    INK,
    RULE,
    SHADE,
    SIGNAL_COLOURS,
    SMALL,
    STRENGTH_COLOURS,
    Margins,
    new_figure,
    panels,
    styled,
    svg_text,
)
from costeer.plant.fleet import FROM_START
from costeer.plant.parameters import CarParameters
from costeer.scenarios.definition import Actor, Road, Scenario, home_lane, speed_of
from costeer.scenarios.world import Draw, curvatures, others_of

Numbers = NDArray[np.float64]

_STEP = 1.0
"""Between points of the drawn road [m]."""

_ROW_HEIGHT_MM = 24.0

_OWN, _ACTOR, _STREAM = STRENGTH_COLOURS["strong"], STRENGTH_COLOURS["weak"], FAINT
_EVENT = SIGNAL_COLOURS["guidance"]

_SEEN = 700.0
"""Distance within which cars at the start are drawn [m]."""


class _Course(NamedTuple):
    """The left lane's centre as points.

    Attributes:
        station: Along the road [m].
        curvature: There [1/m].
        heading: [rad].
        x: East [m].
        y: North [m].
    """

    station: Numbers
    curvature: Numbers
    heading: Numbers
    x: Numbers
    y: Numbers


def preview_svg(scenario: Scenario) -> str:
    """The figure as SVG."""
    with styled():
        return svg_text(
            preview_figure(scenario),
            f"scenario-{scenario.name}",
            f"Scenario {scenario.name}: {scenario.about}",
        )


def preview_figure(scenario: Scenario) -> Figure:
    """Draw a scenario; call it inside `pages.style.styled`."""
    course = _course(scenario.road) if scenario.road.stations else None
    heights = [_ROW_HEIGHT_MM, _ROW_HEIGHT_MM]
    if course is not None:
        share = float(np.ptp(course.y)) / float(np.ptp(course.x))
        heights = [min(max(160.0 * share + 24.0, 30.0), 150.0), 20.0, *heights]
    margins = Margins(left=16.0, right=5.0, top=15.0, between_rows=15.0)
    gaps = margins.between_rows * (len(heights) - 1) + margins.top + margins.bottom
    figure = new_figure(FULL_WIDTH_MM, sum(heights) + gaps)
    rows = [r[0] for r in panels(figure, len(heights), 1, margins, None, heights)]
    figure.text(
        margins.left / FULL_WIDTH_MM,
        1.0 - 4.0 / (sum(heights) + gaps),
        f"{scenario.name}   {scenario.about}",
        va="center",
    )
    if course is not None:
        _draw_plan(rows[0], scenario, course)
        _draw_curvature(rows[1], scenario, course)
    _draw_along(rows[-2], scenario)
    _draw_start(rows[-1], scenario)
    return figure


def _course(road: Road) -> _Course:
    """The road, turned so that it is as wide as may be on the page."""
    count = max(round(road.length / _STEP), 2)
    station, step = np.linspace(0.0, road.length, count + 1, retstep=True)
    curvature = curvatures(road.stations, station)
    turned = np.cumsum((curvature[1:] + curvature[:-1]) / 2.0 * step)
    heading = np.concatenate([[0.0], turned])
    steps = np.exp(1j * (heading[1:] + heading[:-1]) / 2.0) * step
    points = np.concatenate([[0.0], np.cumsum(steps)])
    angles = np.linspace(-math.pi / 2.0, math.pi / 2.0, 181)
    heights = [float(np.ptp((points * turn).imag)) for turn in np.exp(1j * angles)]
    best = float(angles[int(np.argmin(heights))])
    points = points * np.exp(1j * best)
    if points[-1].real < points[0].real:
        points, best = -points, best + math.pi
    return _Course(station, curvature, heading + best, points.real, points.imag)


def _draw_plan(axes: Axes, scenario: Scenario, course: _Course) -> None:
    """The road seen from above, to scale but for its width."""
    axes.plot(course.x, course.y, color=FAINT, linewidth=3.4, solid_capstyle="butt")
    for zone in scenario.zones:
        inside = (course.station >= zone.start) & (course.station <= zone.end)
        axes.plot(course.x[inside], course.y[inside], color=_EVENT, linewidth=3.4)
        middle = (zone.start + zone.end) / 2.0
        _beside(axes, course, middle, zone.name, -1.0, _EVENT)
    axes.plot(course.x, course.y, color="white", linewidth=0.5, dashes=(4.0, 3.0))
    every = next(e for e in (100, 200, 500, 1000, 2000, 5000, 10000, 50000)
                 if scenario.road.length / e <= 12)  # fmt: skip
    for place in np.arange(0.0, scenario.road.length + 1.0, every):
        _beside(axes, course, place, f"{place / 1000.0:g} km", 1.0, INK)
    for place, text in _bends(scenario.road):
        _beside(axes, course, place, text, -1.0, FAINT)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.03, 0.2)
    axes.set_axis_off()
    axes.set_title("plan; the width of the road is not to scale")


def _beside(
    axes: Axes, course: _Course, place: float, text: str, side: float, colour: str
) -> None:
    """Write beside the road; left is side 1."""
    at = int(np.searchsorted(course.station, place - 1e-6))
    at = min(at, len(course.station) - 1)
    direction = course.heading[at] + side * math.pi / 2.0
    far = 16.0 if colour == _EVENT else 9.0
    away = (far * math.cos(direction), 0.8 * far * math.sin(direction))
    axes.annotate(
        text,
        (float(course.x[at]), float(course.y[at])),
        xytext=away,
        textcoords="offset points",
        ha="center",
        va="center",
        color=colour,
        fontsize=SMALL,
    )
    if side > 0.0:
        axes.plot(course.x[at], course.y[at], "o", color=INK, markersize=1.8)


def _bends(road: Road) -> Iterator[tuple[float, str]]:
    """Middle and radius of each stretch of one radius, 20 at most."""
    arcs = [
        (one, after)
        for one, after in pairwise(road.stations)
        if one.radius == after.radius and math.isfinite(one.radius)
    ]
    for one, after in arcs[:20]:
        yield (one.at + after.at) / 2.0, f"R {abs(one.radius):.0f} m"


def _draw_curvature(axes: Axes, scenario: Scenario, course: _Course) -> None:
    _shade_zones(axes, scenario)
    axes.axhline(0.0, color=RULE, linewidth=0.6)
    axes.plot(course.station, course.curvature * 1000.0, color=INK)
    axes.set_ylabel("curvature [1/km]")
    axes.margins(0.0, 0.12)
    axes.set_title("curvature of the left lane's centre, positive to the left")
    _station_axis(axes, scenario)


def _shade_zones(axes: Axes, scenario: Scenario) -> None:
    for zone in scenario.zones:
        axes.axvspan(zone.start, zone.end, color=SHADE, linewidth=0.0)


def _station_axis(axes: Axes, scenario: Scenario) -> None:
    axes.set_xlim(0.0, scenario.road.length)
    axes.set_xlabel("along the road [m]")


def _draw_lanes(axes: Axes, road: Road) -> None:
    """Lines, shoulders and names of lanes; x is set by the caller."""
    width, lanes = road.lane_width, road.lanes
    edges = [width * (0.5 - k) for k in range(lanes + 1)]
    for edge in edges[1:-1]:
        axes.axhline(edge, color=FAINT, linewidth=0.6, dashes=(6.0, 6.0))
    for edge in (edges[0], edges[-1]):
        axes.axhline(edge, color=INK, linewidth=0.8)
    outside = (edges[0] + road.shoulder, edges[-1] - road.shoulder)
    for edge in outside:
        axes.axhline(edge, color=FAINT, linewidth=1.6)
    numbers = range(lanes)
    axes.set_yticks(
        [-width * (lanes - 1 - k) for k in numbers], [f"lane {k}" for k in numbers]
    )
    axes.tick_params(axis="y", length=0.0, pad=6.0)
    axes.set_ylim(outside[1] - 0.4, outside[0] + 0.4)
    axes.spines["left"].set_visible(False)


def _draw_along(axes: Axes, scenario: Scenario) -> None:
    """Events and actors along the whole road."""
    road = scenario.road
    _shade_zones(axes, scenario)
    _draw_lanes(axes, road)
    for event in scenario.events:
        axes.axvspan(event.at, event.at + event.length, color=_EVENT, alpha=0.35)
        told = {"gust": f"{event.force:+.0f} N", "lane-change": event.side}
        _above(axes, event.at + event.length / 2.0, told.get(event.kind, event.kind))
    overtaking, home = scenario.overtaking, home_lane(road)
    for k in range(overtaking.cars):
        place = overtaking.first + k * overtaking.spacing
        _mark(axes, road, place + overtaking.ahead, home, _ACTOR)
    for actor in scenario.actors:
        lane, place = actor.lane, _place_of(scenario, actor)
        if not math.isnan(place):
            _mark(axes, road, place, lane, _ACTOR)
            _above(axes, place, actor.name)
    _mark(axes, road, 0.0, home, _OWN)
    axes.set_title("events, zones (shaded), and where other cars appear", pad=10.0)
    _station_axis(axes, scenario)


def _place_of(scenario: Scenario, actor: Actor) -> float:
    """Where an actor is first seen [m]; NaN if that is not known before the drive."""
    if math.isnan(actor.headway):
        return actor.at
    begins = math.nan if actor.appears is None else actor.appears.place
    return begins + actor.headway * speed_of(scenario.speed)


def _mark(axes: Axes, road: Road, place: float, lane: int, colour: str) -> None:
    lateral = -(road.lanes - 1 - lane) * road.lane_width
    axes.plot(place, lateral, ">", color=colour, markersize=4.0, clip_on=False)


def _above(axes: Axes, place: float, text: str) -> None:
    axes.annotate(
        text,
        (place, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(0.0, 1.0),
        textcoords="offset points",
        ha="center",
        va="bottom",
        fontsize=SMALL,
    )


def _draw_start(axes: Axes, scenario: Scenario) -> None:
    """Cars about the driven one at the start, to scale along the road."""
    road, car = scenario.road, CarParameters()
    _draw_lanes(axes, road)
    lateral = (home_lane(road) + 1 - road.lanes) * road.lane_width
    _car(axes, (0.0, lateral), (car.length, car.width), _OWN)
    farthest = 100.0
    for k, kind in enumerate(others_of(scenario, Draw(1, 1, road.length, car))):
        if kind.trigger != FROM_START or abs(kind.position) > _SEEN:
            continue
        colour = _ACTOR if k < len(scenario.actors) else _STREAM
        size = (float(kind.length), float(kind.width))
        _car(axes, (float(kind.position), float(kind.lateral)), size, colour)
        farthest = max(farthest, abs(float(kind.position)) + 20.0)
    axes.set_xlim(-farthest, farthest)
    axes.set_xlabel("from the driven car at the start [m]")
    axes.set_title(
        "at the start: driven car (blue), actors (orange), others (grey; as of seed 1)"
    )


def _car(
    axes: Axes, middle: tuple[float, float], size: tuple[float, float], colour: str
) -> None:
    corner = (middle[0] - size[0] / 2.0, middle[1] - size[1] / 2.0)
    axes.add_patch(Rectangle(corner, *size, color=colour, linewidth=0.0))
