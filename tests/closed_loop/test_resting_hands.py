"""Guidance that has faded comes back when nobody pushes: it never locks itself out."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from costeer.base.described import with_value_at
from costeer.controller.signals import Request
from costeer.controller.step import ControllerState
from costeer.drivers.arm import ArmParameters
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.rollout import begun
from costeer.loop.rows import rules_of
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.step import LoopState, initial_state
from costeer.loop.tick import INTENTION_OFF, Script
from costeer.loop.trial import idle_network
from costeer.methods.ibhs import IBHS
from costeer.plant.parameters import CARS
from costeer.records.row import ROW_COLUMNS
from costeer.sensing.measurement import standing_start
from costeer.validation.driver_loop import quiet

GAIN = ROW_COLUMNS.index("haptic_gain")
PLACE = ROW_COLUMNS.index("lateral_position")
CENTRES = np.array([0.0, -3.5])

NONE = ArmParameters(hands_on=0.0)
RESTING = ArmParameters(holding_gain=0.0, stiffness=0.0)
"""Arms that weigh and damp, and pull nowhere."""

Rows = Any


def parameters(car: str, speed: float, arms: ArmParameters) -> LoopParameters[Any]:
    setup = TrialSetup(
        condition="strong-normal",
        car=car,
        speed=speed / 3.6,
        driver="hands-off",
        intention="off",
        events=False,
    )
    usual = loop_parameters(setup)
    # No barrier near the road: asked is when the gain comes back, wherever the car is.
    usual = usual._replace(road=usual.road._replace(shoulder=50.0))
    if arms == NONE:
        return usual
    return usual._replace(driver=usual.driver._replace(arm=arms))


def faded(state: ControllerState, gain: float) -> ControllerState:
    """The controller in the middle of a conflict, the gain at `gain`."""
    fade = state.strength._replace(
        consistent=False, time_in_verdict=5.0, gain_at_switch=gain, gain=gain
    )
    verdict = state.consistency._replace(consistent=False, time_in_verdict=5.0)
    return state._replace(strength=fade, consistency=verdict)


def start(
    given: LoopParameters[Any], offset: float, yaw: float, gain: float
) -> LoopState[ControllerState]:
    state = initial_state(rules_of(IBHS), given)
    car = state.world.vehicle._replace(lateral_position=offset, yaw_angle=yaw)
    control = state.control._replace(method=faded(state.control.method, gain))
    return state._replace(world=state.world._replace(vehicle=car), control=control)


def ten_seconds(
    driven: LoopParameters[Any], offset: float, yaw: float, gain: float = 0.0
) -> Rows:
    begin = start(driven, offset, math.radians(yaw), gain)
    rows = np.empty((600, len(ROW_COLUMNS)))
    advance = begun(IBHS, driven, idle_network(), "numba", begin)
    count = advance(Script(INTENTION_OFF, 3.0, np.empty(0)), quiet(600), rows)
    return rows[:count]


@settings(max_examples=15)
@pytest.mark.parametrize("arms", [NONE, RESTING], ids=["none", "resting"])
@pytest.mark.parametrize("car", CARS)
@given(
    speed=st.floats(50.0, 110.0),
    offset=st.floats(-5.1, 1.6),
    yaw=st.floats(-4.0, 4.0),
    gain=st.floats(0.0, 1.0),
)
def test_from_anywhere_on_the_road_the_gain_is_back_and_the_car_in_a_lane(
    car: str, arms: ArmParameters, speed: float, offset: float, yaw: float, gain: float
) -> None:
    rows = ten_seconds(parameters(car, speed, arms), offset, yaw, gain)
    assert (rows[round(3.0 / DT) :, GAIN] > 0.95).all()
    assert apart_after_8_s(rows) < 0.3


def apart_after_8_s(rows: Rows) -> float:
    """Farthest from a lane's centre then [m]."""
    return np.abs(rows[round(8.0 / DT) :, PLACE, None] - CENTRES).min(axis=1).max()


def time_back(rows: Rows) -> float:
    """From when on the gain stays above 0.95 [s]."""
    low = np.flatnonzero(rows[:, GAIN] <= 0.95)
    return (low[-1] + 1) * DT if low.size else 0.0


def test_with_a_constant_gain_resting_hands_would_leave_the_lane() -> None:
    driven = parameters("large", 110.0, RESTING)
    assert apart_after_8_s(ten_seconds(driven, -1.6, -4.0)) < 0.3
    place = "guidance.steering_gain_speed"
    constant = with_value_at(driven.controller, place, 1000.0)
    driven = driven._replace(controller=constant)
    assert apart_after_8_s(ten_seconds(driven, -1.6, -4.0)) > 0.6


@pytest.mark.slow
@pytest.mark.parametrize("car", CARS)
def test_starts_all_over_the_road_are_told(car: str) -> None:
    """`pytest tests/closed_loop/test_resting_hands.py -m slow -rP` prints them."""
    found = []
    for speed, arms in itertools.product((50.0, 70.0, 90.0, 110.0), (NONE, RESTING)):
        driven = parameters(car, speed, arms)
        method = with_value_at(driven.controller, "hands.inertia", 0.0)
        deaf = driven._replace(controller=with_value_at(method, "hands.damping", 0.0))
        for offset in np.linspace(-5.1, 1.6, 10):
            for yaw in (-4.0, -2.0, 0.0, 2.0, 4.0):
                rows = ten_seconds(driven, offset, yaw)
                other = time_back(ten_seconds(deaf, offset, yaw))
                found.append((time_back(rows), apart_after_8_s(rows), other))
    back, apart, deaf_back = np.max(found, axis=0)
    print(
        f"{car}: {len(found)} starts, gain back after {back:.2f} s, {apart:.2f} m from "
        f"a lane's centre; were relaxed arms not known, after {deaf_back:.2f} s"
    )
    assert back < 3.0
    assert apart < 0.3
    assert deaf_back > 3.0  # so it is needed


@pytest.mark.parametrize(
    ("threshold", "comes_back"), [(0.1, True), (0.0, False)], ids=["ours", "printed"]
)
def test_hands_that_only_weigh_on_the_wheel_do_not_keep_the_gain_at_zero(
    threshold: float, comes_back: bool
) -> None:
    # The wheel at rest, the car beside the road, the hands pull by 0.015 N·m: what was
    # seen 92 m beside the road, where the gain stayed under 0.02 for ever.
    driven = parameters("default", 70.0, RESTING)
    method = with_value_at(
        driven.controller, "consistency.hands_on_threshold", threshold
    )
    state = faded(initial_state(rules_of(IBHS), driven).control.method, 0.0)
    astray = standing_start(driven.road)._replace(
        lateral_position=-92.0, yaw_rate=0.01, driver_torque=-0.015
    )
    gains = []
    for _ in range(round(3.0 / DT)):
        state, said = IBHS.step(method, state, astray, Request(), DT)
        gains.append(float(said.haptic_gain))
    assert (gains[-1] > 0.95) is comes_back
