"""Scenarios from files: every key known, every value possible, errors with lines."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import cache, lru_cache
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from costeer.base.described import nearest
from costeer.base.files import read_whole
from costeer.base.nested import filled, parsed_mapping
from costeer.scenarios.definition import Bent, Scenario, curvature_of, speed_of
from costeer.scenarios.faults import faults, faults_of_speed
from costeer.scenarios.limits import Place
from costeer.scenarios.unreadable import in_words

_LONGEST_FILE = 200_000
"""Of a scenario [bytes]: some hundred times those that ship."""

_LONGEST_MESSAGE = 400

_EXAMPLE = "'name: mine'; costeer scenario new FILE.yaml writes a file to begin with"
"""Of what a scenario holds."""

_STEEPEST = 25.0
"""Change of lateral acceleration above which a note is made [m/s³]. Source: assumed,
beyond where imported roads with a straight that meets an arc have it; drivers keep
below 1 where they can choose."""


@cache
def shipped() -> tuple[str, ...]:
    """Names of the scenarios that ship with costeer, the paper's first."""
    folder = files("costeer.scenarios").joinpath("catalogue")
    names = sorted(each.name.removesuffix(".yaml") for each in folder.iterdir())
    return tuple(sorted(names, key=lambda name: name != "expressway"))


def shipped_text(name: str) -> str:
    """The file of a scenario that ships with costeer."""
    file = files("costeer.scenarios").joinpath(f"catalogue/{name}.yaml")
    return file.read_text("utf-8")


@cache
def _shipped(name: str) -> Scenario:
    return parsed(shipped_text(name), name)


def scenario_named(given: str | Scenario, speed: float | None = None) -> Scenario:
    """A scenario by its name, from a file `NAME.yaml`, or itself.

    Args:
        given: What is asked for.
        speed: That is driven there, if it is not the scenario's own [m/s].

    Raises:
        ValueError: If there is none, its file does not say one, or a curve is too
            tight for the speed.
        OSError: If the file cannot be read.
    """
    scenario = _found(given)
    for fault in () if speed is None else faults_of_speed(scenario, speed):
        raise ValueError(f"scenario {scenario.name}: {fault.text}")
    return scenario


def _found(given: str | Scenario) -> Scenario:
    if isinstance(given, Scenario):
        try:
            return _remembered(given)
        except TypeError:  # lists in it, which have no hash
            return checked(given)
    if not isinstance(given, str):
        raise ValueError(
            f"scenario is {given!r:.80}; give a name, such as expressway, a file "
            "NAME.yaml, or a costeer.Scenario"
        )
    if given in shipped():
        return _shipped(given)
    if given.endswith((".yaml", ".yml")):
        return read_scenario(Path(given))
    raise ValueError(
        f"scenario '{given}' is not known{nearest(given, shipped())}; choose one of "
        f"{', '.join(shipped())}, or give a file NAME.yaml"
    )


@lru_cache(maxsize=16)
def _remembered(scenario: Scenario) -> Scenario:
    """The scenario, if it can be; a study asks for the same one at every trial."""
    return checked(scenario)


class Chosen(NamedTuple):
    """A scenario with the length and speed that are driven.

    Attributes:
        scenario: Checked.
        length: Of the course [m].
        speed: Suggested, and at the start [m/s].
        notes: What a user should know.
    """

    scenario: Scenario
    length: float
    speed: float
    notes: tuple[str, ...]


def chosen(given: str | Scenario, length: float | None, speed: float | None) -> Chosen:
    """A scenario with length and speed; what is not given is its own.

    Args:
        given: A name, a file `NAME.yaml`, or itself.
        length: Of the course [m].
        speed: [m/s].

    Raises:
        ValueError: If there is none, or a curve is too tight for the speed.
        OSError: If the file cannot be read.
    """
    for name, value, unit in (("length", length, "m"), ("speed", speed, "m/s")):
        if not isinstance(value, int | float | None) or isinstance(value, bool):
            raise ValueError(f"{name} is {value!r}; give a number [{unit}]")
    scenario = scenario_named(given, speed)
    own = scenario.road.length
    driven = own if length is None else length
    beyond = [f"{name} ({at:g} m)" for name, at in _places(scenario) if at > driven]
    fast = speed_of(scenario.speed) if speed is None else speed
    notes = _doubts(scenario, fast)
    if beyond:
        told = f"beyond {driven:g} m of scenario {scenario.name} lie"
        notes.append(f"{told} {', '.join(beyond[:3])}; make it longer to meet them")
    if driven > own and scenario.road.stations:
        told = f"after {own:g} m the road of scenario {scenario.name} goes on as it"
        notes.append(f"{told} ends")
    return Chosen(scenario, driven, fast, tuple(notes))


def _doubts(scenario: Scenario, speed: float) -> list[str]:
    """What looks wrong in a scenario and can be driven all the same."""
    limit = scenario.road.speed_limit
    told, found = f"scenario {scenario.name}", []
    if limit and speed_of(limit) < speed - 1e-9:
        fast = f"{speed * 3.6:.4g} km/h"
        found.append(f"{told} is driven at {fast} where signs allow {limit}")
    steep = [*_steep(scenario.road.stations, speed)]
    for one, after, least in steep[:1]:
        more = f" (and in {len(steep) - 1} more places)" if steep[1:] else ""
        found.append(
            f"{told}: nobody can follow the curvature from {one.at:.10g} to "
            f"{after.at:.10g} m{more}; put the stations {least:.2g} m apart or more"
        )
    return found


