"""Make the face that the tests of the head tracker render.

    python tests/data/face/make_face.py ASTRONAUT.png PACKED_ASSETS.data

The first is `astronaut` of scikit-image 0.26, the second
`face_mesh_solution_packed_assets.data` of the npm package `@mediapipe/face_mesh`
0.4.1633559619. NOTICE tells where both come from. Writes `portrait.jpg` and `face.npz`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from costeer.devices.head import face

HERE = Path(__file__).parent
METADATA = slice(3_737_848, 3_757_224)
"""Bytes of the packed assets that describe the canonical face."""

PORTRAIT = (slice(20, 245), slice(120, 330))
"""Rows and columns of the astronaut's face."""


def number(data: bytes, at: int) -> tuple[int, int]:
    """A protobuf number and where the next begins."""
    value = shift = 0
    while True:
        value |= (data[at] & 127) << shift
        shift += 7
        at += 1
        if data[at - 1] < 128:
            return value, at


def fields(data: bytes) -> Iterator[tuple[int, bytes | int]]:
    """Fields of a protobuf message: numbers, text and four-byte values."""
    at = 0
    while at < len(data):
        tag, at = number(data, at)
        if tag & 7 == 0:
            value, at = number(data, at)
            yield tag >> 3, value
            continue
        length, at = (4, at) if tag & 7 == 5 else number(data, at)
        yield tag >> 3, data[at : at + length]
        at += length


def canonical(assets: bytes) -> tuple[NDArray[np.float32], NDArray[np.uint16]]:
    """Vertices (468, 3) [cm] and triangles (898, 3) of the canonical face."""
    mesh = next(v for f, v in fields(assets[METADATA]) if f == 1)
    assert isinstance(mesh, bytes)
    parts = list(fields(mesh))
    vertices = b"".join(v for f, v in parts if f == 3 and isinstance(v, bytes))
    corners = [v for f, v in parts if f == 4 and isinstance(v, int)]
    places = np.frombuffer(vertices, "<f4").reshape(-1, 5)[:, :3]
    return places, np.array(corners, np.uint16).reshape(-1, 3)


def measured(image: face.Image) -> NDArray[np.float64]:
    """Landmarks (468, 3) of the portrait: x right, y down, z away [px]."""
    networks, parameters = face.load_networks(), face.FaceParameters()
    region = face.detect(parameters, networks, image)
    assert region is not None
    for _ in range(5):
        found = face.measure_face(networks, image, region)
        region = face.region_of(parameters, found.landmarks)
    to_crop = face._to_crop(region)
    crop = cv2.warpAffine(image, to_crop, (face.CROP_SIZE, face.CROP_SIZE))
    pixels = np.asarray(crop[None, :, :, ::-1], np.float32) / 255.0
    raw = networks.landmarks.run(None, {"input_1": pixels})[0].reshape(-1, 3)
    depth = raw[:, 2] * region.size / face.CROP_SIZE
    found = face.measure_face(networks, image, region)
    return np.column_stack([found.landmarks, depth])


def upright(
    places: NDArray[np.float64], like: NDArray[np.float32]
) -> NDArray[np.float64]:
    """Places turned, moved and scaled onto another shape, least squares."""
    source, target = places - places.mean(axis=0), like - like.mean(axis=0)
    left, stretch, right = np.linalg.svd(target.T @ source)
    keep = np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    turn = left @ keep @ right
    scale = np.sum(stretch * np.diag(keep)) / np.sum(source**2)
    return scale * source @ turn.T + like.mean(axis=0)


def main() -> None:
    """Write both files."""
    portrait = cv2.imread(sys.argv[1])
    assert portrait is not None
    image = np.ascontiguousarray(portrait[PORTRAIT])
    vertices, triangles = canonical(Path(sys.argv[2]).read_bytes())
    cv2.imwrite(str(HERE / "portrait.jpg"), image, [cv2.IMWRITE_JPEG_QUALITY, 95])
    landmarks = measured(image)
    own = upright(landmarks * np.array([1.0, -1.0, -1.0]), vertices)
    np.savez_compressed(
        HERE / "face.npz",
        canonical=vertices,
        own=own.astype(np.float32),
        triangles=triangles,
        texture=landmarks[:, :2].astype(np.float32),
    )


if __name__ == "__main__":
    main()
