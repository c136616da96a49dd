"""A scenario's road as an OpenDRIVE file.

The left lane's centre is the reference line, as it is in costeer, so lines, arcs and
spirals are exact. Where people drive on the right all lanes have negative numbers;
where they drive on the left, positive ones: both go along the reference line.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

import numpy as np

from costeer.scenarios.definition import Road, Scenario, curvature_of

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_LONGEST_STEP = 10.0
"""Over which eight nodes integrate a clothoid to rounding [m]."""


class _Stretch(NamedTuple):
    """A line, an arc or a spiral.

    Attributes:
        begin: Along the road [m].
        length: [m].
        first: Curvature where it begins [1/m].
        last: Where it ends [1/m].
    """

    begin: float
    length: float
    first: float
    last: float


def road_text(scenario: Scenario) -> str:
    """The road of a scenario as OpenDRIVE 1.7; cars and events are not in it."""
    road = scenario.road
    rule = "LHT" if road.traffic == "left" else "RHT"
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        "<OpenDRIVE>",
        f'  <header revMajor="1" revMinor="7" name={quoteattr(scenario.name)}/>',
        f'  <road name={quoteattr(scenario.name)} length="{road.length!r}" id="1" '
        f'junction="-1" rule="{rule}">',
        *_type(road),
        "    <planView>",
        *_geometry(road),
        "    </planView>",
        "    <lanes>",
        *_lanes(road),
        "    </lanes>",
        "  </road>",
        "</OpenDRIVE>",
    ]
    return "\n".join(lines) + "\n"


def _type(road: Road) -> Iterator[str]:
    if road.speed_limit:
        number, _, unit = road.speed_limit.strip().partition(" ")
        told = f'<speed max="{number}" unit="{unit.strip() or "m/s"}"/>'
        yield f'    <type s="0" type="motorway">{told}</type>'


def _stretches(road: Road) -> Iterator[_Stretch]:
    """Stretches between stations, and before the first and after the last."""
    places = [each.at for each in road.stations]
    bends = [curvature_of(each) for each in road.stations]
    if not places:
        places, bends = [0.0], [0.0]
    places, bends = [0.0, *places, road.length], [bends[0], *bends, bends[-1]]
    for (begin, first), (end, last) in pairwise(zip(places, bends, strict=True)):
        if end > begin:
            yield _Stretch(begin, end - begin, first, last)


def _geometry(road: Road) -> Iterator[str]:
    place, heading = 0j, 0.0
    for each in _stretches(road):
        yield (
            f'      <geometry s="{each.begin!r}" x="{place.real!r}" '
            f'y="{place.imag!r}" hdg="{heading!r}" length="{each.length!r}">'
            f"{_shape(each)}</geometry>"
        )
        place += _displacement(each, heading)
        heading += (each.first + each.last) / 2.0 * each.length


def _shape(stretch: _Stretch) -> str:
    first, last = stretch.first, stretch.last
    if first != last:
        return f'<spiral curvStart="{first!r}" curvEnd="{last!r}"/>'
    return f'<arc curvature="{first!r}"/>' if first else "<line/>"


def _displacement(stretch: _Stretch, heading: float) -> complex:
    """From the beginning to the end of a stretch [m], east and north."""
    count = math.ceil(stretch.length / _LONGEST_STEP)
    step = stretch.length / count
    at = (np.arange(count)[:, None] + (1.0 + _NODES) / 2.0) * step
    slope = (stretch.last - stretch.first) / stretch.length
    angles = heading + (stretch.first + slope * at / 2.0) * at
    return complex(np.sum(np.exp(1j * angles) * _WEIGHTS) * step / 2.0)


def _lanes(road: Road) -> Iterator[str]:
    left = road.traffic == "left"
    # From the reference line to the edge at which lanes are counted from.
    edge = (0.5 - road.lanes if left else 0.5) * road.lane_width
    yield f'      <laneOffset s="0" a="{edge!r}" b="0" c="0" d="0"/>'
    yield '      <laneSection s="0">'
    yield from _side(road, "left", road.lanes if left else 0)
    yield '        <center><lane id="0" type="none" level="false"/></center>'
    yield from _side(road, "right", 0 if left else road.lanes)
    yield "      </laneSection>"


def _side(road: Road, side: str, lanes: int) -> Iterator[str]:
    """Lanes from the left to the right, the shoulder outside."""
    sign = 1 if side == "left" else -1
    numbers = [sign * number for number in range(1, lanes + 2)]
    yield f"        <{side}>"
    for number in sorted(numbers, reverse=True):
        is_lane = abs(number) <= lanes
        kind = "driving" if is_lane else "shoulder"
        width = road.lane_width if is_lane else road.shoulder
        yield (
            f'          <lane id="{number}" type="{kind}" level="false">'
            f'<width sOffset="0" a="{width!r}" b="0" c="0" d="0"/>'
            f'<roadMark sOffset="0" type="{"broken" if is_lane else "none"}" '
            f'weight="standard" color="standard" width="0.12"/></lane>'
        )
    yield f"        </{side}>"