def _steep(
    stations: Sequence[Bent], speed: float
) -> Iterator[tuple[Bent, Bent, float]]:
    """Stations between which the curvature jumps, and the distance they need [m]."""
    for one, after in pairwise(stations):
        turn = abs(curvature_of(after) - curvature_of(one))
        least = speed**3 * turn / _STEEPEST
        if after.at - one.at < least:
            yield one, after, least


def _places(scenario: Scenario) -> Iterator[tuple[str, float]]:
    """What happens along the road, and how far one must drive to meet it [m]."""
    for event in scenario.events:
        yield f"the {event.kind}", event.at
    for actor in scenario.actors:
        appears = math.nan if actor.appears is None else actor.appears.place
        yield actor.name, max(actor.at, 0.0 if math.isnan(appears) else appears)
        for order in actor.orders:
            if not math.isnan(order.when.place):
                yield f"an order of {actor.name}", order.when.place
    for zone in scenario.zones:
        yield f"zone {zone.name}", zone.end


def read_scenario(path: Path) -> Scenario:
    """The scenario of a YAML file.

    Raises:
        ValueError: Naming the first wrong value with its line.
        OSError: If it cannot be read.
    """
    return parsed(read_whole(path, _LONGEST_FILE), str(path))


def parsed(text: bytes | str, name: str) -> Scenario:
    """The scenario of a YAML text.

    Args:
        text: UTF-8.
        name: Of the file, for messages.

    Raises:
        ValueError: Naming the first wrong value with its line.
    """
    try:
        _refuse_references(text, name)
        content = parsed_mapping(text, name)
        scenario = filled(Scenario, content, name)
    except ValueError as error:
        told = in_words(error, text, name).replace("'seed: 1'", _EXAMPLE)
        shortened = f"{told[: _LONGEST_MESSAGE - 3]}..."
        wrong = told if len(told) <= _LONGEST_MESSAGE else shortened
        raise ValueError(wrong) from error
    except Exception as error:  # whatever odd tags make the parser raise
        raise ValueError(
            f"{name} holds a value that no scenario has ({type(error).__name__}); "
            "give plain numbers, text and lists"
        ) from error
    for fault in faults(scenario):
        line = _line(content, fault.place)
        told = f"{name}: " if line is None else f"{name}, line {line}: "
        raise ValueError(told + fault.text)
    return scenario


def _refuse_references(text: bytes | str, name: str) -> None:
    """Refuse `*name`: a few of them can stand for more than fits into memory.

    Raises:
        ValueError: If there is one.
    """
    if (b"*" if isinstance(text, bytes) else "*") not in text:  # type: ignore[operator]  # of one kind
        return
    try:
        found = [each for each in yaml.scan(text) if isinstance(each, yaml.AliasToken)]
    except yaml.YAMLError:
        return  # told by the parser
    if found:
        line = found[0].start_mark.line + 1
        raise ValueError(
            f"{name}, line {line}: references are not read; write out what "
            f"*{found[0].value} stands for"
        )


def scenario_of(told: Mapping[str, Any]) -> Scenario:
    """The scenario that a record or a study tells of.

    Args:
        told: As `writing.plain` or a record's metadata has it; null is not set.

    Raises:
        ValueError: If it is none.
    """
    return checked(filled(Scenario, _without_nulls(told), "the scenario"))


def _without_nulls(told: Any) -> Any:  # Any: part of a mapping from JSON
    if isinstance(told, Mapping):
        given = told.items()
        return {key: _without_nulls(each) for key, each in given if each is not None}
    return [*map(_without_nulls, told)] if isinstance(told, list | tuple) else told


def checked(scenario: Scenario) -> Scenario:
    """The scenario, if it can be.

    Raises:
        ValueError: Naming the first wrong value.
    """
    name = f"scenario {scenario.name}"
    known: Scenario = filled(Scenario, _as_mapping(scenario), name)
    for fault in faults(known):
        raise ValueError(f"{name}: {fault.text}")
    return known


def _as_mapping(value: Any) -> Any:  # Any: a field of a scenario
    """Named tuples as mappings, so that the kinds of their values are checked too."""
    if hasattr(value, "_asdict"):
        given = value._asdict().items()
        return {name: _as_mapping(each) for name, each in given if each is not None}
    return [*map(_as_mapping, value)] if isinstance(value, list | tuple) else value


def _line(content: Any, place: Place) -> int | None:  # Any: a part of a file
    """Line of a value, or of the nearest thing around it that has one."""
    line: int | None = None
    for step in place:
        line = getattr(content, "lines", {}).get(step, line)
        try:
            content = content[step]
        except (KeyError, IndexError, TypeError):
            break
        if isinstance(step, int):
            first = getattr(content, "lines", {})
            line = min(first.values(), default=line)
    return line
