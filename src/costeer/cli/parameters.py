"""`costeer parameters`: every number of the loop that can be set by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli import plug_ins
from costeer.cli.console import print_table

if TYPE_CHECKING:
    from costeer.base.described import Described


def parameters(
    words: Annotated[
        list[str] | None, typer.Argument(help="Only names that contain all of these.")
    ] = None,
    method: plug_ins.Method = "ibhs",
    condition: Annotated[
        str, typer.Option(help="manual, or strong or weak with a duration.")
    ] = "strong-normal",
    car: plug_ins.Car = "default",
    assignments: plug_ins.Assignments = None,
    file: plug_ins.ParameterFile = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List every parameter that --set can change: value, unit, range, source.

    Example:
        costeer parameters
        costeer parameters guidance
        costeer parameters --method my_method.py --json
    """
    from costeer.loop.inputs import car_of
    from costeer.loop.overrides import parameter_list
    from costeer.loop.scenario import TrialSetup, loop_parameters

    setup = TrialSetup(
        condition=condition,
        method=method,
        car=car_of(car),
        parameters=plug_ins.chosen_values(file, assignments),
    )
    usual = loop_parameters(setup._replace(parameters=()))
    listed = parameter_list(loop_parameters(setup), usual)
    shown = _named(listed, words or [])
    if json:
        _print_json(shown)
        return
    print_table(
        ["name", "value", "unit", "from", "to", "what", "source"],
        [
            [
                each.name,
                f"{each.value:.6g}",
                _unit(each),
                f"{each.allowed.low:.4g}",
                f"{each.allowed.high:.4g}",
                each.meaning,
                each.source,
            ]
            for each in shown
        ],
    )


def _unit(each: Described) -> str:
    """The unit in which `--set` takes it, and the value in that of people."""
    from costeer.pages.units import shown

    unit, factor = shown(each.unit)
    return (
        each.unit
        if factor == 1.0
        else f"{each.unit} ({each.value * factor:.4g} {unit})"
    )


def _named(listed: list[Described], words: list[str]) -> list[Described]:
    """Parameters whose names contain all words.

    Raises:
        ValueError: If there is none.
    """
    from costeer.base.described import nearest

    shown = [each for each in listed if all(word in each.name for word in words)]
    if not shown:
        raise ValueError(
            f"no parameter has {' and '.join(words)} in its name"
            f"{nearest(' '.join(words), (each.name for each in listed))}"
        )
    return shown


def _print_json(shown: list[Described]) -> None:
    import json

    rows = [each._asdict() | each.allowed._asdict() for each in shown]
    for row in rows:
        del row["allowed"]
    typer.echo(json.dumps(rows, indent=2, ensure_ascii=False))
