"""Known drivers come back from their recordings."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from costeer.identification import steering
from costeer.identification.fit import WHITE, DriverFit, fit_driver
from costeer.identification.parameters import STEERING, Estimate, value_of
from costeer.loop.inputs import read_driver, write_driver
from costeer.records.columns import TrialRecord
from tests.identification.driving import (
    cut,
    recorded,
    recorded_with,
    true_driver,
    with_columns,
)
from tests.records.mirror import mirrored

SHORT, LONG = 2000.0, 8000.0
"""Drives [m]."""


@cache
def fit_of(participant: int, length: float = LONG) -> DriverFit:
    return fit_driver(recorded(participant, length))


def part_of_a_drive() -> TrialRecord:
    """Less than half of a drive: enough for what a fit finds, and quicker to fit."""
    return cut(recorded(1), slice(0, 11_000))


@cache
def fit_of_a_part() -> DriverFit:
    return fit_driver(part_of_a_drive())


@cache
def fit_of_a_still_wheel() -> DriverFit:
    return fit_driver(recorded_with(friction=100.0))


def by_name(fit: DriverFit) -> dict[str, Estimate]:
    return {estimate.name: estimate for estimate in fit.estimates}


# A short drive at once, whole ones with the tests that need several.
@pytest.mark.parametrize(
    ("participant", "length"),
    [(1, SHORT), *(pytest.param(n, LONG, marks=pytest.mark.slow) for n in (1, 2, 3))],
)
def test_the_truth_is_near_every_estimate(participant: int, length: float) -> None:
    truth = true_driver(participant)
    for estimate in fit_of(participant, length).estimates:
        value = value_of(truth, estimate.name)
        # Twice the interval's half-width, four standard errors: one of 16,000 normal
        # estimates is outside. Whether 95 % hold is for the benchmark to count.
        room = estimate.high - estimate.low
        middle = (estimate.high + estimate.low) / 2.0
        assert abs(value - middle) < room, estimate


@pytest.mark.slow
def test_most_intervals_of_three_drivers_hold_the_truth() -> None:
    inside = [
        e.low <= value_of(true_driver(n), e.name) <= e.high
        for n in (1, 2, 3)
        for e in fit_of(n).estimates
    ]
    # Of 33 intervals at 95 %, 27 or more hold in 99.8 of 100 samples.
    assert len(inside) == 33
    assert sum(inside) >= 27


@pytest.mark.slow
def test_twenty_drivers_are_in_their_intervals() -> None:
    drivers = range(10, 30)
    fits = {n: fit_driver(recorded(n)) for n in drivers}
    for name in by_name(fits[10]):
        inside = [
            e.low <= value_of(true_driver(n), name) <= e.high
            for n in drivers
            for e in fits[n].estimates
            if e.name == name
        ]
        # At 95 %, 16 or more of 20 hold in 99.7 of 100 samples.
        assert sum(inside) >= 16, name


@pytest.mark.slow
@pytest.mark.parametrize("participant", [1, 2, 3])
def test_prediction_errors_of_the_fitted_driver_are_white(participant: int) -> None:
    assert fit_of(participant).whiteness < WHITE
    assert fit_of(participant).white_limit == WHITE
    assert fit_of(participant).notes == ()


def test_the_fitted_driver_has_the_estimates_and_else_the_usual_values() -> None:
    fit = fit_of(1, SHORT)
    for estimate in fit.estimates:
        assert value_of(fit.driver, estimate.name) == estimate.value
    assert value_of(fit.driver, "reliance.reliance") == 0.5


def test_the_fitted_driver_is_the_linear_one_and_a_file_keeps_it(
    tmp_path: Path,
) -> None:
    driver = fit_of(1, SHORT).driver
    # Whatever makes a driver of population 3 intermittent is off.
    assert driver.tolerance.band == driver.correcting.evidence_rate == 0.0
    assert driver.vision.signal_noise == driver.learning.share == 0.0
    path = tmp_path / "driver.yaml"
    write_driver(path, driver, {"fitted_to": "a drive"})
    assert read_driver(path) == driver


@pytest.mark.slow
def test_a_mirrored_recording_mirrors_the_bias_and_nothing_else() -> None:
    record = part_of_a_drive()
    mirror = record._replace(columns=mirrored(record.columns))
    one, other = by_name(fit_of_a_part()), by_name(fit_driver(mirror))
    assert one.keys() == other.keys()
    for name, estimate in one.items():
        found = other[name]
        if name == "tracking.lane_bias":
            found = found._replace(value=-found.value, low=-found.high, high=-found.low)
        # The searches end within a hundredth of a standard error of their maximum.
        width = estimate.high - estimate.low
        for a, b in zip(estimate[1:4], found[1:4], strict=True):
            assert abs(a - b) < 0.02 * width, name


@pytest.mark.slow
def test_a_wheel_that_never_moves_tells_nothing_of_inertia_and_damping() -> None:
    fit = fit_of_a_still_wheel()
    reasons = {each.name: each.reason for each in fit.not_identified}
    assert "never moves" in reasons["arm.inertia"]
    assert "never moves" in reasons["arm.damping"]
    assert {"arm.inertia", "arm.damping"}.isdisjoint(by_name(fit))


@pytest.mark.slow
def test_what_is_left_of_a_wheel_that_never_moves_is_estimated() -> None:
    # Torque then tells stiffness times noise, not each: one of them is held.
    found = by_name(fit_of_a_still_wheel())
    assert {"vision.near_noise", "tracking.wander_deviation"} & found.keys()


@pytest.mark.slow
def test_without_head_and_leader_those_rows_say_why() -> None:
    absent = {"head_yaw": None, "event": None, "lead_distance": None}
    fit = fit_driver(with_columns(part_of_a_drive(), **absent))
    reasons = {each.name: each.reason for each in fit.not_identified}
    assert "head_yaw" in reasons["gaze.false_rate"]
    assert "head_yaw" in reasons["decision.glance_share"]
    assert "lead_distance" in reasons["longitudinal.preferred_speed"]
    assert {p.name for p in STEERING} <= by_name(fit).keys()


def noisy(deviation: float) -> TrialRecord:
    record = cut(recorded(2), slice(0, 14_000))
    rng = np.random.default_rng(5)
    noise = deviation * rng.standard_normal(len(record.columns["time"]))
    return with_columns(record, driver_torque=record.columns["driver_torque"] + noise)


@pytest.mark.slow
def test_noise_of_the_torque_sensor_is_found_and_hides_what_moves_the_arms() -> None:
    fit = fit_driver(noisy(0.02))
    # The relative error of a deviation from 15,000 samples is 0.6 %; the driver's own
    # steps, half as large, are told apart from it to a few percent.
    assert fit.torque_noise == pytest.approx(0.02, rel=0.1)
    reasons = {each.name: each.reason for each in fit.not_identified}
    assert "noise of 0.02" in reasons["arm.inertia"]
    assert "noise of 0.02" in reasons["arm.damping"]
    assert "noise of 0.02" in fit.notes[0]
    # What is left agrees with the fit of the clean torque to within its interval.
    for name in ("vision.lead_time", "tracking.lane_bias"):
        clean, found = by_name(fit_of(2))[name], by_name(fit)[name]
        assert clean.low < found.value < clean.high


def test_a_simulators_torque_has_no_noise() -> None:
    assert fit_of(1, SHORT).torque_noise == 1e-5


def test_a_recording_that_tells_nothing_of_the_steering_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    moved = tuple(p for p in STEERING if p.name in ("arm.inertia", "arm.damping"))
    monkeypatch.setattr(steering, "STEERING", moved)
    with pytest.raises(ValueError, match=r"nothing of the steering: arm\.damping: the"):
        fit_driver(recorded_with(friction=100.0))


def test_every_interval_holds_its_estimate() -> None:
    for estimate in fit_of(1, SHORT).estimates:
        assert estimate.low <= estimate.value <= estimate.high
        assert math.isfinite(estimate.low)
        assert math.isfinite(estimate.high)


@pytest.mark.slow
def test_a_shorter_recording_tells_less() -> None:
    whole = by_name(fit_of(1))
    part = by_name(fit_of_a_part())
    for parameter in STEERING:
        wide, narrow = part[parameter.name], whole[parameter.name]
        # Less than half of the lane keeping: intervals are about 1.5 times as wide.
        assert wide.high - wide.low > 1.1 * (narrow.high - narrow.low)


def test_a_short_recording_of_the_model_raises_no_false_alarm() -> None:
    fit = fit_of(1, SHORT)
    assert fit.whiteness < fit.white_limit
    assert 0.06 < fit.white_limit < 0.07
