"""What an OpenDRIVE road has that costeer does not drive on: it is named."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from costeer.scenarios.opendrive.lanes import BESIDE, DRIVING
from costeer.scenarios.opendrive.tree import Element

_CUBICS: dict[tuple[str, ...], str] = {
    ("elevationProfile", "elevation"): "elevation: the road is read as flat",
    ("lateralProfile", "superelevation"): "superelevation: the road is read as level",
    ("lateralProfile", "crossfall"): "crossfall: the road is read as level",
}

_REFUSED = ("include", "crossSectionSurface")
"""Elements without which a road would be another one."""

_UNREAD: dict[tuple[str, ...], str] = {
    ("lateralProfile", "shape"): "the shape of its surface is not read",
    ("surface",): "its surface is not read",
    ("railroad",): "its rails are not read",
}


def left_out(root: Element, road: Element) -> Iterator[str]:
    """What is not read of a road, a line each.

    Raises:
        ValueError: If without it the road would be another one.
    """
    for element in (*root.children, *road.children):
        if element.name in _REFUSED:
            told = f"<{element.name}> is not read"
            raise ValueError(f"{element.where}: {told}; write out what it stands for")
    for path, told in _CUBICS.items():
        records = road.below(*path)
        uneven = [
            each
            for each in records
            if any(abs(each.number(name, 0.0)) > 1e-9 for name in "bcd")
            or abs(each.number("a", 0.0) - records[0].number("a", 0.0)) > 1e-9
            or (path[0] == "lateralProfile" and abs(each.number("a", 0.0)) > 1e-9)
        ]
        if uneven:
            yield f"{uneven[0].where}: {told}"
    for path, told in _UNREAD.items():
        for element in road.below(*path)[:1]:
            if element.given or len(path) > 1:
                yield f"{element.where}: {told}"
    yield from _around(road)
    yield from _lanes(road)


def _around(road: Element) -> Iterator[str]:
    """Junctions and roads that it is part of or leads to."""
    junction = road.given.get("junction", "-1")
    if junction != "-1":
        told = f"the road lies within junction {junction[:20]}"
        yield f"{road.where}: {told}; nothing else of the junction is read"
    for name in ("predecessor", "successor"):
        for link in road.below("link", name):
            what = link.given.get("elementType", "road")
            number = link.given.get("elementId", "")[:20]
            place = "begins" if name == "predecessor" else "ends"
            yield f"{link.where}: it {place} at {what} {number}, which is not read"


def _lanes(road: Element) -> Iterator[str]:
    """Lanes of other kinds, a line for all."""
    kinds: Counter[str] = Counter()
    lines: dict[str, str] = {}
    for section in road.below("lanes", "laneSection"):
        for side in ("left", "right"):
            for each in section.below(side, "lane"):
                kind = each.given.get("type", "none")
                if kind not in (DRIVING, "none", *BESIDE):
                    kinds[kind] += 1
                    lines.setdefault(kind, each.where)
    for kind in kinds:
        yield f"{lines[kind]}: lanes of type {kind[:30]} are not read"
