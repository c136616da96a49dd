"""Rendered faces whose angle is known: how far off the tracker is, and how fast."""

from __future__ import annotations

import math
import time
from functools import cache

import numpy as np
import pytest

from costeer.devices.head import face, tracker
from costeer.devices.head.calibration import FitParameters, Look, fit_calibration
from costeer.devices.head.source import HeadDescription
from tests.devices.head.rendering import View, cabin, render

PARAMETERS = tracker.TrackerParameters()
WEBCAM = HeadDescription("webcam", "0")
FRAME = 1.0 / 30.0

HELD = {
    "canonical": View(),
    "own": View(pitch_deg=-8.0, roll_deg=5.0, aside=0.05, distance=0.7),
}
"""How each face is held: straight in front of the camera, or not at all."""


@cache
def networks() -> face.FaceNetworks:
    return face.load_networks()


def tracked(image: face.Image) -> tracker.TrackerState:
    """What one picture tells a tracker that knows nothing yet."""
    state = tracker.initial_state()
    return tracker.step(PARAMETERS, networks(), state, image, FRAME)


@cache
def yaw_at(shape: str, yaw_deg: float) -> float:
    """Tracked yaw of a face that is turned so far [deg]."""
    image = render(HELD[shape]._replace(yaw_deg=yaw_deg), shape)
    state = tracked(image)
    assert state.valid
    return math.degrees(state.head_yaw)


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["canonical", "own"])
def test_calibrated_yaw_is_right_within_30_degrees(shape: str) -> None:
    looks = [
        Look(math.radians(angle), math.radians(yaw_at(shape, angle)))
        for angle in (0.0, 30.0, -30.0)
    ]
    fitted = fit_calibration(FitParameters(), "P01", WEBCAM, looks)
    angles = np.arange(-27.5, 28.0, 5.5)  # two of the looks are not among them
    found = np.array([yaw_at(shape, float(angle)) for angle in angles])
    errors = fitted.gain * found + math.degrees(fitted.offset) - angles
    # The product's promise; measured 1.0 and 0.9 deg here.
    assert np.mean(np.abs(errors)) <= 3.0
    # Without any calibration the sign and the order are right already.
    assert np.all(np.diff(found) > 0.0)
    assert found[0] < -15.0
    assert found[-1] > 15.0


def test_a_head_turned_to_its_left_is_positive() -> None:
    # The camera faces the driver: the driver's left is the picture's right.
    assert yaw_at("canonical", 30.0) > 20.0


def test_a_mirrored_picture_gives_the_mirrored_yaw() -> None:
    image = render(View(yaw_deg=20.0, roll_deg=4.0))
    mirrored = np.ascontiguousarray(image[:, ::-1])
    left, right = tracked(image).head_yaw, tracked(mirrored).head_yaw
    # The networks are not exactly symmetric: 1 to 2 deg where it was tried.
    assert math.degrees(abs(left + right)) < 4.0
    assert right < math.radians(-10.0)


def test_a_lost_face_holds_its_angle_and_is_found_again() -> None:
    first = tracked(render(View(yaw_deg=15.0)))
    lost = tracker.step(PARAMETERS, networks(), first, cabin(), FRAME)
    assert not lost.valid
    assert lost.head_yaw == first.head_yaw
    assert lost.region is None
    elsewhere = render(View(yaw_deg=10.0, aside=0.12, below=-0.05))
    again = tracker.step(PARAMETERS, networks(), lost, elsewhere, FRAME)
    assert again.valid
    assert math.degrees(again.head_yaw) == pytest.approx(10.0, abs=4.0)


@pytest.mark.parametrize("aside", [-0.2, -0.03, 0.0, 0.05, 0.2])
def test_the_detector_points_at_the_face(aside: float) -> None:
    image = render(View(aside=aside, roll_deg=10.0))
    found = face.detect(face.FaceParameters(), networks(), image)
    assert found is not None
    measured = face.measure_face(networks(), image, found)
    region = face.region_of(face.FaceParameters(), measured.landmarks)
    # Measured 6 to 11 px; the middle of its cell would be 16 to 22 px off.
    assert math.hypot(found.x - region.x, found.y - region.y) < 13.0
    assert found.size == pytest.approx(region.size, rel=0.2)
    assert found.angle == pytest.approx(math.radians(10.0), abs=0.1)


def test_a_face_is_followed_without_the_detector() -> None:
    state = tracked(render(View()))
    blind = networks()._replace(detector=None)
    for yaw_deg in (4.0, 8.0, 12.0):
        image = render(View(yaw_deg=yaw_deg, aside=yaw_deg / 500.0))
        state = tracker.step(PARAMETERS, blind, state, image, FRAME)
        assert state.valid


@pytest.mark.parametrize("size", [(48, 64), (1080, 1920)])
def test_pictures_of_any_size_without_a_face_are_survived(
    size: tuple[int, int],
) -> None:
    noise = np.random.default_rng(1).integers(0, 256, (*size, 3), dtype=np.uint8)
    assert not tracked(noise).valid


def test_fifteen_pictures_a_second_take_less_than_one_core() -> None:
    images = [render(View(yaw_deg=angle)) for angle in (-6.0, 0.0, 6.0)]
    state = tracked(images[1])
    start = time.process_time()
    for image in images * 4:
        state = tracker.step(PARAMETERS, networks(), state, image, FRAME)
    spent = (time.process_time() - start) / 12
    # 8 ms of one core where it was measured: an eighth of what is allowed.
    assert spent < 1.0 / 15.0
