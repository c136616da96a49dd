"""Lanes of an OpenDRIVE road: which are driven on, and where they are across it.

Lanes with negative numbers are on the right of the reference line, seen along it. Where
people drive on the right these go along the line; where they drive on the left, those
with positive numbers do (ASAM OpenDRIVE 1.8, section 11).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.scenarios.opendrive.geometry import check_rising
from costeer.scenarios.opendrive.tree import Element

Numbers = NDArray[np.float64]

DRIVING = "driving"
"""Type of the lanes that are read."""

BESIDE = ("shoulder", "stop", "border")
"""Types of what lies between the outer line and a barrier."""

NARROWEST = 1.5
"""A lane that is narrower somewhere ends or begins there [m]."""

_ROUNDING = 0.05
"""Below nothing, where a lane that ends is rounded [m]."""


class Lane(NamedTuple):
    """A lane in one section of a road.

    Attributes:
        number: Its id, positive on the left.
        kind: Its type.
        element: In the file.
    """

    number: int
    kind: str
    element: Element


class Section(NamedTuple):
    """A stretch of road on which lanes neither begin nor end.

    Attributes:
        begin: Along the road [m].
        lanes: By their numbers.
        element: In the file.
    """

    begin: float
    lanes: dict[int, Lane]
    element: Element


Chain = tuple[int, ...]
"""One lane along the road: its number in each section."""


def sections_of(road: Element) -> list[Section]:
    """Sections of a road.

    Raises:
        ValueError: If there is none, or a lane cannot be read, naming its line.
    """
    found = [_section(each) for each in road.below("lanes", "laneSection")]
    if not found:
        raise ValueError(f"{road.where}: the road has no laneSection; give it one")
    # Sections of one side only: they would have to be laid over each other.
    for each in found:
        if each.element.given.get("singleSide") == "true":
            told = "singleSide sections are not read; write both sides into one"
            raise ValueError(f"{each.element.where}: {told}")
    check_rising([(each.begin, each.element) for each in found])
    if found[0].begin > _ROUNDING:
        told = f"lanes begin at s = {found[0].begin:g} m; give 0"
        raise ValueError(f"{found[0].element.where}: {told}")
    return found


def _section(element: Element) -> Section:
    lanes = {}
    for side in ("left", "right"):
        for each in element.below(side, "lane"):
            number = each.number("id")
            if number != int(number) or (number > 0) != (side == "left"):
                told = f"a lane on the {side} has the id {number:g}; give whole numbers"
                raise ValueError(f"{each.where}: {told}, positive on the left")
            if number in lanes:
                told = f"two lanes have the id {number:g}; give each its own"
                raise ValueError(f"{each.where}: {told}")
            kind = each.given.get("type", "none")
            lanes[int(number)] = Lane(int(number), kind, each)
    return Section(element.number("s"), lanes, element)


def chains_of(sections: Sequence[Section], side: int) -> list[Chain]:
    """Lanes of one side that are driven on from the first section to the last.

    Args:
        sections: Of the road.
        side: 1 left, -1 right of the reference line.
    """
    found = []
    for number in sorted(sections[0].lanes, key=abs):
        if number * side > 0:
            chain = _followed(sections, number)
            if len(chain) == len(sections):
                found.append(chain)
    return found


def _followed(sections: Sequence[Section], number: int) -> Chain:
    """A lane from section to section as far as it is driven on."""
    chain: list[int] = []
    following: int | None = number
    for section, after in zip(sections, [*sections[1:], None], strict=True):
        lane = section.lanes.get(following) if following is not None else None
        if lane is None or lane.kind != DRIVING:
            break
        chain.append(lane.number)
        following = None if after is None else _successor(lane)
    return tuple(chain)


def _successor(lane: Lane) -> int:
    """Number of a lane in the next section; the same where the file does not say."""
    links = lane.element.below("link", "successor")
    return int(links[0].number("id")) if links else lane.number


def ended_lanes(
    sections: Sequence[Section], chains: Sequence[Chain], side: int
) -> Iterator[Lane]:
    """Lanes that are driven on somewhere but are in none of the chains, each once."""
    told: set[int] = set()
    for place, section in enumerate(sections):
        kept = {chain[place] for chain in chains}
        for lane in section.lanes.values():
            new = lane.number not in kept | told and lane.number * side > 0
            if new and lane.kind == DRIVING:
                told.add(lane.number)
                yield lane


Cubics = Callable[[Numbers], Numbers]


def cubics(records: Sequence[Element], key: str, begin: float = 0.0) -> Cubics:
    """Piecewise cubic polynomials along the road, 0 before the first.

    Args:
        records: With `a`, `b`, `c`, `d` and where each begins.
        key: Attribute that says where.
        begin: Place from which that is measured [m].
    """
    starts = np.array([begin + each.number(key) for each in records])
    if np.any(np.diff(starts) < 0.0):
        where = records[int(np.argmax(np.diff(starts) < 0.0)) + 1].where
        raise ValueError(f"{where}: give {key} in rising order")
    factors = np.array([[each.number(name) for name in "abcd"] for each in records])

    def value(at: Numbers) -> Numbers:
        if not len(starts):
            return np.zeros_like(at)
        place = np.searchsorted(starts, at + 1e-9, side="right") - 1
        a, b, c, d = factors[np.maximum(place, 0)].T
        beyond = at - starts[np.maximum(place, 0)]
        here = a + (b + (c + d * beyond) * beyond) * beyond
        return np.where(place >= 0, here, 0.0)

    return value


def edges_of(section: Section, number: int, at: Numbers) -> tuple[Numbers, Numbers]:
    """Inner and outer edge of a lane from the centre lane, left positive [m].

    Args:
        section: With the lane and those between it and the centre.
        number: Of the lane.
        at: Along the road [m].

    Raises:
        ValueError: If a lane in between is missing or has no width, or a negative one.
    """
    side = 1 if number > 0 else -1
    inner = outer = np.zeros_like(at)
    for each in range(side, number + side, side):
        lane = section.lanes.get(each)
        if lane is None:
            told = f"lane {number} is there without lane {each}; give both"
            raise ValueError(f"{section.element.where}: {told}")
        inner = outer
        widths, borders = lane.element.all("width"), lane.element.all("border")
        if not (widths or borders):
            told = f"lane {each} has no width; give it <width> or <border>"
            raise ValueError(f"{lane.element.where}: {told}")
        drawn = cubics(widths or borders, "sOffset", section.begin)(at)
        outer = inner + side * drawn if widths else drawn
        width = side * (outer - inner)
        if width.min() < -_ROUNDING:
            told = f"lane {each} is {width.min():.3g} m wide"
            where = f"{lane.element.where}: {told} at s = {at[width.argmin()]:.4g} m"
            raise ValueError(f"{where}; give 0 or more")
    return inner, outer


def breaks_of(road: Element, sections: Sequence[Section]) -> set[float]:
    """Places where lanes or their polynomials begin [m]."""
    found = {section.begin for section in sections}
    found |= {each.number("s") for each in road.below("lanes", "laneOffset")}
    for section in sections:
        for lane in section.lanes.values():
            records = [*lane.element.all("width"), *lane.element.all("border")]
            found |= {section.begin + each.number("sOffset") for each in records}
    return found
