"""The network that ships: there, small, of these drivers, and worth what it says."""

from __future__ import annotations

import re
from functools import partial
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from costeer.drivers.population import POPULATION_VERSION
from costeer.intention.features import VARIANTS
from costeer.intention.gru import hidden_size
from costeer.intention.predictors.gru import our_probabilities
from costeer.intention.weights import load_weights, save_weights
from costeer.training.evaluate import evaluate
from costeer.training.simulation import simulate_recordings

PAGE = Path(__file__).parents[2] / "docs" / "intention.md"


def test_it_is_below_a_megabyte_and_is_what_it_would_be_written_as(
    tmp_path: Path,
) -> None:
    shipped = resources.files("costeer.intention").joinpath("data", "ibhs.npz")
    content = shipped.read_bytes()
    assert len(content) < 1_000_000
    save_weights(tmp_path / "again.npz", load_weights())
    assert (tmp_path / "again.npz").read_bytes() == content


def test_it_was_trained_on_the_drivers_of_this_version() -> None:
    assert f"population {POPULATION_VERSION}" in load_weights().facts["source"]


def test_no_driver_had_two_parts() -> None:
    parts = [set(names) for names in load_weights().facts["drivers"].values()]
    assert len(parts) == 3
    assert len(set.union(*parts)) == sum(map(len, parts))


@pytest.mark.slow  # drives kilometres
def test_it_judges_other_seeds_as_its_facts_say() -> None:
    network = load_weights()
    predict = partial(our_probabilities, network.weights)
    result = evaluate(predict, simulate_recordings(6, seed=98_765, jobs=2))
    told = network.facts["test"]
    # Six drivers scatter about three times as much as the 48 of the facts, whose
    # interval for the area is ±0.01.
    told_area = told["samples"]["pr_auc"]
    assert result["samples"]["pr_auc"] == pytest.approx(told_area, abs=0.04)
    assert result["triggers"]["missed_share"] <= 0.1
    lead = told["triggers"]["lead_time_median"]
    assert result["triggers"]["lead_time_median"] == pytest.approx(lead, abs=0.5)


def test_the_page_tells_the_numbers_of_the_file() -> None:
    network, page = load_weights(), PAGE.read_text("utf-8")
    test = network.facts["test"]
    values = test["samples"] | test["triggers"]
    rows = {
        "accuracy": "accuracy",
        'accuracy of the answer "never"': "accuracy_of_never",
        "balanced accuracy": "balanced_accuracy",
        "F1": "f1",
        "area under the precision-recall curve": "pr_auc",
        "area under the ROC curve": "roc_auc",
        "false triggers per km": "false_per_km",
    }
    for label, name in rows.items():
        low, high = test["interval_95"][name]
        row = f"| {label} | {values[name]:.3f} | {low:.3f} to {high:.3f} |"
        assert row in page
    assert f"median | {values['lead_time_median']:.2f} s |" in page
    sizes = sorted(network.facts["hidden_sizes"].items(), key=lambda item: int(item[0]))
    areas = ", ".join(f"{point['validation_pr_auc']:.3f}" for _, point in sizes)
    assert areas in page
    means = [np.mean(list(point["pr_auc"].values())) for _, point in sizes]
    assert ", ".join(f"{mean:.3f}" for mean in means) in page
    assert f"so {hidden_size(network.weights)}." in page


def test_the_python_of_the_page_runs(capsys: pytest.CaptureFixture[str]) -> None:
    (block,) = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    exec(compile(block, PAGE.name, "exec"), {})
    assert capsys.readouterr().out == "True\n"


def test_every_learning_curve_is_kept_and_falls() -> None:
    for curve in load_weights().facts["curves"].values():
        losses = np.array(curve)[:, 2]
        assert losses.min() < losses[0]


def test_the_page_tells_what_each_variant_is_worth() -> None:
    network, page = load_weights(), PAGE.read_text("utf-8")
    assert list(network.facts["variants"]) == sorted(VARIANTS)
    for scores in network.facts["variants"].values():
        told = (scores["pr_auc"], scores["balanced_accuracy"], scores["log_loss"])
        assert " | {:.3f} | {:.3f} | {:.3f} |".format(*told) in page


def test_it_does_without_every_signal_but_the_speed() -> None:
    lacking = load_weights().weights.dispensable
    assert lacking.tolist() == [1.0, 1.0, 0.0, 1.0, 1.0, 1.0]


def test_the_hash_on_the_page_is_that_of_the_file() -> None:
    assert load_weights().hash[:12] in PAGE.read_text("utf-8")
