"""A participant without a mind: answers by chance, drives by virtual hands.

It works the real pages in a browser without a window, and kills what they stand on.
"""

from __future__ import annotations

import hashlib
import os
import random
import shutil
import signal
import subprocess
import time
import urllib.error
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from costeer.base.extras import install_command
from costeer.sessions.rehearsal_server import RehearsalServer
from costeer.sessions.standing import WHOLE

# Any, in this file: of JSON, and objects of Playwright, which a plain install lacks.
ACCIDENTS = ("server", "loop", "network", "watchdog", "browser")
"""What is killed."""

_PATIENCE = 120.0
"""A rehearsal in which nothing moves for so long has failed [s]."""

_MOST_ATTEMPTS = 10
"""Nor does one come to an end whose drive breaks so often though nothing was killed."""

_FLAGS = (
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--no-first-run",
)


class RehearsalSettings(NamedTuple):
    """What is rehearsed.

    Attributes:
        participants: How many.
        seed: Of answers and accidents.
        accidents: Each minute, on average.
        haste: Seconds of a drive in a second.
        length: Of a trial [m].
        conditions: Of the block of trials; the plan's if empty.
        scenario: That ships with costeer.
    """

    participants: int = 12
    seed: int = 1
    accidents: float = 0.5
    haste: float = 20.0
    length: float = 300.0
    conditions: tuple[str, ...] = ()
    scenario: str = "expressway"


def playwright() -> Any:
    """Playwright's own context.

    Raises:
        ModuleNotFoundError: If it is not installed.
    """
    try:
        from playwright.sync_api import sync_playwright
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"a rehearsal needs a browser that is driven; run: "
            f"{install_command('rehearse')}",
            name="playwright",
        ) from error
    return sync_playwright()


def browser_path() -> str:
    """The browser of this computer.

    Raises:
        OSError: If there is none.
    """
    names = ("chromium", "chromium-browser", "google-chrome", "chrome", "msedge")
    found = next((path for name in names if (path := shutil.which(name))), None)
    if found is None:
        raise FileNotFoundError(
            "no Chromium or Chrome is installed; a rehearsal needs one"
        )
    return found


