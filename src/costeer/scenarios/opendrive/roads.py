"""The road of an OpenDRIVE file as a scenario has it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.scenarios.definition import Road
from costeer.scenarios.limits import LIMITS
from costeer.scenarios.opendrive import lanes as lane
from costeer.scenarios.opendrive.features import left_out
from costeer.scenarios.opendrive.fitting import (
    STRETCH,
    Errors,
    fitted,
    line_through,
)
from costeer.scenarios.opendrive.geometry import (
    STEP,
    Piece,
    course_of,
    pieces_of,
)
from costeer.scenarios.opendrive.tree import Element, read_tree

Numbers = NDArray[np.float64]

LONGEST_ROAD = 210_000.0
"""Along the lanes that are read [m]: who swings out by kilometres is no lane."""

MOST_ERROR = 0.1
"""Distance from the file's line within `fitting.STRETCH` above which it is told [m]."""

_GAP, _KINK = 0.01, 0.001
"""Between elements of a reference line, above which they are told [m], [rad]."""

_JUMP = 0.3
"""Sideways, above which a lane is not one line [m]."""

_UNEVEN = 0.1
"""Difference of widths that is told [m]."""

_SHOWN = 12
"""Roads that an error lists."""

_UNITS = {"km/h": 1 / 3.6, "mph": 0.44704, "m/s": 1.0}


class Imported(NamedTuple):
    """A road that was read.

    Attributes:
        road: As a scenario has it.
        notes: What a reader should know of it.
        errors: Of its alignment against the file's geometry.
    """

    road: Road
    notes: tuple[str, ...]
    errors: Errors


class _Driven(NamedTuple):
    """Lanes that are read, and which way they go.

    Attributes:
        chains: The lanes, section by section.
        forward: Whether along the reference line.
        notes: On this choice.
    """

    chains: tuple[lane.Chain, ...]
    forward: bool
    notes: tuple[str, ...]


class _Strip(NamedTuple):
    """A stretch of road on which all polynomials are one.

    Attributes:
        x: Of the left lane's centre, east [m].
        y: As above, north [m].
        widths: Of each lane that is read, by place [m].
        beside: Between the outer line and the barrier, by place [m].
    """

    x: Numbers
    y: Numbers
    widths: Numbers
    beside: Numbers


def read_road(path: Path, wanted: str = "", against: bool = False) -> Imported:
    """A road of an OpenDRIVE file.

    Args:
        path: Of the file.
        wanted: Id of the road; may be empty if there is only one.
        against: Whether to read the lanes that go against the reference line.

    Raises:
        ValueError: Naming what cannot be read, with file and line.
        OSError: If the file cannot be read.
    """
    root = read_tree(path)
    road = _chosen(root, wanted)
    sections, pieces = lane.sections_of(road), pieces_of(road)
    driven = _driven(road, sections, against)
    strips = [*_strips(road, sections, pieces, driven)]
    parts = [(each.x, each.y) for each in strips]
    if not driven.forward:
        parts = [(x[::-1], y[::-1]) for x, y in reversed(parts)]
    line = line_through(parts)
    if not line.length <= LONGEST_ROAD:
        told = f"its lanes are {line.length:.3g} m long; give at most"
        raise ValueError(f"{road.where}: {told} {LONGEST_ROAD:g} m")
    fit = fitted(line)
    widths = np.concatenate([each.widths for each in strips], axis=1)
    limit, limit_notes = _limit(road)
    made = Road(
        length=fit.length,
        lanes=len(driven.chains),
        lane_width=round(float(widths.mean()), 3),
        shoulder=_shoulder(strips),
        traffic="left" if _left_hand(road) else "right",
        speed_limit=limit,
        stations=fit.stations,
    )
    notes = [
        *driven.notes,
        *_of_widths(road, widths),
        *_of_length(road, pieces),
        *_of_joints(pieces),
        *limit_notes,
        *left_out(root, road),
    ]
    if fit.errors.stretch > MOST_ERROR:
        told = f"the road read is up to {fit.errors.stretch:.2f} m from the file's"
        notes.append(f"{road.where}: {told} within {STRETCH:g} m")
    return Imported(made, tuple(notes), fit.errors)


def _chosen(root: Element, wanted: str) -> Element:
    """The road of that id, or the only one.

    Raises:
        ValueError: If there is none, or several and none is named.
    """
    roads = root.all("road")
    if not roads:
        raise ValueError(f"{root.where}: the file has no road; give one that has")
    found = [each for each in roads if each.given.get("id", "") == wanted]
    if not wanted and len(roads) == 1:
        found = roads
    if len(found) == 1:
        return found[0]
    if len(found) > 1:
        told = f"{found[1].where}: two roads have the id {wanted!r}"
        raise ValueError(f"{told}; give each its own")
    longest = sorted(roads, key=lambda each: -each.number("length", 0.0))
    listed = ", ".join(
        f"{each.given.get('id', '')} ({each.number('length', 0.0):.0f} m)"
        for each in longest[:_SHOWN]
    )
    more = f" and {len(roads) - _SHOWN} shorter ones" if len(roads) > _SHOWN else ""
    told = f"there is no road {wanted!r}" if wanted else f"it has {len(roads)} roads"
    raise ValueError(f"{root.file}: {told}; give --road with one of {listed}{more}")


