"""Tests, figures and `report.html` of a study folder, made from its records."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from costeer.base.described import nearest
from costeer.base.files import write_text
from costeer.pages.exhibit import Exhibit
from costeer.pages.frame import Picture, picture, write_figures
from costeer.pages.style import styled
from costeer.study.agreement import AgreementRow, agreement
from costeer.study.figures.catalogue import FIGURE_NAMES, draw_figures
from costeer.study.material import StudyMaterial, read_material, read_virtual
from costeer.study.outcome import (
    DroppedRow,
    EffectRow,
    PairRow,
    StudyTests,
    SummaryRow,
)
from costeer.study.people import People
from costeer.study.reporting.page import render
from costeer.study.trial_tables import write_csv

ANSWERS = "answers_"
"""How the names of tables begin that hold tests of the items of the NASA-TLX."""

AGREEMENT_FILE = "agreement.csv"
AGAIN_FILE = "again.csv"
FIGURES = "figures"
REPORT_FILE = "report.html"
NUM_STEPS = len(FIGURE_NAMES) + 2
"""How often a report tells of a step: each figure is one, drawn or not."""


class StatisticsFile(NamedTuple):
    """A table of the statistics: name of the file, columns, and where its rows are."""

    name: str
    columns: tuple[str, ...]
    rows: str


STATISTICS_FILES = (
    StatisticsFile("tests.csv", EffectRow._fields, "tests"),
    StatisticsFile("pairs.csv", PairRow._fields, "pairs"),
    StatisticsFile("summaries.csv", SummaryRow._fields, "summaries"),
    StatisticsFile("dropped.csv", DroppedRow._fields, "dropped"),
)


def write_report(
    folder: Path | str,
    progress: Callable[[str], None] | None = None,
    people: People | None = None,
    beside: Path | None = None,
) -> Path:
    """Write `tests.csv`, `pairs.csv`, `figures/` and `report.html` of a study.

    The folder holds `study.yaml`, `trials.csv`, `lane_changes.csv`, `triggers.csv`
    and `records/`; of people or of virtual drivers, finished or not. The same folder
    gives the same bytes.

    Args:
        folder: Of the study.
        progress: Called with a few words before each step.
        people: Whose drives these are; None for a folder with `study.yaml`.
        beside: Folder of virtual drivers to compare with.

    Returns:
        Path of `report.html`.

    Raises:
        ValueError: If the folder is no study, or a table or record cannot be read.
        OSError: If a file cannot be written.
    """
    tell = progress or _say_nothing
    path = Path(folder)
    tell("tests")
    material = read_material(path, people)
    if beside is not None:
        material = material._replace(beside=read_virtual(beside))
    _write_statistics(path, material.tests)
    if material.answers is not None:
        _write_statistics(path, material.answers, ANSWERS)
    _write_agreement(path / AGREEMENT_FILE, material)
    _write_again(path / AGAIN_FILE, material)
    pictures = _write_figures(path / FIGURES, material, tell)
    tell("report")
    write_text(path / REPORT_FILE, render(material, pictures))
    return path / REPORT_FILE


@contextmanager
def one_figure(
    folder: Path, name: str, people: People | None = None, beside: Path | None = None
) -> Iterator[Exhibit]:
    """Draw one figure of a study, from the tables that are there, inside the style.

    Args:
        folder: Of the study.
        name: One of `FIGURE_NAMES`.
        people: Whose drives these are; None for a folder with `study.yaml`.
        beside: Folder of virtual drivers to compare with.

    Raises:
        ValueError: If there is no such figure, or the study has none.
    """
    if name not in FIGURE_NAMES:
        close = nearest(name.replace("_", "-"), FIGURE_NAMES)
        known = "" if close else f"; choose from {', '.join(FIGURE_NAMES)}"
        raise ValueError(f"there is no figure {name!r}{close}{known}")
    material = read_material(folder, people)
    if beside is not None:
        material = material._replace(beside=read_virtual(beside))
    with styled():
        found = next(draw_figures(material, name), None)
        if found is None:
            raise ValueError(f"{folder} has nothing to draw figure {name} from")
        yield found


def _say_nothing(_: str) -> None:
    """Show no progress."""


def _write_statistics(folder: Path, tests: StudyTests, prefix: str = "") -> None:
    for file in STATISTICS_FILES:
        rows = [row._asdict() for row in getattr(tests, file.rows)]
        write_csv(folder / f"{prefix}{file.name}", rows, file.columns)


def _write_agreement(file: Path, material: StudyMaterial) -> None:
    """Write how virtual drivers agree; remove what an earlier report has left."""
    if material.beside is None:
        file.unlink(missing_ok=True)
        return
    rows = [each._asdict() for each in agreement(material, material.beside)]
    write_csv(file, rows, AgreementRow._fields)


def _write_again(file: Path, material: StudyMaterial) -> None:
    """Write trials beside the first of their condition; remove what is old."""
    if not material.again:
        file.unlink(missing_ok=True)
        return
    write_csv(file, [each._asdict() for each in material.again], PairRow._fields)


def _write_figures(
    folder: Path, material: StudyMaterial, tell: Callable[[str], None]
) -> Sequence[Picture]:
    """Write every figure that can be drawn, and remove those that no longer can."""
    pictures = []
    with styled():
        for exhibit in draw_figures(material):
            tell(f"figure {exhibit.name}")
            pictures.append(picture(exhibit))
    for _ in range(len(pictures), len(FIGURE_NAMES)):
        tell("figure that cannot be drawn")
    write_figures(folder, pictures, FIGURE_NAMES)
    return pictures
