"""The report of a study as one HTML page with everything it needs inside."""

from __future__ import annotations

from collections.abc import Sequence

from costeer.pages.frame import Picture, render_page
from costeer.study.figures import forest
from costeer.study.material import StudyMaterial, is_virtual
from costeer.study.reporting import findings, overview
from costeer.study.reporting.comparisons import shown_quantities
from costeer.study.reporting.sections import page_sections


def render(material: StudyMaterial, pictures: Sequence[Picture]) -> str:
    """Return the page as HTML.

    Args:
        material: The study.
        pictures: All figures, drawn or not.
    """
    words = {
        "virtual": is_virtual(material),
        "subtitle": overview.subtitle(material),
        "run": overview.run_sentences(material),
        "outcomes": _outcomes(material),
        "meaning": findings.meaning(material),
    }
    by_name = {each.exhibit.name: each for each in pictures}
    sections = page_sections(material, by_name)
    first = by_name[forest.NAME]
    return render_page("report.html", sections, words, "costeer.study", first)


def _outcomes(material: StudyMaterial) -> list[tuple[str, str]]:
    """Heading and sentences of each point of what came out."""
    points = [
        (each.title, findings.measure_sentences(material, each))
        for each in shown_quantities(material)
    ]
    points.append(("Intention", overview.detection_sentence(material)))
    points.append(("Inconsistencies", overview.inconsistency_sentence(material)))
    points.append(("Lane departures", overview.departure_sentence(material)))
    return points
