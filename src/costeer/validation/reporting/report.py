"""The folder of a validation report: page, tables, figures."""

from __future__ import annotations

from pathlib import Path

from costeer.base.files import prepare_folder, write_text
from costeer.pages.frame import render_page, write_figures
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

_CAUTION = (
    "No run with the guidance of a study was looked at.",
    "The drivers were calibrated on manual driving; that they drive like people here "
    "does not show that they answer guidance like people. What a study says of "
    "guidance is a prediction, to be tested with people.",
)
FIGURES = "figures"
REPORT_FILE = "report.html"


def prepare(folder: Path) -> None:
    """Make the folder, as `prepare_folder` does, before minutes of work."""
    prepare_folder(folder, TARGETS_FILE, "validation report")
    (folder / FIGURES).mkdir(exist_ok=True)


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
    write_figures(folder / FIGURES, pictures.values())
    words = {
        "title": "Validation of virtual drivers",
        "heading": "Virtual drivers beside people: validation report",
        "subtitle": summary.subtitle(evidence),
        "looked_at": summary.looked_at(evidence),
        "outcomes": summary.outcomes(evidence),
        "caution": _CAUTION,
    }
    sections = page_sections(evidence, pictures)
    page = render_page("judgement.html", sections, words)
    write_text(folder / REPORT_FILE, page)
    return folder / REPORT_FILE
