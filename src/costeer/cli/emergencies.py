"""`costeer emergencies`: obstacles that appear, with and without guidance."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from costeer.cli.console import progress
from costeer.cli.plug_ins import Method
from costeer.cli.validate import at_least, in_range


def emergencies(
    out: Annotated[
        Path, typer.Option(help="Folder for report, table, figures and records.")
    ],
    drivers: Annotated[
        int, typer.Option(callback=in_range(1, 1000), help="Number of virtual drivers.")
    ] = 10,
    seed: Annotated[int, typer.Option(help="Seed of drivers and noise.")] = 1,
    conditions: Annotated[
        str, typer.Option(help="Conditions to drive, separated by commas.")
    ] = "manual,weak-normal,strong-normal",
    method: Method = "ibhs",
    jobs: Annotated[
        int | None,
        typer.Option(
            callback=at_least(1), help="Number of threads; by default one per core."
        ),
    ] = None,
) -> None:
    """Let an obstacle appear ahead, and compare the outcomes.

    The four situations of the paper's Sec. V-C, at 70 and 90 km/h, 1.5 to 4 s before
    the obstacle, with the other lane free or not. Writes a report, a table with a row
    for each drive, figures, and records of the worst cases for costeer replay.

    Example:
        costeer emergencies --out out/emergencies
        costeer emergencies --out out/e --drivers 25 --conditions manual,strong-rapid
    """
    from costeer.emergencies.design import Settings
    from costeer.emergencies.report import write_report
    from costeer.emergencies.run import drive_all, num_drives, prepare
    from costeer.methods.conditions import check_conditions
    from costeer.scale.jobs import JobsStoppedError, default_jobs

    named = tuple(name.strip() for name in conditions.split(",") if name.strip())
    settings = Settings(drivers, seed, check_conditions(named), method)
    prepare(out, settings)
    try:
        with progress("emergencies", num_drives(settings)) as advance:
            rows = drive_all(settings, jobs or default_jobs(), advance)
    except JobsStoppedError as error:
        cause = error.__cause__
        assert cause is not None  # it always has one
        raise cause from None
    typer.echo(write_report(out, settings, rows))
