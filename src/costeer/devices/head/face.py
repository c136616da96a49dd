"""A face in a picture: the detector finds it, the landmark network measures it.

Both networks are MediaPipe's (Apache-2.0, see data/NOTICE); they run on one thread.
"""

from __future__ import annotations

import math
from importlib import resources
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]
"""Picture of a camera: rows, columns, blue green red."""

Floats = NDArray[np.float64]

CROP_SIZE = 192
"""Edge of the picture that the landmark network takes [px]."""

DETECTOR_SIZE = 128
"""Edge of the picture that the detector takes [px]."""

NUM_LANDMARKS = 468

EYE_CORNERS = (33, 263)
"""Landmarks at the outer corners of the eyes, that at the picture's left first."""


class FaceParameters(NamedTuple):
    """When a face counts as found.

    Attributes:
        least_detection: Score from which the detector has found a face [-]. Source:
            assumed, the networks' usual threshold.
        least_presence: Score from which the landmarks lie on a face [-]. Source:
            assumed, the same.
        margin: Edge of the region looked at over the face's [-]. Source: assumed, as
            the landmark network was trained.
    """

    least_detection: float = 0.5
    least_presence: float = 0.5
    margin: float = 1.5


class Region(NamedTuple):
    """A turned square around a face.

    Attributes:
        x: Its centre, from the picture's left [px].
        y: From its top [px].
        size: Edge [px].
        angle: By which the face is rolled, clockwise as seen [rad].
    """

    x: float
    y: float
    size: float
    angle: float


class Face(NamedTuple):
    """A face that was found.

    Attributes:
        landmarks: x and y of each in the picture, shape `(468, 2)` [px].
        presence: How sure the network is, in [0, 1] [-].
    """

    landmarks: Floats
    presence: float


class FaceNetworks(NamedTuple):
    """The two networks, loaded.

    Attributes:
        detector: Session of onnxruntime; finds faces.
        landmarks: The same; measures one.
    """

    detector: Any  # Any: onnxruntime ships no types
    landmarks: Any  # Any: the same


def load_networks() -> FaceNetworks:
    """Load both networks, to run on one thread each.

    Raises:
        ModuleNotFoundError: If onnxruntime is missing; the extra `drive` brings it.
    """
    return FaceNetworks(
        detector=_session("face_detection_short_range.onnx"),
        landmarks=_session("face_landmark.onnx"),
    )


def _session(name: str) -> Any:  # Any: onnxruntime ships no types
    """One network that ships with costeer."""
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    options.inter_op_num_threads = 1
    options.log_severity_level = 3
    network = resources.files("costeer.devices.head").joinpath("data", name)
    return onnxruntime.InferenceSession(
        network.read_bytes(), options, providers=["CPUExecutionProvider"]
    )


def detect(
    parameters: FaceParameters, networks: FaceNetworks, image: Image
) -> Region | None:
    """Region of the face that is largest and surest; None if there is none."""
    height, width = image.shape[:2]
    scale = DETECTOR_SIZE / max(height, width)
    square, corner = _in_square(image, scale)
    pixels = np.asarray(square[None, :, :, ::-1], dtype=np.float32) / 127.5 - 1.0
    offsets, scores = networks.detector.run(None, {"input": pixels})
    best = _best_box(np.asarray(offsets[0], float), np.asarray(scores[0, :, 0], float))
    if best is None or best.score < parameters.least_detection:
        return None
    centre = (best.centre * DETECTOR_SIZE - corner) / scale
    eyes = best.eyes[1] - best.eyes[0]
    return Region(
        x=float(centre[0]),
        y=float(centre[1]),
        size=parameters.margin * best.size * DETECTOR_SIZE / scale,
        angle=math.atan2(eyes[1], eyes[0]),
    )


