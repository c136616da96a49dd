"""`costeer scenario`: list, show, preview, make and export scenarios."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from costeer.cli.units import parse_speed

_USES = {
    "list": frozenset[str](),
    "mistakes": frozenset[str](),
    "show": frozenset({"TARGET"}),
    "preview": frozenset({"TARGET", "--out"}),
    "export": frozenset({"TARGET", "--out"}),
    "new": frozenset(
        {"TARGET", "--from", "--opendrive", "--road", "--against", "--speed"}
    ),
}
"""What each action takes."""


def scenario(
    action: Annotated[
        str,
        typer.Argument(
            help="What to do: list, show, preview, new, export or mistakes."
        ),
    ],
    target: Annotated[
        str | None,
        typer.Argument(
            help="Name or FILE.yaml of a scenario; with new, FILE.yaml to write."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="File to write, replaced if it exists: FILE.svg with "
            "preview, FILE.xodr (OpenDRIVE) with export."
        ),
    ] = None,
    origin: Annotated[
        str | None,
        typer.Option(
            "--from", metavar="NAME", help="With new: scenario to start from."
        ),
    ] = None,
    opendrive: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.xodr", help="With new: OpenDRIVE file to take the road from."
        ),
    ] = None,
    road: Annotated[
        str | None,
        typer.Option(
            metavar="ID", help="With --opendrive: road to take, if there are several."
        ),
    ] = None,
    against: Annotated[
        bool,
        typer.Option(
            "--against",
            help="With --opendrive: take the lanes that run against the "
            "reference line.",
        ),
    ] = False,
    speed: Annotated[
        float | None,
        typer.Option(
            parser=parse_speed,
            metavar="SPEED",
            help="With --opendrive: suggested speed [m/s], or with a unit, "
            "such as 90km/h; by default the file's speed limit, or what "
            "its curves allow.",
        ),
    ] = None,
) -> None:
    """List, show, draw, make and export scenarios: roads, other cars, events.

    A scenario is a short YAML file. `new` writes one for you to edit: with a straight
    road, from a scenario that ships with costeer, or with a road of an OpenDRIVE file.
    `mistakes` lists what can be made to go wrong on purpose, in a scenario or with
    --mistake of `costeer simulate` and `costeer study`.

    Example:
        costeer scenario list
        costeer scenario mistakes
        costeer scenario show cut-in
        costeer scenario preview expressway-curves --out out/curves.svg
        costeer scenario new mine.yaml --from cut-in
        costeer scenario new e6.yaml --opendrive e6mini.xodr
        costeer scenario export expressway-curves --out out/curves.xodr
    """
    from costeer.cli import scenario_actions as actions

    given = {
        "TARGET": target is not None,
        "--out": out is not None,
        "--from": origin is not None,
        "--opendrive": opendrive is not None,
        "--road": road is not None,
        "--against": against,
        "--speed": speed is not None,
    }
    _check(action, {name for name, value in given.items() if value})
    if action == "list":
        actions.show_all()
    elif action == "mistakes":
        actions.show_mistakes()
    elif action == "show":
        actions.show_one(target or "")
    elif action == "preview":
        actions.draw(target or "", out or Path())
    elif action == "export":
        actions.write_road(target or "", out or Path())
    elif opendrive is None:
        actions.make(Path(target or ""), origin)
    else:
        asked = actions.RoadAsked(opendrive, road or "", against, speed)
        actions.make_on_road(Path(target or ""), asked)


def _check(action: str, given: set[str]) -> None:
    """Refuse what contradicts, is missing, or would do nothing.

    Raises:
        ValueError: If there is any.
    """
    if action not in _USES:
        from costeer.base.described import nearest

        close = nearest(action, _USES)
        raise ValueError(f"{action!r} is no action{close}; give {', '.join(_USES)}")
    if useless := sorted(given - _USES[action]):
        raise ValueError(f"{action} does not use {' and '.join(useless)}; leave it out")
    if "TARGET" in _USES[action] - given:
        what = "the FILE.yaml to write" if action == "new" else "a name or FILE.yaml"
        raise ValueError(f"{action} needs {what}, as costeer scenario {action} ...")
    if "--out" in _USES[action] - given:
        ending = "svg" if action == "preview" else "xodr"
        raise ValueError(f"{action} needs --out FILE.{ending}")
    if {"--from", "--opendrive"} <= given:
        raise ValueError("give --from or --opendrive, not both")
    unused = sorted(given & {"--road", "--against", "--speed"})
    if unused and "--opendrive" not in given:
        raise ValueError(f"{' and '.join(unused)} needs --opendrive FILE.xodr")
