"""The page drives: it shows the road, tells what hands do and what it waits for."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

from costeer.runtime.states import Fault
from costeer.sessions.questionnaires.texts import load_texts
from tests.web.page.conftest import until, wait_for
from tests.web.page.stub import Json, Stub, served

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Route

pytestmark = pytest.mark.browser


LIMPING: Json = {
    "code": 7,
    "name": "limping",
    "title": "On three wheels",
    "lines": ["Press [Enter] to stop."],
    "goes_on_by": "stop",
}
"""A state that no server has: the page knows states from the hello alone."""

FLAT_TYRE: Json = {
    "code": 77,
    "name": "flat_tyre",
    "text": "A tyre is flat.",
    "can_resume": False,
}
"""The same of a fault."""


class Driven:
    """A page that drives on a stub."""

    def __init__(self, page: Page, stub: Stub, address: str) -> None:
        self.page, self.stub, self.address = page, stub, address
        self.requests: list[str] = []
        self.errors: list[str] = []
        page.on("request", lambda request: self.requests.append(request.url))
        page.on("pageerror", lambda error: self.errors.append(str(error)))

    def press(self, key: str) -> None:
        """Press a key in the page."""
        self.page.keyboard.press(key)

    def hear_steer(self, steer: float) -> None:
        """Wait until the newest input steers so."""
        inputs = self.stub.of_type
        wait_for(self.page, lambda: inputs("input")[-1]["steer"] == steer)

    def enter(self, state: str) -> None:
        """Bring the trial into a state and wait until the page is there."""
        states = self.stub.tables["run_states"]
        (number,) = [each["code"] for each in states if each["name"] == state]
        self.stub.frame |= {"run_state": float(number), "fault": 0.0}
        arrived = f"costeer.state === '{state}' && costeer.lastFrame.fault === 0"
        until(self.page, arrived)


@pytest.fixture(scope="module")
def driven(browser: Browser) -> Iterator[Driven]:
    stub = Stub()
    stub.tables["run_states"].append(LIMPING)
    stub.tables["faults"].append(FLAT_TYRE)
    with served(stub) as address:
        page = browser.new_page(viewport={"width": 480, "height": 270})
        found = Driven(page, stub, address)
        page.goto(f"{address}/?low&clean")
        until(page, "window.costeer && costeer.state === 'waiting'")
        yield found
        assert found.errors == []
        page.close()


def banner(page: Page) -> str:
    return page.locator("#banner").inner_text()


def test_enter_starts_a_waiting_trial(driven: Driven) -> None:
    driven.enter("waiting")
    assert "Press Enter or Space to start" in banner(driven.page)
    driven.press("Enter")
    until(driven.page, "costeer.state === 'running'")
    assert len(driven.stub.of_type("start")) == 1
    assert driven.page.locator("#banner").is_hidden()


def test_who_has_no_keyboard_taps_the_message(driven: Driven) -> None:
    driven.stub.heard.clear()
    driven.enter("paused")
    driven.stub.frame |= {"fault": float(FLAT_TYRE["code"])}
    driven.page.locator("#banner", has_text="A tyre is flat.").click()
    driven.enter("paused")  # what was wrong is not
    driven.page.locator("#banner").click()
    until(driven.page, "costeer.state === 'running'")
    assert len(driven.stub.of_type("resume")) == 1


def test_frames_arrive_by_name_and_are_counted(driven: Driven) -> None:
    driven.enter("running")
    before = driven.page.evaluate("costeer.frames")
    until(driven.page, f"costeer.frames > {before} + 10")
    frame = driven.page.evaluate("costeer.lastFrame")
    assert frame["longitudinal_velocity"] == 20.0
    assert frame["steering_wheel_angle"] == 0.2
    assert until(driven.page, "costeer.fps > 0")


def test_arrows_steer_left_positive_and_let_go(driven: Driven) -> None:
    driven.enter("running")
    for key, steer in (("ArrowLeft", 1), ("d", -1)):
        driven.page.keyboard.down(key)
        driven.hear_steer(steer)
        driven.page.keyboard.up(key)
        driven.hear_steer(0)


def test_inputs_go_on_without_keys_and_are_numbered(driven: Driven) -> None:
    before = len(driven.stub.of_type("input"))
    wait_for(driven.page, lambda: len(driven.stub.of_type("input")) > before + 5)
    numbers = [message["sequence"] for message in driven.stub.of_type("input")]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))


def test_latency_is_measured_and_told(driven: Driven) -> None:
    until(driven.page, "costeer.latency.input.count > 5")
    p50 = driven.page.evaluate("costeer.latency.input.p50")
    # The echo comes with a frame, so within some frames; a second is another fault.
    assert 0.0 < p50 < 1000.0
    wait_for(driven.page, lambda: len(driven.stub.of_type("latency")) > 0)
    assert 1 <= len(driven.stub.of_type("latency")[0]["values"]) <= 60


def test_a_lost_wheel_is_named_and_a_word_goes_before_the_key_that_goes_on(
    driven: Driven,
) -> None:
    driven.enter("running")
    driven.stub.frame |= {"run_state": 2.0, "fault": float(Fault.WHEEL_LOST)}
    until(driven.page, "costeer.state === 'paused'")
    assert "The steering wheel was lost" in banner(driven.page)
    before = len(driven.stub.of_type("resume"))
    driven.press("Space")
    driven.press("c")
    wait_for(driven.page, lambda: len(driven.stub.of_type("acknowledge")) == 1)
    assert len(driven.stub.of_type("resume")) == before
    driven.stub.frame["fault"] = float(Fault.ACKNOWLEDGED)
    until(driven.page, f"costeer.lastFrame.fault === {int(Fault.ACKNOWLEDGED)}")
    driven.press("Space")
    until(driven.page, "costeer.state === 'running'")


def test_every_fault_of_the_server_is_shown_with_what_can_be_done(
    driven: Driven,
) -> None:
    driven.enter("paused")
    faults = driven.stub.tables["faults"]
    assert {"The page did not answer for a moment.", "A tyre is flat."} <= {
        fault["text"] for fault in faults
    }
    warns = "document.getElementById('banner').classList.contains('warn')"
    for fault in faults:
        driven.stub.frame["fault"] = float(fault["code"])
        until(driven.page, f"costeer.lastFrame.fault === {fault['code']}")
        told = [line for line in banner(driven.page).split("\n") if line]
        assert told[0] == "Paused"
        assert (fault["text"] in told) == bool(fault["text"])
        mends = bool(fault.get("must_be_acknowledged"))
        goes_on = fault["can_resume"] and not mends
        assert ("Press Enter or Space to go on." in told) == goes_on
        assert any("mended press C" in line for line in told) == mends
        assert driven.page.evaluate(warns) == bool(fault["text"])


def test_a_key_does_nothing_where_nothing_can_go_on(driven: Driven) -> None:
    driven.enter("paused")
    driven.stub.frame["fault"] = float(FLAT_TYRE["code"])
    until(driven.page, f"costeer.lastFrame.fault === {FLAT_TYRE['code']}")
    before = len(driven.stub.of_type("resume"))
    driven.press("Enter")
    driven.page.keyboard.down("ArrowLeft")
    driven.hear_steer(1.0)  # what was pressed before has been sent as well
    driven.page.keyboard.up("ArrowLeft")
    assert len(driven.stub.of_type("resume")) == before
    driven.stub.frame["fault"] = 0.0


def test_every_state_of_the_server_is_shown_and_left_as_it_says(
    driven: Driven,
) -> None:
    for state in driven.stub.tables["run_states"]:
        driven.enter(state["name"])
        assert banner(driven.page).split("\n")[0] == state["title"]
    driven.enter("limping")
    driven.press("Enter")
    wait_for(driven.page, lambda: bool(driven.stub.of_type("stop")))


def test_the_same_indicator_twice_is_off(driven: Driven) -> None:
    driven.enter("running")
    for side in (1, 0):
        driven.press("z")
        until(driven.page, f"costeer.lastFrame.indicator === {side}")
    assert [m["side"] for m in driven.stub.of_type("indicator")] == [1, 0]


def test_participants_see_no_signals(driven: Driven) -> None:
    for _ in range(2):
        assert driven.page.locator("#signals").is_hidden()
        driven.press("s")
    assert driven.page.locator("#panel").is_hidden()


def test_the_view_shows_sky_above_and_road_below(driven: Driven) -> None:
    driven.enter("running")
    driven.page.wait_for_timeout(300)
    picture = Image.open(io.BytesIO(driven.page.screenshot())).convert("RGB")
    pixels = np.asarray(picture, dtype=float)
    height, width, _ = pixels.shape
    sky = pixels[: height // 8, width // 2 :].mean(axis=(0, 1))
    road = pixels[int(0.58 * height), width // 3 : width // 2].mean(axis=0)
    assert sky[2] > sky[0] + 20.0  # blue sky
    assert np.ptp(road) < 25.0  # grey road
    assert road.mean() < sky.mean()


def test_nothing_is_loaded_from_elsewhere(driven: Driven) -> None:
    assert driven.requests
    own = driven.address.removeprefix("http")
    outside = [u for u in driven.requests if own not in u and not u.startswith("data:")]
    assert outside == []


def test_what_the_drive_goes_on_without_stays_on_the_page(driven: Driven) -> None:
    told = driven.page.locator("#losses")
    assert told.is_hidden()
    driven.stub.say({"type": "losses", "texts": ["The <b>network</b> has ended."]})
    told.wait_for(state="visible")
    assert told.inner_text() == "The <b>network</b> has ended."
    driven.stub.say({"type": "losses", "texts": []})
    told.wait_for(state="hidden")


def test_a_server_that_is_halted_is_told_and_left_as_it_answers(
    driven: Driven,
) -> None:
    driven.enter("running")
    driven.stub.is_halted = True
    until(driven.page, "costeer.state === 'silent'")
    assert "The server does not answer" in banner(driven.page)
    driven.stub.is_halted = False
    until(driven.page, "costeer.state === 'running'")


def test_a_page_that_comes_late_is_told_how_it_stands(browser: Browser) -> None:
    stub = Stub()
    gone = next(each for each in stub.tables["faults"] if each["name"] == "loop_gone")
    stub.tables |= {"run_state": 2, "fault": gone["code"], "losses": ["No network."]}
    stub.is_loop_gone = True  # no frame comes any more
    with served(stub) as address:
        page = browser.new_page(viewport={"width": 480, "height": 270})
        page.goto(f"{address}/?low&clean")
        until(page, "window.costeer && costeer.state === 'paused'")
        assert gone["text"] in banner(page)
        assert "Enter" not in banner(page)
        assert page.locator("#losses").inner_text() == "No network."
        page.close()


FRAMED = """(texts) => {
  const frame = document.createElement("iframe");
  Object.assign(frame, {id: "drive", src: "/?low&clean", width: 480, height: 270});
  Object.assign(frame.dataset, {texts: JSON.stringify(texts), lang: "de"});
  document.body.replaceChildren(frame);
}"""
"""As the page of a session holds the page of a drive."""


def test_in_a_session_the_participants_language_is_spoken(browser: Browser) -> None:
    stub = Stub()
    stub.tables["losses"] = ["Start costeer drive again."]
    with served(stub) as address:
        page = browser.new_page(viewport={"width": 640, "height": 360})
        page.goto(f"{address}/page.css")
        page.evaluate(FRAMED, load_texts("de").pages)
        inside = page.frame_locator("#drive")
        told = inside.locator("#banner")
        told.filter(has_text="Nehmen Sie das Lenkrad").wait_for()
        assert told.locator("kbd").inner_text() == "Enter"
        assert inside.locator("html").get_attribute("lang") == "de"
        stub.frame |= {"fault": 5.0}  # before the start nothing was interrupted
        told.filter(has_text="Die Versuchsleitung bereitet").wait_for()
        assert told.inner_text().startswith("Bereit")
        stub.frame |= {"run_state": 2.0}
        told.filter(has_text="Die Fahrt wurde unterbrochen").wait_for()
        assert "doctor" not in told.inner_text()
        inside.locator("body").press("h")
        for name in ("#losses", "#help"):
            assert inside.locator(name).is_hidden()
        page.close()


@pytest.mark.parametrize(
    ("language", "told"), [(None, "Connecting …"), ("de", "Einen Moment …")]
)
def test_a_page_that_still_loads_says_so(
    browser: Browser, language: str | None, told: str
) -> None:
    """What it is to show has not arrived: no black window without a word."""
    held: list[Route] = []
    with served(Stub()) as address:
        page = browser.new_page(viewport={"width": 640, "height": 360})
        page.route("**/api/hello*", lambda route: held.append(route))
        page.goto(f"{address}/{'?low&clean' if language is None else 'page.css'}")
        if language is not None:
            page.evaluate(FRAMED, load_texts(language).pages)
        shown = page.frames[-1].locator("#banner")
        shown.filter(has_text=told).wait_for()
        assert shown.inner_text().strip() == told
        wait_for(page, lambda: len(held) == 1)
        held[0].continue_()
        shown.filter(has_not_text=told).wait_for()
        until(page, f"{'' if language is None else 'frames[0].'}costeer?.state")
        assert shown.inner_text().strip() not in ("", told)
        page.close()


def test_each_language_has_words_for_what_a_participant_may_see() -> None:
    names = {state["name"] for state in Stub().tables["run_states"]} - {"running"}
    for language in ("en", "de", "ja"):
        pages = load_texts(language).pages
        for name in names | {"connecting", "lost", "silent", "over", "refused"}:
            assert pages[f"drive_{name}_title"]


def test_a_second_page_is_told_why_it_does_not_drive(browser: Browser) -> None:
    stub = Stub()
    stub.refuses = "another page drives already; close it"
    with served(stub) as address:
        page = browser.new_page(viewport={"width": 480, "height": 270})
        page.goto(f"{address}/?low&clean")
        until(page, "window.costeer && costeer.state === 'refused'")
        assert "another page drives already" in banner(page)
        stub.refuses = ""
        until(page, "costeer.state === 'waiting'")  # it is tried again, as it says
        page.close()


def test_the_end_of_the_server_is_told_and_nothing_is_tried_again(
    browser: Browser,
) -> None:
    stub = Stub()
    with served(stub) as address:
        page = browser.new_page(viewport={"width": 480, "height": 270})
        page.goto(f"{address}/?low&clean")
        until(page, "window.costeer && costeer.state === 'waiting'")
        stub.say({"type": "farewell"})
        until(page, "costeer.state === 'over'")
        stub.say({"type": "losses", "texts": ["seen"]})
        page.locator("#losses").wait_for(state="visible")
    page.wait_for_timeout(700)  # the first retry would come after half a second
    assert page.evaluate("costeer.state") == "over"
    assert "has ended" in banner(page)
    assert "again" not in banner(page)
    page.close()
