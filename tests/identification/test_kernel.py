"""The Kalman filter predicts the torque of a simulated driver."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.identification.kernel import (
    FilterInputs,
    innovations,
    innovations_compiled,
)
from costeer.identification.likelihood import predicted
from costeer.identification.model import (
    filter_inputs,
    filter_parameters,
    part,
    start,
)
from tests.identification.driving import evidence_of, recorded, true_driver


def standardised(participant: int) -> np.ndarray:
    driver = true_driver(participant)
    found = predicted(driver, evidence_of(recorded(participant), driver))
    return found.errors / np.sqrt(found.variances)


@pytest.mark.parametrize("participant", [1, 2, 3])
def test_with_the_true_driver_prediction_errors_are_white(participant: int) -> None:
    errors = standardised(participant)
    lags = [float(np.mean(errors[k:] * errors[:-k])) for k in range(1, 61)]
    # Each is normal with deviation 1/sqrt(n); the largest of 60 is within 3.9 of them
    # in 99.4 of 100 samples.
    assert max(np.abs(lags)) < 3.9 / np.sqrt(errors.size)


@pytest.mark.parametrize("participant", [1, 2, 3])
def test_with_the_true_driver_the_predicted_variance_is_that_of_the_errors(
    participant: int,
) -> None:
    errors = standardised(participant)
    # The mean square of n standard normals has deviation sqrt(2/n).
    assert abs(np.mean(errors**2) - 1.0) < 3.5 * np.sqrt(2.0 / errors.size)


def some_inputs() -> tuple[FilterInputs, np.ndarray, np.ndarray]:
    driver = true_driver(1)
    evidence = evidence_of(recorded(1), driver)
    parameters = filter_parameters(driver, evidence.drive.dt, 1e-5)
    inputs = filter_inputs(driver, evidence.drive, evidence.motion)
    stretch = part(inputs, slice(600, 640))
    mean, covariance = start(parameters, stretch, driver.vision)
    return stretch, mean, covariance


def test_compiled_filter_gives_what_plain_python_gives() -> None:
    parameters = filter_parameters(true_driver(1), 1.0 / 60.0, 1e-5)
    outcomes = []
    for run in (innovations, innovations_compiled):
        stretch, mean, covariance = some_inputs()
        errors, variances = np.empty((2, stretch.torque.size))
        run(parameters, stretch, mean, covariance, errors, variances)
        outcomes.append(np.concatenate([errors, variances, mean, covariance.ravel()]))
    # The compiler may fuse products and sums: a few units in the last place a step.
    np.testing.assert_allclose(outcomes[0], outcomes[1], rtol=1e-6, atol=1e-12)


def test_the_covariance_settles_and_stays_positive() -> None:
    driver = true_driver(1)
    evidence = evidence_of(recorded(1), driver)
    parameters = filter_parameters(driver, evidence.drive.dt, 1e-5)
    inputs = filter_inputs(driver, evidence.drive, evidence.motion)
    stretch = part(inputs, evidence.stretches[0])
    mean, covariance = start(parameters, stretch, driver.vision)
    errors, variances = np.empty((2, stretch.torque.size))
    innovations_compiled(parameters, stretch, mean, covariance, errors, variances)
    assert np.linalg.eigvalsh((covariance + covariance.T) / 2.0).min() > -1e-12
    # Speed varies by a few percent within a stretch, and the variance with it.
    late = variances[len(variances) // 2 :]
    assert np.ptp(late) / late.mean() < 0.2
