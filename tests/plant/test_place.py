"""Rumble strip and barrier: where they are and what the wheel feels of them."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.plant.parameters import DEFAULT_CAR, ColumnParameters, RoadParameters
from costeer.plant.place import (
    BARRIER,
    NO_CONTACT,
    STRIP,
    STRIP_BEGINS,
    STRIP_PERIOD,
    STRIP_WIDTH,
    Place,
    beyond_line,
    ground_contact,
    rumble_torque,
)
from costeer.plant.world import Inputs, initial_state, step

WIDTH = 1.8
OUTER_LEFT = 1.75
"""The left line beside the left lane, whose centre is 0 [m]."""


@pytest.mark.parametrize(("lanes", "right"), [(1.0, -1.75), (2.0, -5.25), (3.0, -8.75)])
def test_the_cars_side_is_as_far_beyond_either_outer_line(
    lanes: float, right: float
) -> None:
    road = RoadParameters(num_lanes=lanes)
    for beyond in (-0.4, 0.0, 0.3, 2.0):
        middle = beyond - WIDTH / 2.0
        left = beyond_line(road, OUTER_LEFT + middle, WIDTH)
        assert left == pytest.approx(beyond, abs=1e-12)
        assert beyond_line(road, right - middle, WIDTH) == pytest.approx(left)


@pytest.mark.parametrize(
    ("beyond", "contact"),
    [
        (-1.0, NO_CONTACT),
        (STRIP_BEGINS - 0.01, NO_CONTACT),
        (STRIP_BEGINS + 0.01, STRIP),
        (STRIP_BEGINS + STRIP_WIDTH - 0.01, STRIP),
        (STRIP_BEGINS + STRIP_WIDTH + 0.01, NO_CONTACT),
        (2.49, NO_CONTACT),
        (2.5, BARRIER),
        (9.0, BARRIER),
    ],
)
def test_outside_the_line_comes_the_strip_and_then_the_barrier(
    beyond: float, contact: float
) -> None:
    assert ground_contact(RoadParameters(shoulder=2.5), beyond) == contact


@pytest.mark.parametrize("amplitude", [0.6, -0.6])
def test_a_groove_turns_the_wheel_as_much_to_one_side_as_to_the_other(
    amplitude: float,
) -> None:
    place = Place(rumble=amplitude)
    positions = 137.0 + (np.arange(1200) + 0.5) * STRIP_PERIOD / 1200
    torques = np.array([rumble_torque(place, float(x)) for x in positions])
    assert torques.mean() == pytest.approx(0.0, abs=1e-9)
    assert np.abs(torques).max() == pytest.approx(0.6, rel=2e-3)
    assert torques.min() == pytest.approx(-torques.max(), rel=1e-6)
    later = [rumble_torque(place, float(x) + STRIP_PERIOD) for x in positions]
    np.testing.assert_allclose(later, torques, atol=1e-9)
    mirrored = [rumble_torque(Place(rumble=-amplitude), float(x)) for x in positions]
    np.testing.assert_array_equal(mirrored, -torques)


def test_without_a_strip_the_wheel_feels_nothing() -> None:
    assert rumble_torque(Place(), 12.3) == 0.0


def test_the_strip_shakes_the_wheel_and_hardly_steers() -> None:
    place = Place(rumble=RoadParameters().rumble)
    state = initial_state(DEFAULT_CAR, 0.0, 20.0)
    angles = []
    for _ in range(480):
        state = step(
            DEFAULT_CAR,
            ColumnParameters(),
            state,
            Inputs(0.0, 0.0, state.vehicle.drive, place),
            1.0 / 480.0,
        )
        angles.append(state.column.steering_wheel_angle)
    swing = np.array(angles[240:])
    # 33 Hz is far above the column: amplitude about torque / (J ω²), 0.1 mrad.
    assert 2e-5 < swing.std() < 2e-3
    assert abs(swing.mean()) < 2e-3
    assert abs(state.vehicle.lateral_position) < 0.02
