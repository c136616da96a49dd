"""How well a drive keeps time: real-time process, server and a page that renders.

A simulated wheel in swinging hands is driven over a road without end while a headless
browser draws the page. Everything is measured where it happens: lateness at each of
960 plant steps a second, computing time at each control step, age of a wheel's
reading in the page on its arrival there.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.devices.wheels.simulated import (
    SimulatedWheelParameters,
    SpringHands,
    simulated_description,
    true_calibration,
)
from costeer.loop.scenario import TrialSetup
from costeer.runtime.clock import favour_thread
from costeer.runtime.frame import PLACE, TRACE_COLUMNS
from costeer.runtime.setup import PLANT_DT, DriveSetup
from costeer.runtime.states import RunState
from costeer.web.app import drive_app
from costeer.web.drive import DriveOnPages, PageOptions
from costeer.web.security import access_for
from costeer.web.serving import Running, serve

COMPUTE_BUDGET = 1e-3
"""Computing time of a control step, 99.9th percentile [s]."""

LATE_BUDGET = 0.005
"""Share of plant steps that begin more than a period late [-]."""

PAGE_BUDGET = 0.030
"""From the wheel's movement to its state in the page, 95th percentile [s]."""

DEVICE_BUDGET = 0.005
"""From the control step's start to the device's answer, 99th percentile [s]."""

FRAME = 1.0 / 60.0

CHROMIUM = (
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-quic",
    "--no-first-run",
)
"""How a browser without a screen renders in software and asks nobody anything."""

_LATE = TRACE_COLUMNS.index("lateness")
_TOOK = TRACE_COLUMNS.index("step_time")


class Kept(NamedTuple):
    """One number of the drive, and whether its budget was kept.

    Attributes:
        name: What was measured.
        value: In `unit`.
        unit: SI or a part of it.
        verdict: The budget and whether it was kept; empty without one.
    """

    name: str
    value: float
    unit: str
    verdict: str = ""


class Material(NamedTuple):
    """What was collected.

    Attributes:
        frames: Of the running trial, shape `(frame, column)`.
        trace: Of the wheel, shape `(step, column)`.
        arrivals: When each frame reached the server [s].
        ages: Of the wheel's reading when it reached the page [s].
        page: What the page says of itself: `fps` and `frames`; empty without one.
        priority: Of the real-time process, in words.
    """

    frames: NDArray[np.float64]
    trace: NDArray[np.float64]
    arrivals: NDArray[np.float64]
    ages: NDArray[np.float64]
    page: dict[str, float]
    priority: str


def bench_setup() -> DriveSetup:
    """A simulated wheel in hands that swing it, over a road without end."""
    trial = TrialSetup(length=200_000.0, events=False)
    return DriveSetup(
        trial=trial._replace(condition="strong-normal"),
        wheel=simulated_description(hands=SpringHands(amplitude=0.03, period=3.0)),
        calibration=true_calibration(SimulatedWheelParameters()),
        needs_page=False,
    )


def measure_drive(seconds: float, browser: str) -> Material:
    """Drive for so long and collect.

    Args:
        seconds: How long [s].
        browser: Path of Chromium; empty for none.

    Raises:
        ValueError: If the drive cannot begin.
        ModuleNotFoundError: If a browser is asked for and Playwright is not there.
    """
    session = DriveOnPages(bench_setup(), None, PageOptions(input="wheel"))
    frames: list[NDArray[np.float64]] = []
    arrivals: list[float] = []

    def keep(frame: NDArray[np.float64]) -> None:
        if frame[PLACE["run_state"]] == RunState.RUNNING:
            frames.append(frame.copy())
            arrivals.append(time.perf_counter())

    session.also(keep, lambda marker: None)
    session.drive.start()
    try:
        with _served(session) as running, _page(browser, running.address) as asked:
            trace = _collect(session, seconds)
            page = asked()
    finally:
        session.stop()
    return Material(
        frames=np.array(frames),
        trace=trace,
        arrivals=np.array(arrivals),
        ages=np.array(session.latencies) / 1e3,
        page=page,
        priority=session.drive.priority,
    )


def _collect(session: DriveOnPages, seconds: float) -> NDArray[np.float64]:
    """Let it drive; return the trace of the wheel."""
    drive = session.drive
    session.latencies.clear()
    next_row = drive.shared.trace.written
    drive.send("start")
    parts, end = [], time.perf_counter() + seconds
    while time.perf_counter() < end:
        time.sleep(1.0)
        if drive.shared.mailbox.get("stalled"):
            with suppress(ValueError):
                drive.send("acknowledge")
                drive.send("resume")  # and its figures tell what it cost
        next_row, rows = drive.shared.trace.since(next_row)
        parts.append(rows)
    return np.concatenate(parts)


