"""`costeer report`: tables, tests, figures and report of a study folder again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from costeer.cli.console import note, progress
from costeer.cli.figure import Wanted, checked, write_figure
from costeer.cli.units import parse_width

if TYPE_CHECKING:
    from costeer.study.people import People


def report(
    folder: Annotated[
        Path,
        typer.Argument(help="Folder of a study, of a session, or of drive records."),
    ],
    beside: Annotated[
        Path | None,
        typer.Option(help="Folder of a study with virtual drivers to compare with."),
    ] = None,
    figure: Annotated[
        str | None,
        typer.Option(help="Write this figure alone, as figures/ names it."),
    ] = None,
    width: Annotated[
        float | None,
        typer.Option(
            help="Width of that figure, 60mm to 210mm.",
            parser=parse_width,
            metavar="WIDTH",
        ),
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option("--format", help="pdf, png, svg, or csv for its data."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="File to write that figure to."),
    ] = None,
) -> None:
    """Rewrite the tables, tests, figures and report.html of a study.

    The records stay as they are, and nothing is simulated. Works for virtual drivers
    and for people, finished or not, on the folder of costeer study, costeer session or
    costeer compare, or on a folder with records of drives whose participants are
    pseudonyms. The tables trials.csv and lane_changes.csv of a study with people that
    has a study.yaml are not touched: they hold answers.

    With --figure only that figure is written, for a journal: its letters keep their
    size at every width. It is a PDF in figures/ if --format and --out are not
    given.

    Example:
        costeer report out/study
        costeer report out/study --figure sdlp --width 88mm --format pdf --out sdlp.pdf
        costeer report my-study --beside out/study
        costeer report out/compare
    """
    from costeer.comparison.folder import COMPARE_FILE
    from costeer.study.again import remake_report, trials_without_record
    from costeer.study.folder import STUDY_FILE
    from costeer.study.report import NUM_STEPS

    wanted = checked(Wanted(figure, width, kind, out))
    if (folder / COMPARE_FILE).is_file():
        _remake_comparison(folder, beside, figure)
        return
    if beside is not None and not (beside / STUDY_FILE).is_file():
        raise ValueError(f"--beside is {beside}, which has no {STUDY_FILE}")
    is_study = (folder / STUDY_FILE).is_file()
    people = None if is_study else _people(folder)
    if figure is not None:
        typer.echo(write_figure(folder, wanted, people, beside))
        return
    apart = {} if people is None else people.apart
    with progress("report", NUM_STEPS * (1 + len(apart))) as advance:
        page = remake_report(folder, lambda _: advance(1), people, beside)
        others = [
            remake_report(part.study.path, lambda _: advance(1), part)
            for part in apart.values()
        ]
    if people is None:
        _tell_missing(trials_without_record(folder))
    elif people.exclusions:
        amount = len(people.exclusions)
        drives = "1 drive is" if amount == 1 else f"{amount} drives are"
        note(f"costeer: {drives} excluded or missing; exclusions.csv says why")
    for each in (page, *others):
        typer.echo(each)


def _remake_comparison(folder: Path, beside: Path | None, figure: str | None) -> None:
    """Write tables, figures and page of a comparison again.

    Raises:
        ValueError: If it cannot be read, is to stand beside something, or one figure is
            asked for.
        OSError: If a file cannot be read or written.
    """
    from costeer.comparison.folder import read_comparison
    from costeer.comparison.report import NUM_STEPS, remake_report
    from costeer.comparison.results import num_missing
    from costeer.pages.numerals import plural

    if beside is not None:
        raise ValueError(
            f"--beside is {beside}, and {folder} is a comparison, which has nothing "
            "beside it; leave --beside out"
        )
    if figure is not None:
        raise ValueError(
            f"{folder} is a comparison, and --figure is for studies; the figures of a "
            f"comparison stand in {folder / 'figures'}"
        )
    with progress("report", NUM_STEPS) as advance:
        page = remake_report(folder, lambda _: advance(1))
    missing = num_missing(read_comparison(folder))
    if missing:
        note(
            f"costeer: the report is without {plural(missing, 'trial')} not driven "
            "yet; the first lines of compare.yaml hold the command that goes on"
        )
    typer.echo(page)


def _people(folder: Path) -> People:
    """Who drove, of a session or of a plain folder of records.

    Raises:
        ValueError: If it is neither, or what it holds cannot be.
        OSError: If it cannot be read.
    """
    from costeer.sessions.store import STORE_FILE

    if (folder / STORE_FILE).is_file():
        from costeer.sessions.tables import write_session
        from costeer.sessions.withdrawal import made_apart

        for file in made_apart(folder):  # of trials that are excluded by now, perhaps
            file.unlink()
        people = write_session(folder, folder)
        for part in people.apart.values():
            part.study.path.mkdir(parents=True, exist_ok=True)
        return people
    from costeer.study.plain_folder import people_of_records

    return people_of_records(folder)


def _tell_missing(records: list[str]) -> None:
    """Say which trials the report is without, and how to make them."""
    if records:
        more = f" and {len(records) - 3} more" if len(records) > 3 else ""
        note(
            f"costeer: the report is without {', '.join(records[:3])}{more}; the first "
            "lines of study.yaml hold the command that makes them"
        )
