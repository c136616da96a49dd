"""`costeer parameters`: every number of the loop that can be set by name."""

from __future__ import annotations

import json as json_text
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from costeer.cli import plug_ins
from costeer.cli.console import note, print_table

if TYPE_CHECKING:
    from costeer.base.described import Described
    from costeer.loop.scenario import TrialSetup
    from costeer.methods.registry import AnyMethod


def parameters(
    words: Annotated[
        list[str] | None,
        typer.Argument(help="Words, all of which a listed name contains."),
    ] = None,
    method: plug_ins.Method = "ibhs",
    condition: Annotated[
        str,
        typer.Option(
            help="Condition: manual, or a strength and a duration, such as weak-gentle."
        ),
    ] = "strong-normal",
    car: plug_ins.Car = "default",
    assignments: plug_ins.Assignments = None,
    file: plug_ins.ParameterFile = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print the results as JSON.")
    ] = False,
) -> None:
    """List every parameter that --set can change: value, unit, range, source.

    Example:
        costeer parameters
        costeer parameters guidance
        costeer parameters --method my_method.py --json
    """
    from costeer.loop.inputs import car_of
    from costeer.loop.scenario import TrialSetup
    from costeer.methods.registry import method_named

    setup = TrialSetup(
        condition=condition,
        method=method,
        car=car_of(car),
        parameters=plug_ins.chosen_values(file, assignments),
    )
    shown = _named(listed_of(setup), words or [])
    if json:
        typer.echo(json_text.dumps(rows_of(shown), indent=2, ensure_ascii=False))
        return
    print_parameters(shown, method_named(method))


class Shown(NamedTuple):
    """A parameter as it is printed.

    Attributes:
        told: Name, value, unit, range, meaning, source.
        is_own: Whether it is the method's own, not the world's.
    """

    told: Described
    is_own: bool


def listed_of(setup: TrialSetup) -> list[Shown]:
    """Every parameter of a trial, the method's first.

    One of the method's own that is in no group is shown with `controller.`, so that
    its name says whose it is; `--set` takes it without as well. Where the docstring
    that describes it names no unit, that of a tunable serves.

    Raises:
        ValueError: If the trial cannot be.
    """
    from costeer.base.described import described
    from costeer.loop.overrides import METHOD, parameter_list
    from costeer.loop.scenario import loop_parameters
    from costeer.methods.registry import method_named

    parameters = loop_parameters(setup)
    usual = loop_parameters(setup._replace(parameters=()))
    known = {each.name for each in described(parameters)}
    moved = {each.leaf: each for each in method_named(setup.method).tunables}
    found = []
    for each in parameter_list(parameters, usual):
        place = each.name.removeprefix(METHOD)
        is_own = each.name not in known or each.name.startswith(METHOD)
        name = METHOD + place if is_own and "." not in place else each.name
        told = each._replace(name=name)
        if is_own and place in moved:
            told = told._replace(
                unit=told.unit or moved[place].unit,
                meaning=told.meaning or moved[place].label,
            )
        found.append(Shown(told, is_own))
    return found


def print_parameters(shown: list[Shown], method: AnyMethod) -> None:
    """Print parameters as a table; say where a plug-in tells no unit."""
    from costeer.methods.registry import METHODS

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
            for each, _ in shown
        ],
    )
    silent = [each.name for each, is_own in shown if is_own and not each.unit]
    if silent and method.name not in METHODS:
        note(
            f"costeer: method {method.name} names no unit of {', '.join(silent)}; "
            "units, meanings and sources are read from the Attributes: section of the "
            "docstring of the class that has the parameter"
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


def _named(listed: list[Shown], words: list[str]) -> list[Shown]:
    """Parameters whose names contain all words.

    Raises:
        ValueError: If there is none.
    """
    from costeer.base.described import nearest

    shown = [each for each in listed if all(word in each.told.name for word in words)]
    if not shown:
        raise ValueError(
            f"no parameter has {' and '.join(words)} in its name"
            f"{nearest(' '.join(words), (each.told.name for each in listed))}"
        )
    return shown


def rows_of(shown: list[Shown]) -> list[dict[str, object]]:
    """Parameters as plain values."""
    rows = []
    for each, is_own in shown:
        row = each._asdict() | each.allowed._asdict()
        del row["allowed"]
        rows.append(row | {"of": "method" if is_own else "trial"})
    return rows
