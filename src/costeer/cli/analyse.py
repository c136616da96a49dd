"""`costeer analyse`: driving measures of records and of tables of others."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli.validate import at_least, positive

if TYPE_CHECKING:
    from costeer.records.tables import Reading
    from costeer.study.analysis import Analysis


def analyse(
    files: Annotated[
        list[Path],
        typer.Argument(help="Trial records, tables (text, Parquet, Arrow), folders."),
    ],
    map_file: Annotated[
        Path | None,
        typer.Option("--map", help="YAML of names, units, scale, flip and marks."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Write a CSV with one row for each drive instead."),
    ] = None,
    rename: Annotated[
        list[str] | None,
        typer.Option(metavar="OLD=NEW", help="Name of a column; repeatable."),
    ] = None,
    scale: Annotated[
        list[str] | None,
        typer.Option(
            metavar="COLUMN=FACTOR",
            help="Factor to SI units, by the new name; repeatable.",
        ),
    ] = None,
    sequence: Annotated[
        str,
        typer.Option(
            metavar="COLUMN",
            help="Column that tells separate stretches apart; [default: sequence]",
        ),
    ] = "",
    cutoff: Annotated[
        float,
        typer.Option(
            callback=at_least(0, "Hz"),
            help="Low-pass before reversals are counted [Hz]; 0 for none.",
        ),
    ] = 0.6,
    gap_deg: Annotated[
        float,
        typer.Option(callback=positive("deg"), help="Gap of a reversal [deg]."),
    ] = 3.0,
    any_lane: Annotated[
        bool,
        typer.Option("--any-lane", help="Measure lane keeping in whichever lane."),
    ] = False,
    join_lanes: Annotated[
        bool,
        typer.Option(
            "--join-lanes",
            help="The lateral position is from the centre of the lane driven in.",
        ),
    ] = False,
    drop_repeated: Annotated[
        bool,
        typer.Option("--drop-repeated", help="Leave out rows whose time is repeated."),
    ] = False,
    separator: Annotated[
        str, typer.Option(help="Between columns of a text; else found out.")
    ] = "",
    decimal: Annotated[
        str, typer.Option(help="Decimal mark of a text; else found out.")
    ] = "",
    encoding: Annotated[
        str, typer.Option(help="Of a text, as cp1252; else found out.")
    ] = "",
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> int | None:
    """Compute driving measures from records or a table.

    A table needs a column time [s] and any of a trial record's columns in SI units;
    steering_wheel_angle alone gives the reversal rate. What cannot be computed is
    listed with the reason.

    Example:
        costeer analyse drive.csv --rename t=time --rename angle=steering_wheel_angle
        --scale steering_wheel_angle=0.0174533
        costeer analyse drives/ --map lab.yaml --out table.csv
    """
    from math import radians

    from costeer.cli.many import drives
    from costeer.cli.mapping import read_lab
    from costeer.study.analysis import analyse_file
    from costeer.study.definitions import MeasureParameters
    from costeer.study.recordings import Adaptation

    lab = read_lab(map_file)
    adaptation = Adaptation(
        renames={**lab.renames, **pairs("--rename", rename or [])},
        scales={**lab.scales, **factors(scale or [])},
        sequence=sequence or lab.sequence,
        drop_repeated=drop_repeated,
        join_lanes=join_lanes,
    )
    parameters = MeasureParameters(
        reversal_angle=radians(gap_deg),
        reversal_cutoff=cutoff,
        any_lane=float(any_lane),
    )
    reading = reading_of(
        separator or lab.separator, decimal or lab.decimal, encoding or lab.encoding
    )

    def one(file: Path) -> list[Analysis]:
        return analyse_file(file, adaptation, parameters, reading)

    if out is not None:
        return table_of(out, drives(files), one)
    found = [each for file in drives(files) for each in one(file)]
    show_json(found) if json else show_tables(found)
    return None


def table_of(
    out: Path, files: list[Path], one: Callable[[Path], list[Analysis]]
) -> int:
    """Write the table of all drives; the exit code says whether all could be read."""
    from costeer.base.files import try_writing
    from costeer.cli.console import note
    from costeer.cli.many import analysed, write_rows

    try_writing(out)
    found, refused = analysed([file for file in files if file != out], one)
    for why in refused.values():
        note(f"costeer: {why}")
    for each in found:
        for line in each.notes:
            note(f"note on {_name(each)}: {line}")
    write_rows(out, found, refused)
    note(f"written: {out}, {len(found)} drives, {len(refused)} files not read")
    return 2 if refused else 0


_BETWEEN = {"tab": "\t", "\\t": "\t", "comma": ",", "semicolon": ";", "space": " "}


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


def show_json(analyses: list[Analysis]) -> None:
    """Print the analyses as one JSON list."""
    import json

    from costeer.study.analysis import as_json

    typer.echo(json.dumps(as_json(analyses), indent=2, ensure_ascii=False))


def show_tables(analyses: list[Analysis]) -> None:
    """Print a table of measures for each stretch, then what could not be computed."""
    from costeer.cli.console import note, print_table

    for each in analyses:
        measured = {k: m for k, m in each.measures.items() if not m.reason}
        rows = [[k, f"{m.value:.4g}", m.unit] for k, m in measured.items()]
        typer.echo(_title(each))
        print_table(["measure", "value", "unit"], rows)
        _show_lane_changes(each)
        for line in _not_computed(each):
            typer.echo(line)
        for line in each.notes:
            note(f"note on {_name(each)}: {line}")
        typer.echo()


def _title(each: Analysis) -> str:
    seconds = each.num_rows / each.sampling.rate
    return f"{_name(each)}: {seconds:.1f} s at {each.sampling.rate:.4g} Hz"


def _name(each: Analysis) -> str:
    if not each.sequence:
        return each.source
    return f"{each.source}, sequence {each.sequence}"


# Short headings, so that the table fits a terminal 80 characters wide.
_HEADINGS = {
    "index": "no.",
    "direction": "to",
    "crossing_time": "at s",
    "duration": "for s",
    "overshoot": "beyond m",
    "steering_velocity_rms": "rms rad/s",
    "peak_steering_angle": "peak rad",
    "detection_lead_time": "lead s",
}


def _show_lane_changes(each: Analysis) -> None:
    from costeer.cli.console import print_table

    rows = [[_cell(row[name]) for name in _HEADINGS] for row in each.lane_changes]
    if rows:
        title = "Lane changes: to -1 right, +1 left"
        print_table(list(_HEADINGS.values()), rows, title=title)


def _cell(value: object) -> str:
    if isinstance(value, float):
        return "-" if value != value else f"{value:.4g}"
    return str(value)


def _not_computed(each: Analysis) -> list[str]:
    """One line per reason, with the measures it stands in the way of."""
    names: dict[str, list[str]] = {}
    for name, measure in each.measures.items():
        if measure.reason:
            names.setdefault(measure.reason, []).append(name)
    return [
        f"not computed: {', '.join(held)}: {reason}" for reason, held in names.items()
    ]
