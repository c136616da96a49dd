"""Questionnaires and consent as a participant fills them in."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from costeer.sessions.questionnaires.answers import checked_answers
from costeer.sessions.questionnaires.definition import instrument_names, load_definition
from tests.web.session.conftest import ORIGIN, show

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.browser

CUT = """[...document.querySelectorAll(".face, button, legend, .ends span")]
  .filter((e) => !e.closest(".unseen") && getComputedStyle(e).display !== "inline"
    && e.scrollWidth > e.clientWidth + 1)
  .map((e) => e.textContent)"""
"""Words that do not fit into their box."""

SIZES = ((360, 640), (390, 844), (1280, 720), (1920, 1080))


def sent(page: Page) -> list[dict[str, Any]]:
    """Answers that were handed over; Any as JSON has it."""
    found: list[dict[str, Any]] = page.evaluate("window.sent")
    return found


def tick(page: Page, item: str, value: str) -> None:
    """Choose a value of a scale or choice."""
    place = f"input[name='item-{item}'][value='{value}']"
    page.evaluate("(place) => document.querySelector(place).click()", place)


def submit(page: Page) -> None:
    """Send the form."""
    page.locator("button.main").click()


def focused(page: Page) -> str:
    """Id or name of what has the focus."""
    return str(
        page.evaluate("document.activeElement.id || document.activeElement.name")
    )


def fill(page: Page, given: dict[str, Any]) -> None:
    """Answer everything somehow."""
    for item in given["items"]:
        if item["kind"] == "scale":
            tick(page, item["name"], f"{item['low'] + item['step']:g}")
        elif item["kind"] == "yes_no" and item["must_agree"]:
            page.locator(f"#item-{item['name']}").check()
        elif item["kind"] in ("choice", "yes_no"):
            tick(page, item["name"], item["options"][-1]["value"])
        elif item["kind"] in ("number", "text"):
            page.locator(f"#item-{item['name']}").fill("42")
        else:
            page.evaluate("document.querySelector('button.side').click()")


@pytest.mark.parametrize("name", instrument_names())
def test_what_a_page_sends_passes_the_check(page: Page, name: str) -> None:
    given = show(page, name)
    fill(page, given)
    submit(page)
    (answers,) = sent(page)
    assert checked_answers(load_definition(name), answers) == answers
    assert set(answers) == {item["name"] for item in given["items"]}


def test_an_untouched_scale_is_unanswered(page: Page) -> None:
    show(page, "nasa-tlx-raw")
    assert page.locator("input:checked").count() == 0
    tick(page, "mental_demand", "50")
    submit(page)
    assert sent(page) == []
    assert page.locator("[role=alert]").inner_text().startswith("5 answers are missing")
    assert focused(page) == "item-physical_demand"
    wrong = page.locator("[aria-invalid=true]")
    assert wrong.count() == 5
    described = wrong.first.get_attribute("aria-describedby") or ""
    error = page.locator(f"#{described.split()[-1]}")
    assert error.inner_text() == "Please answer this question."
    tick(page, "physical_demand", "0")
    assert page.locator("[aria-invalid=true]").count() == 4
    assert page.locator("[role=alert]").inner_text().startswith("4 answers are missing")
    for item in ("temporal_demand", "performance", "effort", "frustration"):
        tick(page, item, "0")
    assert page.locator("[role=alert]").inner_text() == ""


def test_a_scale_is_answered_by_keyboard(page: Page) -> None:
    show(page, "fms")
    page.keyboard.press("Tab")
    page.keyboard.press("Space")
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("Enter")
    assert sent(page) == [{"sickness": 2}]


def test_a_mouse_on_the_line_marks_the_tick_under_it(page: Page) -> None:
    show(page, "nasa-tlx-raw")
    box = page.locator(".row.ticks").first.bounding_box()
    assert box is not None
    middle = box["y"] + box["height"] / 2
    # The seventh of 21 ticks stands for 6 * 5 = 30; a drag on to the 20th for 95.
    page.mouse.click(box["x"] + box["width"] * 6.5 / 21, middle)
    assert page.locator("input:checked").get_attribute("value") == "30"
    page.mouse.move(box["x"] + box["width"] * 6.5 / 21, middle)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 19.5 / 21, middle, steps=5)
    page.mouse.up()
    assert page.locator("input:checked").get_attribute("value") == "95"


def test_comparisons_are_made_by_arrow_keys(page: Page) -> None:
    given = show(page, "nasa-tlx", seed=4)
    pairs = [item for item in given["items"] if item["kind"] == "pairs"]
    for item in given["items"][:6]:
        tick(page, item["name"], "50")
    page.locator("button.side").first.focus()
    for n in range(15):
        progress = page.locator(".progress").inner_text()
        assert progress.startswith(f"Comparison {n + 1} of 15")
        page.keyboard.press("ArrowLeft" if n % 2 else "ArrowRight")
    assert page.locator(".progress").inner_text() == "All 15 comparisons are done."
    submit(page)
    chosen = {
        p["name"]: p["options"][(n + 1) % 2]["value"] for n, p in enumerate(pairs)
    }
    assert sent(page) == [
        dict.fromkeys([i["name"] for i in given["items"][:6]], 50) | chosen
    ]


def test_a_comparison_can_be_taken_back(page: Page) -> None:
    given = show(page, "nasa-tlx")
    first = next(item for item in given["items"] if item["kind"] == "pairs")
    page.locator("button.side").first.click()
    page.get_by_role("button", name="Back").click()
    pressed = page.locator("button.side[aria-pressed=true] strong")
    assert pressed.inner_text() == first["options"][0]["label"]
    page.locator("button.side").last.click()
    kept = page.evaluate("Object.values(sessionStorage)[0]")
    assert f'"{first["name"]}":"{first["options"][1]["value"]}"' in kept


def test_a_draft_survives_a_reload_and_goes_when_sent(page: Page) -> None:
    show(page, "likert", seed=5)
    tick(page, "understood", "4")
    page.locator("#item-comment").fill("<b>good</b>")
    page.goto(f"{ORIGIN}/")
    show(page, "likert", seed=5)
    assert page.locator("input:checked").get_attribute("value") == "4"
    assert page.locator("#item-comment").input_value() == "<b>good</b>"
    tick(page, "in_control", "4")
    tick(page, "worked_against_me", "1")
    submit(page)
    assert len(sent(page)) == 1
    assert page.evaluate("sessionStorage.length") == 0


def test_the_next_step_finds_no_draft_of_another(page: Page) -> None:
    show(page, "fms", seed=5)
    tick(page, "sickness", "9")
    show(page, "fms", seed=6)
    assert page.locator("input:checked").count() == 0
    assert page.evaluate("sessionStorage.length") == 0


@pytest.mark.parametrize("broken", ["{", "null", "7", '{"sickness": {"a": 1}}'])
def test_a_broken_draft_is_no_harm(page: Page, broken: str) -> None:
    page.evaluate(
        "(text) => sessionStorage.setItem('costeer.draft.fms-1', text)", broken
    )
    show(page, "fms", seed=1)
    assert page.locator("input:checked").count() == 0


def test_answers_stay_when_they_cannot_be_sent(page: Page) -> None:
    show(page, "fms")
    tick(page, "sickness", "3")
    page.evaluate("window.failure = {}")
    submit(page)
    told = page.locator("[role=alert]")
    assert told.inner_text() == (
        "The answers could not be sent: no link. They are still here; please try again."
    )
    page.evaluate("window.failure = null")
    submit(page)
    assert sent(page) == [{"sickness": 3}]


def test_what_the_server_refuses_is_marked_where_it_is(page: Page) -> None:
    given = show(page, "likert")
    fill(page, given)
    page.evaluate("window.failure = { problems: { comment: 'personal' } }")
    submit(page)
    assert focused(page) == "item-comment"
    error = page.locator("#item-comment-error").inner_text()
    assert error.startswith("This looks like an e-mail address")
    page.evaluate("window.failure = { problems: { gone: 'unknown' } }")
    submit(page)
    assert (
        page.locator("[role=alert]").inner_text().startswith("This page is out of date")
    )


def test_two_clicks_send_once(page: Page) -> None:
    show(page, "fms")
    tick(page, "sickness", "3")
    page.evaluate(
        "for (const n of [1, 2, 3]) document.querySelector('button.main').click()"
    )
    assert sent(page) == [{"sickness": 3}]


@pytest.mark.parametrize(
    ("typed", "told"),
    [
        ("", "Please answer this question."),
        ("old", "Please give a number."),
        ("12", "Please give a number from 16 to 110."),
        ("20,5", "Please give a whole number."),
    ],
)
def test_a_wrong_number_is_told(page: Page, typed: str, told: str) -> None:
    show(page, "demographics")
    page.locator("#item-age").fill(typed)
    submit(page)
    assert page.locator("#item-age-error").inner_text() == told
    assert focused(page) == "item-age"


def test_full_width_digits_are_a_number(page: Page) -> None:
    show(page, "demographics", "ja")
    page.locator("#item-age").fill("２１")
    submit(page)
    assert page.locator("#item-age-error").is_hidden()


def test_words_of_a_lab_are_never_markup(page: Page) -> None:
    evil = "<img src=x onerror='window.stolen = 1'>"
    item = {
        "name": "a",
        "kind": "scale",
        "required": True,
        "title": evil,
        "text": evil,
        "low": 0,
        "high": 1,
        "step": 1,
        "low_text": evil,
        "high_text": evil,
        "labels": {"0": evil, "1": evil},
    }
    show(page, "fms", title=evil, instruction=[evil], items=[item])
    assert page.locator("h1").inner_text() == evil
    assert page.locator("img").count() == 0
    assert page.evaluate("window.stolen") is None


def test_consent_needs_every_point_and_leaves_a_way_out(page: Page) -> None:
    given = show(page, "consent")
    submit(page)
    assert sent(page) == []
    assert focused(page) == "item-informed"
    told = page.locator("#item-informed-error").inner_text()
    assert told == "You can take part only if you agree to this."
    page.get_by_role("button", name="I do not take part").click()
    assert page.evaluate("window.declined") == 1
    fill(page, given)
    page.get_by_role("button", name="I agree and take part").click()
    assert sent(page)[0]["voluntary"] == "yes"


@pytest.mark.parametrize("language", ["en", "de", "ja"])
def test_nothing_is_wider_than_the_screen(page: Page, language: str) -> None:
    for name in instrument_names():
        show(page, name, language)
        submit(page)  # with every error shown
        for width, height in SIZES:
            page.set_viewport_size({"width": width, "height": height})
            over = page.evaluate("document.documentElement.scrollWidth - innerWidth")
            assert over <= 0, (name, width)
            cut = page.evaluate(CUT)
            assert cut == [], (name, width)


def test_a_heading_gets_the_focus_when_a_form_appears(page: Page) -> None:
    show(page, "ssq")
    assert focused(page) == "form-title"
