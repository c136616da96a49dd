"""Both pages of a session, with a real server and a real browser, and no drive."""

from __future__ import annotations

import json
import urllib.error
import urllib.request
from typing import TYPE_CHECKING, Any

import pytest

from tests.sessions.made_up import rows_of
from tests.web.page.conftest import until, wait_for
from tests.web.sessions.conftest import OpenPage, Study

if TYPE_CHECKING:
    from playwright.sync_api import Page, Route

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]

HTML = "<img src=x onerror=alert(1)>"


def begin(study: Study, console: Page, name: str = "P01") -> None:
    """Let a participant sit down by the console."""
    field = console.get_by_label("Pseudonym")
    field.fill(name)
    console.get_by_role("button", name="Begin", exact=True).click()
    wait_for(console, lambda: study.desk.participant == name)


def agree(page: Page) -> None:
    """Tick what a consent asks."""
    page.get_by_role("checkbox").first.wait_for()
    for box in page.get_by_role("checkbox").all():
        box.check()
    page.locator("form input[type=text]").fill("AB")
    page.get_by_role("button", name="I agree").click()


def go_to_questions(study: Study, page: Page) -> None:
    """From the consent to the first questions."""
    agree(page)
    page.get_by_role("button", name="Continue").click()
    page.get_by_role("textbox").wait_for()
    assert step_of(study) == "ask-likert"


def step_of(study: Study) -> str:
    """The step that is on."""
    return str(study.desk.state()["step"]["id"])


def rate(page: Page) -> None:
    """Give every statement the third of its answers."""
    page.get_by_role("radiogroup").first.wait_for()
    for group in page.get_by_role("radiogroup").all():
        group.get_by_role("radio").nth(2).check()


def answers(study: Study, step: str = "ask-likert") -> dict[str, Any]:
    """What is kept of a step."""
    kept = study.desk.session.answers_of("P01", step)
    return {item: json.loads(value) for item, value in kept.items()}


def test_participant_goes_from_welcome_to_thanks(
    study: Study, open_page: OpenPage
) -> None:
    console, page = open_page(study.console), open_page(study.participant)
    page.get_by_text("The experimenter starts the session.").wait_for()
    begin(study, console)
    go_to_questions(study, page)
    assert page.inner_text("#progress") == "3 of 5"
    rate(page)
    page.get_by_role("textbox").fill(HTML)
    page.get_by_role("button", name="Continue").click()
    page.get_by_role("button", name="Go on").click()  # once the break is over
    rate(page)
    for _ in range(15):
        page.locator(".side").first.click()
    page.get_by_role("button", name="Continue").click()
    page.get_by_role("heading", name="Thank you").wait_for()
    assert answers(study)["comment"] == HTML
    console.get_by_role("button", name="Leave").click()
    wait_for(console, lambda: study.desk.participant == "")
    page.wait_for_timeout(1500)
    assert page.get_by_role("heading", name="Thank you").is_visible()


def test_reload_and_back_keep_what_was_filled_in(
    study: Study, open_page: OpenPage
) -> None:
    console, page = open_page(study.console), open_page(study.participant)
    begin(study, console)
    go_to_questions(study, page)
    rate(page)
    page.get_by_role("textbox").fill("half a thought")
    page.reload()
    assert page.get_by_role("textbox").input_value() == "half a thought"
    assert page.locator("input:checked").count() == 3
    page.goto("about:blank")
    page.go_back()
    assert page.get_by_role("textbox").input_value() == "half a thought"


def test_answers_sent_twice_are_kept_once(study: Study, open_page: OpenPage) -> None:
    console, page = open_page(study.console), open_page(study.participant)
    other = open_page(study.participant)
    begin(study, console)
    go_to_questions(study, page)
    for each in (page, other):
        rate(each)
    page.get_by_role("button", name="Continue").dblclick()
    page.get_by_role("heading", name="Break").wait_for()
    # The other tab still shows the form, or has already gone on by itself.
    other.evaluate("document.querySelector('form')?.requestSubmit()")
    other.get_by_role("heading", name="Break").wait_for()
    assert len(answers(study)) == 3
    said = [
        event["kind"]
        for event in study.desk.session.store.rows(
            "SELECT kind FROM events WHERE step = 'ask-likert'"
        )
    ]
    assert said == ["step finished"]


def test_answers_to_a_step_that_is_over_show_the_step_that_is_on(
    study: Study, open_page: OpenPage
) -> None:
    console, page = open_page(study.console), open_page(study.participant)
    begin(study, console)
    go_to_questions(study, page)
    rate(page)
    page.route("**/api/session", lambda route: route.abort())  # it hears nothing new
    study.desk.session.skip("P01", "ask-likert", "a test")
    page.get_by_role("button", name="Continue").click()
    page.get_by_role("heading", name="Break").wait_for()
    page.unroute("**/api/session")
    open_page.wrong.clear()  # the aborted requests and the 409