class Robot:
    """Participant and experimenter in one."""

    def __init__(
        self,
        folder: Path,
        settings: RehearsalSettings,
        library: Any,
        told: Callable[[str], None],
    ) -> None:
        self._settings, self._library, self._told = settings, library, told
        self._random = random.Random(settings.seed)
        self._folder = folder
        self.server = RehearsalServer(folder, settings.haste)
        self._browser: Any = None
        self._page: Any = None
        self.given: dict[tuple[str, str], dict[str, Any]] = {}
        self.finished: dict[tuple[str, str, int], str] = {}
        self.accidents = dict.fromkeys(ACCIDENTS, 0)
        self.waits: list[float] = []
        self._who, self._is_seated = "", False
        self._moved = 0.0

    def close(self) -> None:
        """End server and browser."""
        with suppress(Exception):  # whatever a dead browser raises
            if self._browser is not None:
                self._browser.close()
        self.server.stop()

    # One participant

    def take_part(self, who: str) -> None:
        """Go through a participant's session to its end.

        Raises:
            ValueError: If nothing moves any more.
        """
        self._who, self._is_seated = who, False
        self._moved, last = time.monotonic(), ""
        next_accident = self._until_accident()
        while (on := self._went_on()) != "done":
            if on and on != last:
                last, self._moved = on, time.monotonic()
            if time.monotonic() - self._moved > _PATIENCE:
                log = self._folder / "rehearsal.log"
                raise ValueError(
                    f"{who} stands at {last} for {_PATIENCE:g} s; the computer is too "
                    f"busy or too slow, or {log} says why"
                )
            if time.monotonic() > next_accident:
                self._accident()
                next_accident = self._until_accident()
        self._note_finished()
        self._told(f"{who}: done; {sum(self.accidents.values())} accidents so far")

    def _went_on(self) -> str:
        """Do what comes next, whatever was killed; return where the session stands."""
        try:
            if not (self._is_seated and self.server.is_alive):
                self._sit_down()
            state = self.server.ask("/api/session")
            step = state["step"] or {}
            if step.get("kind") == "done":
                return "done"
            self._do(state, step)
        except OSError:
            return ""
        except self._errors as error:  # browser or server was killed under the hand
            self._told(f"{self._who}: browser: {str(error).splitlines()[0]}")
            self._is_seated = False
            return ""
        return _told(step)

    @property
    def _errors(self) -> type[Exception]:
        from playwright.sync_api import Error

        return Error

    def _until_accident(self) -> float:
        """When the next one comes; a session takes some three minutes."""
        rate = self._settings.accidents / 60.0
        pause = self._random.expovariate(rate) if rate > 0.0 else 1e9
        return time.monotonic() + pause

    def _sit_down(self) -> None:
        """Have server, participant and page there."""
        if not self.server.is_alive:
            begun = time.monotonic()
            self.server.start()
            self._moved += time.monotonic() - begun  # it may compile for long
        self.server.console("begin", participant=self._who)
        self._open_page()
        self._is_seated = True

    def _open_page(self) -> None:
        """A page of the participant, in a new browser if the old one is gone."""
        if self._browser is None or not self._browser.is_connected():
            self._browser = self._library.chromium.launch(
                executable_path=browser_path(), args=list(_FLAGS)
            )
            self._page = None
        if self._page is not None:
            with suppress(self._errors):
                self._page.close()
        self._page = self._browser.new_page(viewport={"width": 480, "height": 320})
        self._page.goto(self.server.address + "/?low")

    # One step

    def _do(self, state: dict[str, Any], step: dict[str, Any]) -> None:
        """Do what a participant would, once."""
        if state["trouble"]:
            self.server.console("retry")
        if state["held"]:
            self.server.console("well", reason="rehearsed")
        kind = step.get("kind")
        if kind in ("ask", "consent"):
            self._answer(step)
        elif kind in ("instruct", "break"):
            self._press_on(step)
        elif kind in ("practise", "drive"):
            self._drive(step)
            if step["drive"]["state"] == "running":
                self._time_console()
        time.sleep(0.1)

    def _answer(self, step: dict[str, Any]) -> None:
        """Fill the form on the page and send it."""
        key = (self._who, step["id"])
        chosen = self.given.setdefault(
            key, {i["name"]: self._choice(i) for i in step["instrument"]["items"]}
        )
        form = self._page.locator("form")
        form.wait_for(timeout=15_000)
        items = step["instrument"]["items"]
        plain = [item for item in items if item["kind"] != "pairs"]
        questions = form.locator(".question")
        for place, item in enumerate(plain):
            _fill(questions.nth(place), item, chosen[item["name"]])
        for item in items:
            if item["kind"] == "pairs":
                values = [each["value"] for each in item["options"]]
                sides = form.locator(".side")
                if sides.first.is_visible():
                    sides.nth(values.index(chosen[item["name"]])).click(timeout=5000)
        form.locator("button[type=submit]").first.click(timeout=5000)
        for _ in range(50):  # the page shows the step that is on when it is answered
            if self.server.ask("/api/session")["step"]["id"] != step["id"]:
                break
            time.sleep(0.1)

    def _choice(self, item: dict[str, Any]) -> Any:
        """An answer by chance."""
        kind = item["kind"]
        if kind in ("choice", "pairs"):
            return self._random.choice(item["options"])["value"]
        if kind == "yes_no":
            return "yes"
        if kind in ("scale", "number"):
            count = round((item["high"] - item["low"]) / item["step"])
            return item["low"] + item["step"] * self._random.randint(0, int(count))
        return "AB"

    def _press_on(self, step: dict[str, Any]) -> None:
        """The button that goes on, when it may be pressed."""
        button = self._page.locator("#step button").first
        if step["kind"] == "break" and step.get("remaining", 0) > 0:
            return
        button.click(timeout=5000)

    def _drive(self, step: dict[str, Any]) -> None:
        """Say that one is ready, start in the frame, go on after a pause."""
        stands = step["drive"]["state"]
        self._refuse_endless(step)
        frame = self._page.locator("iframe:not([inert])")
        if stands in ("starting", "ready", "waiting") and not frame.count():
            button = self._page.locator("#step button")
            if button.count() and button.first.is_visible():
                button.first.click(timeout=5000)
            return
        if stands == "running" and step["kind"] == "practise" and step.get("enough"):
            with suppress(urllib.error.HTTPError):
                self.server.ask(
                    "/api/session/next", {"participant": self._who, "step": step["id"]}
                )
        if step["drive"].get("is_broken"):
            self.server.console("acknowledge")
        elif stands == "paused" and time.monotonic() - self._moved > _PATIENCE / 4.0:
            self._told(f"{self._who}: {step['id']} stopped: {step['drive']['reason']}")
            self.server.console("stop")
        elif stands in ("ready", "paused") and frame.count():
            inside = self._page.frame_locator("iframe:not([inert])").locator("body")
            inside.press("Enter", timeout=5000)
            time.sleep(0.4)

    def _refuse_endless(self, step: dict[str, Any]) -> None:
        """Give up a drive that never comes to its end.

        Raises:
            ValueError: If it was begun too often.
        """
        if step["attempt"] > _MOST_ATTEMPTS + sum(self.accidents.values()):
            rows = self.server.console()["attempts"]
            why = [row["reason"] for row in rows if row["reason"]]
            raise ValueError(
                f"{self._who} has begun {step['id']} {step['attempt']} times; the "
                f"last time: {why[-1] if why else 'no reason'}"
            )

    def _time_console(self) -> None:
        """Measure how long the console waits for an answer while someone drives [s]."""
        asked = time.monotonic()
        self.server.console()
        self.waits.append(time.monotonic() - asked)

    # Accidents

    def _note_finished(self) -> None:
        """Remember every trial that is finished, and the bytes of its record."""
        for row in self.server.console()["attempts"]:
            key = self._who, row["step"], row["attempt"]
            if row["state"] == WHOLE and key not in self.finished:
                self.finished[key] = digest(self._folder, *key)

    def _accident(self) -> None:
        """Kill something, without a word."""
        with suppress(OSError):
            self._note_finished()
            running = self.server.console()["processes"]
            there = [w for w in ACCIDENTS if w in running or w == "browser"]
            what = self._random.choice(there)
            self.accidents[what] += 1
            self._told(f"{self._who}: {what} is killed")
            if what == "browser":
                _kill_tree(self._browser_pid())
            else:
                os.kill(running[what], signal.SIGKILL)
            if what == "server":
                time.sleep(0.5)

    def _browser_pid(self) -> int:
        """Of the browser that this process has started; no other is touched."""
        found = subprocess.run(
            ["ps", "-eo", "pid,ppid,args"], capture_output=True, text=True, check=True
        ).stdout
        parents: dict[int, int] = {}
        browsers: list[int] = []
        for line in found.splitlines()[1:]:
            pid, parent, command = line.split(None, 2)
            parents[int(pid)] = int(parent)
            if "--headless" in command and "--type=" not in command:
                browsers.append(int(pid))
        return next((pid for pid in browsers if _is_below(pid, parents)), 0)


