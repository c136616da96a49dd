"""What of a scenario a drive did not meet."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.records.columns import TrialRecord
from costeer.scenarios.definition import SIDES, Actor, Event, When, size_of
from costeer.scenarios.reading import scenario_of

_WITHIN = 10.0
"""From the end of a stretch on which a lane change is asked for until its line is
crossed, at the latest [s]. Source: assumed; nearly all virtual drivers take less."""

Columns = Mapping[str, NDArray[np.float64]]


def may_be_unmet(about: Mapping[str, Any]) -> bool:
    """Whether a scenario, as a record tells of it, has actors or asks for something."""
    told = about.get("scenario")
    return isinstance(told, Mapping) and bool(told.get("actors") or told.get("events"))


def unmet(record: TrialRecord) -> list[str]:
    """What a scenario had in store and a drive did not meet, in words.

    Args:
        record: Of the drive.
    """
    about: Any = record.metadata  # Any: from JSON
    columns, found = record.columns, list[str]()
    if not may_be_unmet(about):
        return []
    scenario = scenario_of(about["scenario"])
    own_length = about["configuration"]["car"]["length"]
    for number, actor in enumerate(scenario.actors, start=1):
        half = (size_of(actor)[0] + own_length) / 2.0
        found += _unmet_of(actor, f"car_{number:02d}", columns, half)
    asked = [each for each in scenario.events if each.kind == "lane-change"]
    made = [each for each in asked if each.at <= columns["longitudinal_position"][-1]]
    return found + [
        f"the driver did not change to the {each.side} as asked for at {each.at:g} m"
        for each in made
        if not _is_made(each, columns)
    ]


def _unmet_of(actor: Actor, name: str, columns: Columns, half: float) -> Iterator[str]:
    """Orders that an actor was never given; or it was never there."""
    there = np.isfinite(columns[f"{name}_position"])
    if not there.any():
        yield f"{actor.name} never appeared"
        return
    for order in actor.orders:
        if not (there & _is_due(order.when, name, columns, half)).any():
            does = f"lane {order.lane}" if not order.speed else order.speed
            yield f"{actor.name} never got its order ({does}): its moment did not come"


def _is_due(when: When, name: str, columns: Columns, half: float) -> NDArray[np.bool_]:
    """Where the moment of an order has come; `fleet_motion.is_due` has the same."""
    own = columns["longitudinal_position"]
    gap = columns[f"{name}_position"] - own
    if not math.isnan(when.time):
        return columns["time"] >= when.time
    if not math.isnan(when.place):
        return own >= when.place
    if not math.isnan(when.gap):
        return (gap > 0.0) & (gap <= when.gap)
    closing = columns["longitudinal_velocity"] - columns[f"{name}_velocity"]
    return (gap > 0.0) & (gap - half <= when.time_to_collision * closing)


def _is_made(event: Event, columns: Columns) -> bool:
    """Whether a line was crossed to the side that is asked for, in time."""
    crossed = np.diff(columns["lane"], prepend=columns["lane"][:1])
    place, time = columns["longitudinal_position"], columns["time"]
    begun = place >= event.at
    ended = place >= event.at + event.length
    latest = time[ended][0] + _WITHIN if ended.any() else np.inf
    return bool((begun & (time <= latest) & (crossed * SIDES[event.side] > 0.0)).any())
