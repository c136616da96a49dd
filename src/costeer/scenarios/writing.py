"""Scenarios as text: with every value that a file leaves out, or as one to fill in."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import yaml

from costeer.scenarios.definition import Actor, Road, Scenario, size_of

_WIDTH = 88


def plain(value: Any) -> Any:  # Any: a scenario, or a part of one
    """A scenario as values that YAML and JSON have; what is not set is left out.

    `reading.scenario_of` makes the scenario of it again.
    """
    if isinstance(value, Actor):
        length, width = size_of(value)
        value = value._replace(length=length, width=width)
    if hasattr(value, "_asdict"):
        given = {name: plain(each) for name, each in value._asdict().items()}
        return {name: each for name, each in given.items() if _is_set(each)}
    return [*map(plain, value)] if isinstance(value, tuple | list) else value


def _is_set(value: Any) -> bool:
    return value is not None and not (
        isinstance(value, float) and not math.isfinite(value)
    )


def scenario_text(scenario: Scenario) -> str:
    """A scenario as YAML, with all its values."""
    return "".join(_entry(key, value) for key, value in plain(scenario).items())


def _entry(key: str, value: Any, indent: str = "") -> str:
    """A key with its value, on lines of their own."""
    if isinstance(value, dict):
        lines = [_entry(name, each, "  ") for name, each in value.items()]
        return f"{key}:\n{''.join(lines)}"
    if isinstance(value, list) and value and isinstance(value[0], dict):
        rows = "".join(f"{indent}  - {_flow(each, indent)}\n" for each in value)
        return f"{indent}{key}:\n{rows}"
    return f"{indent}{key}: {_flow(value, indent)}\n"


def _flow(value: Any, indent: str = "") -> str:
    """A value in one line, or as few as fit."""
    text = yaml.safe_dump(
        value,
        sort_keys=False,
        default_flow_style=True,
        allow_unicode=True,
        width=_WIDTH - len(indent) - 4,
    )
    lines = text.removesuffix("...\n").rstrip("\n").splitlines()
    return f"\n{indent}    ".join(lines)


_HEAD = """\
# A scenario of costeer: a road and what happens on it; docs/scenarios.md has every key.
#   costeer scenario show FILE     all values, also those that are not written here
#   costeer scenario preview FILE --out FILE.svg
#   costeer simulate --scenario FILE --out trial.parquet
# Lengths are in metres, times in seconds, speeds have a unit; left is positive, and
# lane 0 is the right one. What has a # before it below is an example: take it away.
"""

_ROAD = """\
  # Where the curvature changes; between two stations it changes evenly (a clothoid).
  # A station without a radius is straight; a positive radius is a curve to the left.
"""
_BEND = """\
  # stations:
  #   - {at: 500}
  #   - {at: 620, radius: 800}
  #   - {at: 1000, radius: 800}
  #   - {at: 1120}
"""

_REST = """
# Slower cars that appear ahead one after the other, each to be overtaken.
overtaking: {cars: 1, first: FIRST, spacing: 2000, ahead: 70}

# Cars all about that follow (IDM) and change lanes (MOBIL).
# stream: {cars: 12, speed: 75 km/h, reach: 300, trucks: 0.1}

# Single cars and obstacles: kind car, truck or obstacle. A moment (when, appears) is
# one of time, place (of the driven car), gap (to the actor) and time_to_collision.
# actors:
#   - name: cuts in
#     lane: 0
#     at: 100
#     speed: 68 km/h
#     orders:
#       - {when: {gap: 40}, lane: 1}
#       - {when: {gap: 32}, speed: 55 km/h, rate: 2}
#   - {name: lost load, kind: obstacle, lane: 1, appears: {place: 900}, headway: 2.5}

# What happens on stretches: gust (force in newtons), head-lost, lane-change (side).
# events:
#   - {kind: gust, at: 1300, length: 60, force: 1200}

# Stretches for which measures are computed by themselves.
# zones:
#   - {name: curve, start: 500, end: 1120}
"""


def template(scenario: Scenario, notes: Sequence[str] = ()) -> str:
    """A file to fill in: name, speed and road as given, examples of all else.

    Args:
        scenario: Whose road it has.
        notes: What a reader should know, a line of comment each.
    """
    told = "".join(f"# {' '.join(each.split())}\n" for each in notes)
    first = "".join(_entry(k, getattr(scenario, k)) for k in ("name", "about", "speed"))
    rest = _REST.replace("FIRST", f"{min(200, scenario.road.length // 4):g}")
    return f"{_HEAD}{told}\n{first}\n{_road(scenario.road)}{rest}"


def _road(road: Road) -> str:
    told = plain(road)
    stations = told.pop("stations")
    lines = "".join(_entry(key, value, "  ") for key, value in told.items())
    curves = _entry("stations", stations, "  ") if stations else _BEND
    return f"road:\n{lines}{_ROAD}{curves}"
