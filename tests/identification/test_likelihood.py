"""The likelihood prefers the driver who drove."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.identification.estimate import CONFIDENCE, half_width, information
from costeer.identification.likelihood import log_likelihoods, predicted
from costeer.identification.parameters import (
    STEERING,
    Parameter,
    coordinates,
    driver_at,
    value_of,
)
from tests.identification.driving import evidence_of, recorded, true_driver


def log_likelihood(participant: int, shift: dict[str, float]) -> float:
    """Of the true driver whose parameters are shifted on the searched scale."""
    truth = true_driver(participant)
    point = coordinates(truth, STEERING)
    point += np.array([shift.get(p.name, 0.0) for p in STEERING])
    driver = driver_at(truth, STEERING, point)
    evidence = evidence_of(recorded(participant), driver)
    return float(log_likelihoods(predicted(driver, evidence)).sum())


@cache
def log_likelihood_of_the_truth(participant: int) -> float:
    return log_likelihood(participant, {})


@cache
def expected_information(participant: int) -> NDArray[np.float64]:
    truth = true_driver(participant)
    return information(truth, STEERING, evidence_of(recorded(participant), truth))


@pytest.mark.parametrize("parameter", STEERING, ids=lambda p: p.name)
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_truth_is_likelier_than_a_driver_far_from_it(
    parameter: Parameter, side: float
) -> None:
    expected = expected_information(1)
    place = STEERING.index(parameter)
    # Eight standard errors away the likelihood has fallen by 32; its maximum is within
    # three of the truth in all but one of 400 recordings, where it is still down by 12.
    far = 8.0 * side / math.sqrt(expected[place, place])
    there = log_likelihood(1, {parameter.name: far})
    assert there < log_likelihood_of_the_truth(1)


@pytest.mark.slow
def test_the_information_is_that_of_the_scores() -> None:
    # The sum of squared scores estimates the same information; its largest deviation
    # over the diagonal is some sqrt(2/15000) = 1 %, more where single samples weigh.
    expected = np.diag(expected_information(2))
    for k, parameter in enumerate(STEERING):
        if parameter.name == "arm.inertia":
            continue  # wheel and torque are known together: see the log-Jacobian
        step = 0.05 / math.sqrt(expected[k])
        shifts = ({parameter.name: side * step} for side in (1.0, -1.0))
        up, down = (log_likelihood(2, shift) for shift in shifts)
        curvature = (2.0 * log_likelihood_of_the_truth(2) - up - down) / step**2
        assert curvature == pytest.approx(expected[k], rel=0.25)


def test_values_come_back_from_the_scale_that_is_searched() -> None:
    truth, usual = true_driver(1), true_driver(2)
    driver = driver_at(usual, STEERING, coordinates(truth, STEERING))
    for parameter in STEERING:
        found = value_of(driver, parameter.name)
        assert found == pytest.approx(value_of(truth, parameter.name), rel=1e-12)


def test_motor_noise_keeps_its_ratio_to_near_noise() -> None:
    truth = true_driver(1)
    point = coordinates(truth, STEERING) + math.log(2.0)
    doubled = driver_at(truth, STEERING, point).vision
    assert doubled.motor_noise == pytest.approx(2.0 * truth.vision.motor_noise)
    assert doubled.near_noise == pytest.approx(2.0 * truth.vision.near_noise)


def test_an_interval_is_the_normal_one() -> None:
    assert CONFIDENCE == 0.95
    # 1.959964 is the 97.5 % point of the standard normal distribution.
    assert half_width(2.0) == pytest.approx(3.919928, abs=1e-6)
