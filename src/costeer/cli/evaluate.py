"""`costeer evaluate`: judge the intention network on records or a table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from costeer.cli.console import note
from costeer.cli.reading import AS_FOUND, Told, reads_tables
from costeer.cli.scaled import Cluster
from costeer.cli.validate import at_least, fraction, in_range, positive

if TYPE_CHECKING:
    from costeer.training.recordings import Recording

OURS = "gru"
"""Name of costeer's own predictor, as in intention/predictors/registry.py."""

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
_BALANCED = (
    ("accuracy", "accuracy"),
    ("accuracy_even_odds", "accuracy at even odds"),
    ("f1", "F1"),
    ("pr_auc", "area under precision-recall curve"),
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


@reads_tables
def evaluate(
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Trial records or tables (text, Parquet, Arrow) to judge on."
        ),
    ] = None,
    weights: Annotated[
        Path | None,
        typer.Option(
            help="Weights written by `costeer train`; by default those that "
            "ship with costeer."
        ),
    ] = None,
    predictor: Annotated[
        str,
        typer.Option(
            help="Predictor to judge: gru (costeer's own network), another "
            "name that ships, module:object or FILE.py."
        ),
    ] = OURS,
    compare: Annotated[
        bool, typer.Option("--compare", help="Judge all other predictors as well.")
    ] = False,
    without: Annotated[
        list[str] | None,
        typer.Option(
            metavar="SIGNAL", help="Signal to withhold from the predictor; repeatable."
        ),
    ] = None,
    ablations: Annotated[
        bool,
        typer.Option(
            "--ablations", help="Judge also with signals withheld, alone and in groups."
        ),
    ] = False,
    simulate: Annotated[
        int | None,
        typer.Option(
            help="Number of virtual drivers to judge on, none of them used "
            "in training.",
            callback=in_range(1, 10_000),
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            help="Seed of the simulated drivers; by default 1.", callback=at_least(0)
        ),
    ] = None,
    scenario: Annotated[
        str | None,
        typer.Option(
            metavar="NAME|FILE",
            help="With --simulate: scenario to drive, at its own speed; by "
            "default the road of the paper, at several speeds.",
        ),
    ] = None,
    dataset: Annotated[
        str | None,
        typer.Option(help="Data set of real driving to judge on, such as ngsim_lc."),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(
            help="With --dataset: folder that holds the data sets; by default "
            "the one that the environment variable COSTEER_DATA names, else data."
        ),
    ] = None,
    resample: Annotated[
        bool,
        typer.Option(
            "--resample",
            help="Resample tables of another rate to 60 Hz, which delays "
            "them by a row.",
        ),
    ] = False,
    threshold: Annotated[
        float | None,
        typer.Option(
            help="Probability from which a prediction is positive; by "
            "default the value stored with the weights, or else 0.5.",
            callback=fraction(),
        ),
    ] = None,
    false_per_km: Annotated[
        float,
        typer.Option(
            help="False triggers per kilometre at which lead times are compared.",
            callback=positive("per km"),
        ),
    ] = 0.05,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder to write a report, figures and tables into."),
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print the results as JSON.")
    ] = False,
    cluster: Cluster = "",
    told: Told = AS_FOUND,
) -> None:
    """Judge the intention network on records or a table.

    A table has 60 rows a second and these columns of a trial record: time, lane,
    head_yaw, longitudinal_acceleration, longitudinal_velocity, steering_wheel_angle,
    distance_to_adjacent_lane, yaw_angle. It may also have participant, sequence (which
    tells separate stretches apart) and crossing (-1 or +1 at a crossing, else 0).
    Signals may be missing: the command says which, and which variant of the network it
    uses.

    Example:
        costeer evaluate out/study/records/01-manual.parquet --json
        costeer evaluate --simulate 24 --seed 7 --compare --ablations --out out/judged
        costeer evaluate --simulate 24 --scenario three-lanes
        costeer evaluate drives.csv --predictor line-time --without head_yaw
        costeer evaluate others.csv --map lab.yaml --resample
        costeer evaluate --dataset ngsim_lc --data data --compare
    """
    from costeer.cli import evaluation as parts
    from costeer.training.evaluate import DEFAULTS
    from costeer.training.thresholds import chosen_threshold

    source = parts.Source(
        files or [], simulate, seed, dataset, data, resample, told, scenario, cluster
    )
    parts.check_source(source)
    chosen = parts.Chosen(predictor, weights, compare, tuple(without or ()), ablations)
    parts.check_chosen(chosen)
    if out is not None:
        parts.prepare_folder(out)
    parameters = DEFAULTS._replace(
        triggers=DEFAULTS.triggers._replace(
            threshold=chosen_threshold(threshold, predictor, weights)
        ),
        false_per_km=false_per_km,
    )
    recordings = parts.read_source(source)
    print_notes(recordings)
    judged = parts.judge(parameters, source, chosen, recordings)
    if out is not None:
        parts.write_folder(out, judged)
    if json:
        import json as encoder

        typer.echo(encoder.dumps(judged.facts, indent=2, allow_nan=False))
        return
    print_evaluation(judged.facts, judged.title)
    parts.print_comparisons(judged)


def print_notes(recordings: Sequence[Recording]) -> None:
    """Say what should be known before a judgement of the recordings is trusted."""
    lines = Counter(line for recording in recordings for line in recording.notes)
    for line, number in lines.items():
        several = f" ({number} recordings)" if number > 1 else ""
        note(f"note on {line}{several}")


def print_evaluation(result: dict[str, Any], title: str) -> None:
    """Print what `training.evaluate` found as a table."""
    from costeer.cli.console import print_table

    num = result["num_drivers"]
    heading = (
        f"{title}: {num} driver{'s' * (num != 1)}, {result['hours']:.2f} h, "
        f"{result['kilometres']:.1f} km, threshold {result['threshold']:g}"
    )
    intervals = result["interval_95"]
    rows = [
        [label, _shown(name, result[part].get(name)), _interval(intervals.get(name))]
        for part, lines in (("samples", _SAMPLES), ("triggers", _TRIGGERS))
        for name, label in lines
        if name in result[part]
    ]
    balanced = result.get("balanced", {})
    rows += [
        [f"half positive: {label}", _shown(name, balanced[name]), ""]
        for name, label in _BALANCED
        if name in balanced
    ]
    print_table(["score", "value", "95 % over drivers"], rows, title=heading)
    typer.echo(_at_rate_told(result, intervals.get("lead_time_at_false_rate")))
    if why := result.get("intervals", {}).get("none_because"):
        typer.echo(f"No intervals: {why}.")


def _at_rate_told(result: dict[str, Any], ends: list[float] | None) -> str:
    """The best threshold at the fixed rate of false triggers, as a sentence."""
    fixed = result["at_false_rate"]
    if not fixed:
        return "No threshold keeps to the rate of false triggers, or nobody crossed."
    within = f" ({_interval(ends)})" if ends else ""
    return (
        f"At threshold {fixed['threshold']:.3f}: {fixed['false_per_km']:.3f} false "
        f"triggers per km, median lead {_number(fixed['lead_time_median'])} s{within}, "
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
