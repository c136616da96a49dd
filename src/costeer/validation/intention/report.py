"""The folder of a judgement: page, figures, tables and JSON."""

from __future__ import annotations

import json
from pathlib import Path

from costeer.base.files import prepare_folder, write_text
from costeer.pages.frame import Picture, Section, picture, render_page, write_figures
from costeer.pages.style import styled
from costeer.pages.tables import versions_table
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
    """Make the folder, as `prepare_folder` does, before minutes of work."""
    prepare_folder(folder, JSON_FILE, "judgement")
    (folder / FIGURES).mkdir(exist_ok=True)


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
    write_figures(folder / FIGURES, pictures.values())
    tables.write_tables(folder, material)
    words = {
        "title": "Judgement of an intention predictor",
        "heading": "Intention to change lanes: what the predictors are worth",
        "subtitle": subtitle(material),
        "looked_at": looked_at(material),
        "outcomes": outcomes(material),
        "caution": (),
    }
    sections = page_sections(material, pictures)
    page = render_page("judgement.html", sections, words)
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
