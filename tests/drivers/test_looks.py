"""Looks before a lane change: when they come, how far, in which order, and forgotten.

Many drivers make up their minds at once, each with draws of its own; arrays go through
the same functions as numbers do.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.drivers import decision, gaze
from costeer.drivers.decision import (
    CHANGING,
    CRUISING,
    PREPARING,
    DecisionParameters,
    DecisionState,
)
from costeer.drivers.gaze import GazeDraws, GazeParameters, GazeState, Looks
from tests.drivers.samples import DT

HEAD = GazeParameters(drift_deviation=0.0)
MIND = DecisionParameters()
NUM_DRIVERS = 2000
CRUISE_STEPS = 120
"""Two seconds before the decision, in which glances may begin by themselves."""
NO_DRAW = GazeDraws(
    start_uniform=1.0, side_uniform=0.0, amplitude_normal=0.0, drift_normal=0.0
)


class Heads(NamedTuple):
    """What the heads do at each step, shape `(time, driver)`.

    Attributes:
        yaw: Head yaw [-].
        begins: Whether a glance begins.
        amplitude: Of the last glance [-].
        shoulder: Whether a look over the shoulder was due before and is no longer.
        mirror: The same of a look to the mirror.
        looks: Whether the driver looks before this change, shape `(driver,)`.
        over_shoulder: Whether over the shoulder too, shape `(driver,)`.
        busy: Whether a glance was under way at the decision, shape `(driver,)`.
    """

    yaw: NDArray[np.float64]
    begins: NDArray[np.bool_]
    amplitude: NDArray[np.float64]
    shoulder: NDArray[np.bool_]
    mirror: NDArray[np.bool_]
    looks: NDArray[np.bool_]
    over_shoulder: NDArray[np.bool_]
    busy: NDArray[np.bool_]


def planned(step: int, preparation: float, drawn: NDArray[np.float64]) -> DecisionState:
    """A change of 7.2 s decided after `CRUISE_STEPS`, with looks as drawn."""
    since = (step - CRUISE_STEPS) * DT
    prepares = since < preparation
    changing = PREPARING if prepares else CHANGING
    return decision.initial_state()._replace(
        phase=CRUISING if since < -DT / 2.0 else changing,
        time_in_phase=max(since if prepares else since - preparation, 0.0),
        preparation_time=preparation,
        change_duration=MIND.change_duration,
        looks=drawn < MIND.glance_share,
        looks_over_shoulder=drawn < MIND.shoulder_share,
        decided=step == CRUISE_STEPS,
    )


def drawn_glances(generator: np.random.Generator) -> GazeDraws:
    return GazeDraws(
        start_uniform=generator.random(NUM_DRIVERS),
        side_uniform=generator.random(NUM_DRIVERS),
        amplitude_normal=generator.standard_normal(NUM_DRIVERS),
        drift_normal=np.zeros(NUM_DRIVERS),
    )


@cache
def heads(preparation: float = 1.8, false_rate: float = 0.5) -> Heads:
    """Drivers who glance around a lot, then decide to change lanes, all to the left."""
    generator = np.random.default_rng(11)
    wild = HEAD._replace(false_rate=false_rate)
    drawn = generator.random(NUM_DRIVERS)
    state, before = gaze.initial_state(), gaze.initial_state()
    steps: dict[str, list[NDArray[np.float64]]] = {
        name: [] for name in ("yaw", "begins", "amplitude", "shoulder", "mirror")
    }
    busy = np.zeros(NUM_DRIVERS, bool)
    for k in range(CRUISE_STEPS + round(9.0 / DT)):
        mind = planned(k, preparation, drawn)
        direction = 0.0 if mind.phase == CRUISING else 1.0
        draws = drawn_glances(generator)
        before, state = state, gaze.step(wild, state, mind, direction, draws, DT)
        waiting = gaze.due(before, mind)
        if mind.decided:
            over = np.asarray(before.time_in_glance) + DT >= wild.duration
            busy = np.asarray(before.glancing) & ~over
        found = {
            "yaw": gaze.head_yaw(wild, state),
            "begins": state.glancing & (np.asarray(state.time_in_glance) == 0.0),
            "amplitude": state.amplitude,
            "shoulder": np.asarray(waiting.shoulder) & ~np.asarray(state.shoulder_due),
            "mirror": np.asarray(waiting.mirror) & ~np.asarray(state.mirror_due),
        }
        for name, value in found.items():
            steps[name].append(np.broadcast_to(value, (NUM_DRIVERS,)))
    looks, shoulder = drawn < MIND.glance_share, drawn < MIND.shoulder_share
    return Heads(*map(np.array, steps.values()), looks, shoulder, busy)


def first(flags: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Seconds from the decision to the first true, infinite without one."""
    after = flags[CRUISE_STEPS:]
    return np.where(after.any(axis=0), after.argmax(axis=0) * DT, math.inf)


@pytest.mark.parametrize(
    "preparation",
    [0.1, *(pytest.param(t, marks=pytest.mark.slow) for t in (0.35, 1.8))],
)
def test_a_head_never_jumps(preparation: float) -> None:
    # A raised cosine climbs at most π/2 amplitudes in its turning time.
    found = heads(preparation)
    steepest = math.pi / 2.0 / HEAD.turning_time * DT
    largest = np.maximum(found.amplitude[1:], found.amplitude[:-1])
    assert (np.abs(np.diff(found.yaw, axis=0)) <= steepest * largest + 1e-12).all()
    assert np.count_nonzero(found.busy) > 100  # many decisions fell during a glance


