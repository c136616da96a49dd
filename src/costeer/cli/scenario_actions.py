"""What `costeer scenario` does: one function for each of its actions."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import typer

from costeer.base.files import write_text
from costeer.cli.console import note, print_table
from costeer.scenarios.definition import Scenario, curvature_of
from costeer.scenarios.faults import fastest, faults_of_speed
from costeer.scenarios.limits import LIMITS
from costeer.scenarios.mistakes import MISTAKES
from costeer.scenarios.reading import (
    checked,
    parsed,
    scenario_named,
    shipped,
    shipped_text,
)
from costeer.scenarios.writing import scenario_text, template

_USUAL_SPEED = 70.0
"""Where an OpenDRIVE file names no limit [km/h]."""


def show_all() -> None:
    """Print the scenarios that ship with costeer."""
    print_table(
        ["name", "about", "road", "other cars", "speed"],
        [_row(scenario_named(name)) for name in shipped()],
    )


def show_mistakes() -> None:
    """Print all mistakes with their usual sizes and ranges."""
    rows = []
    for name, kind in MISTAKES.items():
        unit = "" if kind.unit in ("", "-") else f" {kind.unit}"
        numbers = (f"{n:.4g}" for n in (kind.size, kind.low, kind.high))
        size, low, high = numbers if kind.unit else ("", "", "")
        about = kind.about.format("SIZE")
        rows.append(
            [name, kind.whose, f"{size}{unit if size else ''}", low, high, about]
        )
    print_table(["mistake", "of", "size", "from", "to", "what goes wrong"], rows)


def _row(scenario: Scenario) -> list[str]:
    road = scenario.road
    sharpest = max((abs(curvature_of(each)) for each in road.stations), default=0.0)
    shape = f"curves to {1.0 / sharpest:.0f} m" if sharpest else "straight"
    cars = scenario.overtaking.cars + scenario.stream.cars + len(scenario.actors)
    return [
        scenario.name,
        scenario.about,
        f"{road.length / 1000:g} km, {road.lanes} lanes, {road.traffic}, {shape}",
        str(cars),
        scenario.speed,
    ]


def show_one(name: str) -> None:
    """Print a scenario with all its values."""
    typer.echo(scenario_text(scenario_named(name)), nl=False)


def draw(name: str, out: Path) -> None:
    """Write the figure of a scenario.

    Raises:
        ValueError: If there is no such scenario, or the file would be no SVG.
        OSError: If it cannot be written.
    """
    from costeer.scenarios.preview import preview_svg

    scenario = scenario_named(name)
    _write(out, ".svg", preview_svg(scenario))


def write_road(name: str, out: Path) -> None:
    """Write the road of a scenario as OpenDRIVE.

    Raises:
        ValueError: If there is no such scenario, or the file has another ending.
        OSError: If it cannot be written.
    """
    from costeer.scenarios.opendrive.writing import road_text

    scenario = scenario_named(name)
    _write(out, ".xodr", road_text(scenario))
    if scenario.actors or scenario.events or scenario.stream.cars:
        note("costeer: other cars and events are not in an OpenDRIVE file")


def _write(out: Path, ending: str, text: str) -> None:
    if out.suffix != ending:
        raise ValueError(f"--out is {str(out)!r}; give a name that ends in {ending}")
    out.parent.mkdir(parents=True, exist_ok=True)
    write_text(out, text)
    typer.echo(out)


def make(file: Path, origin: str | None) -> None:
    """Write a scenario to fill in, or a copy of one that ships with costeer.

    Raises:
        ValueError: If the file is there, or there is no such scenario.
        OSError: If it cannot be written.
    """
    name = _name_for(file)
    if origin is None:
        text = template(Scenario(name, about="What happens here, in one sentence."))
    elif origin in shipped():
        text = shipped_text(origin).replace(f"name: {origin}\n", f"name: {name}\n", 1)
    else:
        scenario_named(origin)  # names the nearest one
        text = Path(origin).read_text("utf-8")
    _write_new(file, text)


class RoadAsked(NamedTuple):
    """Which road of which file.

    Attributes:
        file: OpenDRIVE.
        road: Its id; empty for the only one.
        against: Whether to drive against the reference line.
        speed: Suggested; None: as the file and its curves say [m/s].
    """

    file: Path
    road: str
    against: bool
    speed: float | None


def make_on_road(file: Path, asked: RoadAsked) -> None:
    """Write a scenario on a road of an OpenDRIVE file, and say how close it is.

    Raises:
        ValueError: If the road cannot be read, is too tight for the speed, or the file
            is there.
        OSError: If a file cannot be read or written.
    """
    from costeer.scenarios.opendrive.fitting import STRETCH
    from costeer.scenarios.opendrive.roads import read_road

    name = _name_for(file)
    read = read_road(asked.file, asked.road, asked.against)
    about = f"The road of {asked.file.name[:100]}."
    empty = Scenario(name, about=about, road=read.road)
    limits = LIMITS[Scenario]["speed"]
    speed = _wanted_speed(empty) if asked.speed is None else asked.speed
    if not limits.low <= speed <= limits.high:
        low, high = limits.low * 3.6, limits.high * 3.6
        raise ValueError(
            f"--speed is {speed * 3.6:.4g} km/h; give {low:.4g} to {high:.4g} km/h"
        )
    for fault in faults_of_speed(empty, speed):
        raise ValueError(f"{asked.file}: {fault.text}")
    made = checked(empty._replace(speed=f"{speed * 3.6:.6g} km/h"))
    close = (
        f"the road is within {read.errors.stretch:.3f} m of the file's in every "
        f"{STRETCH:g} m, and within {read.errors.whole:.2f} m over all of its "
        f"{read.road.length:.0f} m"
    )
    for each in read.notes:
        note(f"note on {each}")
    _write_new(file, template(made, [f"Of {asked.file.name}: {close}."]))
    note(f"costeer: {close}")


def _wanted_speed(scenario: Scenario) -> float:
    """The limit of a road, or the usual speed; less where curves are tight [m/s].

    Raises:
        ValueError: If a curve is too tight for any speed.
    """
    from costeer.scenarios.definition import speed_of

    limits, road = LIMITS[Scenario]["speed"], scenario.road
    usual = speed_of(road.speed_limit or f"{_USUAL_SPEED} km/h")
    usual = min(max(usual, limits.low), limits.high)
    if fastest(road) >= usual:
        return usual
    slower = max(5.0 * (fastest(road) * 3.6 // 5.0) / 3.6, limits.low)
    if fastest(road) >= limits.low:
        note(
            f"costeer: curves allow {fastest(road) * 3.6:.0f} km/h; the speed is "
            f"{slower * 3.6:.4g} km/h"
        )
    return slower


def _name_for(file: Path) -> str:
    """The name of a scenario in a new file.

    Raises:
        ValueError: If the file is there, or is no YAML by its name.
    """
    if file.suffix not in (".yaml", ".yml"):
        raise ValueError(f"{file} is no name of a scenario; give FILE.yaml")
    if file.exists():
        raise ValueError(f"{file} is there already; choose another name")
    name = re.sub(r"[^a-z0-9]+", "-", file.stem.lower()).lstrip("-0123456789")
    return name[:40].strip("-") or "own"


def _write_new(file: Path, text: str) -> None:
    overtaking = parsed(text, str(file)).overtaking
    if overtaking.cars:
        told = f"costeer: a slower car to overtake appears at {overtaking.first:g} m"
        note(f"{told}; take overtaking out of {file} to drive without")
    file.parent.mkdir(parents=True, exist_ok=True)
    write_text(file, text)
    typer.echo(file)
