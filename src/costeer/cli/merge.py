"""`costeer merge`: tables and report of a study that was run in shards."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from costeer.cli.console import note, progress
from costeer.cli.scaled import end_if_failed


def merge(
    folders: Annotated[
        list[Path],
        typer.Argument(help="Folder that the shards shared, or those of each."),
    ],
    out: Annotated[
        Path | None, typer.Option(help="Folder for the whole study, of several.")
    ] = None,
    report: Annotated[
        bool, typer.Option(help="Tests, figures and report.html after the tables.")
    ] = True,
) -> None:
    """Write tables and report of a study whose shards are all done.

    Trials that are missing are named. One that two folders have is taken once if its
    bytes are the same, and refused if they are not. What is written is the same, byte
    for byte, as of a study that one process ran.

    Example:
        costeer merge out/study
        costeer merge node-1 node-2 node-3 --out out/study
    """
    from costeer.study.merge import merge_study, told
    from costeer.study.report import NUM_STEPS
    from costeer.study.run import full_report

    with progress("report", NUM_STEPS) as advance:

        def write(folder: Path) -> None:
            full_report(folder, lambda _: advance(1))

        merged = merge_study(folders, out, write if report else None)
    if merged.repeated:
        amount = len(merged.repeated)
        note(
            f"costeer: {amount} {'trials are' if amount > 1 else 'trial is'} in more "
            f"than one folder, with the same bytes: {told(merged.repeated[0])}"
            f"{f' and {amount - 1} more' if amount > 1 else ''}"
        )
    outcome = merged.outcome
    typer.echo(outcome.folder / ("report.html" if report else "trials.csv"))
    end_if_failed(outcome)
