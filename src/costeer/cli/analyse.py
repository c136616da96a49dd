"""`costeer analyse`: driving measures of records and of tables of others."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli.reading import AS_FOUND, Told, reads_tables, way_of
from costeer.cli.validate import at_least, positive

if TYPE_CHECKING:
    from costeer.study.analysis import Analysis
    from costeer.study.definitions import Measure


@reads_tables
def analyse(
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Trial records, tables (text, Parquet, Arrow) or folders of them."
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(help="CSV file to write instead, with one row per drive."),
    ] = None,
    cutoff: Annotated[
        float,
        typer.Option(
            callback=at_least(0, "Hz"),
            help="Cut-off of the low-pass filter before reversals are "
            "counted [Hz]; 0 for no filter.",
        ),
    ] = 0.6,
    gap_deg: Annotated[
        float,
        typer.Option(
            callback=positive("deg"),
            help="Smallest angle that counts as a reversal [deg].",
        ),
    ] = 3.0,
    any_lane: Annotated[
        bool,
        typer.Option(
            "--any-lane", help="Measure lane keeping in whichever lane the car is."
        ),
    ] = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print the results as JSON.")
    ] = False,
    told: Told = AS_FOUND,
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
    from costeer.cli.many import drives
    from costeer.study.analysis import analyse_file
    from costeer.study.definitions import MeasureParameters

    way = way_of(told)
    parameters = MeasureParameters(
        reversal_angle=math.radians(gap_deg),
        reversal_cutoff=cutoff,
        any_lane=float(any_lane),
    )

    def one(file: Path) -> list[Analysis]:
        return analyse_file(file, way.adaptation, parameters, way.reading)

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
        rows = [_row(name, measure) for name, measure in measured.items()]
        typer.echo(_title(each))
        print_table(["measure", "value", "unit"], rows)
        _show_zones(each)
        _show_lane_changes(each)
        for line in _not_computed(each):
            typer.echo(line)
        for line in each.notes:
            note(f"note on {_name(each)}: {line}")
        typer.echo()


def _show_zones(each: Analysis) -> None:
    from costeer.cli.console import print_table

    for zone, found in each.zones.items():
        rows = [_row(name, one) for name, one in found.items() if not one.reason]
        if rows:
            print_table(["measure", "value", "unit"], rows, title=f"Zone {zone}")


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
    "steering_velocity_rms": "rms deg/s",
    "peak_steering_angle": "peak deg",
    "detection_lead_time": "lead s",
}


_GAPS = {
    "index": "no.",
    "from_lane": "from lane",
    "to_lane": "to lane",
    "lead_gap": "lead m",
    "lead_time_gap": "lead s",
    "lag_gap": "lag m",
    "lag_time_gap": "lag s",
}


def _show_lane_changes(each: Analysis) -> None:
    from costeer.cli.console import print_table

    for title, headings in (("Lane changes", _HEADINGS), ("Gaps accepted", _GAPS)):
        known = [row for row in each.lane_changes if headings.keys() <= row.keys()]
        rows = [[_cell(name, row[name]) for name in headings] for row in known]
        if rows:
            print_table(list(headings.values()), rows, title=title)


def _row(name: str, measure: Measure) -> list[str]:
    """Name, value and unit of a measure as people read it."""
    from costeer.pages.units import shown

    unit, factor = shown(measure.unit)
    return [name, f"{measure.value * factor:.4g}", unit]


_IN_DEGREES = ("steering_velocity_rms", "peak_steering_angle")


def _cell(name: str, value: object) -> str:
    if name == "direction":
        return "left" if value == 1 else "right"
    if isinstance(value, float):
        value = math.degrees(value) if name in _IN_DEGREES else value
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