def _left_hand(road: Element) -> bool:
    """Whether people drive on the left.

    Raises:
        ValueError: If the file says something else.
    """
    rule = road.given.get("rule", "RHT")
    if rule not in ("RHT", "LHT"):
        raise ValueError(f"{road.where}: rule is {rule[:40]!r}; give RHT or LHT")
    return rule == "LHT"


def _driven(road: Element, sections: Sequence[lane.Section], against: bool) -> _Driven:
    """The lanes of one direction; with a single one, that of the other beside it.

    Raises:
        ValueError: If there are none, or others than a scenario has.
    """
    along = 1 if _left_hand(road) else -1
    side = -along if against else along
    chains, others = (_through(road, sections, each) for each in (side, -side))
    notes = []
    if not chains and others and not against:
        side, chains, others = -side, others, chains
        notes.append(f"{road.where}: all lanes go against the reference line")
    names = ", ".join(str(chain[0]) for chain in chains)
    if len(chains) == 1 and others and set(chains[0]) | set(others[0]) == {-1, 1}:
        chains = [chains[0], others[0]]
        notes.append(
            f"{road.where}: one lane goes in this direction ({names}); the one beside "
            f"it, of the other direction, is read as the lane to overtake in"
        )
    most = int(LIMITS[Road]["lanes"].high)
    if not 2 <= len(chains) <= most:
        way = "against" if against else "along"
        raise ValueError(
            f"{road.where}: {len(chains)} lanes are driven on {way} the reference line "
            f"from end to end ({names or 'none'}); take a road (--road) or direction "
            f"(--against) with 2 to {most}"
        )
    for place, section in enumerate(sections):
        numbers = sorted(chain[place] for chain in chains)
        for one, after in pairwise(numbers):
            if after - one > (2 if one == -1 else 1):
                told = f"between lanes {one} and {after} lie others; give neighbours"
                raise ValueError(f"{section.element.where}: {told}")
    notes += _of_lanes(sections, chains, side)
    return _Driven(tuple(chains), side == along, tuple(notes))


def _through(
    road: Element, sections: Sequence[lane.Section], side: int
) -> list[lane.Chain]:
    """Lanes of a side from end to end that are wide enough everywhere."""
    ends = [*(each.begin for each in sections[1:]), _end(road)]
    found = []
    for chain in lane.chains_of(sections, side):
        wide = True
        for section, end, number in zip(sections, ends, chain, strict=True):
            inner, outer = lane.edges_of(
                section, number, np.linspace(section.begin, end, 50)
            )
            wide &= bool(np.all(np.abs(outer - inner) >= lane.NARROWEST))
        if wide:
            found.append(chain)
    return found


def _end(road: Element) -> float:
    last = pieces_of(road)[-1]
    return last.begin + last.length


def _of_lanes(
    sections: Sequence[lane.Section], chains: Sequence[lane.Chain], side: int
) -> Iterator[str]:
    """What is told of lanes."""
    for each in lane.ended_lanes(sections, chains, side):
        told = f"lane {each.number} does not go from end to end"
        yield f"{each.element.where}: {told}; it is left out"
    for place, section in enumerate(sections):
        for chain in chains:
            element = section.lanes[chain[place]].element
            way = element.given.get("direction", "standard")
            if way != "standard":
                told = f"lane {chain[place]} has the direction {way[:20]!r}"
                raise ValueError(f"{element.where}: {told}; give standard")


def _strips(
    road: Element,
    sections: Sequence[lane.Section],
    pieces: Sequence[Piece],
    driven: _Driven,
) -> Iterator[_Strip]:
    """The left lane's centre between all places where something begins.

    Raises:
        ValueError: If a lane jumps sideways, naming the line.
    """
    offset = lane.cubics(road.below("lanes", "laneOffset"), "s")
    end = pieces[-1].begin + pieces[-1].length
    inner = {b for b in lane.breaks_of(road, sections) if pieces[0].begin < b < end}
    breaks = sorted(inner | {each.begin for each in pieces} | {end})
    before = math.nan
    for begin, after in pairwise(breaks):
        if after - begin < 1e-6:
            continue
        middle = (begin + after) / 2.0
        piece = [each for each in pieces if each.begin <= middle][-1]
        place = max(sum(each.begin <= middle for each in sections) - 1, 0)
        # Just inside, so that each end belongs to this stretch.
        at = np.linspace(begin, after - 1e-9, max(math.ceil((after - begin) / STEP), 2))
        centre, widths, beside = _across(sections[place], place, at, driven)
        centre += offset(at)
        if abs(centre[0] - before) > _JUMP:
            where = sections[place].element.where
            told = f"at s = {begin:g} m the lane is {abs(centre[0] - before):.1f} m"
            raise ValueError(f"{where}: {told} beside itself; give even widths there")
        before = float(centre[-1])
        course = course_of(piece, at - piece.begin)
        x = course.x - centre * np.sin(course.heading)
        y = course.y + centre * np.cos(course.heading)
        yield _Strip(x, y, widths, beside)