def _told(step: dict[str, Any]) -> str:
    """Where a session stands; it changes as long as somebody drives on."""
    drive = step.get("drive", {})
    driven = f" {drive['metres']:.0f} m" if drive.get("state") == "running" else ""
    return f"{step.get('id')} {drive.get('state', '')}{driven}".rstrip()


def _is_below(pid: int, parents: dict[int, int]) -> bool:
    """Whether this process has started another, perhaps by way of others."""
    while pid in parents and pid != os.getpid():
        pid = parents[pid]
    return pid == os.getpid()


def _kill_tree(pid: int) -> None:
    if pid:
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)


def _fill(question: Any, item: dict[str, Any], value: Any) -> None:
    """Give an answer to a question on the page."""
    if item["kind"] == "yes_no" and item.get("must_agree"):
        question.locator("input[type=checkbox]").check(timeout=5000)
    elif item["kind"] in ("scale", "choice", "yes_no"):
        said = f"{value:g}" if isinstance(value, int | float) else value
        radio = question.locator(f'input[type=radio][value="{said}"]')
        radio.check(force=True, timeout=5000)
    else:
        said = f"{value:g}" if isinstance(value, int | float) else str(value)
        question.locator("input, textarea").first.fill(said, timeout=5000)


def digest(folder: Path, who: str, step: str, attempt: int) -> str:
    """Hash of a finished record; empty if it is not there."""
    suffix = f"-{attempt}" if attempt > 1 else ""
    for room in ("records", "practice"):
        file = folder / room / f"{who}-{step}{suffix}.parquet"
        if file.is_file():
            return hashlib.sha256(file.read_bytes()).hexdigest()
    return ""
