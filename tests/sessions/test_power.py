"""Power of a planned study: known cases of paired t-tests, and a driven plan."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.sessions.plan_file import parsed_plan
from costeer.sessions.power import (
    PowerSettings,
    effect_size,
    found,
    planned_power,
)


def normal(effect: float, conditions: int = 1, drivers: int = 20_000) -> np.ndarray:
    """Differences of many people with a known d_z."""
    generator = np.random.default_rng(5)
    drawn = generator.normal(0.0, 1.0, (drivers, conditions))
    drawn -= drawn.mean(axis=0)
    return effect + drawn / drawn.std(axis=0, ddof=1)


@pytest.mark.parametrize(("size", "effect"), [(12, 0.89), (24, 0.60)])
def test_eighty_percent_where_tables_of_paired_t_tests_have_it(
    size: int, effect: float
) -> None:
    """Cohen's tables: paired, two-sided 0.05, 80 % (spec section 13)."""
    share = found(normal(effect), size, 20_000, np.random.default_rng(1))
    assert share[0] == pytest.approx(0.8, abs=0.02)


def test_without_an_effect_five_percent_are_found() -> None:
    share = found(normal(0.0), 12, 20_000, np.random.default_rng(1))
    assert share[0] == pytest.approx(0.05, abs=0.01)


def test_correction_over_six_keeps_the_false_discovery_rate() -> None:
    share = found(normal(0.0, 6), 12, 20_000, np.random.default_rng(1))
    assert share.max() < 0.02


def test_power_grows_with_size_and_effect() -> None:
    shares = [
        found(normal(0.6), size, 4000, np.random.default_rng(2))[0]
        for size in (6, 12, 24, 48)
    ]
    assert shares == sorted(shares)
    assert shares[-1] > 0.95


def test_effect_size_is_mean_over_standard_deviation() -> None:
    differences = np.array([[1.0, 0.0], [3.0, 0.0], [5.0, 0.0]])
    assert effect_size(differences).tolist() == [1.5, 0.0]


@pytest.mark.parametrize("changed", [{"drivers": 2}, {"studies": 5}, {"redrawn": 1}])
def test_too_few_draws_are_refused(changed: dict[str, int]) -> None:
    plan = parsed_plan("title: a\nsteps: [{kind: drive, condition: manual}]")
    with pytest.raises(ValueError, match=f"{next(iter(changed))} is"):
        planned_power(plan, PowerSettings(**changed))


def test_a_plan_without_manual_has_nothing_to_compare_with() -> None:
    plan = parsed_plan("title: a\nsteps: [{kind: drive, condition: weak-rapid}]")
    with pytest.raises(ValueError, match="no manual trial"):
        planned_power(plan, PowerSettings())


@pytest.mark.slow
def test_a_plan_is_driven_and_every_difference_has_its_power() -> None:
    plan = parsed_plan(
        "title: a\nlength: 1600\nsteps:\n"
        "- {kind: drive, condition: manual}\n"
        "- {kind: trials, conditions: [strong-rapid, weak-gentle]}\n"
    )
    settings = PowerSettings(
        drivers=6, studies=200, redrawn=20, sizes=(6, 24), intention="scripted"
    )
    done: list[int] = []
    powers = planned_power(plan, settings, lambda n, of: done.append(of - n))
    assert done[-1] == 0
    assert {each.condition for each in powers} == {"strong-rapid", "weak-gentle"}
    for each in powers:
        assert ((each.low <= each.high) & (each.power <= 1.0)).all()
        assert each.effect_low <= each.effect_high
    again = planned_power(plan, settings)
    assert [each.power.tolist() for each in again] == [p.power.tolist() for p in powers]
