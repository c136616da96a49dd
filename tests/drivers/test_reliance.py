"""Hands that feel: the arms stiffen against guidance that opposes, and relax after."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.drivers import reliance
from costeer.drivers.reliance import RelianceParameters
from costeer.plant.parameters import RoadParameters
from costeer.sensing.measurement import standing_start
from tests.drivers.samples import DT

PARAMETERS = RelianceParameters()


def stiffening(
    guidance: float,
    seconds_of_guidance: float,
    seconds: float,
    wanted: float = 1.0,
    leading: bool = False,
) -> NDArray[np.float64]:
    """Stiffening at each step while guidance acts for a while, then not."""
    state, answers = reliance.initial_state(), []
    for k in range(round(seconds / DT)):
        torque = guidance if k * DT < seconds_of_guidance else 0.0
        state = reliance.step(PARAMETERS, state, torque, wanted, leading, DT)
        answers.append(state.stiffening)
    return np.array(answers)


def time_of(values: NDArray[np.float64], level: float) -> float:
    """When the values first pass a level [s]."""
    return float(np.argmax(values > level) + 1) * DT


def test_arms_stiffen_within_0_3_to_0_5_s_against_opposing_guidance() -> None:
    # 0.2 s of opposition, then 63 % of the way within another 0.2 s.
    tense = stiffening(-2.0, 5.0, 2.0)
    most = 1.0 + 0.63 * (PARAMETERS.cocontraction - 1.0)
    assert 0.3 <= time_of(tense, most) <= 0.5
    assert tense[-1] == pytest.approx(PARAMETERS.cocontraction, rel=1e-3)


def test_arms_stay_relaxed_for_the_first_fifth_of_a_second() -> None:
    assert (stiffening(-2.0, 5.0, 0.2) == 1.0).all()


def test_arms_relax_when_the_guidance_is_gone() -> None:
    # 2 N·m falls below what is noticed after 0.2 s, the arm follows in 0.2 s.
    tense = stiffening(-2.0, 2.0, 4.0)
    assert tense[round(1.9 / DT)] > 2.0
    assert tense[round(3.2 / DT)] < 1.05


def test_agreeing_or_faint_guidance_leaves_the_arms_relaxed() -> None:
    assert (stiffening(2.0, 5.0, 2.0) == 1.0).all()
    assert (stiffening(-0.29, 5.0, 2.0) == 1.0).all()


def test_arms_stay_relaxed_against_guidance_that_leads() -> None:
    assert (stiffening(-2.0, 5.0, 2.0, leading=True) == 1.0).all()


@pytest.mark.parametrize(
    ("guidance", "steered", "speed", "leads"),
    [
        (1.0, 1.0, 0.5, True),  # 3.5 m to go, 0.75 m come by themselves
        (-1.0, 1.0, 0.5, False),  # away from the goal
        (1.0, 1.0, 3.0, False),  # 4.5 m would be too far: this makes it worse
        (-1.0, 1.0, 3.0, True),  # and this does not
        (1.0, 0.0, 0.5, False),  # no lane change
    ],
)
def test_guidance_leads_that_brings_the_car_to_the_wanted_lane(
    guidance: float, steered: float, speed: float, leads: bool
) -> None:
    car = standing_start(RoadParameters())._replace(
        lateral_position=-3.5, lateral_velocity=speed
    )
    own = PARAMETERS._replace(leading_horizon=1.5)
    assert reliance.leads(own, car, guidance, 0.0, steered) is leads
    nobody = own._replace(leading_horizon=0.0)
    assert not reliance.leads(nobody, car, guidance, 0.0, steered)


def test_a_knock_shorter_than_a_reaction_leaves_the_arms_relaxed() -> None:
    assert (stiffening(-0.6, 0.15, 2.0) == 1.0).all()


def test_stiffening_never_leaves_the_range_of_its_parameter() -> None:
    tense = stiffening(-8.0, 1.0, 3.0)
    assert tense.min() >= 1.0
    assert tense.max() <= PARAMETERS.cocontraction


def test_left_and_right_are_felt_alike() -> None:
    mirrored = stiffening(2.0, 1.0, 2.0, wanted=-1.0)
    np.testing.assert_array_equal(stiffening(-2.0, 1.0, 2.0), mirrored)
