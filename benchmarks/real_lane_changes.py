"""The intention network on people it has never seen, beside its rivals.

    python benchmarks/real_lane_changes.py --data FOLDER [SET ...]

FOLDER holds the sets of docs/datasets.md. Everything but the last two rows of each
table learned from virtual drivers only; the last two learned from other vehicles of the
same set, four folds by vehicle. Intervals are 95 % by resampling vehicles, differences
are to the network as it ships. Needs the extra `train`; some minutes.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from costeer.intention.weights import load_weights
from costeer.training.comparison import Difference, Judged
from costeer.training.datasets.catalogue import read_dataset
from costeer.validation.intention.transfer import transfer

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
