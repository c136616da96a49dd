"""Pictures of a face whose angle is known: a textured mesh, seen by a camera.

The face looks where it is told: yaw positive to the picture's right, which is the
left of a person who faces the camera.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from costeer.devices.head.face import Image

FACE = Path(__file__).parents[2] / "data" / "face"
WIDTH, HEIGHT = 640, 480

Floats = NDArray[np.float64]


class View(NamedTuple):
    """How a face is held and seen; angles in degrees, places in metres.

    Attributes:
        yaw_deg: Positive to the picture's right.
        pitch_deg: Positive downwards.
        roll_deg: Positive clockwise.
        aside: To the picture's right.
        below: Under the camera's axis.
        distance: From the camera.
    """

    yaw_deg: float = 0.0
    pitch_deg: float = 0.0
    roll_deg: float = 0.0
    aside: float = 0.0
    below: float = 0.0
    distance: float = 0.65


class Mesh(NamedTuple):
    """A face as triangles.

    Attributes:
        vertices: Shape `(468, 3)`: x right, y down, z away from the camera [m].
        triangles: Shape `(898, 3)`, indices of vertices.
        texture: Where each vertex lies in the portrait, shape `(468, 2)` [px].
    """

    vertices: Floats
    triangles: NDArray[np.int64]
    texture: Floats


@cache
def mesh(shape: str = "canonical") -> Mesh:
    """The face in a shape: `canonical`, or `own` for the portrait's."""
    with np.load(FACE / "face.npz") as stored:
        return Mesh(
            vertices=stored[shape] * np.array([0.01, -0.01, -0.01]),
            triangles=stored["triangles"].astype(np.int64),
            texture=stored["texture"].astype(float),
        )


@cache
def portrait() -> Image:
    """The texture."""
    read = cv2.imread(str(FACE / "portrait.jpg"))
    assert read is not None
    return np.asarray(read, np.uint8)


@cache
def cabin(seed: int = 1) -> Image:
    """A background: soft patches with straight edges across, as inside a car."""
    random = np.random.default_rng(seed)
    patches = random.integers(30, 190, (6, 8, 3), dtype=np.uint8)
    soft = cv2.resize(patches, (WIDTH, HEIGHT), interpolation=cv2.INTER_CUBIC)
    for _ in range(8):
        ends = [(int(x), int(y)) for x, y in random.integers(0, WIDTH, (2, 2))]
        tint = [int(c) for c in random.integers(20, 220, 3)]
        cv2.line(soft, ends[0], ends[1], tint, int(random.integers(4, 25)))
    return np.asarray(soft, np.uint8)


def turn(view: View) -> Floats:
    """Rotation of the face: roll first, then pitch, then yaw, shape `(3, 3)`."""
    yaw, pitch, roll = np.radians([-view.yaw_deg, -view.pitch_deg, view.roll_deg])
    matrices = [
        cv2.Rodrigues(np.array(axis))[0]
        for axis in ([0.0, yaw, 0.0], [pitch, 0.0, 0.0], [0.0, 0.0, roll])
    ]
    return np.asarray(matrices[0] @ matrices[1] @ matrices[2], float)


def render(view: View, shape: str = "canonical", seed: int = 1) -> Image:
    """The picture of a camera whose focal length is one picture width."""
    face = mesh(shape)
    place = np.array([view.aside, view.below, view.distance])
    seen = face.vertices @ turn(view).T + place
    points = seen[:, :2] / seen[:, 2:] * WIDTH + np.array([WIDTH, HEIGHT]) / 2.0
    source, covered = _texture_places(face, points, 1.0 / seen[:, 2])
    skin = cv2.remap(portrait(), source.astype(np.float32), None, cv2.INTER_LINEAR)
    picture = np.where(covered[:, :, None], skin, cabin(seed))
    return np.asarray(cv2.GaussianBlur(picture, (3, 3), 0.6), np.uint8)


class Covered(NamedTuple):
    """Pixels inside triangles, a row for each pixel of each triangle.

    Attributes:
        corners: Vertices of the triangle, shape `(pixels, 3)`.
        place: Column and row, shape `(pixels, 2)` [px].
        shares: Of each vertex, shape `(pixels, 3)` [-].
    """

    corners: NDArray[np.int64]
    place: NDArray[np.int64]
    shares: Floats


def _texture_places(
    face: Mesh, points: Floats, closeness: Floats
) -> tuple[Floats, NDArray[np.bool_]]:
    """Place in the portrait that each pixel shows, and which pixels show the face.

    Args:
        face: The mesh.
        points: Where each vertex is in the picture, shape `(468, 2)` [px].
        closeness: One over its distance [1/m].
    """
    seen = _seen(face.triangles, points)
    weights = seen.shares * closeness[seen.corners]
    near = weights.sum(axis=1)
    mixed = np.einsum("pc,pcd->pd", weights, face.texture[seen.corners])
    order = np.argsort(near)  # the nearest is written last
    column, row = seen.place[order].T
    source = np.zeros((HEIGHT, WIDTH, 2))
    source[row, column] = (mixed / near[:, None])[order]
    covered = np.zeros((HEIGHT, WIDTH), bool)
    covered[row, column] = True
    return source, covered


def _seen(triangles: NDArray[np.int64], points: Floats) -> Covered:
    """Pixels of all triangles that face the camera; small ones are done together."""
    zero, one, two = np.moveaxis(points[triangles], 1, 0)
    front = triangles[_cross(one - zero, two - zero) < 0.0]
    extent = np.ptp(points[front], axis=1).max(axis=1)
    groups = np.array_split(front[np.argsort(extent)], 12)
    parts = [_covered(group, points) for group in groups]
    return Covered(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def _covered(triangles: NDArray[np.int64], points: Floats) -> Covered:
    """Pixels of triangles of about the same size."""
    zero, one, two = np.moveaxis(points[triangles], 1, 0)
    area = _cross(one - zero, two - zero)[:, None]
    low = np.floor(points[triangles].min(axis=1)).astype(int)
    edge = int(np.ceil(np.ptp(points[triangles], axis=1).max())) + 2
    offsets = np.stack(np.meshgrid(range(edge), range(edge)), axis=-1).reshape(-1, 2)
    places = low[:, None, :] + offsets
    reach = places - zero[:, None]
    first = _cross(reach, (two - zero)[:, None]) / area
    second = _cross((one - zero)[:, None], reach) / area
    shares = np.stack([1.0 - first - second, first, second], axis=-1)
    inside = shares.min(axis=-1) >= -1e-9
    inside &= np.all((places >= 0) & (places < [WIDTH, HEIGHT]), axis=-1)
    triangle, pixel = np.nonzero(inside)
    return Covered(
        triangles[triangle], places[triangle, pixel], shares[triangle, pixel]
    )


def _cross(a: Floats, b: Floats) -> Floats:
    """Area of the parallelogram of two vectors in the plane."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], float)
