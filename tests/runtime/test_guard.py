"""Whatever the wheel is asked for, what it gives is bounded, smooth and can end."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.runtime.guard import GuardParameters, GuardState, step

DT = 1.0 / 960.0
PARAMETERS = GuardParameters()
ANYTHING = st.floats(allow_nan=True, allow_infinity=True)
DRIVES = st.lists(st.tuples(ANYTHING, st.booleans(), st.booleans()), max_size=60)


def given_over(drive: list[tuple[float, bool, bool]]) -> list[GuardState]:
    state, states = GuardState(), [GuardState()]
    for wanted, engaged, fault in drive:
        state, torque = step(PARAMETERS, state, wanted, engaged, fault, DT)
        assert torque == state.torque
        states.append(state)
    return states


def held(torque: float = 6.0) -> GuardState:
    """A wheel that has given a torque for long."""
    state = GuardState()
    for _ in range(2000):
        state, _ = step(PARAMETERS, state, torque, True, False, DT)
    return state


@given(DRIVES)
def test_torque_is_never_above_the_limit_and_never_jumps(
    drive: list[tuple[float, bool, bool]],
) -> None:
    states = given_over(drive)
    fastest = max(
        PARAMETERS.torque_rate_limit, PARAMETERS.torque_limit / PARAMETERS.fault_time
    )
    for before, after in itertools.pairwise(states):
        assert abs(after.torque) <= PARAMETERS.torque_limit
        assert abs(after.torque - before.torque) <= fastest * DT * (1 + 1e-9)
        assert 0.0 <= after.fade <= 1.0


@given(DRIVES)
def test_mirrored_request_gives_mirrored_torque(
    drive: list[tuple[float, bool, bool]],
) -> None:
    mirrored = [(-wanted, engaged, fault) for wanted, engaged, fault in drive]
    there = [state.torque for state in given_over(mirrored)]
    assert there == [-state.torque for state in given_over(drive)]


@pytest.mark.parametrize("wanted", [math.nan, math.inf, -math.inf])
def test_torque_that_is_not_finite_ends_all_within_the_fault_time(
    wanted: float,
) -> None:
    state = held()
    for _ in range(math.ceil(PARAMETERS.fault_time / DT)):
        state, _ = step(PARAMETERS, state, wanted, True, False, DT)
    assert state == GuardState(torque=0.0, fade=0.0)


def test_fault_ends_all_within_the_fault_time_although_torque_is_wanted() -> None:
    state = held(-100.0)
    for _ in range(math.ceil(PARAMETERS.fault_time / DT)):
        state, _ = step(PARAMETERS, state, -100.0, True, True, DT)
    assert state.torque == 0.0


def test_start_fades_in_and_stop_fades_out_in_their_times() -> None:
    state, fades = GuardState(), []
    for k in range(int(1.5 / DT)):
        state, _ = step(PARAMETERS, state, 1.0, True, False, DT)
        fades.append(state.fade)
        if k == int(0.5 / DT):
            assert state.torque == pytest.approx(0.5, abs=0.01)  # linear
    assert state.torque == 1.0
    for _ in range(math.ceil(PARAMETERS.fade_out / DT)):
        state, _ = step(PARAMETERS, state, 1.0, False, False, DT)
    assert state.torque == pytest.approx(0.0, abs=0.01)
    assert fades == sorted(fades)


def test_after_a_fault_the_torque_fades_in_anew() -> None:
    state, _ = step(PARAMETERS, held(), 6.0, True, True, DT)
    state, torque = step(PARAMETERS, state, 6.0, True, False, DT)
    assert state.fade == pytest.approx(DT / PARAMETERS.fade_in)
    # From what is left of the torque towards a thousandth of what is wanted.
    assert 0.0 < torque < 6.0


def test_torque_that_is_asked_to_turn_round_does_so_at_its_rate() -> None:
    state, torques = held(6.0), [6.0]
    for _ in range(100):
        state, torque = step(PARAMETERS, state, -6.0, True, False, DT)
        torques.append(torque)
    steps = [before - after for before, after in itertools.pairwise(torques)]
    assert max(steps) == pytest.approx(PARAMETERS.torque_rate_limit * DT)
    assert torques[-1] == -6.0


@pytest.mark.parametrize("wanted", [100.0, -100.0])
def test_what_is_over_the_limit_is_cut_before_it_fades_in(wanted: float) -> None:
    # Half of the limit at half of the fade, not half of whatever was asked for.
    state = GuardState()
    for _ in range(round(PARAMETERS.fade_in / 2.0 / DT)):
        state, torque = step(PARAMETERS, state, wanted, True, False, DT)
    assert torque == pytest.approx(math.copysign(4.0, wanted), abs=0.01)
