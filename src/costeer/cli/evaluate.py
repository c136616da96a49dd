"""`costeer evaluate`: judge the intention network on records or a table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from costeer.cli.console import note
from costeer.cli.validate import fraction, positive

if TYPE_CHECKING:
    from costeer.training.recordings import Recording

_SAMPLES = (
    ("prevalence", "prevalence"),
    ("accuracy", "accuracy"),
    ("accuracy_of_never", 'accuracy of the answer "never"'),
    ("balanced_accuracy", "balanced accuracy"),
    ("precision", "precision"),
    ("recall", "recall"),
    ("f1", "F1"),
    ("pr_auc", "area under precision-recall curve"),
    ("roc_auc", "area under ROC curve"),
    ("brier", "Brier score"),
    ("log_loss", "log loss [nat]"),
    ("calibration_error", "calibration error"),
)
_COUNTS = {
    "num_crossings",
    "true_triggers",
    "early_triggers",
    "false_triggers",
    "missed",
}
_TRIGGERS = (
    ("num_crossings", "crossings the drivers meant"),
    ("true_triggers", "true triggers"),
    ("early_triggers", "early triggers (3 to 5 s)"),
    ("false_triggers", "false triggers"),
    ("false_per_km", "false triggers [1/km]"),
    ("false_per_hour", "false triggers [1/h]"),
    ("missed", "missed crossings"),
    ("lead_time_median", "lead time, median [s]"),
    ("lead_time_p10", "lead time, 10th percentile [s]"),
    ("lead_time_p90", "lead time, 90th percentile [s]"),
)


def evaluate(
    files: Annotated[
        list[Path], typer.Argument(help="Trial records or tables (CSV, Parquet).")
    ],
    weights: Annotated[
        Path | None, typer.Option(help="File of `costeer train`; else the shipped one.")
    ] = None,
    threshold: Annotated[
        float,
        typer.Option(help="Positive from this probability on.", callback=fraction()),
    ] = 0.5,
    false_per_km: Annotated[
        float,
        typer.Option(
            help="False triggers a kilometre at which lead times are compared.",
            callback=positive("per km"),
        ),
    ] = 0.05,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Judge the intention network on records or a table.

    A table has the names of a trial record: time, lane, head_yaw,
    longitudinal_acceleration, longitudinal_velocity, steering_wheel_angle,
    distance_to_adjacent_lane, yaw_angle, at 60 rows a second; if wanted sequence
    (separate stretches), participant, and crossing (-1, 0, +1 at a crossing).

    Example:
        costeer evaluate out/study/records/01-manual.parquet --json
    """
    from costeer.intention.weights import load_weights
    from costeer.training.evaluate import DEFAULTS
    from costeer.training.evaluate import evaluate as judge
    from costeer.training.recordings import read_recordings

    network = load_weights(weights)
    parameters = DEFAULTS._replace(
        triggers=DEFAULTS.triggers._replace(threshold=threshold),
        false_per_km=false_per_km,
    )
    recordings = read_recordings(files)
    print_notes(recordings)
    result = judge(network.weights, recordings, parameters)
    result = {"intention_model_hash": network.hash, **result}
    if json:
        import json as encoder

        typer.echo(encoder.dumps(result, indent=2))
    else:
        print_evaluation(result, f"Network {network.hash[:12]}")


def print_notes(recordings: Sequence[Recording]) -> None:
    """Say what should be known before a judgement of the recordings is trusted."""
    for recording in recordings:
        for line in recording.notes:
            note(f"note on {line}")


def print_evaluation(result: dict[str, Any], title: str) -> None:
    """Print what `training.evaluate` found as a table."""
    from costeer.cli.console import print_table

    num = result["num_drivers"]
    heading = (
        f"{title}: {num} driver{'s' * (num != 1)}, {result['hours']:.2f} h, "
        f"{result['kilometres']:.1f} km, threshold {result['threshold']:g}"
    )
    intervals = result["interval_95"] if num > 1 else {}
    rows = [
        [label, _shown(name, result[part].get(name)), _interval(intervals.get(name))]
        for part, lines in (("samples", _SAMPLES), ("triggers", _TRIGGERS))
        for name, label in lines
    ]
    print_table(["score", "value", "95 % over drivers"], rows, title=heading)
    fixed = result["at_false_rate"]
    if fixed:
        typer.echo(
            f"At threshold {fixed['threshold']:.3f}: {fixed['false_per_km']:.3f} false "
            f"triggers per km, median lead {_number(fixed['lead_time_median'])} s, "
            f"missed {fixed['missed']:.0f}."
        )


def _shown(name: str, value: float | None) -> str:
    if name in _COUNTS and value is not None:
        return f"{value:.0f}"
    return _number(value)


def _number(value: float | None) -> str:
    if value is None:
        return "–"
    return (
        f"{value:.0f}" if value == round(value) and abs(value) >= 1 else f"{value:.3f}"
    )


def _interval(ends: list[float] | None) -> str:
    return f"{_number(ends[0])} to {_number(ends[1])}" if ends else ""
