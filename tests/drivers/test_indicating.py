"""Drivers signal late: half of them at the onset, nine of ten within 1.75 s."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.drivers import decision
from costeer.drivers.decision import NEVER
from costeer.drivers.indicating import (
    IndicatorParameters,
    drawn_delay,
    initial_state,
    step,
)
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial

UNIFORM = (np.arange(10_000) + 0.5) / 10_000
DT = 1.0 / 60.0
DECIDED = decision.initial_state()._replace(change_duration=5.0)


def delays(parameters: IndicatorParameters) -> np.ndarray:
    return np.array([drawn_delay(parameters, float(u)) for u in UNIFORM])


def test_half_signal_at_the_onset_and_nine_of_ten_within_the_published_time() -> None:
    found = delays(IndicatorParameters())
    assert np.mean(found <= 0.0) == pytest.approx(0.5, abs=1e-3)
    assert np.mean(found <= 1.75) == pytest.approx(0.9, abs=1e-3)
    assert np.all(np.diff(found) >= 0.0)


def test_the_profile_of_real_roads() -> None:
    # 60 % before, 33 % after, 7 % never: of those that signal 60 / 93 are on in time.
    roads = IndicatorParameters(at_onset=60 / 93, never_share=0.07)
    found = delays(roads)
    assert np.mean(found >= NEVER) == pytest.approx(0.07, abs=1e-3)
    assert np.mean(found <= 0.0) == pytest.approx(0.60, abs=1e-3)


def test_it_comes_on_after_the_delay_and_goes_off_with_the_lane_change() -> None:
    parameters, state, sides = IndicatorParameters(), initial_state(), []
    uniform = 0.9  # 90 % are on after 1.75 s
    for k in range(400):
        decided = DECIDED._replace(started=k == 10)
        side = 1.0 if k >= 10 else 0.0
        state = step(parameters, state, decided, side, uniform, DT)
        sides.append(state.side)
    on = np.flatnonzero(np.array(sides))
    assert (on[0] - 10) * DT == pytest.approx(1.75, abs=1.01 * DT)
    assert (on[-1] - 10) * DT == pytest.approx(5.0, abs=1.01 * DT)
    assert set(sides) == {0.0, 1.0}


def test_a_driven_lane_change_is_signalled_to_its_side() -> None:
    record = simulate_trial(TrialSetup(intention="off", length=1800.0))
    indicator = record.columns["driver_indicator"]
    intention = np.ma.filled(record.columns["driver_intention"], 0)
    assert indicator.any()
    lit = indicator != 0
    assert np.array_equal(indicator[lit], intention[lit])
