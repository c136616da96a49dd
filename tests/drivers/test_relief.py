"""Guidance that does the work: what hands that rely on it leave to it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.drivers.arm import shared_torque, wanted_torque
from tests.drivers.arms import PARAMETERS, PLANT_DT, RELAXED, settled_torque, torques

TORQUES = st.floats(-10.0, 10.0)


@given(TORQUES, TORQUES)
def test_shared_torque_is_odd(wanted: float, guidance: float) -> None:
    assert shared_torque(-wanted, -guidance) == -shared_torque(wanted, guidance)


@given(TORQUES, TORQUES, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
def test_shared_torque_has_no_jump(w: float, g: float, dw: float, dg: float) -> None:
    # It moves at most as far as the one of the two that moves further.
    change = abs(shared_torque(w + dw, g + dg) - shared_torque(w, g))
    assert change <= max(abs(dw), abs(dg)) + 1e-12


@given(TORQUES, TORQUES)
def test_shared_torque_is_never_more_than_either(w: float, g: float) -> None:
    assert abs(shared_torque(w, g)) <= min(abs(w), abs(g))
    if min(w, g) <= 0.0 <= max(w, g):
        assert shared_torque(w, g) == 0.0


def test_full_reliance_on_guidance_that_suffices_leaves_no_torque() -> None:
    wanted = wanted_torque(PARAMETERS, RELAXED, -0.1)
    trusting = RELAXED._replace(guidance=1.5 * wanted, reliance=1.0)
    assert wanted == pytest.approx(1.2)
    # exp(-40) of the lag is left.
    assert settled_torque(trusting, -0.1) == pytest.approx(0.0, abs=1e-12)


def test_guidance_that_opposes_takes_nothing_from_the_driver() -> None:
    opposed = RELAXED._replace(guidance=-3.0, reliance=1.0)
    assert settled_torque(opposed, -0.1) == settled_torque(RELAXED, -0.1) > 0.0


def test_half_reliance_halves_the_torque_that_guidance_shares() -> None:
    half = RELAXED._replace(guidance=5.0, reliance=0.5)
    alone = settled_torque(RELAXED, -0.1)
    assert settled_torque(half, -0.1) == pytest.approx(0.5 * alone, rel=1e-9)


def test_guidance_takes_over_with_the_lag_of_the_muscles() -> None:
    trusting = RELAXED._replace(guidance=5.0, reliance=1.0)
    relief = torques(RELAXED, -0.1, 0.5) - torques(trusting, -0.1, 0.5)
    times = PLANT_DT * np.arange(1, relief.size + 1)
    np.testing.assert_allclose(relief, 1.2 * (1.0 - np.exp(-times / 0.1)), rtol=1e-9)
