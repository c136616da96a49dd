"""Which way a face points, from 21 of its landmarks that move with the skull."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

RIGID_POINTS: dict[int, tuple[float, float, float]] = {
    1: (0.0, -1.127, 7.476),
    4: (0.0, -0.463, 7.587),
    5: (0.0, 0.366, 7.243),
    6: (0.0, 2.473, 5.789),
    8: (0.0, 4.019, 5.285),
    9: (0.0, 4.886, 5.385),
    10: (0.0, 8.262, 4.482),
    33: (-4.446, 2.664, 3.173),
    61: (-2.456, -4.343, 4.284),
    70: (-5.721, 4.255, 2.831),
    127: (-7.743, 2.365, -2.005),
    133: (-1.856, 2.585, 3.758),
    152: (0.0, -9.403, 4.264),
    168: (0.0, 3.271, 5.236),
    234: (-7.664, 0.673, -2.436),
    263: (4.446, 2.664, 3.173),
    291: (2.456, -4.343, 4.284),
    300: (5.721, 4.255, 2.831),
    356: (7.743, 2.365, -2.005),
    362: (1.856, 2.585, 3.758),
    454: (7.664, 0.673, -2.436),
}
"""Landmark -> where it lies on MediaPipe's canonical face [cm]: x to the picture's
right, y up, z out of the face. Nose, brow, corners of eyes and mouth, chin, temples."""

_INDICES = list(RIGID_POINTS)
_HEAD = np.array([*RIGID_POINTS.values()]) * np.array([1.0, -1.0, -1.0])
"""The same as a camera counts: y down, z away from it."""


class HeadPose(NamedTuple):
    """Where a head is and where it points.

    Attributes:
        yaw: Against the camera's axis. Positive to the picture's right, which is the
            driver's left as the camera faces the driver [rad].
        misfit: Root mean square distance of the landmarks from those of a rigid face,
            over the face's height in the picture [-].
    """

    yaw: float
    misfit: float


def camera_matrix(width: int, height: int) -> Floats:
    """A usual webcam's: focal length one picture width, axis through the centre.

    Another focal length changes the yaw little: 0.1 deg where it was tried.
    """
    return np.array(
        [
            [float(width), 0.0, width / 2.0],
            [0.0, float(width), height / 2.0],
            [0.0, 0.0, 1.0],
        ]
    )


def head_pose(landmarks: Floats, width: int, height: int) -> HeadPose | None:
    """Pose of the canonical face that fits 21 landmarks best; None if none does.

    Args:
        landmarks: Shape `(468, 2)` [px].
        width: Of the picture [px].
        height: Of it [px].
    """
    import cv2

    points = np.ascontiguousarray(landmarks[_INDICES])
    if not np.all(np.isfinite(points)):
        return None
    camera = camera_matrix(width, height)
    found, turn, place = cv2.solvePnP(
        _HEAD, points, camera, None, flags=cv2.SOLVEPNP_SQPNP
    )
    if not found:
        return None
    turn, place = cv2.solvePnPRefineLM(_HEAD, points, camera, None, turn, place)
    seen, _ = cv2.projectPoints(_HEAD, turn, place, camera, None)
    rotation = np.asarray(cv2.Rodrigues(turn)[0], float)
    if not np.all(np.isfinite(rotation)) or float(place[2, 0]) <= 0.0:
        return None
    misfit = np.sqrt(np.mean(np.sum((seen.reshape(-1, 2) - points) ** 2, axis=1)))
    return HeadPose(
        yaw=-math.atan2(rotation[0, 2], rotation[2, 2]),
        misfit=float(misfit / np.ptp(points[:, 1])),
    )
