"""The pose of a rigid face is what it was projected from."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from costeer.devices.head.face import FaceParameters, region_of
from costeer.devices.head.pose import RIGID_POINTS, camera_matrix, head_pose
from tests.devices.head.rendering import View, mesh, turn

WIDTH, HEIGHT = 640, 480


def projected(view: View) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """The canonical face's vertices in the picture [px]."""
    place = np.array([view.aside, view.below, view.distance])
    seen = (mesh().vertices @ turn(view).T + place) @ camera_matrix(WIDTH, HEIGHT).T
    return np.asarray(seen[:, :2] / seen[:, 2:], float)


@given(
    yaw_deg=st.floats(-60.0, 60.0),
    pitch_deg=st.floats(-20.0, 20.0),
    roll_deg=st.floats(-20.0, 20.0),
    aside=st.floats(-0.15, 0.15),
)
@settings(max_examples=25)
def test_pose_undoes_the_projection(
    yaw_deg: float, pitch_deg: float, roll_deg: float, aside: float
) -> None:
    pose = head_pose(
        projected(View(yaw_deg, pitch_deg, roll_deg, aside)), WIDTH, HEIGHT
    )
    assert pose is not None
    # The 21 points are written with three decimals of a centimetre.
    assert math.degrees(pose.yaw) == pytest.approx(yaw_deg, abs=0.05)
    assert pose.misfit < 1e-3


def test_a_head_beside_the_axis_that_looks_parallel_to_it_has_no_yaw() -> None:
    # Against the line of sight it would be turned by 12 deg.
    pose = head_pose(projected(View(aside=0.15, distance=0.7)), WIDTH, HEIGHT)
    assert pose is not None
    assert math.degrees(pose.yaw) == pytest.approx(0.0, abs=0.05)


def test_the_points_lie_on_the_canonical_face() -> None:
    listed = np.array([*RIGID_POINTS.values()]) * [0.01, -0.01, -0.01]
    assert np.allclose(mesh().vertices[list(RIGID_POINTS)], listed, atol=1e-5)


def test_no_pose_of_landmarks_that_are_no_numbers() -> None:
    assert head_pose(np.full((468, 2), np.nan), WIDTH, HEIGHT) is None


@given(roll_deg=st.floats(-40.0, 40.0))
@settings(max_examples=20)
def test_the_region_turns_with_the_face_and_holds_it(roll_deg: float) -> None:
    landmarks = projected(View(roll_deg=roll_deg))
    region = region_of(FaceParameters(), landmarks)
    assert math.degrees(region.angle) == pytest.approx(roll_deg, abs=1.0)
    distance = np.abs(landmarks - [region.x, region.y]).max()
    assert distance < region.size * math.sqrt(0.5)
    # The same face upright needs a region of the same size.
    upright = region_of(FaceParameters(), projected(View()))
    assert region.size == pytest.approx(upright.size, rel=0.02)
