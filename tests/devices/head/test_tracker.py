"""What is believed of the angles that pictures give, without pictures."""

from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from costeer.devices.head.face import Region
from costeer.devices.head.tracker import (
    NO_FACE,
    Sight,
    TrackerParameters,
    TrackerState,
    initial_state,
    judge,
)

PARAMETERS = TrackerParameters()
FRAME = 1.0 / 30.0
HERE = Region(x=320.0, y=240.0, size=200.0, angle=0.0)


def seen(yaw_deg: float) -> Sight:
    return Sight(HERE, math.radians(yaw_deg))


def at(yaw_deg: float) -> TrackerState:
    """A face that was seen in the last picture."""
    return judge(PARAMETERS, initial_state(), seen(yaw_deg), FRAME)


def test_nothing_is_valid_before_a_face_is_seen() -> None:
    state = judge(PARAMETERS, initial_state(), NO_FACE, FRAME)
    assert not state.valid
    assert state.head_yaw == 0.0


@given(yaw_deg=st.floats(-50.0, 50.0))
def test_the_first_face_is_believed_at_any_angle_in_range(yaw_deg: float) -> None:
    state = judge(PARAMETERS, initial_state(), seen(yaw_deg * 0.999), FRAME)
    assert state.valid
    assert state.head_yaw == math.radians(yaw_deg * 0.999)


@given(start=st.floats(-30.0, 30.0), leap=st.floats(15.1, 100.0))
def test_a_leap_of_more_than_15_degrees_is_refused(start: float, leap: float) -> None:
    before = at(start)
    for side in (-1.0, 1.0):
        after = judge(PARAMETERS, before, seen(start + side * leap), FRAME)
        assert not after.valid
        assert after.head_yaw == before.head_yaw
        assert after.region is None  # looked for anew: it may be another face


def test_a_quick_but_human_turn_is_believed() -> None:
    state = at(0.0)
    for yaw_deg in (14.0, 28.0, 42.0):
        state = judge(PARAMETERS, state, seen(yaw_deg), FRAME)
        assert state.valid


def test_after_a_gap_a_head_may_be_elsewhere() -> None:
    state = at(-30.0)
    for _ in range(5):
        state = judge(PARAMETERS, state, NO_FACE, FRAME)
        assert state.head_yaw == math.radians(-30.0)
        assert not state.valid
    # 450 deg/s over six pictures is 90 deg.
    assert judge(PARAMETERS, state, seen(30.0), FRAME).valid


def test_beyond_the_range_the_last_angle_is_held_and_the_face_followed() -> None:
    state = judge(PARAMETERS, at(48.0), seen(52.0), FRAME)
    assert not state.valid
    assert state.head_yaw == math.radians(48.0)
    assert state.region == HERE
    assert judge(PARAMETERS, state, seen(45.0), FRAME).valid


def test_a_yaw_that_is_not_a_number_is_not_believed() -> None:
    state = judge(PARAMETERS, at(10.0), Sight(HERE, math.nan), FRAME)
    assert not state.valid
    assert state.head_yaw == math.radians(10.0)
