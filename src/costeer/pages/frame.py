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
from costeer.pages.style import COLUMN_WIDTH_MM, MM_PER_INCH, svg_text
from costeer.pages.tables import Table, shortened

_HOME = "costeer.pages"


class Picture(NamedTuple):
    """A figure as it stands on the page.

    Attributes:
        exhibit: Its words.
        svg: Its drawing; empty if there is none.
        half: Whether two stand side by side.
    """

    exhibit: Exhibit
    svg: str
    half: bool


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
    """

    number: int
    table: Table | None = None
    picture: Picture | None = None
    drawing: Markup = Markup()


def picture(exhibit: Exhibit) -> Picture:
    """Return the figure as text; the drawing itself is let go, it is large.

    Args:
        exhibit: Drawn inside `styled`, and still in it.
    """
    if exhibit.figure is None:
        return Picture(exhibit, "", half=False)
    svg = svg_text(exhibit.figure, exhibit.name, exhibit.title)
    width_mm = float(exhibit.figure.get_figwidth()) * MM_PER_INCH
    words = exhibit._replace(figure=None)
    return Picture(words, svg, half=width_mm <= COLUMN_WIDTH_MM + 1.0)


def write_figures(
    folder: Path, pictures: Iterable[Picture], known: Iterable[str] = ()
) -> None:
    """Write every figure that was drawn, and remove those that no longer are.

    Args:
        folder: Made if it is not there.
        pictures: Drawn or not.
        known: Figures that an earlier report may have left; every SVG file if empty.
    """
    folder.mkdir(exist_ok=True)
    drawn = {each.exhibit.name: each.svg for each in pictures if each.svg}
    for name in known or [file.stem for file in folder.glob("*.svg")]:
        if name not in drawn:
            (folder / f"{name}.svg").unlink(missing_ok=True)
    for name, svg in drawn.items():
        write_text(folder / f"{name}.svg", svg)


def render_page(
    template: str,
    sections: Sequence[Section],
    words: dict[str, Any],  # Any: what a template takes
    package: str = _HOME,
) -> str:
    """Return a page as HTML.

    Args:
        template: Extends `frame.html`.
        sections: After the opening.
        words: What the template's own blocks need.
        package: Where the template is, in its folder `templates`.
    """
    home = PackageLoader(_HOME, "templates")
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(package, "templates"), home]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    css = Markup(home.get_source(environment, "page.css")[0])
    page = environment.get_template(template)
    return page.render(css=css, sections=_numbered(sections), **words)


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


def _drawing(shown: Picture) -> Markup:
    exhibit = shown.exhibit
    return Markup(
        inline_svg(shown.svg, exhibit.name, exhibit.title, exhibit.description)
    )
