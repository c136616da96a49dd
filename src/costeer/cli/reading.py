"""Options by which tables of others are read; every command that does shares them."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from inspect import Parameter, signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeVar, get_type_hints

import typer

if TYPE_CHECKING:
    from costeer.records.adaptation import Adaptation
    from costeer.records.tables import Reading

Result = TypeVar("Result")

_BETWEEN = {"tab": "\t", "\\t": "\t", "comma": ",", "semicolon": ";", "space": " "}


class Told(NamedTuple):
    """What the options say, as they were given; each field is an option."""

    map_file: Annotated[
        Path | None,
        typer.Option(
            "--map",
            help="YAML file with names, units, scale, flip and marks of a "
            "laboratory's columns.",
        ),
    ] = None
    rename: Annotated[
        list[str] | None,
        typer.Option(
            "--rename", metavar="OLD=NEW", help="Rename a column; repeatable."
        ),
    ] = None
    scale: Annotated[
        list[str] | None,
        typer.Option(
            "--scale",
            metavar="COLUMN=FACTOR",
            help="Factor that converts a column, by its new name, to SI "
            "units; repeatable.",
        ),
    ] = None
    sequence: Annotated[
        str,
        typer.Option(
            "--sequence",
            metavar="COLUMN",
            help="Column that tells separate stretches apart; by default sequence.",
        ),
    ] = ""
    join_lanes: Annotated[
        bool,
        typer.Option(
            "--join-lanes",
            help="Take the lateral position as measured from the centre of "
            "the current lane.",
        ),
    ] = False
    drop_repeated: Annotated[
        bool,
        typer.Option("--drop-repeated", help="Leave out rows whose time is repeated."),
    ] = False
    separator: Annotated[
        str,
        typer.Option(
            "--separator",
            help="Separator between columns of a text file; by default detected.",
        ),
    ] = ""
    decimal: Annotated[
        str,
        typer.Option(
            "--decimal", help="Decimal mark of a text file; by default detected."
        ),
    ] = ""
    encoding: Annotated[
        str,
        typer.Option(
            "--encoding",
            help="Encoding of a text file, such as cp1252; by default detected.",
        ),
    ] = ""


AS_FOUND = Told()
OPTIONS = tuple(
    "--" + name.removesuffix("_file").replace("_", "-") for name in Told._fields
)


def reads_tables(command: Callable[..., Result]) -> Callable[..., Result]:
    """Give a command the options of `Told`; it takes them as its argument `told`."""

    @wraps(command)
    def run(**given: Any) -> Result:  # Any: each option has its own type
        told = Told(**{name: given.pop(name) for name in Told._fields})
        return command(told=told, **given)

    hints = get_type_hints(command, include_extras=True)
    options = get_type_hints(Told, include_extras=True)
    own = [
        each.replace(annotation=hints[each.name])
        for each in signature(command).parameters.values()
        if each.name != "told"
    ]
    shared = [
        Parameter(
            name,
            Parameter.POSITIONAL_OR_KEYWORD,
            default=Told._field_defaults[name],
            annotation=option,
        )
        for name, option in options.items()
    ]
    parameters = [*own, *shared]
    run.__annotations__ = {each.name: each.annotation for each in parameters}
    run.__signature__ = signature(command).replace(  # type: ignore[attr-defined]  # of Typer
        parameters=parameters
    )
    return run


class Way(NamedTuple):
    """How tables are to be read.

    Attributes:
        adaptation: Names, units and stretches.
        reading: Marks of a text.
    """

    adaptation: Adaptation
    reading: Reading


def way_of(told: Told) -> Way:
    """How tables are to be read: by the file of names, and the options before it.

    Raises:
        ValueError: If an option or the file says what it cannot.
        OSError: If the file of names cannot be read.
    """
    from costeer.cli.mapping import read_lab
    from costeer.records.adaptation import Adaptation

    lab = read_lab(told.map_file)
    adaptation = Adaptation(
        renames={**lab.renames, **pairs("--rename", told.rename or [])},
        scales={**lab.scales, **factors(told.scale or [])},
        sequence=told.sequence or lab.sequence,
        drop_repeated=told.drop_repeated,
        join_lanes=told.join_lanes,
    )
    reading = reading_of(
        told.separator or lab.separator,
        told.decimal or lab.decimal,
        told.encoding or lab.encoding,
    )
    return Way(adaptation, reading)


def options_given(told: Told) -> list[str]:
    """The options that were given."""
    return [
        option
        for option, value, usual in zip(OPTIONS, told, AS_FOUND, strict=True)
        if value != usual
    ]


def refuse_without_files(files: bool, told: Told) -> None:
    """Refuse options that have no table to say something of.

    Raises:
        ValueError: Naming them.
    """
    given = options_given(told)
    if given and not files:
        raise ValueError(f"{' and '.join(given)}: this is for tables; name them")


def reading_of(separator: str, decimal: str, encoding: str) -> Reading:
    """How a text is to be read, from the options.

    Raises:
        ValueError: If a mark is not one letter, or both are the same.
    """
    from costeer.records.tables import Reading

    between = _BETWEEN.get(separator, separator)
    mark = {"point": ".", "comma": ","}.get(decimal, decimal)
    if len(between) > 1:
        raise ValueError(f"--separator {separator}: give one letter, or tab")
    if mark not in ("", ".", ","):
        raise ValueError(f"--decimal {decimal}: give a point or a comma")
    if mark and mark == between:
        raise ValueError(f"--decimal {decimal} is the --separator too; change one")
    return Reading(between, mark, encoding)


def pairs(option: str, words: list[str]) -> dict[str, str]:
    """Names before and after the equals sign of a repeated option.

    Raises:
        ValueError: If there is no equals sign, or a name is missing or given twice.
    """
    found: dict[str, str] = {}
    for word in words:
        name, sign, value = word.partition("=")
        if not (name and sign and value):
            raise ValueError(f"{option} {word}: write it as name=value")
        if name in found or (option == "--rename" and value in found.values()):
            raise ValueError(f"{option} {word}: this name is given twice")
        found[name] = value
    return found


def factors(words: list[str]) -> dict[str, float]:
    """Column names and factors of `--scale`.

    Raises:
        ValueError: If one is not a number.
    """
    found: dict[str, float] = {}
    for name, text in pairs("--scale", words).items():
        try:
            found[name] = float(text)
        except ValueError as error:
            raise ValueError(f"--scale {name}={text}: {text} is no number") from error
    return found
