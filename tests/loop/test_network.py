"""In which form a trial's network runs, and that the drive does not depend on it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from costeer.intention.starts import BracketWeights
from costeer.intention.weights import load_weights, save_weights
from costeer.loop.network import network_form, trial_network, trial_predictor
from costeer.loop.scenario import TrialSetup, check_setup, loop_parameters
from costeer.loop.trial import simulate_trial
from costeer.methods.ibhs import IBHS
from costeer.training.bracket_check import BAND, Tally, with_check

PASSED = Tally(kilometres=2000.0, verdicts=10**6, triggers=900, margin=0.4)
SETUP = TrialSetup(seed=5, condition="strong-normal", length=2000.0)


@pytest.fixture(scope="module")
def checked(tmp_path_factory: pytest.TempPathFactory) -> TrialSetup:
    """A trial with the shipped numbers, said to have passed."""
    file: Path = tmp_path_factory.mktemp("weights") / "checked.npz"
    save_weights(file, with_check(load_weights(), PASSED, 1))
    return SETUP._replace(weights=str(file))


def form(setup: TrialSetup) -> str | None:
    return network_form(setup, loop_parameters(setup), trial_predictor(setup))


def packed(setup: TrialSetup) -> BracketWeights:
    parameters, predictor = loop_parameters(setup), trial_predictor(setup)
    return trial_network(setup, parameters, predictor).weights


def test_weights_that_passed_run_with_their_band(checked: TrialSetup) -> None:
    assert form(checked) == "bracket"
    assert form(checked._replace(condition="manual")) == "bracket"
    assert form(checked._replace(method="lane-keeping")) == "bracket"
    assert packed(checked).low == pytest.approx(math.log(BAND.low / (1.0 - BAND.low)))


def test_whoever_looks_at_the_number_gets_the_exact_form(checked: TrialSetup) -> None:
    # A method of somebody else may use the probability itself.
    own = IBHS._replace(name="mine")
    other = ("inference.threshold", 0.3)
    for setup in (
        checked._replace(exact_network=True),
        checked._replace(parameters=(other,)),
        checked._replace(method=own),
    ):
        assert form(setup) == "exact"
        assert packed(setup).low == -math.inf
    assert form(checked._replace(parameters=(("inference.threshold", 0.5),)))


def test_weights_without_a_check_run_exactly(tmp_path: Path) -> None:
    file, network = tmp_path / "network.npz", load_weights()
    facts = {n: v for n, v in network.facts.items() if n != "bracket"}
    save_weights(file, network._replace(facts=facts))
    assert form(SETUP._replace(weights=str(file))) == "exact"


def test_without_a_network_in_the_loop_there_is_no_form() -> None:
    assert form(SETUP._replace(intention="scripted")) is None
    assert form(SETUP._replace(predictor="line-time")) is None


def test_both_forms_drive_the_same_drive(checked: TrialSetup) -> None:
    bracket = simulate_trial(checked)
    exact = simulate_trial(checked._replace(exact_network=True))
    assert bracket.metadata["network_form"] == "bracket"
    assert exact.metadata["network_form"] == "exact"
    assert bracket.metadata["intention_model_hash"] == load_weights().hash
    for name, values in exact.columns.items():
        one, other = np.ma.getdata(values), np.ma.getdata(bracket.columns[name])
        if name == "crossing_probability":
            np.testing.assert_array_equal(one >= 0.5, other >= 0.5)
            assert (one[179:] != other[179:]).mean() > 0.5
            assert (one >= 0.5).any()
        else:
            assert one.tobytes() == other.tobytes(), name


def test_exact_network_is_yes_or_no() -> None:
    with pytest.raises(ValueError, match="exact_network is 'no'; give True or False"):
        check_setup(SETUP._replace(exact_network="no"))  # type: ignore[arg-type]  # wrong on purpose
