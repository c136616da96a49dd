"""A figure for a journal has its width, and letters that can be read."""

from __future__ import annotations

import gc
import re

import pytest
from matplotlib.figure import Figure

from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.publish import legible, published, set_width
from costeer.pages.series import say
from costeer.pages.style import MM_PER_INCH, Margins, new_figure, panels, styled

MARGINS = Margins(left=12.0, right=3.0, top=5.0, bottom=9.0, between_columns=14.0)


def drawn(columns: int = 2, title: str = "Title") -> Exhibit:
    figure = new_figure(180.0, 60.0)
    for axes in panels(figure, 1, columns, MARGINS)[0]:
        say(axes.plot([0.0, 1.0], [0.0, 1.0])[0], "line")
        axes.set_title(title)
    return Exhibit("f", "F", "", "", figure)


def boxes(figure: Figure) -> list[list[float]]:
    """Left, bottom, width and height of each panel [mm]."""
    size = [float(each) * MM_PER_INCH for each in figure.get_size_inches()]
    return [
        [
            share * size[place % 2]
            for place, share in enumerate(axes.get_position().bounds)
        ]
        for axes in figure.axes
    ]


def test_margins_keep_their_millimetres() -> None:
    with styled():
        figure = drawn().figure
        assert figure is not None
        set_width(figure, 140.0)
        # (140 - 12 - 3 - 14) / 2 = 55.5
        expected = [[12.0, 9.0, 55.5, 46.0], [81.5, 9.0, 55.5, 46.0]]
        assert boxes(figure) == [pytest.approx(each) for each in expected]


def test_a_row_that_would_be_too_narrow_is_stacked() -> None:
    with styled():
        figure = drawn().figure
        assert figure is not None
        set_width(figure, 88.0)
        # Each panel keeps 46 mm; between them are the margins, 5 + 9 mm.
        expected = [[12.0, 69.0, 73.0, 46.0], [12.0, 9.0, 73.0, 46.0]]
        assert boxes(figure) == [pytest.approx(each) for each in expected]
        assert figure.get_figheight() * MM_PER_INCH == pytest.approx(120.0)


def test_words_that_meet_are_not_legible() -> None:
    with styled():
        figure = drawn(title="A title that needs a whole panel").figure
        assert figure is not None
        assert legible(figure)
        figure.axes[1].set_title("")
        figure.axes[0].set_title("w" * 200)  # leaves the figure
        assert not legible(figure)
        figure.axes[0].set_title("")
        for at in (0.5, 0.52):
            figure.axes[0].text(at, 0.5, "word")
        assert not legible(figure)


@pytest.mark.slow
def test_who_asks_for_too_narrow_a_figure_is_told_what_it_needs() -> None:
    with styled():
        exhibit = drawn(6, "A title of a panel")
        with pytest.raises(
            ValueError, match=r"not legible at 70 mm.*needs \d+ mm"
        ) as told:
            published(exhibit, 70.0, "pdf")
        needed = float(re.findall(r"needs (\d+) mm", str(told.value))[0])
        assert published(drawn(6, "A title of a panel"), needed, "svg")


@pytest.mark.slow
def test_a_pdf_and_a_png_are_as_wide_as_asked_and_the_same_each_time() -> None:
    with styled():
        pdf, again = (published(drawn(), 88.0, "pdf") for _ in range(2))
        png = published(drawn(), 88.0, "png")
    assert pdf == again
    box = re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) [\d.]+ \]", pdf)
    assert float(box[0]) == pytest.approx(88.0 / 25.4 * 72.0, abs=0.01)
    # The width in pixels stands in bytes 16 to 20 of a PNG; 600 dots per inch.
    assert int.from_bytes(png[16:20], "big") == int(88.0 / 25.4 * 600.0)


def test_what_is_not_there_is_told() -> None:
    with styled():
        with pytest.raises(ValueError, match=r"not drawn: No trial\."):
            published(not_drawn("f", "F", "No trial."), None, "pdf")
        bare = Exhibit("f", "F", "", "", new_figure(50.0, 50.0))
        with pytest.raises(ValueError, match="no data"):
            published(bare, None, "csv")


@pytest.mark.parametrize("before", [True, False])
def test_the_style_leaves_the_collector_as_it_was(before: bool) -> None:
    def drawn() -> None:
        with styled():
            assert not gc.isenabled()
            raise ValueError("drawing")

    was = gc.isenabled()
    (gc.enable if before else gc.disable)()
    try:
        with pytest.raises(ValueError, match="drawing"):
            drawn()
        assert gc.isenabled() == before
    finally:
        (gc.enable if was else gc.disable)()
