"""The report as one HTML page with everything it needs inside."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from costeer.study.material import StudyMaterial, is_virtual
from costeer.study.reporting import findings, overview
from costeer.study.reporting.comparisons import shown_quantities
from costeer.study.reporting.inline import inline_svg
from costeer.study.reporting.sections import Picture, Section, page_sections
from costeer.study.reporting.tables import Table, shortened


class Item(NamedTuple):
    """A table or a picture with its number; the other one is None.

    Attributes:
        number: Counted among tables or among figures; 0 for what is not drawn.
        table: The table.
        picture: The picture.
        drawing: SVG to put into the page.
    """

    number: int
    table: Table | None = None
    picture: Picture | None = None
    drawing: Markup = Markup()


def render(material: StudyMaterial, pictures: Sequence[Picture]) -> str:
    """Return the page as HTML.

    Args:
        material: The study.
        pictures: All figures, drawn or not.
    """
    loader = PackageLoader("costeer.study", "templates")
    environment = Environment(
        loader=loader,
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    sections = page_sections(material, {each.exhibit.name: each for each in pictures})
    return environment.get_template("report.html").render(
        css=Markup(loader.get_source(environment, "report.css")[0]),
        virtual=is_virtual(material),
        subtitle=overview.subtitle(material),
        run=overview.run_sentences(material),
        outcomes=_outcomes(material),
        meaning=findings.meaning(material),
        sections=_numbered(sections),
    )


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


def _numbered(sections: Sequence[Section]) -> list[dict[str, object]]:
    """The sections with tables and figures counted through the page."""
    num_tables = num_figures = 0
    numbered: list[dict[str, object]] = []
    for section in sections:
        items = []
        for each in section.items:
            if isinstance(each, Table):
                num_tables += 1
                items.append(Item(num_tables, table=shortened(each)))
            elif each.svg:
                num_figures += 1
                items.append(Item(num_figures, None, each, _drawing(each)))
            else:
                items.append(Item(0, None, each))
        numbered.append({**section._asdict(), "contents": items})
    return numbered


def _drawing(picture: Picture) -> Markup:
    exhibit = picture.exhibit
    return Markup(
        inline_svg(picture.svg, exhibit.name, exhibit.title, exhibit.description)
    )