def test_a_look_that_is_due_waits_for_the_glance_under_way() -> None:
    found = heads()
    waits = first(found.mirror)
    free, busy = found.looks & ~found.busy, found.looks & found.busy
    assert (waits[free] == 0.0).all()
    assert (waits[busy] > 0.0).all()
    assert (waits[busy] <= HEAD.duration + DT).all()
    assert np.ptp(waits[busy]) > 0.5  # at whatever time of the glance


@pytest.mark.parametrize(
    "preparation", [0.1, pytest.param(0.35, marks=pytest.mark.slow), 1.8]
)
def test_glances_never_overlap(preparation: float) -> None:
    begins = heads(preparation).begins
    for one in begins.T:
        times = np.flatnonzero(one) * DT
        # The step at which a glance ends is the first at which another may begin.
        assert (np.diff(times) >= HEAD.duration - DT / 2.0).all()


def test_share_of_changes_without_any_look_is_16_percent() -> None:
    found = heads()
    after = found.begins[CRUISE_STEPS : CRUISE_STEPS + round(1.8 / DT)].any(axis=0)
    assert (after == found.looks).all()
    # Binomial: four standard deviations of 2000 decisions.
    allowed = 4.0 * math.sqrt(0.84 * 0.16 / NUM_DRIVERS)
    assert np.mean(~after) == pytest.approx(0.16, abs=allowed)


def test_the_mirror_comes_first_and_the_shoulder_before_steering() -> None:
    found = heads(false_rate=0.0)
    mirror, shoulder = first(found.mirror), first(found.shoulder)
    both = found.over_shoulder
    assert (mirror[both] < shoulder[both]).all()
    assert (shoulder[~both] == math.inf).all()
    # 0.8 s before steering at 1.8 s, or when glances by itself leave the head free.
    planned_at = 1.8 - HEAD.shoulder_lead
    assert shoulder[both].min() >= planned_at - DT
    after_mirror = HEAD.duration
    usual = max(planned_at, after_mirror)
    assert np.median(shoulder[both]) == pytest.approx(usual, abs=2.0 * DT)


def test_a_hurried_change_still_has_both_looks_before_the_line() -> None:
    # Steering starts 0.1 s after the decision: the look over the shoulder follows
    # the one to the mirror, in the first second of the change.
    found = heads(preparation=0.1, false_rate=0.0)
    both = found.over_shoulder
    shoulder = first(found.shoulder)[both]
    assert (first(found.mirror)[both] == 0.0).all()
    assert np.median(shoulder) == pytest.approx(HEAD.duration, abs=2.0 * DT)
    assert (shoulder < 0.1 + 0.4 * MIND.change_duration + DT).all()


def test_a_look_over_the_shoulder_is_larger_by_its_ratio() -> None:
    found = heads(false_rate=0.0)
    sizes = found.amplitude[CRUISE_STEPS:]
    shoulder = sizes[found.shoulder[CRUISE_STEPS:] & found.begins[CRUISE_STEPS:]]
    mirror = sizes[found.mirror[CRUISE_STEPS:] & found.begins[CRUISE_STEPS:]]
    assert shoulder.size > 400 < mirror.size
    # Medians of log-normal draws: 1.25 · 0.2 / sqrt(n) each, four times that.
    ratio = float(np.median(shoulder) / np.median(mirror))
    allowed = 4.0 * 1.25 * 0.2 * math.sqrt(1.0 / shoulder.size + 1.0 / mirror.size)
    assert math.log(ratio / HEAD.shoulder_ratio) == pytest.approx(0.0, abs=allowed)


def late(state: GazeState, time_in_phase: float) -> GazeState:
    """One step later, so long after steering started for a change of 6 s."""
    mind = decision.initial_state()._replace(
        phase=CHANGING, time_in_phase=time_in_phase, change_duration=6.0, looks=True
    )
    return gaze.step(HEAD, state, mind, 1.0, NO_DRAW, DT)


def test_looks_that_are_due_are_dropped_at_the_line() -> None:
    # The head is busy for another second while the change goes on.
    waiting = gaze.initial_state()._replace(
        glancing=True, amplitude=0.3, mirror_due=True, shoulder_due=True
    )
    before, after = late(waiting, 2.0), late(waiting, 2.5)
    assert before.mirror_due
    assert before.shoulder_due
    assert not after.mirror_due
    assert not after.shoulder_due
    for _ in range(round(3.0 / DT)):
        after = late(after, 2.5)
        assert not after.glancing or after.time_in_glance > 0.0


def test_nothing_begins_while_the_head_is_not_free() -> None:
    mind = decision.initial_state()._replace(phase=PREPARING, preparation_time=0.1)
    both = Looks(mirror=True, shoulder=True)
    assert gaze.begin(HEAD, both, mind, False) == Looks(False, False)
    assert gaze.begin(HEAD, both, mind, True) == Looks(True, False)
    alone = Looks(mirror=False, shoulder=True)
    assert gaze.begin(HEAD, alone, mind, True) == Looks(False, True)


def test_a_look_goes_to_the_side_of_the_change_and_mirrors() -> None:
    for side in (-1.0, 1.0):
        mind = decision.initial_state()._replace(
            phase=PREPARING, looks=True, decided=True
        )
        state = gaze.step(HEAD, gaze.initial_state(), mind, side, NO_DRAW, DT)
        assert state.side == side
        half_way = state._replace(time_in_glance=HEAD.duration / 2.0)
        assert gaze.head_yaw(HEAD, half_way) == side * HEAD.amplitude
