"""Tables of the page and the CSV files of a judgement."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from costeer.pages.numerals import NOTHING, interval, number, signed
from costeer.pages.tables import Table
from costeer.study.trial_tables import write_csv
from costeer.training.assessment import shown
from costeer.training.bootstrap import AT_RATE
from costeer.training.comparison import Comparison, Difference, Judged
from costeer.training.operating import operating_curve
from costeer.validation.intention.driver_figures import driver_scores
from costeer.validation.intention.material import Material

Facts = dict[str, Any]  # Any: JSON

PREDICTORS_FILE, ABLATIONS_FILE = "predictors.csv", "ablations.csv"
DRIVERS_FILE, OPERATING_FILE = "drivers.csv", "operating.csv"

_OWN = (
    ("samples", "prevalence", "Prevalence [-]", 3),
    ("samples", "accuracy", "Accuracy [-]", 4),
    ("samples", "accuracy_of_never", "Accuracy of the answer “never” [-]", 4),
    ("samples", "balanced_accuracy", "Balanced accuracy [-]", 3),
    ("samples", "precision", "Precision [-]", 3),
    ("samples", "recall", "Recall [-]", 3),
    ("samples", "f1", "F1 [-]", 3),
    ("samples", "pr_auc", "Area under precision and recall [-]", 3),
    ("samples", "roc_auc", "Area under ROC [-]", 4),
    ("samples", "brier", "Brier score [-]", 4),
    ("samples", "log_loss", "Log loss [nat]", 4),
    ("samples", "calibration_error", "Calibration error [-]", 4),
    ("balanced", "accuracy", "Half positive: accuracy [-]", 3),
    ("balanced", "accuracy_even_odds", "Half positive: accuracy at even odds [-]", 3),
    ("balanced", "f1", "Half positive: F1 [-]", 3),
    ("balanced", "pr_auc", "Half positive: area, precision and recall [-]", 4),
    ("triggers", "false_per_km", "False triggers [1/km]", 3),
    ("triggers", "false_per_hour", "False triggers [1/h]", 2),
    ("triggers", "missed_share", "Missed crossings, share [-]", 3),
    ("triggers", "lead_time_median", "Lead time, median [s]", 2),
    ("triggers", "lead_time_p10", "Lead time, 10 % [s]", 2),
    ("triggers", "lead_time_p90", "Lead time, 90 % [s]", 2),
    ("at_false_rate", "threshold", "At the rate: threshold [-]", 3),
    ("at_false_rate", "false_per_km", "At the rate: false triggers [1/km]", 3),
    ("at_false_rate", "missed", "At the rate: missed crossings", 0),
    ("at_false_rate", "lead_time_median", "At the rate: lead time, median [s]", 2),
    ("at_false_rate", "lead_time_p10", "At the rate: lead time, 10 % [s]", 2),
    ("at_false_rate", "lead_time_p90", "At the rate: lead time, 90 % [s]", 2),
)
"""Part, score, words and decimals of the table of the judged predictor."""

_INTERVALS = {
    ("balanced", "accuracy"): "balanced_accuracy",
    ("balanced", "f1"): "f1_balanced",
    ("balanced", "pr_auc"): "pr_auc_balanced",
    ("at_false_rate", "lead_time_median"): AT_RATE,
}
"""Name of the interval where it is not that of the score."""


def own_table(material: Material) -> Table:
    """All scores of the judged predictor with their intervals."""
    facts = material.facts
    rows = tuple(
        (
            words,
            shown_number(facts[part].get(name), digits),
            _ends(facts, part, name, digits),
        )
        for part, name, words, digits in _OWN
    )
    return Table(
        name="scores",
        title=f"Scores of {material.assessment.judged.title}",
        note=f"Threshold {facts['threshold']:g} unless said. Intervals: 95 %, drivers "
        f"resampled. At the rate: at most {facts['false_per_km_allowed']:g} false "
        "triggers per km, largest median lead.",
        header=("Score", "Value", "95 % interval"),
        rows=rows,
    )


def _ends(facts: Facts, part: str, name: str, digits: int) -> str:
    """Interval of a score; nothing where it has none."""
    if facts["num_drivers"] < 2:
        return ""
    otherwise = name if part in ("samples", "triggers") else ""
    ends = facts["interval_95"].get(_INTERVALS.get((part, name), otherwise))
    return interval(ends[0], ends[1], digits) if ends else ""


def shown_number(value: float | None, digits: int) -> str:
    """A number with its decimals; a dash if there is none."""
    return NOTHING if value is None else number(float(value), digits)


_COLUMNS = (
    "Accuracy",
    "Balanced\naccuracy",
    "F1",
    "PR area",
    "Difference\nin PR area",
    "ROC area",
    "Calibration\nerror",
    "Lead at the\nrate [s]",
    "Difference\nin lead [s]",
    "Missed at\nthe rate",
)


def comparison_table(comparison: Comparison, name: str, title: str) -> Table:
    """Predictors, or one with signals taken away, side by side."""
    facts = comparison.judged[0].judgement.facts
    never = shown_number(facts["samples"]["accuracy_of_never"], 3)
    return Table(
        name=name,
        title=title,
        note=f"All rows over the same {facts['num_samples']} samples, "
        f"{facts['kilometres']:.1f} km, {facts['num_crossings']} crossings of "
        f"{facts['num_drivers']} drivers. The answer “never” has an accuracy of "
        f"{never}. Lead: median, at most {facts['false_per_km_allowed']:g} false "
        "triggers per km. Below a value its 95 % interval over drivers; differences "
        "are to the first row, in the same resamplings: a tie if the interval holds 0.",
        header=("", *_COLUMNS),
        rows=tuple(_row(one, comparison.reference) for one in comparison.judged),
    )


def _row(one: Judged, reference: str) -> tuple[str, ...]:
    facts = one.judgement.facts
    samples, rated = facts["samples"], facts["at_false_rate"]
    own = one.name == reference

    def with_ends(part: str, name: str, digits: int) -> str:
        value = shown_number(facts[part].get(name), digits)
        return f"{value}\n{_ends(facts, part, name, digits)}".rstrip()

    return (
        one.title,
        shown_number(samples["accuracy"], 4),
        shown_number(samples["balanced_accuracy"], 3),
        shown_number(samples["f1"], 3),
        with_ends("samples", "pr_auc", 3),
        NOTHING if own else _against(one.differences.get("pr_auc"), 3),
        shown_number(samples["roc_auc"], 3),
        shown_number(samples["calibration_error"], 4),
        with_ends("at_false_rate", "lead_time_median", 2),
        NOTHING if own else _against(one.differences.get(AT_RATE), 2),
        shown_number(rated.get("missed"), 0),
    )


def _against(difference: Difference | None, digits: int) -> str:
    """A difference, its interval and the verdict, one below the other."""
    if difference is None:
        return NOTHING
    parts = (
        signed(difference.value, digits),
        interval(difference.low, difference.high, digits),
        difference.verdict,
    )
    return "\n".join(part for part in parts if part)


def write_tables(folder: Path, material: Material) -> None:
    """Write `predictors.csv`, `drivers.csv`, `operating.csv` and `ablations.csv`."""
    rows = shown(material.assessment)
    write_csv(folder / PREDICTORS_FILE, [_csv_row(one) for one in rows])
    write_csv(folder / DRIVERS_FILE, [r for one in rows for r in _driver_rows(one)])
    points = [
        {"predictor": one.name, **point._asdict()}
        for one in rows
        for point in operating_curve(one.judgement.operating)
    ]
    write_csv(folder / OPERATING_FILE, points)
    ablations = material.assessment.ablations
    if ablations is None:
        (folder / ABLATIONS_FILE).unlink(missing_ok=True)
    else:
        write_csv(folder / ABLATIONS_FILE, [_csv_row(one) for one in ablations.judged])


def _csv_row(one: Judged) -> dict[str, object]:
    """Every score of a predictor, with intervals and differences."""
    facts = one.judgement.facts
    row: dict[str, object] = {"predictor": one.name, "title": one.title}
    for name in ("num_drivers", "num_crossings", "num_samples", "hours", "kilometres"):
        row[name] = facts[name]
    for part, name, _, _ in _OWN:
        row[f"{part}_{name}"] = facts[part].get(name)
    for name in ("pr_auc", AT_RATE):
        low, high = facts["interval_95"].get(name, (None, None))
        row |= {f"{name}_low_95": low, f"{name}_high_95": high}
        difference = one.differences.get(name)
        for part in Difference._fields:
            row[f"{name}_difference_{part}"] = getattr(difference, part, None)
    return row


def _driver_rows(one: Judged) -> list[dict[str, object]]:
    scores = zip(*driver_scores(one), strict=True)
    drivers = (each.driver for each in one.judgement.drivers)
    return [
        {
            "predictor": one.name,
            "driver": driver,
            "pr_auc": float(area),
            "lead_time_at_rate": float(lead),
            "false_per_km_at_rate": float(false),
        }
        for driver, (area, lead, false) in zip(drivers, scores, strict=True)
    ]