@contextmanager
def _served(session: DriveOnPages) -> Iterator[Running]:
    """The server in a thread of its own."""
    told: list[Running] = []
    ready = threading.Event()

    def announce(running: Running) -> None:
        told.append(running)
        ready.set()

    def run() -> None:
        favour_thread()
        serve(lambda taken: drive_app(session, taken), access_for(port=0), announce)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    if not ready.wait(30.0):
        raise ValueError("the server did not start; run: costeer doctor")
    yield told[0]
    told[0].stop()
    thread.join(10.0)


@contextmanager
def _page(browser: str, address: str) -> Iterator[Callable[[], dict[str, float]]]:
    """A page that renders in software at 640x360; gives what it says of itself."""
    if not browser:
        yield dict
        return
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path=browser, args=list(CHROMIUM)
        )
        page = chromium.new_page(viewport={"width": 640, "height": 360})
        page.goto(f"{address}?low")
        time.sleep(5.0)  # scene and socket are up

        def asked() -> dict[str, float]:
            # Any: what the page's script holds.
            found: dict[str, Any] = page.evaluate(
                "({fps: window.costeer.fps, frames: window.costeer.frames})"
            )
            return {name: float(value) for name, value in found.items()}

        yield asked
        with suppress(Exception):  # the server may have gone first
            chromium.close()


def figures(material: Material) -> list[Kept]:
    """What the issue of keeping time comes down to."""
    return [
        *_steps(material),
        *_device(material),
        *_server(material),
        *_pages(material),
    ]


def _steps(material: Material) -> list[Kept]:
    """Computing time of control steps, lateness of plant steps."""
    compute = material.frames[:, PLACE["compute_time"]]
    late = material.trace[:, _LATE]
    slow = float(np.quantile(compute, 0.999))
    share = float(np.mean(late > PLANT_DT))
    privileged = "not permitted" not in material.priority
    lasted = float(material.arrivals[-1] - material.arrivals[0])
    return [
        Kept("control step, computing, median", 1e6 * float(np.median(compute)), "us"),
        Kept(
            "control step, computing, 99.9 %",
            1e6 * slow,
            "us",
            _verdict(slow, COMPUTE_BUDGET, "1000 us"),
        ),
        Kept("plant steps", float(len(late)), "-"),
        Kept(
            "plant steps made of those due", 100.0 * len(late) * PLANT_DT / lasted, "%"
        ),
        Kept("lateness, median", 1e6 * float(np.median(late)), "us"),
        Kept("lateness, 99 %", 1e6 * float(np.quantile(late, 0.99)), "us"),
        Kept("lateness, largest", 1e3 * float(late.max()), "ms"),
        Kept(
            "steps over a period late",
            100.0 * share,
            "%",
            _verdict(share, LATE_BUDGET, "0.5 %") if privileged else "no priority",
        ),
    ]


def _device(material: Material) -> list[Kept]:
    """From the start of a control step until the wheel has its torque.

    The first plant step after a control step writes it: computing of the one, then
    the whole other, late or not.
    """
    compute = material.frames[:, PLACE["compute_time"]]
    steps = material.trace[:, _TOOK]
    slowest = float(np.quantile(compute, 0.99) + np.quantile(steps, 0.99))
    return [
        Kept("plant step, 99 %", 1e6 * float(np.quantile(steps, 0.99)), "us"),
        Kept(
            "torque command to device, 99 %",
            1e3 * slowest,
            "ms",
            _verdict(slowest, DEVICE_BUDGET, "5 ms"),
        ),
    ]


def _server(material: Material) -> list[Kept]:
    """Rate and regularity of frames in the server."""
    gaps = np.diff(material.arrivals)
    lasted = material.arrivals[-1] - material.arrivals[0]
    return [
        Kept("frames a second at the server", len(gaps) / float(lasted), "1/s"),
        Kept("gap between frames, 99 %", 1e3 * float(np.quantile(gaps, 0.99)), "ms"),
    ]


def _pages(material: Material) -> list[Kept]:
    """Age of a wheel's movement when the page has it.

    The page measures the age of the newest reading. A movement comes at any time
    between two frames, so it waits up to a frame more; both are told.
    """
    if len(material.ages) < 2:
        return []
    age = material.ages
    waits = (np.arange(100) + 0.5) / 100.0 * FRAME
    moved = (age[:, None] + waits[None, :]).ravel()
    late = float(np.quantile(moved, 0.95))
    return [
        Kept("frames drawn a second, 640x360", material.page.get("fps", np.nan), "1/s"),
        Kept("reading to page, median", 1e3 * float(np.median(age)), "ms"),
        Kept("reading to page, 95 %", 1e3 * float(np.quantile(age, 0.95)), "ms"),
        Kept(
            "movement to page, 95 %",
            1e3 * late,
            "ms",
            _verdict(late, PAGE_BUDGET, "30 ms"),
        ),
    ]


def _verdict(value: float, budget: float, words: str) -> str:
    return f"budget {words}: {'kept' if value < budget else 'NOT kept'}"
