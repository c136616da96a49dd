"""A system that follows the driver's plan changes lanes when and as long as they do."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.base.bezier import Quintic, path_point
from costeer.controller.step import ControllerParameters
from costeer.drivers.interface import DriverNoise
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.rows import rules_of
from costeer.loop.scenario import PILOT_SEED, TrialSetup, loop_parameters
from costeer.loop.step import initial_state
from costeer.loop.tick import INTENTION_SCRIPTED, Script, tick
from costeer.loop.trial import idle_network
from costeer.methods.ibhs import IBHS

RULES = rules_of(IBHS)
METHODS_DURATION = 5.0
WHO = (1, pytest.param(2, marks=pytest.mark.slow))
FIRST_CHANGE, BOTH_CHANGES = 12.0, 30.0
"""Until the end of a change [s]."""
FOLLOWERS = pytest.mark.parametrize(
    ("participant", "until"),
    [
        (1, FIRST_CHANGE),
        *(pytest.param(n, BOTH_CHANGES, marks=pytest.mark.slow) for n in (1, 2)),
    ],
)


class Change(NamedTuple):
    """A lane change as it was planned.

    Attributes:
        time: When it began [s].
        duration: That was planned [s].
        path: From there.
    """

    time: float
    duration: float
    path: Quintic


class Changes(NamedTuple):
    """Of the driver and of the system, and the durations that the driver drew [s]."""

    driver: list[Change]
    system: list[Change]
    drawn: list[float]


def setup(participant: int) -> TrialSetup:
    """A pilot driver with weak guidance."""
    return TrialSetup(
        participant=participant,
        seed=PILOT_SEED,
        condition="pilot",
        strength_factor=0.4,
        change_duration=METHODS_DURATION,
        intention="scripted",
    )


def parameters_of(
    participant: int, follows_plan: float
) -> LoopParameters[ControllerParameters]:
    """Their trial with one leader, early."""
    usual = loop_parameters(setup(participant))
    early = usual.traffic._replace(
        first_event=20.0, appearance_distance=50.0, num_events=1.0
    )
    return usual._replace(traffic=early, follows_plan=follows_plan)


@cache
def changes(
    participant: int, follows_plan: float, until: float = BOTH_CHANGES
) -> Changes:
    """Half a minute: over to the other lane and back; or less."""
    parameters = parameters_of(participant, follows_plan)
    state = initial_state(RULES, parameters)
    script = Script(INTENTION_SCRIPTED, 3.0, np.zeros(0))
    network = idle_network()
    found = Changes([], [], [])
    for draws in driver_noise(PILOT_SEED, participant, "pilot", round(until / DT)):
        before, noise = state, DriverNoise(*draws.tolist())
        state, sample = tick(RULES, parameters, state, script, network, noise)
        own, system = state.driver.tracking.path, state.control.method.trajectory.path
        speed = sample.measurement.longitudinal_velocity
        if own != before.driver.tracking.path:
            found.driver.append(Change(before.control.time, own.length / speed, own))
            found.drawn.append(state.driver.decision.change_duration)
        if system != before.control.method.trajectory.path:
            found.system.append(
                Change(before.control.time, system.length / speed, system)
            )
    return found


@pytest.mark.slow
@pytest.mark.parametrize("participant", WHO)
def test_every_change_of_a_following_system_lasts_as_the_driver_planned(
    participant: int,
) -> None:
    found = changes(participant, follows_plan=1.0)
    assert len(found.driver) == 2
    planned = [change.duration for change in found.driver]
    assert planned == pytest.approx(found.drawn, rel=1e-12)
    assert [c.duration for c in found.system] == pytest.approx(planned, rel=1e-12)
    assert abs(planned[0] - planned[1]) > 0.1  # drawn anew for each
    assert all(abs(duration - METHODS_DURATION) > 0.1 for duration in planned)


@FOLLOWERS
def test_a_following_system_begins_with_the_driver(
    participant: int, until: float
) -> None:
    # The trigger takes three positives in a row, the first where steering is due.
    found = changes(participant, 1.0, until)
    assert found.system
    for own, system in zip(found.driver, found.system, strict=True):
        assert 0.0 < system.time - own.time <= 3.0 * DT + 1e-9


def positions(path: Quintic, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Lateral position of a path at places along the road [m]."""
    found = [path_point(path, place).lateral_position for place in places.tolist()]
    return np.array(found)


@FOLLOWERS
def test_paths_of_driver_and_following_system_are_one(
    participant: int, until: float
) -> None:
    # They begin 0.05 s apart at the most and end beside each other by what the
    # driver prefers: at 1.1 m/s of lateral speed that is 6 cm and the bias.
    bias = parameters_of(participant, 1.0).driver.tracking.lane_bias
    found = changes(participant, 1.0, until)
    assert found.system
    for own, system in zip(found.driver, found.system, strict=True):
        places = own.path.start + np.linspace(0.0, own.path.length, 50)
        apart = positions(own.path, places) - positions(system.path, places)
        assert np.abs(apart).max() < abs(bias) + 0.06


@pytest.mark.slow
@pytest.mark.parametrize("participant", WHO)
def test_otherwise_changes_last_as_the_method_says(participant: int) -> None:
    found = changes(participant, follows_plan=0.0)
    durations = [change.duration for change in found.system]
    assert len(durations) >= 2
    assert durations == pytest.approx([METHODS_DURATION] * len(durations), rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("participant", WHO)
def test_otherwise_a_change_begins_at_the_horizon(participant: int) -> None:
    # The first one: 3 s before the driver's own crossing, half the duration after
    # steering starts; the trigger takes three samples.
    found = changes(participant, follows_plan=0.0)
    crossing = found.driver[0].time + found.drawn[0] / 2.0
    assert crossing - found.system[0].time == pytest.approx(3.0, abs=4.0 * DT)


@pytest.mark.parametrize("participant", WHO)
def test_trials_do_not_follow_the_plan(participant: int) -> None:
    assert loop_parameters(setup(participant)).follows_plan == 0.0
