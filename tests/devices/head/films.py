"""Video files that stand in for a camera."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cv2

from costeer.devices.head.face import Image
from tests.devices.head.rendering import HEIGHT, WIDTH


def film(path: Path, pictures: Sequence[Image], rate: float = 30.0) -> Path:
    """Write pictures as a video of so many a second [1/s]."""
    motion_jpeg = cv2.VideoWriter.fourcc(*"MJPG")
    writer = cv2.VideoWriter(str(path), motion_jpeg, rate, (WIDTH, HEIGHT))
    assert writer.isOpened()
    for picture in pictures:
        writer.write(picture)
    writer.release()
    return path
