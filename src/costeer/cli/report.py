"""`costeer report`: tables, tests, figures and report of a study folder again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from costeer.cli.console import progress


def report(
    folder: Annotated[Path, typer.Argument(help="Folder of the study.")],
) -> None:
    """Write tables, tests, figures and report.html of a study again.

    The records stay as they are; nothing is simulated. Works for virtual drivers and
    for people, and for a study that is not finished. The tables trials.csv and
    lane_changes.csv of a study with people are not touched: they hold answers.

    Example:
        costeer report out/study
    """
    from costeer.study.again import remake_report
    from costeer.study.report import NUM_STEPS

    with progress("report", NUM_STEPS) as advance:
        page = remake_report(folder, lambda _: advance(1))
    typer.echo(page)
