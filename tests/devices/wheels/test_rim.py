"""Motion of a rim: closed forms, friction, mirrors."""

from __future__ import annotations

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from costeer.devices.wheels.rim import Rim, moved

DT = 1.0 / 960.0
RIM = Rim(inertia=0.05, damping=0.2, friction=0.3)

rims = st.builds(
    Rim,
    inertia=st.floats(0.01, 0.2),
    damping=st.one_of(st.just(0.0), st.floats(0.01, 1.0)),
    friction=st.floats(0.0, 0.5),
)
torques, rates = st.floats(-5.0, 5.0), st.floats(-20.0, 20.0)


def run(rim: Rim, rate: float, torque: float, steps: int) -> tuple[float, float]:
    """Angle and rate after many steps."""
    angle = 0.0
    for _ in range(steps):
        turned, rate = moved(rim, rate, torque, DT)
        angle += turned
    return angle, rate


def test_a_free_rim_slows_down_as_the_exponential() -> None:
    rim = Rim(inertia=0.05, damping=0.2, friction=0.0)
    angle, rate = run(rim, 4.0, 0.0, 960)
    # Rounding of 960 sums.
    assert rate == pytest.approx(4.0 * math.exp(-0.2 / 0.05), rel=1e-12)
    assert angle == pytest.approx(4.0 * 0.25 * -math.expm1(-4.0), rel=1e-12)


def test_friction_alone_stops_a_rim_after_half_its_rate_squared() -> None:
    rim = Rim(inertia=0.05, damping=0.0, friction=0.3)
    angle, rate = run(rim, 4.0, 0.0, 960)
    assert rate == 0.0
    # Energy J ω²/2 is friction times angle.
    assert angle == pytest.approx(0.05 * 4.0**2 / 2.0 / 0.3, rel=1e-12)


def test_a_lasting_torque_ends_in_the_rate_that_damping_allows() -> None:
    _, rate = run(RIM, 0.0, 1.0, 4000)
    # Sixteen time constants of J / B: what is left is below rounding.
    assert rate == pytest.approx((1.0 - 0.3) / 0.2, rel=1e-6)


@given(rims, st.floats(-1.0, 1.0))
def test_friction_holds_what_is_not_stronger(rim: Rim, share: float) -> None:
    assert moved(rim, 0.0, share * rim.friction, DT) == (0.0, 0.0)


@given(rims, rates, torques)
def test_mirrored_torque_gives_mirrored_motion(
    rim: Rim, rate: float, torque: float
) -> None:
    angle, last = moved(rim, rate, torque, DT)
    assert moved(rim, -rate, -torque, DT) == (-angle, -last)


@given(rims, rates, torques)
def test_two_half_steps_are_one_step(rim: Rim, rate: float, torque: float) -> None:
    angle, last = moved(rim, rate, torque, 0.1)
    first, between = moved(rim, rate, torque, 0.05)
    second, end = moved(rim, between, torque, 0.05)
    # Exact solutions: rounding only, of rates up to 20 rad/s and 500 rad/s².
    assert first + second == pytest.approx(angle, abs=1e-9)
    assert end == pytest.approx(last, abs=1e-9)


@given(rims, rates)
@example(Rim(0.125, 0.0, 1e-45), 2e-309)  # their product is no number above zero
def test_a_rim_that_is_left_alone_loses_energy(rim: Rim, rate: float) -> None:
    _, last = moved(rim, rate, 0.0, DT)
    assert abs(last) <= abs(rate)
    assert last * rate >= 0.0


def test_a_rim_pushed_back_stops_and_returns_within_a_step() -> None:
    rim = Rim(inertia=0.05, damping=0.0, friction=0.3)
    angle, rate = moved(rim, 1.0, -1.3, 0.1)
    # Slows at 32 rad/s² for 1/32 s, then -20 rad/s² for the rest.
    rest = 0.1 - 1.0 / 32.0
    assert rate == pytest.approx(-20.0 * rest, rel=1e-12)
    assert angle == pytest.approx(1.0 / 64.0 - 10.0 * rest**2, rel=1e-12)
