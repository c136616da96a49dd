"""A lane change that the driver does not want is resisted."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.controller.consistency import ConsistencyParameters
from costeer.loop.parameters import DT
from costeer.loop.scenario import PILOT_SEED, TrialSetup, loop_parameters
from costeer.loop.trial import simulate_trial
from costeer.validation.resistance import (
    QUANTITIES,
    SYSTEMS,
    TRIGGER_TIMES,
    Resistance,
    answer,
    resist,
    resistance_rows,
    time_to_overrule,
    wrong_change,
)

TIME = np.arange(600) * DT


@cache
def trio() -> dict[tuple[float, str], Resistance]:
    return {(r.change_duration, r.system): r for r in resist(PILOT_SEED, 3)}


def made_up(**columns: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Ten seconds from a trigger at 0 s in which nothing happens, but for these."""
    quiet = {
        name: np.zeros(600)
        for name in ("lateral_position", "driver_torque", "applied_torque")
    }
    return {**quiet, "haptic_gain": np.ones(600), **columns}


def setup_at_zero() -> TrialSetup:
    return wrong_change(1, 1, 6.0, "fades out", 0)._replace(trigger_times=(0.0,))


def test_both_systems_meet_the_same_driver_with_the_same_noise() -> None:
    real, other = (wrong_change(PILOT_SEED, 4, 6.0, s, 1) for s in SYSTEMS)
    assert other._replace(parameters=real.parameters) == real
    thresholds = [
        loop_parameters(setup).controller.consistency.inconsistency_threshold
        for setup in (real, other)
    ]
    assert thresholds == [ConsistencyParameters().inconsistency_threshold, 100.0]
    before = round(real.trigger_times[0] / DT)
    ways = [simulate_trial(s).columns["lateral_position"] for s in (real, other)]
    assert (ways[0][:before] == ways[1][:before]).all()
    assert (ways[0][before : before + 300] != ways[1][before : before + 300]).any()


def test_trials_of_a_driver_have_other_noise_and_another_trigger() -> None:
    setups = [wrong_change(1, 1, 4.0, "fades out", k) for k in range(4)]
    assert len({setup.condition for setup in setups}) == 4
    assert tuple(t for setup in setups for t in setup.trigger_times) == TRIGGER_TIMES
    assert not any(setup.events for setup in setups)


def test_a_trial_lasts_as_long_as_the_driver_is_looked_at() -> None:
    for number in range(1, 9):
        setup = wrong_change(PILOT_SEED, number, 8.0, "never yields", 3)
        time = simulate_trial(setup).columns["time"]
        assert time[-1] >= setup.trigger_times[0] + 8.0 + 4.0


@pytest.mark.slow
def test_every_driver_overrules_both_systems() -> None:
    for found in trio().values():
        assert (found.overruled == 1.0).all()
        assert (found.time_to_overrule < 4.0).all()


@pytest.mark.slow
def test_the_real_system_fades_out_and_the_other_does_not() -> None:
    for duration in (4.0, 6.0, 8.0):
        real, other = (trio()[duration, system] for system in SYSTEMS)
        assert (real.least_gain < 0.2).all()
        assert (other.least_gain > 0.99).all()
        assert np.isnan(other.fading_time).all()


@pytest.mark.slow
def test_a_system_that_yields_is_overruled_with_less_torque_and_way() -> None:
    for duration in (4.0, 6.0, 8.0):
        real, other = (trio()[duration, system] for system in SYSTEMS)
        assert (real.peak_torque < other.peak_torque).all()
        assert (real.deviation < other.deviation).all()


@pytest.mark.slow
def test_a_faster_change_takes_more_torque() -> None:
    peaks = [trio()[duration, "fades out"].peak_torque for duration in (4.0, 6.0)]
    assert (peaks[0] > peaks[1]).all()


