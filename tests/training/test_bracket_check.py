"""The check of a network's bracketed form, and what weights say of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from costeer.intention.checked import FACT, passed_band, shortcomings
from costeer.intention.gru import random_weights
from costeer.intention.starts import Band, bracket_weights
from costeer.intention.weights import (
    intention_network,
    load_weights,
    save_weights,
)
from costeer.training.bracket_check import (
    BAND,
    Tally,
    check_setup,
    checked_drives,
    compared,
    joined,
    num_drives,
    with_check,
)
from tests.intention.lively import lively_weights, signals

GOOD = Tally(drives=250, kilometres=2000.0, verdicts=10**6, triggers=900, margin=0.4)
NETWORK = intention_network(random_weights(4, 1), {"source": "none"})


def test_weights_pass_only_with_a_check_of_their_own() -> None:
    checked = with_check(NETWORK, GOOD, 5)
    assert passed_band(checked) == BAND
    assert checked.facts["source"] == "none"
    assert passed_band(NETWORK) is None
    # Facts of other weights, as a careless fine-tuning would leave them.
    other = intention_network(random_weights(4, 2), checked.facts)
    assert passed_band(other) is None


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ({"kilometres": 999.0}, "999 km are fewer than 1000"),
        ({"wrong": 1}, "1 verdicts were on the wrong side"),
        ({"margin": 0.76}, "76 % of the way"),
    ],
)
def test_a_check_may_not_suffice(changed: dict[str, Any], why: str) -> None:
    found = GOOD._replace(**changed)
    assert passed_band(with_check(NETWORK, found, 5)) is None
    (told,) = shortcomings(found._asdict())
    assert why in told


@pytest.mark.parametrize("damage", ["kilometres", "wrong", "margin", "low", "hash"])
def test_a_fact_that_lacks_something_is_no_pass(damage: str) -> None:
    checked = with_check(NETWORK, GOOD, 5)
    del checked.facts[FACT][damage]
    assert passed_band(checked) is None


@pytest.mark.parametrize(("end", "value"), [("low", 0.6), ("high", 0.4), ("low", -1)])
def test_a_band_that_does_not_hold_a_half_is_no_pass(end: str, value: float) -> None:
    checked = with_check(NETWORK, GOOD, 5)
    checked.facts[FACT][end] = value
    assert passed_band(checked) is None


def test_the_file_keeps_the_check(tmp_path: Path) -> None:
    file = tmp_path / "network.npz"
    save_weights(file, with_check(NETWORK, GOOD, 5))
    assert passed_band(load_weights(file)) == BAND


def test_half_of_the_drives_are_manual_and_half_take_all_conditions() -> None:
    setups = [check_setup(place, 7, Path("none.npz")) for place in range(24)]
    assert all(setup.condition == "manual" for setup in setups[::2])
    guided = setups[1::2]
    assert len({setup.condition for setup in guided}) == 6
    assert all(setup.intention == "network" for setup in guided)
    people = {(setup.participant, setup.condition) for setup in setups}
    assert len(people) == 24
    assert num_drives(16.0) == 4  # drives of 8 km, a few end early
    assert num_drives(10_000.0) * 8.0 >= 10_000.0


@pytest.mark.slow
def test_wrong_sides_and_margins_are_counted() -> None:
    # Wild enough that a window may say another thing than those begun around it.
    weights = lively_weights(8)
    weights = weights._replace(hidden_weights=4.0 * weights.hidden_weights)
    rows = np.concatenate([signals(1500, seed) for seed in range(3)])
    # A band so narrow that the states are believed where they should not be.
    narrow = bracket_weights(weights, Band(0.4999, 0.5001))
    found = compared(weights, narrow, rows)
    assert found.wrong > 0
    assert found.margin > 1.0
    wide = compared(weights, bracket_weights(weights, Band(1e-9, 1.0 - 1e-9)), rows)
    assert wide.wrong == 0
    assert 0.0 < wide.margin < 1.0
    assert wide.exact == wide.verdicts == found.verdicts == len(rows) - 179
    # The same states, measured against bands of another width: ln(1/1e-9) = 20.7,
    # and 4e-4 for the narrow one.
    assert found.margin / wide.margin == pytest.approx(20.723 / 4e-4, rel=1e-3)


def test_what_two_parts_saw_is_added() -> None:
    one, other = Tally(2, 16.0, 8.0, 0.0, 100, 3, 5, 0, 0.3), GOOD
    both = joined(one, other)
    assert both.kilometres == 2016.0
    assert both.triggers == 903
    assert both.margin == 0.4


@pytest.mark.slow
def test_drives_are_judged_and_the_same_again() -> None:
    network = load_weights()
    found = checked_drives(network, range(2), 11, 2)
    assert found == checked_drives(network, range(2), 11, 1)
    assert found.drives == 2
    assert found.kilometres == pytest.approx(16.0, abs=0.1)
    assert found.assisted_kilometres == pytest.approx(8.0, abs=0.1)
    # The first two are driven once more without head.
    assert found.headless_kilometres == pytest.approx(16.0, abs=0.1)
    assert found.wrong == 0
    assert 0.0 < found.exact < 0.2 * found.verdicts
    assert found.triggers > 5
