"""`costeer report`: tables, tests, figures and report of a study folder again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from costeer.cli.console import note, progress


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
    from costeer.study.again import remake_report, trials_without_record
    from costeer.study.report import NUM_STEPS

    with progress("report", NUM_STEPS) as advance:
        page = remake_report(folder, lambda _: advance(1))
    _tell_missing(trials_without_record(folder))
    typer.echo(page)


def _tell_missing(records: list[str]) -> None:
    """Say which trials the report is without, and how to make them."""
    if records:
        more = f" and {len(records) - 3} more" if len(records) > 3 else ""
        note(
            f"costeer: the report is without {', '.join(records[:3])}{more}; the first "
            "lines of study.yaml hold the command that makes them"
        )
