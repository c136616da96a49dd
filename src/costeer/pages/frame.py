"""The frame of a report page: sections with numbered tables and figures in one file.

Whose report it is decides only the opening: a template that fills the blocks of
`frame.html`. Everything that the page needs is inside it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from costeer.base.files import write_text
from costeer.pages.exhibit import Exhibit
from costeer.pages.inline import inline_svg
from costeer.pages.series import name_parts, page_values, table
from costeer.pages.style import COLUMN_WIDTH_MM, MM_PER_INCH, svg_text
from costeer.pages.tables import Table, shortened

_HOME = "costeer.pages"


class Picture(NamedTuple):
    """A figure as it stands on the page.

    Attributes:
        exhibit: Its words.
        svg: Its drawing; empty if there is none.
        half: Whether two stand side by side.
        csv: Its data as a table; empty if there are none.
        values: The same for the page, as JSON.
    """

    exhibit: Exhibit
    svg: str
    half: bool
    csv: str = ""
    values: str = ""


class Section(NamedTuple):
    """A section of the page.

    Attributes:
        name: Anchor.
        title: Heading.
        text: Paragraphs before the items.
        items: Tables and pictures.
    """

    name: str
    title: str
    text: tuple[str, ...]
    items: tuple[Table | Picture, ...]


class Item(NamedTuple):
    """A table or a picture with its number; the other one is None.

    Attributes:
        number: Counted among tables or among figures; 0 for what is not drawn.
        table: The table.
        picture: The picture.
        drawing: SVG to put into the page.
        values: JSON to put beside it.
    """

    number: int
    table: Table | None = None
    picture: Picture | None = None
    drawing: Markup = Markup()
    values: Markup = Markup()


def picture(exhibit: Exhibit) -> Picture:
    """Return the figure as text; the drawing itself is let go, it is large.

    Args:
        exhibit: Drawn inside `styled`, and still in it.
    """
    if exhibit.figure is None:
        return Picture(exhibit, "", half=False)
    figure = exhibit.figure
    name_parts(figure)
    svg = svg_text(figure, exhibit.name, exhibit.title)
    values = page_values(figure, exhibit.others)
    half = float(figure.get_figwidth()) * MM_PER_INCH <= COLUMN_WIDTH_MM + 1.0
    words = exhibit._replace(figure=None, others=())
    return Picture(words, svg, half, table(figure), values)


def write_figures(
    folder: Path, pictures: Iterable[Picture], known: Iterable[str] = ()
) -> None:
    """Write every figure that was drawn and its data; remove what no longer is.

    Args:
        folder: Made if it is not there.
        pictures: Drawn or not.
        known: Figures that an earlier report may have left; every SVG file if empty.
    """
    folder.mkdir(exist_ok=True)
    drawn = {f"{each.exhibit.name}.svg": each.svg for each in pictures if each.svg}
    drawn |= {f"{each.exhibit.name}.csv": each.csv for each in pictures if each.csv}
    for name in known or [file.stem for file in folder.glob("*.svg")]:
        for file in (f"{name}.svg", f"{name}.csv"):
            if file not in drawn:
                (folder / file).unlink(missing_ok=True)
    for file, text in drawn.items():
        write_text(folder / file, text)


def render_page(
    template: str,
    sections: Sequence[Section],
    words: dict[str, Any],  # Any: what a template takes
    package: str = _HOME,
    opening: Picture | None = None,
) -> str:
    """Return a page as HTML.

    Args:
        template: Extends `frame.html`.
        sections: After the opening.
        words: What the template's own blocks need.
        package: Where the template is, in its folder `templates`.
        opening: The figure that a template puts before all else, as `opening`.
    """
    home = PackageLoader(_HOME, "templates")
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(package, "templates"), home]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    css, js = (
        Markup(home.get_source(environment, file)[0])
        for file in ("page.css", "page.js")
    )
    page = environment.get_template(template)
    first = _item(opening, 1) if opening is not None else None
    numbered = _numbered(sections, int(first is not None and first.number > 0))
    return page.render(css=css, js=js, opening=first, sections=numbered, **words)


def _numbered(sections: Sequence[Section], num_figures: int) -> list[dict[str, object]]:
    """The sections with tables and figures counted through the page."""
    num_tables = 0
    numbered: list[dict[str, object]] = []
    for section in sections:
        items = []
        for each in section.items:
            if isinstance(each, Table):
                num_tables += 1
                items.append(Item(num_tables, table=shortened(each)))
            else:
                num_figures += bool(each.svg)
                items.append(_item(each, num_figures))
        numbered.append({**section._asdict(), "contents": items})
    return numbered


def _item(shown: Picture, number: int) -> Item:
    """A picture with its number, or why it is not drawn."""
    if not shown.svg:
        return Item(0, None, shown)
    exhibit = shown.exhibit
    svg = inline_svg(shown.svg, exhibit.name, exhibit.title, exhibit.description)
    # Inside a script only this letter could begin something else.
    values = Markup(shown.values.replace("<", "\\u003c"))
    return Item(number, None, shown, Markup(svg), values)