def _across(
    section: lane.Section, place: int, at: Numbers, driven: _Driven
) -> tuple[Numbers, Numbers, Numbers]:
    """The left lane's centre, widths of lanes, and the room beside the outer one."""
    edges = [lane.edges_of(section, c[place], at) for c in driven.chains]
    centres = np.array([(inner + outer) / 2.0 for inner, outer in edges])
    left = centres.max(axis=0) if driven.forward else centres.min(axis=0)
    widths = np.array([np.abs(outer - inner) for inner, outer in edges])
    outermost = max((c[place] for c in driven.chains), key=abs)
    side = 1 if outermost > 0 else -1
    beside, number = np.zeros_like(at), outermost + side
    while number in section.lanes and section.lanes[number].kind in lane.BESIDE:
        inner, outer = lane.edges_of(section, number, at)
        beside = beside + np.abs(outer - inner)
        number += side
    return left, widths, beside


def _shoulder(strips: Sequence[_Strip]) -> float:
    """Room beside the outer lane; the usual one where the file shows none [m]."""
    beside = float(np.median(np.concatenate([each.beside for each in strips])))
    low = LIMITS[Road]["shoulder"].low
    return round(min(beside, 10.0), 3) if beside >= low else Road().shoulder


def _of_widths(road: Element, widths: Numbers) -> Iterator[str]:
    low, high, mean = widths.min(), widths.max(), widths.mean()
    if high - low > _UNEVEN:
        told = f"lanes are {low:.2f} to {high:.2f} m wide"
        yield f"{road.where}: {told}; all are read as {mean:.3f} m"
    limits = LIMITS[Road]["lane_width"]
    if not limits.low <= mean <= limits.high:
        told = f"lanes are {mean:.2f} m wide; give {limits.low:g} to {limits.high:g} m"
        raise ValueError(f"{road.where}: {told}")


def _of_length(road: Element, pieces: Sequence[Piece]) -> Iterator[str]:
    """What the file says of the road's length, if its geometry has another."""
    drawn = pieces[-1].begin + pieces[-1].length - pieces[0].begin
    told = road.number("length", drawn) if "length" in road.given else None
    if told is None or abs(told - drawn) > max(_GAP, 1e-3 * drawn):
        said = "no length" if told is None else f"the length {told:g} m"
        yield f"{road.where}: the road has {said}; its geometry of {drawn:g} m is read"


def _of_joints(pieces: Sequence[Piece]) -> Iterator[str]:
    """Gaps and kinks between elements of the reference line, the largest of them."""
    found = []
    for one, after in pairwise(pieces):
        end = course_of(one, np.array([0.0, one.length]))
        gap = math.hypot(end.x[-1] - after.x, end.y[-1] - after.y)
        kink = abs(math.remainder(end.heading[-1] - after.heading, 2.0 * math.pi))
        found.append((gap, kink, after.shape.where))
        if abs(one.begin + one.length - after.begin) > _GAP:
            told = f"ends at s = {one.begin + one.length:g} m, the next begins at"
            yield f"{one.shape.where}: geometry {told} {after.begin:g} m and counts"
    gap, _, where = max(found, default=(0.0, 0.0, ""))
    if gap > _GAP:
        told = f"geometry begins {gap:.3g} m from the end of the one before"
        yield f"{where}: {told}; it is moved there"
    kink, where = max(((k, w) for _, k, w in found), default=(0.0, ""))
    if kink > _KINK:
        told = f"geometry begins with a kink of {math.degrees(kink):.2g} degrees"
        yield f"{where}: {told}; it is made even"


def _limit(road: Element) -> tuple[str, list[str]]:
    """Speed limit where the road begins, in words, and notes.

    Raises:
        ValueError: If it is no speed, naming the line.
    """
    given, notes, limits = [], list[str](), LIMITS[Road]["speed_limit"]
    for each in road.below("type", "speed"):
        text = each.given.get("max", "")
        if text in ("no limit", "undefined", ""):
            continue
        unit = each.given.get("unit", "m/s")
        if unit not in _UNITS:
            told = f"unit {unit[:20]!r} is no unit of speed; give one of"
            raise ValueError(f"{each.where}: {told} {', '.join(_UNITS)}")
        value = each.number("max")
        if limits.low <= value * _UNITS[unit] <= limits.high:
            given.append((f"{value:.4g} {unit}", each.where))
        else:
            notes.append(
                f"{each.where}: the speed limit {value:.4g} {unit} is left out"
            )
    first = given[0][0] if given else ""
    others = sorted({text for text, _ in given} - {first})
    if others:
        told = f"the speed limit changes to {', '.join(others)}"
        notes.append(f"{given[1][1]}: {told}; {first} is shown all along")
    return first, notes
