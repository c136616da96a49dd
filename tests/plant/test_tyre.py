"""The tyre: linear, odd, and no stronger than its grip."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.plant.tyre import lateral_force

STIFFNESS = 110e3
GRIP = 6000.0
SLIDE = 3.0 * GRIP / STIFFNESS
SLIPS = st.floats(-1.0, 1.0)


@given(SLIPS)
def test_the_force_is_odd_in_the_slip(slip: float) -> None:
    left = lateral_force(slip, STIFFNESS, GRIP)
    assert lateral_force(-slip, STIFFNESS, GRIP) == -left


@given(SLIPS)
def test_the_force_opposes_the_slip_and_stays_within_the_grip(slip: float) -> None:
    force = lateral_force(slip, STIFFNESS, GRIP)
    assert force * slip <= 0.0
    assert abs(force) <= GRIP * (1.0 + 1e-15)  # rounding of the product


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_more_slip_never_gives_less_force(one: float, other: float) -> None:
    low, high = sorted((one, other))
    weak, strong = (abs(lateral_force(s, STIFFNESS, GRIP)) for s in (low, high))
    assert weak <= strong * (1.0 + 1e-15)  # rounding of the product


def test_the_slope_at_no_slip_is_the_cornering_stiffness() -> None:
    slip = 1e-8
    slope = lateral_force(slip, STIFFNESS, GRIP) / slip
    # The first correction is slip / slide, 6e-8.
    assert slope == pytest.approx(-STIFFNESS, rel=1e-7)


@pytest.mark.parametrize("slip", [SLIDE, 1.2 * SLIDE, 10.0])
def test_a_sliding_tyre_gives_all_its_grip(slip: float) -> None:
    assert lateral_force(slip, STIFFNESS, GRIP) == pytest.approx(-GRIP, rel=1e-15)


def test_half_way_to_sliding_seven_eighths_of_the_grip_are_used() -> None:
    # 1 - (1 - 1/2)³, the brush model's cubic.
    half = lateral_force(SLIDE / 2.0, STIFFNESS, GRIP)
    assert half == pytest.approx(-GRIP * 7.0 / 8.0, rel=1e-15)


def test_a_batch_gives_what_its_members_give() -> None:
    slips = np.linspace(-0.5, 0.5, 21)
    members = [lateral_force(slip, STIFFNESS, GRIP) for slip in slips.tolist()]
    assert lateral_force(slips, STIFFNESS, GRIP).tolist() == members
