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
        str, typer.Argument(help="list, show, preview, new, export; mistakes.")
    ],
    target: Annotated[
        str | None,
        typer.Argument(help="Name or FILE.yaml; with new the FILE.yaml to write."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="With preview FILE.svg, with export FILE.xodr (OpenDRIVE); replaced."
        ),
    ] = None,
    origin: Annotated[
        str | None,
        typer.Option("--from", metavar="NAME", help="With new: begin with this one."),
    ] = None,
    opendrive: Annotated[
        Path | None,
        typer.Option(metavar="FILE.xodr", help="With new: take the road of this file."),
    ] = None,
    road: Annotated[
        str | None,
        typer.Option(metavar="ID", help="With --opendrive: which road, if several."),
    ] = None,
    against: Annotated[
        bool,
        typer.Option(
            "--against", help="With --opendrive: lanes against the reference line."
        ),
    ] = False,
    speed: Annotated[
        float | None,
        typer.Option(
            parser=parse_speed,
            metavar="SPEED",
            help="With --opendrive: suggested [m/s], or with its unit: 90km/h; the "
            "limit of the file, or what its curves allow.",
        ),
    ] = None,
) -> None:
    """List, show, draw, make and export scenarios: roads, other cars, events.

    A scenario is a short YAML file; `new` writes one to fill in, on a straight road,
    after one that ships with costeer, or on a road of an OpenDRIVE file. `mistakes`
    lists what can go wrong on purpose, in a scenario or by --mistake.

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
