"""Random numbers of a trial: one stream per component, drawn before it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from costeer.drivers.interface import NORMAL_DRAWS, DriverNoise
from costeer.loop import trial
from costeer.loop.noise import driver_noise
from costeer.loop.scenario import TrialSetup

NOISE = driver_noise(1, 2, "manual", 20_000)


def test_a_longer_trial_begins_with_the_numbers_of_a_shorter_one() -> None:
    np.testing.assert_array_equal(driver_noise(1, 2, "manual", 500), NOISE[:500])


@pytest.mark.parametrize(
    "numbers", [(2, 2, "manual"), (1, 3, "manual"), (1, 2, "weak-rapid")]
)
def test_another_seed_driver_or_condition_draws_other_numbers(
    numbers: tuple[int, int, str],
) -> None:
    assert not (driver_noise(*numbers, 500) == NOISE[:500]).any()


def test_a_uniform_draw_lies_from_0_to_1_and_a_normal_one_around_0() -> None:
    uniform, normal = NOISE[:, NORMAL_DRAWS:], NOISE[:, :NORMAL_DRAWS]
    assert (uniform >= 0.0).all()
    assert (uniform < 1.0).all()
    # Four standard errors of 20,000 draws.
    np.testing.assert_allclose(uniform.mean(axis=0), 0.5, atol=4.0 * 0.29 / 141.0)
    np.testing.assert_allclose(normal.mean(axis=0), 0.0, atol=4.0 / 141.0)
    np.testing.assert_allclose(normal.std(axis=0), 1.0, atol=4.0 / 200.0)


def test_fields_named_uniform_are_those_after_the_normal_ones() -> None:
    named = [name.endswith("_uniform") for name in DriverNoise._fields]
    assert named == [k >= NORMAL_DRAWS for k in range(len(named))]


def test_components_are_not_correlated() -> None:
    correlation = np.corrcoef(NOISE.T) - np.eye(NOISE.shape[1])
    assert np.abs(correlation).max() < 4.5 / np.sqrt(len(NOISE))


def test_a_trial_that_outlasts_its_numbers_is_the_one_of_more_numbers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    setup = TrialSetup(condition="strong-normal", intention="network", length=500.0)
    drawn: list[int] = []

    def noted(seed: int, participant: int, condition: str, num_steps: int) -> Any:
        drawn.append(num_steps)
        return driver_noise(seed, participant, condition, num_steps)

    monkeypatch.setattr(trial, "driver_noise", noted)
    usual = trial.simulate_trial(setup)
    assert len(drawn) == 1
    assert drawn[0] < 1.1 * len(usual.columns["time"])
    monkeypatch.setattr(trial, "LIKELY_SHARE", 2.0)
    late = trial.simulate_trial(setup)
    assert drawn[1] < len(late.columns["time"]) < drawn[2]
    for name, values in usual.columns.items():
        np.testing.assert_array_equal(values, late.columns[name], name)
    assert usual.metadata == late.metadata
