"""The folder of a validation report: page, tables, figures."""

from __future__ import annotations

from pathlib import Path

from costeer.study.folder import write_text
from costeer.study.reporting.frame import render_page
from costeer.validation.manual import compare
from costeer.validation.reporting import summary
from costeer.validation.reporting.csv_tables import (
    REAL_FILE,
    TARGETS_FILE,
    write_real,
    write_targets,
)
from costeer.validation.reporting.evidence import Evidence
from costeer.validation.reporting.pictures import draw_pictures
from costeer.validation.reporting.sections import page_sections

FIGURES = "figures"
REPORT_FILE = "report.html"


def prepare(folder: Path) -> None:
    """Make the folder, and refuse it before minutes of simulation.

    Args:
        folder: New, empty, or with an earlier report.

    Raises:
        ValueError: If it is a file or holds other things.
        OSError: If it cannot be written.
    """
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is a file; give --out a folder")
    _refuse_foreign(folder)
    try:
        (folder / FIGURES).mkdir(parents=True, exist_ok=True)
        probe = folder / f"{REPORT_FILE}.tmp"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise OSError(
            f"cannot write in {folder}: {error.strerror}; choose another folder"
        ) from error


def _refuse_foreign(folder: Path) -> None:
    """Refuse to spread a report over something else.

    Raises:
        ValueError: If the folder holds other things.
    """
    if not folder.is_dir() or (folder / TARGETS_FILE).exists():
        return
    names = {path.name for path in folder.iterdir()} - {f"{REPORT_FILE}.tmp"}
    unfinished = names == {FIGURES} and not any((folder / FIGURES).iterdir())
    if names and not unfinished:
        raise ValueError(
            f"{folder} is not empty and holds no validation report (it holds "
            f"{min(names)}); give --out a new or empty folder"
        )


def write_validation(folder: Path, evidence: Evidence) -> Path:
    """Write `report.html`, `targets.csv`, `real.csv` and `figures/`.

    The same evidence gives the same bytes.

    Args:
        folder: Of `prepare`.
        evidence: All that was simulated.

    Returns:
        Path of the page.
    """
    write_targets(folder / TARGETS_FILE, compare(evidence.driving), evidence.spreads)
    write_real(folder / REAL_FILE, evidence.people)
    pictures = draw_pictures(evidence)
    for stale in (folder / FIGURES).glob("*.svg"):
        if stale.stem not in pictures:
            stale.unlink()
    for name, each in pictures.items():
        write_text(folder / FIGURES / f"{name}.svg", each.svg)
    words = {
        "subtitle": summary.subtitle(evidence),
        "looked_at": summary.looked_at(evidence),
        "outcomes": summary.outcomes(evidence),
    }
    sections = page_sections(evidence, pictures)
    page = render_page("drivers.html", sections, words, "costeer.validation")
    write_text(folder / REPORT_FILE, page)
    return folder / REPORT_FILE
