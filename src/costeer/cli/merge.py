"""`costeer merge`: tables and report of what was run in shards."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from costeer.cli.console import note, progress
from costeer.cli.scaled import FAILED, end_if_failed


def merge(
    folders: Annotated[
        list[Path],
        typer.Argument(
            help="Folder that the shards shared, or the folder of each shard."
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(help="Folder to write the whole into, if several are given."),
    ] = None,
    report: Annotated[
        bool,
        typer.Option(help="Write tests, figures and report.html after the tables."),
    ] = True,
) -> None:
    """Join the shards of a study, and write its tables and report.

    Comparisons and sensitivity analyses are merged as well. Missing parts are named.
    What two folders share is taken once if it is identical, and refused if it is not.
    The result is the same, byte for byte, as that of a single process.

    Example:
        costeer merge out/study
        costeer merge node-1 node-2 node-3 --out out/study
    """
    from costeer.comparison.folder import COMPARE_FILE
    from costeer.sensitivity.run import SETTINGS_FILE

    if (folders[0] / COMPARE_FILE).is_file():
        _merge_comparison(folders, out, report)
    elif (folders[0] / SETTINGS_FILE).is_file():
        _merge_sensitivity(folders, out, report)
    else:
        _merge_study(folders, out, report)


def _merge_study(folders: list[Path], out: Path | None, report: bool) -> None:
    from costeer.study.merge import merge_study, told
    from costeer.study.report import NUM_STEPS
    from costeer.study.run import full_report

    with progress("report", NUM_STEPS) as advance:

        def write(folder: Path) -> None:
            full_report(folder, lambda _: advance(1))

        merged = merge_study(folders, out, write if report else None)
    _tell_repeated("trial", [told(each) for each in merged.repeated])
    outcome = merged.outcome
    typer.echo(outcome.folder / ("report.html" if report else "trials.csv"))
    end_if_failed(outcome)


def _merge_comparison(folders: list[Path], out: Path | None, report: bool) -> None:
    from costeer.comparison.merge import merge_comparison
    from costeer.comparison.report import NUM_STEPS, write_report

    with progress("report", NUM_STEPS) as advance:

        def write(folder: Path) -> None:
            write_report(folder, lambda _: advance(1))

        merged = merge_comparison(folders, out, write if report else None)
    _tell_repeated("block of drivers", merged.repeated, "blocks of drivers")
    outcome = merged.outcome
    typer.echo(outcome.folder / ("report.html" if report else "trials.csv"))
    if outcome.num_failed:
        note(f"costeer: {outcome.num_failed} trials failed; exclusions.csv says why")
        raise typer.Exit(FAILED)


def _merge_sensitivity(folders: list[Path], out: Path | None, report: bool) -> None:
    """Merge; its tables are made with the page, so that it is always written.

    Raises:
        ValueError: If no report is wanted, or the shards cannot be merged.
        OSError: If a file cannot be read or written.
    """
    from costeer.sensitivity.merge import merge_sensitivity
    from costeer.sensitivity.report import write_report

    if not report:
        raise ValueError(
            f"{folders[0]} is a sensitivity analysis, whose tables come with its "
            "report; leave --no-report out"
        )
    merged = merge_sensitivity(folders, out)
    _tell_repeated("sample", merged.repeated)
    typer.echo(write_report(merged.folder, merged.settings, merged.outcomes))


def _tell_repeated(what: str, repeated: Sequence[str], many: str = "") -> None:
    """Say what several folders have."""
    from costeer.pages.numerals import plural

    if repeated:
        amount, verb = len(repeated), "are" if len(repeated) > 1 else "is"
        more = f" and {amount - 1} more" if amount > 1 else ""
        note(
            f"costeer: {plural(amount, what, many)} {verb} in more than one folder, "
            f"with the same bytes: {repeated[0]}{more}"
        )