def test_lost_server_is_told_and_found_again(study: Study, open_page: OpenPage) -> None:
    page, console = open_page(study.participant), open_page(study.console)
    console.locator("#state", has_text="NOBODY").wait_for()
    for each in (page, console):
        each.route("**/api/**", lambda route: route.abort())
    page.get_by_text("The connection to the simulator is lost").wait_for()
    console.locator("#state", has_text="NO LINK").wait_for()
    for each in (page, console):
        each.unroute("**/api/**")
    page.locator("#banner").wait_for(state="hidden")
    console.locator("#state", has_text="NOBODY").wait_for()
    open_page.wrong.clear()  # the aborted requests


def test_consent_can_be_declined_and_taken_up_again(
    study: Study, open_page: OpenPage
) -> None:
    console, page = open_page(study.console), open_page(study.participant)
    begin(study, console)
    page.get_by_role("button", name="I do not take part").click()
    page.get_by_role("heading", name="You have stopped").wait_for()
    page.wait_for_timeout(2500)  # the state is shown again in the meantime
    page.get_by_role("button", name="Go on with the session").click()
    agree(page)
    page.get_by_role("heading", name="Welcome").wait_for()


@pytest.mark.parametrize("path", ["console", "api/console", "api/console/note"])
def test_console_is_shut_to_participants(study: Study, path: str) -> None:
    body = b"{}" if path.endswith("note") else None
    head = {"Content-Type": "application/json"}
    request = urllib.request.Request(study.participant + path, body, head)
    with pytest.raises(urllib.error.HTTPError) as refused:
        urllib.request.urlopen(request)
    assert refused.value.code == 403
    refused.value.close()


def test_notes_and_device_texts_are_text_on_the_console(
    study: Study, open_page: OpenPage
) -> None:
    console = open_page(study.console)
    begin(study, console)
    console.get_by_label("Note").fill(HTML)
    console.keyboard.press("Enter")
    console.locator("#events", has_text=HTML).wait_for()
    console.get_by_role("button", name="Check").click()
    console.locator("#checks", has_text="<b>plug it in</b>").wait_for()
    assert console.locator("img").count() == 0
    assert console.locator("#checks small b").count() == 0


def test_a_fault_that_waits_for_the_experimenter_is_told_from_afar(
    study: Study, open_page: OpenPage
) -> None:
    drive = {"state": "paused", "is_broken": True, "reason": "The wheel is gone."}

    def broken(route: Route) -> None:
        answer = route.fetch()
        told = answer.json()
        told["step"]["drive"] = {**drive, "losses": [], "unkept": []}
        route.fulfill(response=answer, json=told)

    console = open_page(study.console)
    begin(study, console)
    console.route("**/api/console?*", broken)
    console.locator("#state", has_text="FAULT").wait_for()
    told = "The wheel is gone. When that is mended, press Mended, then Go on."
    console.locator("#banners", has_text=told).wait_for()
    console.unroute_all(behavior="wait")


@pytest.mark.parametrize(
    "study",
    [
        "title: A study\nsteps:\n  - {kind: ask, instrument: fms}\n"
        "  - {kind: break, text: break, minutes: 1}\n"
    ],
    indirect=True,
)
def test_the_console_says_who_is_unwell_until_it_is_decided(
    study: Study, open_page: OpenPage
) -> None:
    console, page = open_page(study.console), open_page(study.participant)
    begin(study, console)
    page.locator("input[type=radio][value='18']").check(force=True)
    page.get_by_role("button", name="Continue").click()
    banner = console.locator("#banners li")
    banner.filter(has_text="P01 waits: fms is 18, the limit 15: end").wait_for()
    banner.get_by_role("button", name="Goes on").click()
    dialog = console.get_by_role("dialog")
    dialog.get_by_label("Reason").fill("feels well again")
    dialog.get_by_role("button", name="Goes on").click()
    banner.wait_for(state="detached")
    console.locator("#events", has_text="feels well again").wait_for()


def test_a_participant_who_is_held_sees_that_the_experimenter_is_at_work(
    study: Study, open_page: OpenPage
) -> None:
    drive = {"state": "ready", "is_broken": False, "reason": ""}
    held = [True]

    def told(route: Route) -> None:
        answer = route.fetch()
        state = answer.json()
        state |= {"held": held[0]}
        state["step"] |= {"kind": "drive", "drive": drive, "attempt": 1}
        route.fulfill(response=answer, json=state)

    console, page = open_page(study.console), open_page(study.participant)
    begin(study, console)
    page.route("**/api/session", told)
    page.get_by_text("The experimenter prepares the next part.").wait_for()
    assert page.get_by_role("button", name="I am ready").count() == 0
    held[0] = False
    page.get_by_role("button", name="I am ready").wait_for()
    page.unroute_all(behavior="wait")


