"""A browser without a screen, and `costeer drive` as its user starts it."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page, sync_playwright

from benchmarks.speed.pace import CHROMIUM
from costeer.web.pages import static_folder

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
START = 240.0
"""The first start compiles [s]."""


def chromium() -> str:
    """Path of the browser; without one the test is skipped, but not in CI.

    Where npm failed there is no page to test, and that is no failure.
    """
    if not (static_folder() / "vendor" / "stamp.txt").is_file():
        pytest.skip("the page's libraries are missing: make page")
    found = os.environ.get("COSTEER_CHROMIUM") or next(
        (path for name in NAMES if (path := shutil.which(name))), ""
    )
    if not found and os.environ.get("CI"):
        pytest.fail("no Chromium; .ci/run installs it")
    if not found:
        pytest.skip("no Chromium; install it, or set COSTEER_CHROMIUM to its path")
    return found


@contextmanager
def page_of(width: int = 640, height: int = 360) -> Iterator[tuple[Page, list[str]]]:
    """A page, and the list that gathers what goes wrong in it."""
    wrong: list[str] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=chromium(), args=list(CHROMIUM)
        )
        context = browser.new_context(viewport={"width": width, "height": height})
        page = context.new_page()
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on(
            "console",
            lambda said: wrong.append(said.text) if said.type == "error" else None,
        )
        yield page, wrong
        browser.close()


class Server(NamedTuple):
    """`costeer drive`, `session run` or `replay` that runs.

    Attributes:
        process: Of the command.
        address: Of the driver's page.
        experimenter: Of the experimenter's page or console; empty for a replay.
    """

    process: subprocess.Popen[str]
    address: str
    experimenter: str


@contextmanager
def serving(*words: str) -> Iterator[Server]:
    """The command with these words, until the block ends or it was stopped."""
    command = [sys.executable, "-m", "costeer", *words, "--no-browser", "--port", "0"]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    try:
        addresses = _addresses(process, 1 if words[0] == "replay" else 2)
        yield Server(process, addresses[0], (*addresses, "")[1])
    finally:
        stop(process)


def _addresses(process: subprocess.Popen[str], number: int) -> list[str]:
    assert process.stdout is not None
    found: list[str] = []
    told: list[str] = []
    deadline = time.monotonic() + START
    while len(found) < number:
        line = process.stdout.readline()
        told.append(line)
        found += re.findall(r"http://\S+", line)
        assert line, f"it ended: {told}"
        assert time.monotonic() < deadline, told
    return found


def stop(process: subprocess.Popen[str]) -> str:
    """End it as Ctrl-C does; return what it still had to say."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    said = ""
    with suppress(ValueError):  # it was stopped before
        said = process.communicate(timeout=30.0)[0]
    return said


def picture(page: Page, path: Path) -> NDArray[np.float64]:
    """A screenshot as numbers in [0, 1], shape `(row, column, 3)`; kept at `path`."""
    import matplotlib.image as images

    page.screenshot(path=path)
    return np.asarray(images.imread(path), dtype=float)[..., :3]
