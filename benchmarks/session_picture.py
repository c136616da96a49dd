"""The console of a session while a participant drives, as a picture.

    python -m benchmarks.session_picture [FIGURE.png]

A participant of a rehearsal goes through two drives of 600 m in real time, in the hands
of a virtual driver, on the real pages; the console is taken 25 s into the second, which
has guidance. Writes `docs/figures/session_console.png` unless a file is named. It needs
Chromium and Playwright, and a computer with nothing else to do.
"""

from __future__ import annotations

import sys
import tempfile
import threading
import time
from pathlib import Path

from costeer.sessions.plan import PLAN_FILE
from costeer.sessions.rehearsal_server import RehearsalServer
from costeer.sessions.robot import RehearsalSettings, Robot, browser_path, playwright

FIGURE = Path("docs/figures/session_console.png")

PLAN = """
title: Shared steering
participants: 2
length: 600
parameters: {traffic.first_event: 100, traffic.num_events: 1}
steps:
  - {kind: consent, instrument: consent}
  - {kind: drive, condition: manual, text: trial}
  - {kind: ask, instrument: nasa-tlx}
  - {kind: trials, conditions: [strong-normal], text: trial}
  - {kind: ask, instrument: nasa-tlx}
"""

PATIENCE = 600.0
"""Longest wait for the drive, which the first compilation precedes [s]."""

TAKEN = "drive-strong-normal", 25.0
"""Step, and time in it at which the picture is taken [s]."""


def take_part(folder: Path, servers: list[RehearsalServer]) -> None:
    """Go through the session as a rehearsal does, without accidents."""
    with playwright() as library:
        settings = RehearsalSettings(participants=1, accidents=0.0, haste=1.0)
        robot = Robot(folder, settings, library, print)
        robot.server.start()
        robot.server.console("check")
        servers.append(robot.server)
        try:
            robot.take_part("P01")
        finally:
            robot.close()


def is_due(server: RehearsalServer) -> bool:
    """Whether the participant has driven far enough."""
    try:
        step = server.console()["step"] or {}
    except OSError:  # not there yet
        return False
    seconds = step.get("drive", {}).get("seconds", 0.0)
    return step.get("id") == TAKEN[0] and seconds >= TAKEN[1]


def take_picture(server: RehearsalServer, file: Path) -> None:
    """Open the console, and keep what it shows when the time has come.

    Raises:
        TimeoutError: If nobody drives.
    """
    deadline = time.monotonic() + PATIENCE
    with playwright() as library:
        browser = library.chromium.launch(
            executable_path=browser_path(), args=["--no-sandbox"]
        )
        page = browser.new_page(viewport={"width": 1280, "height": 720})
        page.goto(f"{server.address}/console?experimenter={server.token}")
        while not is_due(server):
            if time.monotonic() > deadline:
                raise TimeoutError(f"nobody drove {TAKEN[0]} for {TAKEN[1]:g} s")
            page.wait_for_timeout(200)
        page.screenshot(path=file)
        browser.close()


def main() -> None:
    """Rehearse and take the picture."""
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else FIGURE
    with tempfile.TemporaryDirectory() as name:
        folder, servers = Path(name), list[RehearsalServer]()
        (folder / PLAN_FILE).write_text(PLAN)
        person = threading.Thread(target=take_part, args=(folder, servers))
        person.start()
        while person.is_alive() and not servers:
            time.sleep(0.1)
        if servers:
            take_picture(servers[0], file)
        person.join()
    print(file)


if __name__ == "__main__":
    main()
