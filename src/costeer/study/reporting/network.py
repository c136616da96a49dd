"""What the file of the intention network says of its training and its test."""

from __future__ import annotations

from typing import Any

from costeer.intention.weights import load_weights
from costeer.pages.numerals import interval, number
from costeer.pages.tables import Table
from costeer.study.material import StudyMaterial

_SHOWN = {
    "accuracy_of_never": "Accuracy of never expecting a crossing",
    "accuracy": "Accuracy",
    "balanced_accuracy": "Balanced accuracy",
    "precision": "Precision",
    "recall": "Recall",
    "f1": "F1",
    "pr_auc": "Area under precision and recall",
    "roc_auc": "Area under ROC",
    "brier": "Brier score",
    "calibration_error": "Calibration error",
    "num_crossings": "Crossings",
    "missed": "Missed crossings",
    "false_triggers": "False triggers",
    "false_per_km": "False triggers per km",
    "early_triggers": "Early triggers",
    "lead_time_median": "Median lead time [s]",
}
"""Results of the test, by their names in the file."""

Facts = dict[str, Any]  # Any: JSON


def network_table(material: StudyMaterial) -> Table | None:
    """Return what the network's file says of it; None without that very network."""
    facts = network_facts(material.study.configuration.get("intention_model_hash"))
    if facts is None:
        return None
    return Table(
        name="network",
        title="The intention network by itself",
        note="From its file: results on drivers held out of its training, in manual "
        "driving, per sample and per trigger, with 95 % intervals where the file has "
        "them. None of these drivers is in a study. How it does in this study stands "
        "in the tables before.",
        header=("Fact", "Value"),
        rows=(*_training_rows(facts), *_test_rows(facts.get("test", {}))),
        num_labels=2,
        prose=True,
    )


def network_facts(wanted: object) -> Facts | None:
    """Return the facts of the shipped network if its hash is the one wanted."""
    if not wanted:
        return None
    try:
        network = load_weights()
    except (OSError, ValueError):
        return None
    return network.facts if network.hash == wanted else None


def _training_rows(facts: Facts) -> list[tuple[str, str]]:
    rows = []
    if "source" in facts:
        rows.append(("Trained on", str(facts["source"])))
    if "hidden_size" in facts:
        rows.append(("Hidden units", str(facts["hidden_size"])))
    drivers = facts.get("drivers", {})
    if drivers:
        amounts = (f"{len(each)} for {name}" for name, each in drivers.items())
        rows.append(("Drivers", ", ".join(sorted(amounts))))
    return rows


def _test_rows(test: Facts) -> list[tuple[str, str]]:
    results = {**test.get("samples", {}), **test.get("triggers", {})}
    ends = test.get("interval_95", {})
    rows = []
    if "kilometres" in test:
        rows.append(("Driven in the test [km]", number(float(test["kilometres"]), 0)))
    for name, title in _SHOWN.items():
        if name in results:
            value = float(results[name])
            digits = 0 if value.is_integer() and name not in ends else 3
            text = f"{number(value, digits)} {_interval(ends.get(name))}"
            rows.append((title, text.rstrip()))
    return rows


def _interval(ends: list[float] | None) -> str:
    return interval(ends[0], ends[1], 3) if ends else ""
