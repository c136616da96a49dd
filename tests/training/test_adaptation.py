"""A network adapted to people: what each step may change, and who must not matter."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from costeer.intention.gru import NetworkWeights, random_weights
from costeer.intention.predictors.gru import our_probabilities
from costeer.intention.weights import IntentionNetwork, intention_network
from costeer.training import adapt as judging
from costeer.training.adapt import adapt, check, num_fits
from costeer.training.adaptation import (
    DEFAULTS,
    AdaptationParameters,
    adapted,
    held_out,
    threshold_at_rate,
)
from costeer.training.evaluate import trigger_counts
from costeer.training.left_out import num_changes, parts
from costeer.training.recordings import Recording, lacking
from costeer.training.triggers import total
from costeer.training.verdicts import DriverVerdicts, by_driver, verdicts
from tests.training.synthetic import drive, drives

pytestmark = pytest.mark.slow

START = random_weights(4, seed=1)
NETWORK = intention_network(START, {"source": "a test"})
NO_STEP = DEFAULTS._replace(
    fit=DEFAULTS.fit._replace(num_steps=0), false_per_km=50.0, least_minutes=1.0
)
FEW_STEPS = NO_STEP._replace(
    fit=DEFAULTS.fit._replace(
        num_steps=4, steps_per_check=2, batch_size=32, learning_rate=0.02
    )
)


def same(one: NetworkWeights, other: NetworkWeights) -> bool:
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


def people() -> list[Recording]:
    return drives(4, num_changes=1)


def test_no_step_and_no_calibration_give_the_same_bits() -> None:
    found = adapted(START, people(), 1, NO_STEP._replace(calibrate=False))
    assert same(found.weights, START)
    assert found.choice.steps == 0


def test_without_a_step_only_the_last_layer_changes() -> None:
    found = adapted(START, people(), 1, NO_STEP).weights
    assert not np.array_equal(found.output_bias, START.output_bias)
    for name, values in START._asdict().items():
        if not name.startswith("output"):
            np.testing.assert_array_equal(getattr(found, name), values)


def noisy(seed: int) -> list[DriverVerdicts]:
    """Probabilities that know a little, of drivers with lane changes."""
    rng, given = np.random.default_rng(seed), drives(3, num_changes=2)
    said = []
    for one in given:
        known = (
            2.0 * one.labels.positive
            - 3.0
            + np.cumsum(rng.normal(size=one.side.size)) / 40.0
        )
        said.append(
            np.where(
                np.arange(one.side.size) < 179, np.nan, 1.0 / (1.0 + np.exp(-known))
            )
        )
    return by_driver(given, said)


@pytest.mark.parametrize("rate", [0.0, 0.05, 0.5, 5.0])
@pytest.mark.parametrize("seed", range(3))
def test_the_threshold_keeps_to_the_rate_it_is_chosen_for(
    seed: int, rate: float
) -> None:
    heard = noisy(seed)
    parameters = DEFAULTS._replace(false_per_km=rate)
    threshold = threshold_at_rate(heard, parameters)
    triggers = parameters.triggers._replace(threshold=threshold)
    counts = total([trigger_counts(one, triggers) for one in heard])
    assert counts.false / counts.kilometres <= rate


def test_more_false_triggers_never_buy_less_lead() -> None:
    heard, leads = noisy(1), []
    for rate in (0.0, 0.1, 1.0, 10.0):
        parameters = DEFAULTS._replace(false_per_km=rate)
        triggers = parameters.triggers._replace(
            threshold=threshold_at_rate(heard, parameters)
        )
        counts = total([trigger_counts(one, triggers) for one in heard])
        leads.append(np.mean(counts.leads))
    assert leads == sorted(leads)
    assert leads[-1] > leads[0]


def test_a_rate_that_no_threshold_keeps_to_is_told() -> None:
    given = drives(2, num_changes=1)
    sure = [np.where(np.arange(r.side.size) % 120 < 5, 1.0, 0.0) for r in given]
    with pytest.raises(ValueError, match=r"no threshold keeps to 0.05 .* lowest rate"):
        threshold_at_rate(by_driver(given, sure), DEFAULTS)


def spoilt(one: Recording) -> Recording:
    """The same drive with other signals and other answers."""
    turned = one.labels._replace(positive=~one.labels.positive)
    return one._replace(features=3.0 * one.features[::-1] - 1.0, labels=turned)


@pytest.mark.parametrize(
    "parameters",
    [NO_STEP, pytest.param(FEW_STEPS, marks=pytest.mark.slow)],
)
def test_who_judges_has_no_part_in_the_network_that_is_judged(
    parameters: AdaptationParameters,
) -> None:
    given = people()
    victim = given[2].driver
    poisoned = [spoilt(r) if r.driver == victim else r for r in given]
    clean, dirty = (
        list(held_out(START, parts(each), 1, parameters)) for each in (given, poisoned)
    )
    unharmed = []
    for one, other in zip(clean, dirty, strict=True):
        alike = same(one.adapted.weights, other.adapted.weights)
        own = {each.driver for each in one.recordings} == {victim}
        if own:
            assert alike
            assert one.adapted.choice == other.adapted.choice
        unharmed.append(alike)
    assert sum(unharmed) == 1  # poison does work on those who learn from it


@pytest.mark.slow  # trainings of its own
def test_the_same_seed_gives_the_same_network_and_others_learn() -> None:
    found = adapted(START, people(), 1, FEW_STEPS)
    assert found.choice.steps > 0
    assert not same(found.weights, START)
    assert same(found.weights, adapted(START, people(), 1, FEW_STEPS).weights)


@pytest.fixture(scope="module")
def result() -> IntentionNetwork:
    return adapt(NETWORK, drives(6, num_changes=1), 1, NO_STEP)


def test_the_facts_tell_start_seed_threshold_and_data(result: IntentionNetwork) -> None:
    facts = result.facts
    assert facts["start"] == {"hash": NETWORK.hash, "source": "a test"}
    assert facts["seed"] == 1
    assert 0.0 < facts["threshold"] < 1.0
    assert facts["adapted_to"]["lane_changes"] == 6
    assert facts["adapted_to"]["drivers"] == 6
    assert facts["left_out"]["kind"] == "drivers"


def test_both_are_judged_on_the_same_samples(result: IntentionNetwork) -> None:
    judged = result.facts["left_out"]
    before, after = judged["start"], judged["adapted"]
    for name in ("prevalence", "num_crossings", "kilometres", "hours"):
        assert before[name] == after[name]
    alone = verdicts(partial(our_probabilities, START), drives(6, num_changes=1))
    at_half = [trigger_counts(one, DEFAULTS.triggers) for one in alone]
    assert before["false_triggers"] == total(at_half).false
    assert after["log_loss"] < before["log_loss"]


def test_intervals_hold_their_values(result: IntentionNetwork) -> None:
    after = result.facts["left_out"]["adapted"]
    assert set(after["interval_95"]) == set(judging.SHOWN)
    for name, (low, high) in after["interval_95"].items():
        assert low - 2e-3 <= after[name] <= high + 2e-3
    low, high = after["minus_start_interval_95"]["log_loss"]
    assert low < high < 0.0


@pytest.mark.parametrize(("num", "why"), [(4, "4 drivers are too few"), (1, "blocks")])
def test_few_drivers_get_no_interval_but_the_reason(num: int, why: str) -> None:
    given = drives(num, num_changes=4 // num)
    assert num_fits(given, NO_STEP) == 5
    judged = adapt(NETWORK, given, 1, NO_STEP).facts["left_out"]
    assert why in judged["intervals"]["none_because"]
    assert "interval_95" not in judged["adapted"]


def test_no_false_trigger_is_no_proof_of_a_low_rate(result: IntentionNetwork) -> None:
    after = result.facts["left_out"]["adapted"]
    if after["false_triggers"] == 0:  # the rule of three
        assert after["false_per_km_at_most"] == pytest.approx(
            3.0 / after["kilometres"], rel=2e-3
        )
    assert after["false_per_km_at_most"] > after["false_per_km"]


def test_what_cannot_be_adapted_to_is_named() -> None:
    with pytest.raises(ValueError, match=r"hold 2.1 min .* at least 10 min"):
        check(NETWORK, people(), DEFAULTS)
    still = drives(4, num_changes=0)
    with pytest.raises(ValueError, match=r"hold 0 lane changes .* at least 4"):
        check(NETWORK, still, NO_STEP._replace(least_minutes=0.5))
    seeing = NETWORK._replace(weights=START._replace(dispensable=np.zeros(6)))
    with pytest.raises(ValueError, match="to do without head_yaw"):
        check(seeing, [lacking(drive(1), ("head_yaw",))], NO_STEP)


def test_lane_changes_of_one_driver_alone_cannot_judge_and_teach() -> None:
    given = [*drives(1, num_changes=3), drive(5, num_changes=1)]
    assert sum(map(num_changes, given)) == 4
    with pytest.raises(ValueError, match="without driver 0: 1 lane change"):
        adapt(NETWORK, given, 1, NO_STEP)
