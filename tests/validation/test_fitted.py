"""A fitted driver drives the trial again."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from costeer.drivers.driver import DriverParameters
from costeer.identification.fit import DriverFit, fit_driver
from costeer.identification.parameters import with_value
from costeer.loop.scenario import loop_parameters
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import CARS, ColumnParameters
from costeer.validation.fitted import Check, check_fit, same_trial
from costeer.validation.fitted_figure import description, fit_svg
from tests.identification.driving import (
    manual_setup,
    recorded,
    true_driver,
    with_columns,
)

REPEATS = 8


@cache
def fitted() -> DriverFit:
    return fit_driver(recorded(1))


def checks(driver: DriverParameters) -> dict[str, Check]:
    fit = fitted()._replace(driver=driver)
    return {c.measure: c for c in check_fit(recorded(1), fit, 2, REPEATS)}


@pytest.mark.slow
def test_the_true_driver_drives_like_the_recording() -> None:
    found = checks(true_driver(1))
    assert set(found) == {"sdlp", "swrr", "driver_torque_rms", "lane_change_duration"}
    for check in found.values():
        # Eight trials: t with seven degrees of freedom, beyond 6 in 5 of 10,000.
        assert abs(check.recorded - check.mean) < 6.0 * check.deviation, check


@pytest.mark.slow
def test_a_driver_who_wanders_twice_as_much_is_flagged() -> None:
    truth = true_driver(1)
    wide = with_value(truth, "tracking.wander_deviation", 0.6)
    assert checks(wide)["sdlp"].flagged
    slow = with_value(truth, "decision.change_duration", 14.0)
    assert checks(slow)["lane_change_duration"].flagged


@pytest.mark.slow
def test_the_same_check_gives_the_same_numbers_with_any_number_of_threads() -> None:
    one = check_fit(recorded(1), fitted(), 1, 3)
    two = check_fit(recorded(1), fitted(), 2, 3)
    assert one == two


@pytest.mark.slow
def test_progress_counts_every_trial() -> None:
    done: list[int] = []
    check_fit(recorded(1), fitted(), 1, 3, done.append)
    assert done == [1, 1, 1]


def test_the_simulated_trial_is_that_of_the_recording() -> None:
    setup = same_trial(recorded(1))
    assert setup.car == CARS["default"]
    assert setup.events
    # The road was 8 km, of which the last step is beyond.
    assert setup.length == pytest.approx(8000.0, rel=2e-3)


def test_the_simulated_car_and_column_are_those_of_the_record() -> None:
    own = (("car.mass", 2000.0), ("column.stiffness", 3.0))
    record = simulate_trial(manual_setup(1, 200.0)._replace(parameters=own))
    parameters = loop_parameters(same_trial(record))
    assert parameters.car.mass == 2000.0
    assert parameters.column == ColumnParameters(stiffness=3.0)
    assert same_trial(record, "large").car == CARS["large"]


def test_leaders_are_known_from_events_or_gaps_or_lane_changes() -> None:
    record = recorded(1)
    assert same_trial(with_columns(record, event=None)).events
    assert same_trial(with_columns(record, event=None, lead_distance=None)).events
    none = np.zeros(len(record.columns["time"]), dtype=np.int8)
    assert not same_trial(with_columns(record, event=none)).events


@pytest.mark.slow
def test_a_recording_without_lane_changes_says_what_is_not_compared() -> None:
    record = recorded(1)
    nothing = np.zeros(len(record.columns["time"]))
    straight = with_columns(
        record, lateral_position=nothing, yaw_angle=nothing, event=None
    )
    straight = with_columns(straight, lead_distance=None)
    found = {c.measure: c for c in check_fit(straight, fitted(), 2, 2)}
    duration = found["lane_change_duration"]
    assert duration.reason == "no completed lane change"
    assert not duration.flagged
    assert math.isnan(duration.mean)


def test_a_speed_outside_the_simulator_is_refused() -> None:
    slow = np.full(len(recorded(1).columns["time"]), 8.0)
    with pytest.raises(ValueError, match=r"28\.8 km/h; a check .* needs 43\.2"):
        same_trial(with_columns(recorded(1), longitudinal_velocity=slow))


@pytest.mark.slow
def test_the_figure_has_a_panel_for_each_estimate_and_the_same_text_twice() -> None:
    fit = fitted()
    assert fit_svg(fit, 19.4) == fit_svg(fit, 19.4)
    assert description(fit).startswith("11 estimates")
    assert "arm.stiffness" in description(fit)
