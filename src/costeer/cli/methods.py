"""`costeer methods`: the methods that --method takes, and what each is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli.console import note, print_table

if TYPE_CHECKING:
    from costeer.comparison.catalogue import Listed

_BELIEVED = ("controller.car.", "controller.column.", "controller.road.")
"""Of the method, but no numbers that make it what it is."""


def methods(
    method: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="Method to show with its own parameters: a name, "
            "module:object or FILE.py.",
        ),
    ] = "",
    json: Annotated[
        bool, typer.Option("--json", help="Print the results as JSON.")
    ] = False,
) -> None:
    """List the methods of assistance, costeer's own and installed plug-ins.

    For each method it says what its law is, how it learns of a lane change (from the
    driver's intention, by a predictor or --intention scripted, or from the indicator),
    and where it is published. A plug-in that cannot be used is listed with the reason.

    Example:
        costeer methods
        costeer methods --method bandwidth
        costeer methods --method my_method.py --json
    """
    from costeer.comparison.catalogue import listed_methods

    if method:
        _show_one(method, json)
        return
    found = listed_methods()
    if json:
        _print_json([each._asdict() for each in found])
        return
    usable = [each for each in found if not each.failure]
    print_table(
        ["name", "law", "needs", "source", "from"],
        [
            [each.name, each.law, _needs(each), each.source, each.place]
            for each in usable
        ],
    )
    for each in found:
        if each.failure:
            note(f"costeer: {each.name} ({each.place}) cannot be used: {each.failure}")


def _needs(each: Listed) -> str:
    """What must tell a method of a lane change; a dash if it sees for itself."""
    parts = (("intention", each.intention), ("indicator", each.indicator))
    return " and ".join(name for name, is_heard in parts if is_heard) or "-"


def _show_one(given: str, json: bool) -> None:
    """Print what a method is, then its own parameters.

    Raises:
        ValueError: If there is none, or it cannot be used.
    """
    from costeer.cli.parameters import listed_of, print_parameters, rows_of
    from costeer.comparison.catalogue import about_method
    from costeer.loop.scenario import TrialSetup
    from costeer.methods.registry import method_named

    found = method_named(given)
    about = about_method(found)
    condition = "strong-normal" if found.assists else "manual"
    listed = listed_of(TrialSetup(method=given, condition=condition))
    own = [
        each
        for each in listed
        if each.is_own and not each.told.name.startswith(_BELIEVED)
    ]
    if json:
        _print_json(about._asdict() | {"parameters": rows_of(own)})
        return
    typer.echo(f"{about.name}, version {about.version}: {about.law or 'says no more'}")
    typer.echo(f"source: {about.source}")
    typer.echo(f"needs: {_needs(about)}")
    if found.columns:
        adds = (f"{each.name} [{each.unit}]" for each in found.columns)
        typer.echo(f"adds to a record: {', '.join(adds)}")
    if found.tunables:
        names = ", ".join(each.name for each in found.tunables)
        typer.echo(f"can be moved during a drive: {names}")
    print_parameters(own, found)
    note(
        f"costeer: what {about.name} believes of car, column and road, and all else of "
        f"a trial: costeer parameters --method {given}"
    )


def _print_json(shown: object) -> None:
    import json

    typer.echo(json.dumps(shown, indent=2, ensure_ascii=False))
