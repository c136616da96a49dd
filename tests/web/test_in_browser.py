"""A person's drive from the command to the pixels, in a real browser."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page

from costeer.records.record import read_record
from tests.web.browser import page_of, picture, serving, stop

pytestmark = [pytest.mark.browser, pytest.mark.timeout(400)]

DURATION = 60.0


def told(page: Page) -> dict[str, Any]:
    """What the page says of itself."""
    answer: dict[str, Any] = page.evaluate(
        "({fps: costeer.fps, frames: costeer.frames, state: String(costeer.state),"
        " latency: costeer.latency})"
    )
    return answer


def value(page: Page, name: str) -> float:
    """A column of the newest frame in the page."""
    return float(page.evaluate(f"costeer.lastFrame.{name}"))


def wait_for(page: Page, expression: str, seconds: float = 60.0) -> None:
    """Wait until something is so in the page."""
    deadline = time.monotonic() + seconds
    while not page.evaluate(expression):
        assert time.monotonic() < deadline, f"never {expression}"
        time.sleep(0.05)


def steer_until(page: Page, key: str, condition: str) -> None:
    """Hold a key until something is so."""
    page.keyboard.down(key)
    wait_for(page, condition, 15.0)
    page.keyboard.up(key)


def test_page_drives_for_a_minute_and_changes_lanes(tmp_path: Path) -> None:
    record = tmp_path / "trial.parquet"
    words = ("drive", "--wheel", "keyboard", "--no-events", "--record", str(record))
    with serving(*words) as server, page_of() as (page, wrong):
        page.goto(f"{server.address}?low")
        wait_for(page, "window.costeer && costeer.frames > 30")
        page.keyboard.press("Enter")
        wait_for(page, "costeer.lastFrame.run_state === 1")
        before, start = told(page)["frames"], time.monotonic()
        straight = picture(page, tmp_path / "straight.png")
        wait_for(page, "costeer.lastFrame.time > 4")
        # Out to the right: away from the lane, then straight again.
        steer_until(page, "ArrowRight", "costeer.lastFrame.lateral_position < -0.9")
        steer_until(page, "ArrowLeft", "costeer.lastFrame.yaw_angle > -0.01")
        wait_for(page, "costeer.lastFrame.lane === 0", 20.0)
        changed = picture(page, tmp_path / "changed.png")
        while time.monotonic() - start < DURATION:
            time.sleep(0.2)
        told_at_end, lasted = told(page), time.monotonic() - start
        said = stop(server.process)
    assert wrong == []
    rate = (told_at_end["frames"] - before) / lasted
    # A page that waits for the processor loses the oldest frames, never the newest.
    assert rate == pytest.approx(60.0, rel=0.05)
    # 10 frames a second and more on an idle machine (costeer bench --drive).
    assert told_at_end["fps"] > 3.0
    columns = read_record(record).columns
    assert columns["time"][-1] == pytest.approx(lasted, abs=1.5)
    assert {0, 1} <= set(columns["lane"].tolist())
    assert np.abs(columns["driver_torque"]).max() > 0.5
    assert np.isfinite(columns["crossing_probability"]).any()
    assert str(record) in said
    check_road(straight)
    assert np.abs(straight - changed).mean() > 0.01  # the view has moved


def check_road(image: np.ndarray[Any, np.dtype[np.float64]]) -> None:
    """Sky above, grey road ahead, grass beside it."""
    rows, columns, _ = image.shape
    above = image[int(0.08 * rows) : int(0.16 * rows), int(0.28 * columns) :]
    sky = np.median(above, axis=(0, 1))  # whatever tree the car passes
    assert sky[2] > 0.5
    assert sky[2] >= sky[0]
    ahead = image[
        int(0.42 * rows) : int(0.5 * rows), int(0.42 * columns) : columns // 2
    ]
    grey = np.ptp(ahead.mean(axis=(0, 1)))
    assert grey < 0.12


def test_experimenter_tunes_what_the_drivers_page_cannot(tmp_path: Path) -> None:
    record = tmp_path / "trial.parquet"
    words = ("drive", "--wheel", "keyboard", "--no-signals", "--record", str(record))
    with serving(*words) as server, page_of() as (driver, wrong):
        experimenter = driver.context.new_page()
        driver.goto(f"{server.address}?low")
        wait_for(driver, "window.costeer && costeer.frames > 5")
        experimenter.goto(f"{server.experimenter}&low")
        wait_for(experimenter, "window.costeer && costeer.frames > 5")
        driver.keyboard.press("Enter")
        wait_for(driver, "costeer.lastFrame.run_state === 1")
        wait_for(driver, "costeer.lastFrame.time > 1")
        choices = experimenter.locator("#panel select")
        choices.first.select_option("weak-gentle")
        wait_for(experimenter, "Math.abs(costeer.lastFrame.strength_factor-0.4)<1e-9")
        assert not driver.locator("#panel").is_visible()
        experimenter.screenshot(path=tmp_path / "experimenter.png")
        driver.keyboard.press("KeyP")
        wait_for(driver, "costeer.lastFrame.run_state === 2")
        assert "aused" in driver.inner_text("body")
        stop(server.process)
    assert wrong == []
    markers = markers_of(record)
    kinds = [marker["kind"] for marker in markers]
    assert kinds == [
        *("started", "condition", "parameter", "parameter", "paused", "ended")
    ]
    assert (markers[1]["before"], markers[1]["after"]) == (
        "strong-normal",
        "weak-gentle",
    )
    assert markers[4]["name"] == "driver"


def markers_of(record: Path) -> list[dict[str, Any]]:
    """Markers of a record."""
    found: Any = read_record(record).metadata["markers"]
    return list(found)


def test_replay_shows_the_record_where_it_is_sought(tmp_path: Path) -> None:
    from costeer.cli import main

    record = tmp_path / "trial.parquet"
    words = ["simulate", "--out", str(record), "--length", "400", "--trigger-at", "3"]
    assert main(words) == 0
    with serving("replay", str(record)) as server, page_of() as (page, wrong):
        page.goto(f"{server.address}?low")
        wait_for(page, "window.costeer && costeer.lastFrame")
        page.keyboard.press("End")
        wait_for(page, "costeer.lastFrame.longitudinal_position > 390")
        page.keyboard.press("Home")
        wait_for(page, "costeer.lastFrame.longitudinal_position < 10")
        check_road(picture(page, tmp_path / "replay.png"))
    assert wrong == []