DRAWN = """async (pictures) => {
  const { facts } = await import("/js/session/facts.js");
  const drive = { state: "running", has_page: true };
  const state = { step: { kind: "drive", drive }, disk: {}, page_seen: 0, pictures };
  return facts(state, { value: () => Number.NaN }, 20).at(-2);
}"""


def test_a_page_that_draws_too_few_pictures_turns_red(
    study: Study, open_page: OpenPage
) -> None:
    console = open_page(study.console)
    told = {n: console.evaluate(DRAWN, n) for n in (29, 30, None)}
    assert told[29]["unit"] == "29 fps, 20 ms"
    assert told[None]["unit"] == "20 ms"
    assert [each["kind"] for each in told.values()] == ["bad", "good", "good"]


def test_refusals_stand_beside_what_was_pressed_until_dismissed(
    study: Study, open_page: OpenPage
) -> None:
    console = open_page(study.console)
    console.get_by_label("Pseudonym").fill("Hans Meier")
    console.get_by_role("button", name="Begin", exact=True).click()
    error = console.locator("#begin .error")
    assert "Names do not belong here" in error.inner_text()
    console.wait_for_timeout(1500)  # the state is shown again in the meantime
    assert error.is_visible()
    error.get_by_role("button", name="Dismiss").click()
    assert error.count() == 0
    open_page.wrong.clear()  # the browser tells each refusal as an error


def test_skipping_needs_a_reason_and_escape_twice_is_an_emergency(
    study: Study, open_page: OpenPage
) -> None:
    console = open_page(study.console)
    begin(study, console)
    console.get_by_role("button", name="Skip").click()
    dialog = console.get_by_role("dialog")
    dialog.get_by_role("button", name="Skip it").click()
    dialog.get_by_text("give a reason").wait_for()
    assert step_of(study) == "consent"
    dialog.get_by_label("Reason").fill("signed on paper")
    dialog.get_by_role("button", name="Skip it").click()
    wait_for(console, lambda: step_of(study) == "instruct-welcome")
    dialog.wait_for(state="hidden")
    for _ in range(2):
        console.keyboard.press("Escape")
    console.get_by_text("nobody drives in this step").wait_for()
    open_page.wrong.clear()  # the browser tells each refusal as an error


def test_withdrawal_asks_for_the_pseudonym_and_leaves_nothing(
    study: Study, open_page: OpenPage
) -> None:
    console = open_page(study.console)
    begin(study, console)
    console.get_by_role("button", name="Withdraw").click()
    dialog = console.get_by_role("dialog")
    dialog.get_by_role("textbox").fill("P02")
    dialog.get_by_role("button", name="Delete for ever").click()
    dialog.get_by_text("type the pseudonym again").wait_for()
    dialog.get_by_role("textbox").fill("P01")
    dialog.get_by_role("button", name="Delete for ever").click()
    console.get_by_text("1 withdrew").wait_for()
    assert rows_of(study.desk.session, "P01") == []
    open_page.wrong.clear()  # the browser tells each refusal as an error


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 390])
def test_pages_pass_the_rules_of_accessibility(
    study: Study, open_page: OpenPage, scheme: Any, width: int
) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    console, page = open_page(study.console), open_page(study.participant)
    for each in (console, page):
        each.emulate_media(color_scheme=scheme)
        each.set_viewport_size({"width": width, "height": 844 if width < 400 else 720})

    def check(each: Page) -> None:
        found = axe.run(each).response["violations"]
        assert [(v["id"], [n["html"] for n in v["nodes"]]) for v in found] == []
        assert until(each, "document.documentElement.scrollWidth <= innerWidth")

    check(page)
    check(console)
    begin(study, console)
    console.get_by_role("button", name="Check").click()
    console.locator("#checks", has_text="Disk").wait_for()
    page.get_by_role("checkbox").first.wait_for()
    check(page)
    check(console)
    console.get_by_role("button", name="Withdraw").click()
    check(console)
    go_to_questions(study, page)
    check(page)


def test_form_is_filled_with_the_keyboard_alone(
    study: Study, open_page: OpenPage
) -> None:
    console, page = open_page(study.console), open_page(study.participant)
    begin(study, console)
    page.get_by_role("checkbox").first.wait_for()
    press = page.keyboard.press
    for _ in range(4):
        press("Tab")
        press("Space")
    press("Tab")
    page.keyboard.type("AB")
    press("Enter")
    page.get_by_role("heading", name="Welcome").wait_for()
    press("Tab")
    press("Enter")
    page.get_by_role("radiogroup").first.wait_for()
    assert page.evaluate("document.activeElement.tagName") == "H1"
