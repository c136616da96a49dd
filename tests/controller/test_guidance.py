"""Torques before the gain: signs, rest, symmetry, what friction adds."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.controller.guidance import (
    GuidanceParameters,
    disturbance_torque,
    estimated_driver_torque,
    guide,
)
from costeer.controller.signals import Preview
from costeer.plant.parameters import (
    DEFAULT_CAR,
    ColumnParameters,
    holding_stiffness,
    steady_front_slip_angle,
    steady_steering_wheel_angle,
)

PARAMETERS = GuidanceParameters()
COLUMN = ColumnParameters()
NOTHING = Preview(*[0.0] * len(Preview._fields))
ERRORS = st.floats(-1.0, 1.0)
PREVIEWS = st.builds(Preview, *[ERRORS] * len(Preview._fields))


def test_a_car_on_its_straight_target_gets_no_torque() -> None:
    assert guide(PARAMETERS, DEFAULT_CAR, COLUMN, NOTHING) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("name", Preview._fields[:5])
def test_an_error_to_the_left_is_steered_to_the_right(name: str) -> None:
    errors = Preview(**(NOTHING._asdict() | {name: 0.1}))
    torques = guide(PARAMETERS, DEFAULT_CAR, COLUMN, errors)
    if name == "heading_error":  # it acts through the previewed lateral error
        assert torques == (0.0, 0.0, 0.0)
    else:
        assert torques.estimated_driver_torque > 0.0
        assert torques.instructed_torque < 0.0


@given(PREVIEWS)
def test_mirrored_errors_give_the_mirrored_torque(errors: Preview) -> None:
    turned = Preview(*(-value for value in errors))
    left = guide(PARAMETERS, DEFAULT_CAR, COLUMN, errors)
    right = guide(PARAMETERS, DEFAULT_CAR, COLUMN, turned)
    assert tuple(right) == tuple(-value for value in left)


@given(st.floats(10.0, 35.0), st.floats(-4e-3, 4e-3))
def test_in_a_steady_bend_the_torque_is_what_holds_the_wheel(
    speed: float, curvature: float
) -> None:
    angle = steady_steering_wheel_angle(DEFAULT_CAR, speed, curvature)
    planned = NOTHING._asdict() | {
        "planned_steering_angle": angle,
        "planned_slip_angle": steady_front_slip_angle(DEFAULT_CAR, speed, curvature),
    }
    torques = guide(PARAMETERS, DEFAULT_CAR, COLUMN, Preview(**planned))
    held = holding_stiffness(DEFAULT_CAR, COLUMN, speed) * angle
    assert torques.instructed_torque == pytest.approx(held, abs=1e-14)  # rounding


@given(PREVIEWS)
def test_friction_is_compensated_by_at_most_itself_and_in_the_wanted_direction(
    errors: Preview,
) -> None:
    estimated = estimated_driver_torque(PARAMETERS, errors)
    aligning = -DEFAULT_CAR.aligning_stiffness * errors.planned_slip_angle
    added = (
        disturbance_torque(PARAMETERS, DEFAULT_CAR, COLUMN, errors, estimated)
        - aligning
    )
    wanted = 4.0 * COLUMN.damping * errors.planned_steering_rate - estimated
    slack = 1e-13  # rounding of torques up to 100 N·m
    assert abs(added) <= COLUMN.friction + slack
    assert added * wanted >= -slack * abs(wanted)


def test_far_from_its_target_the_guidance_adds_the_whole_friction() -> None:
    errors = NOTHING._asdict() | {"lateral_error": -5.0}
    torques = guide(PARAMETERS, DEFAULT_CAR, COLUMN, Preview(**errors))
    # tanh(7.5 / 0.2) is 1 to rounding.
    assert torques.disturbance_torque == pytest.approx(COLUMN.friction)
    assert torques.instructed_torque == pytest.approx(7.5 + COLUMN.friction)


def test_what_is_lost_gives_no_number() -> None:
    errors = Preview(**(NOTHING._asdict() | {"lateral_error": math.nan}))
    torques = guide(PARAMETERS, DEFAULT_CAR, COLUMN, errors)
    assert math.isnan(torques.instructed_torque)


def test_a_batch_gives_what_its_members_give() -> None:
    columns = np.random.default_rng(2).normal(size=(len(Preview._fields), 30))
    batch = guide(PARAMETERS, DEFAULT_CAR, COLUMN, Preview(*columns))
    members = [
        guide(PARAMETERS, DEFAULT_CAR, COLUMN, Preview(*column))
        for column in columns.T.tolist()
    ]
    # NumPy's tanh may differ in the last place.
    np.testing.assert_allclose(np.transpose(batch), members, 1e-12)
