"""The report as people see it: in a browser, with and without its script."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import pytest

from tests.web.page.conftest import browser as browser  # a fixture

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser

SIZES = {"desk": (1280, 800), "phone": (390, 844)}


@pytest.fixture
def page(browser: Browser, reported: Path) -> Iterator[Page]:
    """The report; what goes wrong in it fails the test."""
    wrong: list[str] = []
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.goto((reported / "report.html").as_uri())
    yield page
    page.close()
    assert wrong == []


@pytest.mark.parametrize(("size", "light"), [("desk", "light"), ("phone", "dark")])
def test_axe_finds_nothing(
    page: Page, size: str, light: Literal["light", "dark"]
) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    width, height = SIZES[size]
    page.set_viewport_size({"width": width, "height": height})
    page.emulate_media(color_scheme=light)
    # The thousands of parts of a drawing count as one picture, which has a title.
    found = axe.run(page, {"exclude": [["svg"]]}).response["violations"]
    assert [(rule["id"], rule["nodes"][0]["html"][:200]) for rule in found] == []


@pytest.mark.parametrize("size", SIZES)
def test_the_answer_is_on_the_first_screen_and_nothing_is_wider(
    page: Page, size: str
) -> None:
    width, height = SIZES[size]
    page.set_viewport_size({"width": width, "height": height})
    box = page.locator("#figure-effects svg").bounding_box()
    assert box is not None
    assert box["y"] + box["height"] < height
    assert page.evaluate("document.documentElement.scrollWidth") == width


def test_a_mark_that_is_pointed_at_tells_its_value(page: Page) -> None:
    place = page.evaluate(
        """() => {
          const figure = document.getElementById("figure-effects");
          const values = JSON.parse(figure.querySelector("script").textContent);
          const svg = figure.querySelector("svg");
          const [x, y, words] = values.marks[1];
          const at = new DOMPoint(x, y).matrixTransform(svg.getScreenCTM());
          return [at.x, at.y, words];
        }"""
    )
    page.mouse.move(place[0], place[1])
    tip = page.locator(".tip")
    assert tip.text_content() == place[2]
    assert tip.text_content().startswith("strong-rapid − manual, SDLP: ")
    page.mouse.move(2, 2)
    assert tip.is_hidden()


def test_a_curve_that_is_pointed_at_tells_its_height(page: Page) -> None:
    # The law of Eq. (10) stands at 1 until the verdict turns at 0 s.
    drawing = page.locator("#figure-gain-adjustment svg")
    drawing.scroll_into_view_if_needed()
    place = page.evaluate(
        """() => {
          const figure = document.getElementById("figure-gain-adjustment");
          const { panels } = JSON.parse(figure.querySelector("script").textContent);
          const { box, x } = panels[0];
          const across = box[0] + ((-0.5 - x[0]) / (x[1] - x[0])) * (box[2] - box[0]);
          const matrix = figure.querySelector("svg").getScreenCTM();
          const middle = (box[1] + box[3]) / 2;
          const at = new DOMPoint(across, middle).matrixTransform(matrix);
          return [at.x, at.y];
        }"""
    )
    page.mouse.move(*place)
    lines = str(page.locator(".tip").text_content()).splitlines()
    assert lines[0].endswith("[s]: −0.5")
    assert lines[2:] == ["consistent after 4 s: 1", "consistent after 1 s: 1"]


@pytest.mark.parametrize("name", ["signals-strong", "signals-weak", "inconsistency"])
def test_another_participant_can_be_chosen_and_the_first_again(
    page: Page, name: str
) -> None:
    figure = page.locator(f"#figure-{name}")
    paths = f"""[...document.querySelectorAll("#figure-{name} path[clip-path]")]
      .map((each) => each.getAttribute("d")).join("|")"""
    first = page.evaluate(paths)
    figure.locator("select").select_option(label="2")
    second = page.evaluate(paths)
    assert second != first
    assert "Participant 2," in str(figure.locator("figcaption").text_content())
    figure.locator("select").select_option(label="1")
    own = page.evaluate(paths)
    assert own != second
    assert "Participant 1," in str(figure.locator("figcaption").text_content())


def column(page: Page, table: str, place: int) -> list[str]:
    cells = page.locator(f"#table-{table} tbody tr > :nth-child({place})")
    return [each.split("\n")[0] for each in cells.all_text_contents()]


def test_a_table_sorts_by_numbers_and_by_words(page: Page) -> None:
    header = page.locator("#table-trials thead th").nth(2)
    header.locator("button").click()
    assert header.get_attribute("aria-sort") == "ascending"
    rising = [float(each.replace("−", "-")) for each in column(page, "trials", 3)]
    assert rising == sorted(rising)
    assert len(set(rising)) > 5
    header.locator("button").click()
    falling = [float(each.replace("−", "-")) for each in column(page, "trials", 3)]
    assert falling == sorted(falling, reverse=True)
    words = page.locator("#table-trials thead th").nth(1)
    words.locator("button").click()
    assert column(page, "trials", 2) == sorted(column(page, "trials", 2))


def test_without_its_script_the_page_says_the_same(
    browser: Browser, reported: Path, page: Page
) -> None:
    context = browser.new_context(java_script_enabled=False)
    plain = context.new_page()
    plain.goto((reported / "report.html").as_uri())
    for what in ("figcaption", "tbody", "dd", "h2"):
        assert (
            plain.locator(what).all_text_contents()
            == page.locator(what).all_text_contents()
        )
    assert plain.locator("select, th button").count() == 0
    context.close()


def test_a_table_whose_rows_belong_together_does_not_sort(page: Page) -> None:
    names = column(page, "effects", 1)
    assert "" in names
    assert page.locator("#table-effects thead button").count() == 0


def test_the_heads_of_tables_are_text_where_the_page_is_printed(page: Page) -> None:
    # Chromium repeats a head on every sheet, but no button that is in it.
    page.emulate_media(media="print")
    shown = page.eval_on_selector_all(
        "thead button", "all => all.map(one => getComputedStyle(one).display)"
    )
    assert shown
    assert set(shown) == {"contents"}