def _in_square(image: Image, scale: float) -> tuple[Image, Floats]:
    """The whole picture in the detector's square, and its corner there [px]."""
    import cv2

    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    square = np.zeros((DETECTOR_SIZE, DETECTOR_SIZE, 3), np.uint8)
    height, width = small.shape[:2]
    top, left = (DETECTOR_SIZE - height) // 2, (DETECTOR_SIZE - width) // 2
    square[top : top + height, left : left + width] = small
    return square, np.array([float(left), float(top)])


class _Box(NamedTuple):
    """What the detector says of one face, in fractions of its picture.

    Attributes:
        score: In [0, 1].
        centre: x, y.
        size: The longer edge.
        eyes: x, y of both eyes, that at the picture's left first.
    """

    score: float
    centre: Floats
    size: float
    eyes: Floats


def _best_box(offsets: Floats, scores: Floats) -> _Box | None:
    """The box with the largest product of score and size, among those in view."""
    score = 1.0 / (1.0 + np.exp(-np.clip(scores, -50.0, 50.0)))
    boxes = offsets / DETECTOR_SIZE
    size = np.max(boxes[:, 2:4], axis=1)
    usable = np.where((size > 0.0) & (score >= 0.5), score * size, 0.0)
    index = int(np.argmax(usable))
    if usable[index] <= 0.0:
        return None
    anchor = _anchors()[index]
    return _Box(
        score=float(score[index]),
        centre=anchor + boxes[index, 0:2],
        size=float(size[index]),
        eyes=anchor + boxes[index, 4:8].reshape(2, 2),
    )


def _anchors() -> Floats:
    """Centres of the detector's cells: two for each of 16 x 16, six of 8 x 8."""
    fine, coarse = _cell_centres(16), _cell_centres(8)
    return np.concatenate([np.repeat(fine, 2, axis=0), np.repeat(coarse, 6, axis=0)])


def _cell_centres(cells: int) -> Floats:
    """Horizontal and vertical place of the centre of each cell, row by row."""
    middle = (np.arange(cells) + 0.5) / cells
    x, y = np.meshgrid(middle, middle)
    return np.stack([x.ravel(), y.ravel()], axis=1)


def measure_face(networks: FaceNetworks, image: Image, region: Region) -> Face:
    """Landmarks of the face in a region; they mean nothing if `presence` is low."""
    import cv2

    to_crop = _to_crop(region)
    crop = cv2.warpAffine(
        image, to_crop, (CROP_SIZE, CROP_SIZE), flags=cv2.INTER_LINEAR
    )
    pixels = np.asarray(crop[None, :, :, ::-1], dtype=np.float32) / 255.0
    found, logit = networks.landmarks.run(None, {"input_1": pixels})
    in_crop = np.asarray(found, float).reshape(NUM_LANDMARKS, 3)[:, :2]
    back = np.linalg.inv(to_crop[:, :2])
    return Face(
        landmarks=(in_crop - to_crop[:, 2]) @ back.T,
        presence=1.0 / (1.0 + math.exp(-max(-50.0, float(np.ravel(logit)[0])))),
    )


def _to_crop(region: Region) -> Floats:
    """Matrix (2, 3) that takes the region upright into the network's picture."""
    scale = CROP_SIZE / region.size
    cosine, sine = scale * math.cos(region.angle), scale * math.sin(region.angle)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    middle = CROP_SIZE / 2.0 - turn @ np.array([region.x, region.y])
    return np.column_stack([turn, middle])


def region_of(parameters: FaceParameters, landmarks: Floats) -> Region:
    """Where to look for the face in the next picture: about its landmarks.

    Args:
        parameters: Margin around the face.
        landmarks: Of this picture, shape `(468, 2)` [px].
    """
    left, right = landmarks[EYE_CORNERS[0]], landmarks[EYE_CORNERS[1]]
    angle = math.atan2(right[1] - left[1], right[0] - left[0])
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    upright = landmarks @ turn.T
    low, high = upright.min(axis=0), upright.max(axis=0)
    centre = turn.T @ ((low + high) / 2.0)
    return Region(
        x=float(centre[0]),
        y=float(centre[1]),
        size=parameters.margin * float(np.max(high - low)),
        angle=angle,
    )
