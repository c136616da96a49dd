"""A webcam, or a video file in its place, as a source of head yaw."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from costeer.devices.head.face import Image, load_networks
from costeer.devices.head.source import HeadLost, HeadReading, aged
from costeer.devices.head.tracker import TrackerParameters, initial_state, step

if TYPE_CHECKING:
    import cv2

WIDTH, HEIGHT, RATE = 640, 480, 30.0
"""What the camera is asked for [px, px, 1/s]."""

FILE_RATE = 30.0
"""Pictures per second of a video file that does not tell [1/s]."""


class Webcam:
    """Head yaw from a camera; `read` waits for the next picture.

    A video file is played at its own speed, so that it can stand in for a camera.
    """

    def __init__(
        self,
        address: str,
        parameters: TrackerParameters | None = None,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """Open the camera and load the networks.

        Args:
            address: Number of the camera, or a video file.
            parameters: What is believed of a face.
            clock: Monotonic [s].

        Raises:
            HeadLost: If there is no such camera or file.
            ModuleNotFoundError: If the extra `drive` is not installed.
        """
        self._parameters = parameters or TrackerParameters()
        self._networks = load_networks()
        self._capture = open_capture(address)
        self._address = address
        self._clock = clock
        self._state = initial_state()
        self._time = -math.inf
        self._due = -math.inf
        self._period = 0.0 if address.isdigit() else _period(self._capture)

    def read(self) -> HeadReading:
        """Yaw of the face in the next picture [rad].

        Raises:
            HeadLost: If the camera gives no picture, or the file is over.
        """
        image, now = self._picture()
        self._state = step(
            self._parameters, self._networks, self._state, image, now - self._time
        )
        self._time = now
        reading = HeadReading(now, self._state.head_yaw, self._state.valid)
        return aged(reading, self._clock())

    def _picture(self) -> tuple[Image, float]:
        """The next picture and when it came [s]."""
        wait = self._due - self._clock()
        if 0.0 < wait <= self._period:
            time.sleep(wait)
        # A film that is late goes on from where it is, not faster.
        self._due = max(self._due, self._clock()) + self._period
        given, image = self._capture.read()
        if not given or image is None:
            raise HeadLost(
                f"camera {self._address} gives no picture; plug it in again, close "
                "programs that use it, or choose another --camera"
            )
        return np.asarray(image, np.uint8), self._clock()

    def close(self) -> None:
        """Release the camera."""
        self._capture.release()


def open_capture(address: str) -> cv2.VideoCapture:
    """Open a camera by its number, or a video file.

    Raises:
        HeadLost: If there is none.
    """
    import cv2

    if not address.isdigit() and not Path(address).is_file():
        raise HeadLost(
            f"no video file {address}; give the number of a camera, as 0, or a file"
        )
    _silence()
    capture = cv2.VideoCapture(int(address) if address.isdigit() else address)
    if not capture.isOpened():
        capture.release()
        raise HeadLost(
            f"camera {address} does not open; check that it is plugged in, that no "
            "other program uses it and that this one may, or choose another --camera"
        )
    if address.isdigit():
        capture.set(cv2.CAP_PROP_FRAME_WIDTH, WIDTH)
        capture.set(cv2.CAP_PROP_FRAME_HEIGHT, HEIGHT)
        capture.set(cv2.CAP_PROP_FPS, RATE)
        capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)
    return capture


def _silence() -> None:
    """OpenCV prints warnings of its own about cameras that are not there."""
    import cv2

    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)


def _period(capture: cv2.VideoCapture) -> float:
    """Time from one picture of a file to the next [s]."""
    import cv2

    rate = capture.get(cv2.CAP_PROP_FPS)
    return 1.0 / (rate if 1.0 <= rate <= 240.0 else FILE_RATE)
