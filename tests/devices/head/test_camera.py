"""A video file stands in for the camera, here and in a process of its own."""

from __future__ import annotations

import math
import multiprocessing
import time
from multiprocessing.queues import Queue
from pathlib import Path
from typing import NamedTuple

import pytest

from costeer.devices.head.calibration import HeadCalibration
from costeer.devices.head.camera import Webcam, open_capture
from costeer.devices.head.process import run_head_process
from costeer.devices.head.source import HeadDescription, HeadLost, HeadReading
from tests.devices.head.films import film
from tests.devices.head.rendering import View, cabin, render
from tests.waiting import PATIENCE


@pytest.fixture(scope="module")
def face_then_none(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six pictures of a face 20 deg to its left, then three without one."""
    pictures = [render(View(yaw_deg=20.0))] * 6 + [cabin()] * 3
    return film(tmp_path_factory.mktemp("films") / "face.avi", pictures)


def test_a_film_is_read_picture_by_picture(face_then_none: Path) -> None:
    camera = Webcam(str(face_then_none))
    start = time.monotonic()
    readings = [camera.read() for _ in range(9)]
    assert time.monotonic() - start > 8 / 30.0 - 0.01  # at its own speed
    states = [reading.valid for reading in readings]
    # A machine that is busy for 0.2 s would make a reading old, thus `any`.
    assert any(states[:6])
    assert not any(states[6:])
    # 3 deg before a calibration, and the face is lost, not straight ahead.
    assert math.degrees(readings[-1].head_yaw) == pytest.approx(20.0, abs=4.0)
    with pytest.raises(HeadLost, match="gives no picture"):
        camera.read()
    camera.close()


def test_a_camera_that_is_not_there_says_so() -> None:
    with pytest.raises(HeadLost, match="camera 97 does not open"):
        open_capture("97")


def test_a_file_that_is_not_there_or_no_film_says_so(tmp_path: Path) -> None:
    with pytest.raises(HeadLost, match="no video file"):
        open_capture(str(tmp_path / "none.avi"))
    text = tmp_path / "text.avi"
    text.write_text("no film")
    with pytest.raises(HeadLost, match="does not open"):
        open_capture(str(text))


class QueueSink(NamedTuple):
    """Takes readings to the test."""

    queue: Queue[HeadReading]

    def put(self, time: float, head_yaw: float, valid: bool) -> None:
        """Hand a reading over."""
        self.queue.put(HeadReading(time, head_yaw, valid))


@pytest.mark.slow
def test_a_process_tells_calibrated_yaw_and_survives_the_end_of_the_film(
    face_then_none: Path,
) -> None:
    context = multiprocessing.get_context("spawn")
    queue, stopped = context.Queue(), context.Event()
    calibration = HeadCalibration(
        "P01", HeadDescription("webcam", str(face_then_none)), offset=0.1, gain=1.2
    )
    process = context.Process(
        target=run_head_process, args=(calibration, QueueSink(queue), stopped)
    )
    process.start()
    try:
        found = [queue.get(timeout=PATIENCE) for _ in range(15)]
        stopped.set()
        process.join(PATIENCE)
        assert process.exitcode == 0
    finally:
        process.kill()
    # A busy machine may make some readings too old, hardly all.
    seen = next(index for index, reading in enumerate(found) if reading.valid)
    expected = (0.1 + 1.2 * math.radians(20.0)) / (math.pi / 2.0)
    # Held through everything that follows: 0.06 is 5 deg.
    assert all(r.head_yaw == pytest.approx(expected, abs=0.06) for r in found[seen:])
    # Nine pictures, the last three without a face; then the end of the film is told.
    assert [r.valid for r in found[6:10]] == [False] * 4
    times = [reading.time for reading in found]
    assert times == sorted(times)
