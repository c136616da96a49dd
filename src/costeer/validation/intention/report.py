"""The folder of a judgement: page, figures, tables and JSON."""

from __future__ import annotations

import json
from pathlib import Path

from costeer.study.figures.exhibit import not_drawn
from costeer.study.figures.style import styled
from costeer.study.folder import write_text
from costeer.study.reporting.frame import Picture, Section, picture, render_page
from costeer.study.reporting.making import versions_table
from costeer.training.comparison import excluded_told
from costeer.validation.intention import (
    curve_figures,
    driver_figures,
    own_figures,
    tables,
)
from costeer.validation.intention.material import Material
from costeer.validation.intention.words import looked_at, outcomes, subtitle

FIGURES, REPORT_FILE, JSON_FILE = "figures", "report.html", "evaluation.json"


def prepare(folder: Path) -> None:
    """Make the folder, and refuse it before minutes of judging.

    Args:
        folder: New, empty, or with an earlier report.

    Raises:
        ValueError: If it is a file or holds other things.
        OSError: If it cannot be written.
    """
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is a file; give --out a folder")
    if folder.is_dir() and not (folder / JSON_FILE).exists():
        names = sorted(path.name for path in folder.iterdir())
        empty = names == [FIGURES] and not any((folder / FIGURES).iterdir())
        if names and not empty:
            raise ValueError(
                f"{folder} is not empty and holds no judgement (it holds {names[0]}); "
                "give --out a new or empty folder"
            )
    try:
        (folder / FIGURES).mkdir(parents=True, exist_ok=True)
        probe = folder / f".{REPORT_FILE}.probe"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise OSError(
            f"cannot write in {folder}: {error.strerror}; choose another folder"
        ) from error


def write_report(folder: Path, material: Material) -> Path:
    """Write `report.html`, `evaluation.json`, the CSV files and `figures/`.

    The same judgement gives the same bytes.

    Args:
        folder: Of `prepare`.
        material: What was found.

    Returns:
        Path of the page.
    """
    pictures = draw_pictures(material)
    for stale in (folder / FIGURES).glob("*.svg"):
        if not pictures.get(stale.stem, _NONE).svg:
            stale.unlink()
    for name, each in pictures.items():
        if each.svg:
            write_text(folder / FIGURES / f"{name}.svg", each.svg)
    tables.write_tables(folder, material)
    words = {
        "subtitle": subtitle(material),
        "looked_at": looked_at(material),
        "outcomes": outcomes(material),
    }
    sections = page_sections(material, pictures)
    page = render_page("intention.html", sections, words, "costeer.validation")
    write_text(folder / REPORT_FILE, page)
    text = json.dumps(material.facts, indent=1, allow_nan=False)
    write_text(folder / JSON_FILE, f"{text}\n")
    return folder / REPORT_FILE


def draw_pictures(material: Material) -> dict[str, Picture]:
    """All figures by name; one without its input says so."""
    draw = (
        curve_figures.draw_operating,
        curve_figures.draw_curves,
        own_figures.draw_calibration,
        driver_figures.draw_leads,
        driver_figures.draw_spread,
        own_figures.draw_learning,
    )
    with styled():
        exhibits = [one(material) for one in draw]
        return {each.name: picture(each) for each in exhibits}


def page_sections(material: Material, drawn: dict[str, Picture]) -> list[Section]:
    """What stands on the page in which order."""
    return [
        _rivals(material, drawn),
        _own(material, drawn),
        _drivers(drawn),
        _ablations(material),
        _making(material, drawn),
    ]


def _rivals(material: Material, drawn: dict[str, Picture]) -> Section:
    title = "Predictors side by side"
    figures = (drawn[curve_figures.OPERATING], drawn[curve_figures.CURVES])
    comparison = material.assessment.comparison
    if comparison is None:
        alone = "One predictor was judged; --compare puts all others beside it."
        return Section("predictors", title, (alone,), figures)
    table = tables.comparison_table(comparison, "predictors", title)
    text = tuple(excluded_told(comparison))
    return Section("predictors", title, text, (table, *figures))


def _own(material: Material, drawn: dict[str, Picture]) -> Section:
    text = (
        "Where few samples are positive, accuracy says little: the answer “never” is "
        "accurate too. “Half positive” weighs both classes alike, as a test set with "
        "as many of each would; “at even odds” also turns the probabilities by Bayes' "
        "rule for such a set, as a network that is trained on one would say them.",
    )
    items = (
        tables.own_table(material),
        drawn[own_figures.CALIBRATION],
        drawn[driver_figures.LEADS],
    )
    return Section("scores", "The judged predictor", text, items)


def _drivers(drawn: dict[str, Picture]) -> Section:
    return Section("drivers", "Drivers", (), (drawn[driver_figures.SPREAD],))


def _ablations(material: Material) -> Section:
    title = "Signals taken away"
    ablations = material.assessment.ablations
    if ablations is None:
        missing = "Nothing was taken away; --ablations does."
        return Section("ablations", title, (missing,), ())
    text = (
        "The same predictor on the same recordings, without some of the signals that "
        "they hold. The speed always stays.",
        *excluded_told(ablations),
    )
    table = tables.comparison_table(ablations, "ablations", title)
    return Section("ablations", title, text, (table,))


def _making(material: Material, drawn: dict[str, Picture]) -> Section:
    text = (
        f"Judged on {material.source}. The same recordings, version and options give "
        "the same bytes; there is no date in them.",
        "The folder holds this page, all numbers (evaluation.json), the tables as CSV "
        "(predictors.csv, drivers.csv, operating.csv, ablations.csv) and the figures "
        "as SVG (figures/).",
    )
    items = (drawn[own_figures.LEARNING], versions_table())
    return Section("making", "How it was made", text, items)


_NONE = Picture(not_drawn("", "", ""), "", half=False)
"""Stands for a figure that is not on the page."""
