"""The intention network on people it has never seen, beside its rivals.

    python -m benchmarks.real_lane_changes --data FOLDER [SET ...]

FOLDER holds the sets of docs/datasets.md. Everything but the last two rows of each
table learned from virtual drivers only; the last two learned from other vehicles of the
same set, four folds by vehicle. Intervals are 95 % by resampling vehicles, differences
are to the network as it ships. Needs the extra `train`; some minutes.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import full_windows
from costeer.intention.gru import NetworkWeights
from costeer.intention.predictors.gru import our_probabilities
from costeer.intention.predictors.interface import Probabilities
from costeer.intention.predictors.registry import fitted_predictor, predictor
from costeer.intention.weights import load_weights
from costeer.training.ablation import variant_of
from costeer.training.comparison import (
    Comparison,
    Contender,
    Difference,
    Judged,
    compare_verdicts,
    contender,
)
from costeer.training.dataset import DatasetParameters
from costeer.training.datasets.catalogue import read_dataset
from costeer.training.datasets.folds import folds
from costeer.training.predictors.logistic import DEFAULTS as LOGISTIC
from costeer.training.predictors.logistic import fit_logistic
from costeer.training.predictors.samples import feature_scaling, summary_table
from costeer.training.recordings import Recording
from costeer.training.tuning import DEFAULTS as TUNING
from costeer.training.tuning import fine_tuned
from costeer.training.verdicts import asked

NUM_FOLDS = 4
RIVALS = ("line-time", "logistic", "crossing-time", "head-only")
"""Predictors of virtual drivers that can do without head and wheel, or with the head
alone."""

Learner = Callable[[list[Recording]], Probabilities]


def transfer(
    network: NetworkWeights,
    recordings: Sequence[Recording],
    seed: int,
    num_folds: int = NUM_FOLDS,
) -> Comparison:
    """Predictors of virtual drivers and of people, side by side.

    Args:
        network: Trained on virtual drivers; the reference.
        recordings: Of people, all with the same signals.
        seed: Of the folds and of what is learned.
        num_folds: Into which the drivers are dealt.
    """
    ours = asked(partial(our_probabilities, network), recordings)
    rows = [
        *(contender(predictor(name), recordings) for name in RIVALS),
        Contender("gru", "GRU with hidden signals", "", ours),
        Contender(
            "logistic-people",
            "Logistic regression, fitted to people",
            "",
            out_of_fold(recordings, num_folds, seed, fitted_to_people),
        ),
        Contender(
            "gru-people",
            "GRU, fine-tuned to people",
            "",
            out_of_fold(recordings, num_folds, seed, partial(_tuned, network, seed)),
        ),
    ]
    return compare_verdicts(rows, recordings, "gru")


def out_of_fold(
    recordings: Sequence[Recording], num_folds: int, seed: int, learn: Learner
) -> list[NDArray[np.float64]]:
    """Verdicts on each recording by what learned from the other folds only.

    Args:
        recordings: Of at least as many drivers as folds.
        num_folds: Into which the drivers are dealt.
        seed: Of the folds.
        learn: From recordings to a predictor.
    """
    place = {id(recording): k for k, recording in enumerate(recordings)}
    found = [np.full(len(recording.side), np.nan) for recording in recordings]
    for others, held_out in folds(recordings, num_folds, seed):
        said = asked(learn(others), held_out)
        for recording, verdicts in zip(held_out, said, strict=True):
            found[place[id(recording)]] = verdicts
    return found


def _tuned(
    network: NetworkWeights, seed: int, recordings: list[Recording]
) -> Probabilities:
    return partial(our_probabilities, fine_tuned(network, recordings, seed, TUNING))


def fitted_to_people(recordings: list[Recording]) -> Probabilities:
    """Logistic regression; a fourth of the drivers chooses its penalty."""
    dataset = DatasetParameters()
    scaling = feature_scaling(recordings)
    training, choosing = _two_parts(recordings)
    matching = variant_of(recordings[0].absent)
    variants = () if matching is None else (matching,)
    fitted = fit_logistic(
        summary_table(training, scaling, dataset),
        summary_table(choosing, scaling, dataset),
        scaling,
        LOGISTIC._replace(variants=variants),
    )
    return fitted_predictor("logistic", fitted).probabilities


def _two_parts(
    recordings: list[Recording],
) -> tuple[list[Recording], list[Recording]]:
    """Drivers to fit and drivers to choose by, with lane changes in both."""
    for training, choosing in folds(recordings, NUM_FOLDS, 0):
        if _changes_lanes(training) and _changes_lanes(choosing):
            return training, choosing
    return recordings, recordings


def _changes_lanes(recordings: Sequence[Recording]) -> bool:
    """Whether some full window precedes a crossing."""
    return any(
        bool((full_windows(r.features, r.absent) & r.labels.positive)[::6].any())
        for r in recordings
    )


SETS = ("ngsim_lc", "ngsim_commonroad", "r3_driving", "brain4cars_head")
SEED = 1


def told(value: float | None, digits: int = 3) -> str:
    """A number, or a dash where there is none."""
    return "–" if value is None else f"{value:.{digits}f}"


def beside(difference: Difference | None) -> str:
    """How a row stands to the network as it ships."""
    if difference is None:
        return ""
    return f"{difference.verdict} ({difference.low:+.3f} to {difference.high:+.3f})"


def row(one: Judged) -> str:
    """One predictor as a row of a Markdown table."""
    facts, ends = one.judgement.facts, one.judgement.facts["interval_95"]
    at_rate = facts["at_false_rate"]
    low, high = ends.get("pr_auc", (None, None))
    cells = [
        one.title,
        f"{told(facts['samples']['pr_auc'])} ({told(low)} to {told(high)})",
        beside(one.differences.get("pr_auc")),
        told(facts["samples"]["roc_auc"]),
        told(facts["samples"]["log_loss"]),
        told(at_rate.get("lead_time_median"), 2),
        beside(one.differences.get("lead_time_at_false_rate")),
        told(facts["triggers"]["false_per_km"], 2),
        told(facts["triggers"]["lead_time_median"], 2),
        told(facts["triggers"]["missed"], 0),
    ]
    return "| " + " | ".join(cells) + " |"


HEADER = (
    "| predictor | PR-AUC (95 %) | against ours | ROC-AUC | log loss | lead at 0.05 "
    "false/km [s] | against ours | false/km at 0.5 | lead at 0.5 [s] | missed |"
)


def main() -> None:
    """Print a table for each set."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("sets", nargs="*", default=SETS)
    arguments = parser.parse_args()
    network = load_weights()
    print(f"Network {network.hash[:12]}, {network.facts.get('source')}")
    for name in arguments.sets:
        recordings = read_dataset(name, arguments.data)
        found = transfer(network.weights, recordings, SEED)
        facts = found.judged[0].judgement.facts
        print(
            f"\n{name}: {facts['num_drivers']} drivers, "
            f"{facts['kilometres']:.0f} km of runs, "
            f"{facts['triggers']['num_crossings']:.0f} crossings, "
            f"prevalence {facts['samples']['prevalence']:.3f}"
        )
        print(HEADER)
        print("|---" * HEADER.count(" | ") + "|---|")
        for one in found.judged:
            print(row(one))
        for out in found.excluded:
            print(f"{out.title}: {out.reason}")


if __name__ == "__main__":
    main()
