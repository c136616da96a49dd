"""The report tells of the network what the network's own file tells."""

from __future__ import annotations

import pytest

from costeer.intention.weights import IntentionNetwork
from costeer.study.material import StudyMaterial
from costeer.study.reporting import network

FACTS = {
    "source": "120 simulated manual drivers",
    "hidden_size": 8,
    "drivers": {"training": ["1", "2"], "test": ["3"]},
    "curves": {"8": [[1, 2.0]]},
    "test": {
        "kilometres": 190.56,
        "samples": {"recall": 0.894, "accuracy": 0.991, "log_loss": 0.03},
        "triggers": {"missed": 0.0, "num_crossings": 189.0},
        "interval_95": {"recall": [0.865, 0.922]},
    },
}


@pytest.fixture
def _shipped(monkeypatch: pytest.MonkeyPatch) -> None:
    def load() -> IntentionNetwork:
        # The weights themselves are not read: None stands in for them.
        return IntentionNetwork(weights=None, facts=FACTS, hash="abc")  # type: ignore[arg-type]  # as said above

    monkeypatch.setattr(network, "load_weights", load)


def with_hash(material: StudyMaterial, found: str | None) -> StudyMaterial:
    configuration = {**material.study.configuration, "intention_model_hash": found}
    return material._replace(study=material.study._replace(configuration=configuration))


@pytest.mark.usefixtures("_shipped")
def test_results_stand_with_their_intervals(material: StudyMaterial) -> None:
    table = network.network_table(with_hash(material, "abc"))
    assert table is not None
    assert dict(table.rows) == {
        "Trained on": "120 simulated manual drivers",
        "Hidden units": "8",
        "Drivers": "1 for test, 2 for training",
        "Driven in the test [km]": "191",
        "Accuracy": "0.991",
        "Recall": "0.894 [0.865, 0.922]",
        "Crossings": "189",
        "Missed crossings": "0",
    }


@pytest.mark.usefixtures("_shipped")
@pytest.mark.parametrize("found", [None, "another"])
def test_another_network_or_none_is_not_told_of(
    material: StudyMaterial, found: str | None
) -> None:
    assert network.network_table(with_hash(material, found)) is None


def test_a_network_that_cannot_be_read_is_not_told_of(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail() -> IntentionNetwork:
        raise OSError("gone")

    monkeypatch.setattr(network, "load_weights", fail)
    assert network.network_facts("abc") is None


def test_a_file_without_facts_gives_no_rows() -> None:
    assert network._training_rows({}) == []
    assert network._test_rows({}) == []