def test_nobody_at_the_wheel_is_taken_to_the_other_lane() -> None:
    setup = wrong_change(PILOT_SEED, 1, 6.0, "fades out", 0)
    setup = setup._replace(driver="hands-off")
    found = answer(simulate_trial(setup).columns, setup)
    assert found["deviation"] == pytest.approx(3.5, abs=0.2)  # overshoot 0.1 m at most
    assert found["crossed_line"] == 1.0
    assert found["overruled"] == 0.0
    assert math.isnan(found["time_to_overrule"])
    assert found["peak_torque"] == 0.0


def test_the_deviation_is_to_the_right_from_the_place_at_the_trigger() -> None:
    position = 0.3 + np.where(TIME < 3.0, -0.2 * TIME, 0.4)
    found = answer(made_up(lateral_position=position), setup_at_zero())
    assert found["deviation"] == pytest.approx(0.6, abs=0.2 * DT)
    assert found["crossed_line"] == 0.0
    found = answer(made_up(lateral_position=position - 0.6), setup_at_zero())
    assert found["crossed_line"] == 1.0  # -0.9 m, the line is reached at -0.85 m


def test_the_gain_is_timed_from_the_trigger() -> None:
    gain = np.where(TIME < 2.5, 1.0, 0.04)
    found = answer(made_up(haptic_gain=gain), setup_at_zero())
    assert found["fading_time"] == pytest.approx(2.5, abs=DT)
    assert found["least_gain"] == 0.04


def test_overruling_begins_when_the_driver_outweighs_the_push() -> None:
    push = np.minimum(TIME, 2.0)
    driver = np.where(TIME < 1.5, 0.0, 2.5)
    assert time_to_overrule(driver, push) == pytest.approx(1.5, abs=DT)


def test_a_twitch_or_a_torque_against_a_weak_guidance_is_no_overruling() -> None:
    push = 2.0 * np.ones(600)
    twitch = np.where((TIME > 1.0) & (TIME < 1.1), 3.0, 0.0)
    assert math.isnan(time_to_overrule(twitch, push))
    assert math.isnan(time_to_overrule(np.ones(600), 0.9 * np.ones(600)))
    assert math.isnan(time_to_overrule(-3.0 * np.ones(600), push))


def test_signs_of_the_record_are_those_of_iso_8855() -> None:
    # To the right is negative: guidance -2 N·m, the driver holds +2.5 N·m.
    columns = made_up(
        applied_torque=-2.0 * np.ones(600),
        driver_torque=np.where(TIME < 1.0, -2.5, 2.5),
    )
    found = answer(columns, setup_at_zero())
    assert found["time_to_overrule"] == pytest.approx(1.0, abs=DT)
    assert found["peak_torque"] == 2.5


def test_rows_hold_percentiles_of_those_who_have_the_quantity() -> None:
    values = np.append(np.linspace(0.0, 1.0, 101), math.nan)
    found = Resistance(4.0, "fades out", *([values] * len(QUANTITIES)))
    rows = resistance_rows([found])
    assert [row.quantity for row in rows] == [name for name, _ in QUANTITIES.values()]
    assert rows[0].percentiles == pytest.approx((0.05, 0.5, 0.95))
    assert rows[0].mean == pytest.approx(0.5)
    assert rows[0].num_drivers == 101


def test_rows_of_what_nobody_has_are_empty() -> None:
    nobody = Resistance(4.0, "fades out", *([np.full(2, math.nan)] * len(QUANTITIES)))
    (row, *_) = resistance_rows([nobody])
    assert row.num_drivers == 0
    assert np.isnan([*row.percentiles, row.mean]).all()


@pytest.mark.slow
def test_progress_and_threads_change_nothing() -> None:
    told: list[int] = []
    for found in resist(PILOT_SEED, 1, jobs=1, progress=told.append):
        same = trio()[found.change_duration, found.system]
        for name in QUANTITIES:
            assert np.array_equal(
                getattr(found, name), getattr(same, name)[:1], equal_nan=True
            )
    assert told == [1] * 6


def test_an_unknown_system_is_refused() -> None:
    with pytest.raises(ValueError, match="fades out or never yields"):
        wrong_change(1, 1, 4.0, "sulks", 0)
