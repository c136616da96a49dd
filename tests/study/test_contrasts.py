from __future__ import annotations

import numpy as np
import pytest

from costeer.study.contrasts import one_way, two_way


@pytest.mark.parametrize("num_levels", [2, 3, 7])
def test_contrasts_are_orthonormal_and_sum_to_zero(num_levels: int) -> None:
    contrasts = one_way("condition", num_levels)[0].contrasts
    assert contrasts.shape == (num_levels, num_levels - 1)
    np.testing.assert_allclose(
        contrasts.T @ contrasts, np.eye(num_levels - 1), atol=1e-15
    )
    np.testing.assert_allclose(contrasts.sum(axis=0), 0.0, atol=1e-15)


def test_effects_of_two_factors_share_out_all_differences_between_cells() -> None:
    effects = two_way("strength", 2, "change_duration", 3)
    together = np.hstack([effect.contrasts for effect in effects])
    assert [effect.contrasts.shape[1] for effect in effects] == [1, 2, 2]
    np.testing.assert_allclose(together.T @ together, np.eye(5), atol=1e-15)
    np.testing.assert_allclose(together.sum(axis=0), 0.0, atol=1e-15)


def test_main_effect_looks_at_its_own_factor_only() -> None:
    strength, duration, interaction = two_way("strength", 2, "change_duration", 3)
    by_strength = np.repeat([0.0, 1.0], 3)
    assert np.abs(strength.contrasts.T @ by_strength).max() > 0.1
    np.testing.assert_allclose(duration.contrasts.T @ by_strength, 0.0, atol=1e-15)
    np.testing.assert_allclose(interaction.contrasts.T @ by_strength, 0.0, atol=1e-15)


def test_single_level_leaves_nothing_to_compare() -> None:
    assert one_way("condition", 1)[0].contrasts.shape == (1, 0)
    assert two_way("strength", 1, "change_duration", 3)[1].contrasts.shape == (3, 2)
