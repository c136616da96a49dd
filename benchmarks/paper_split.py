"""The paper's network under the paper's split by time, and under a split by driver.

    python -m benchmarks.paper_split [--steps N] [--trials N] [--seed N] [--json FILE]

Nine virtual drivers, each at several manual trials. By time: the last 30 minutes of
three drivers test, the rest of the same drivers trains. By driver: the same minutes
test, but nothing of the three drivers trains. The paper reports an accuracy of 94.8 %
for the first. Takes minutes; fewer steps and trials for a try.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.splits import PAPER, compare_splits, paper_recordings

PUBLISHED = 0.948
"""Accuracy of the paper's network. Source: the paper."""

ROWS = (
    ("accuracy", "samples", "accuracy"),
    ('accuracy of "never"', "samples", "accuracy_of_never"),
    ("balanced accuracy", "samples", "balanced_accuracy"),
    ("F1", "samples", "f1"),
    ("PR-AUC", "samples", "pr_auc"),
    ("ROC-AUC", "samples", "roc_auc"),
    ("half positive: accuracy", "balanced", "accuracy"),
    ("half positive: accuracy at even odds", "balanced", "accuracy_even_odds"),
    ("half positive: F1", "balanced", "f1"),
    ("half positive: PR-AUC", "balanced", "pr_auc"),
    ("false triggers [1/km]", "triggers", "false_per_km"),
    ("missed crossings", "triggers", "missed"),
    ("lead, median [s]", "triggers", "lead_time_median"),
    ("at the rate: lead, median [s]", "at_false_rate", "lead_time_median"),
)


def table(found: dict[str, dict[str, Any]]) -> list[str]:
    """Lines of the table, the two splits side by side."""
    names = list(found)
    lines = [f"{'':38s}" + "".join(f"{name:>12s}" for name in names)]
    for part in ("training", "validation", "test"):
        times = [found[name]["hours_of_parts"][part] for name in names]
        lines.append(f"{part + ' [h]':38s}" + "".join(f"{t:12.2f}" for t in times))
    for words, part, score in ROWS:
        values = [found[name][part].get(score) for name in names]
        cells = ["–" if value is None else f"{value:.3f}" for value in values]
        lines.append(f"{words:38s}" + "".join(f"{cell:>12s}" for cell in cells))
    lines.append(f"{'accuracy in the paper':38s}{PUBLISHED:12.3f}")
    return lines


def main(words: Sequence[str] | None = None) -> None:
    """Simulate, train twice, judge, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=PAPER.num_steps)
    parser.add_argument("--trials", type=int, default=PAPER.trials_per_driver)
    parser.add_argument("--test-minutes", type=float, default=PAPER.test_time / 60.0)
    parser.add_argument("--hidden", type=int, default=PAPER.hidden_size)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", type=Path, help="file for all numbers")
    asked = parser.parse_args(words)
    parameters = PAPER._replace(
        num_steps=asked.steps,
        trials_per_driver=asked.trials,
        test_time=60.0 * asked.test_minutes,
        hidden_size=asked.hidden,
    )
    recordings = paper_recordings(parameters, asked.seed, os.cpu_count() or 1)
    found = compare_splits(parameters, recordings, asked.seed)
    print("\n".join(table(found)))
    if asked.json:
        asked.json.write_text(json.dumps(found, indent=1, allow_nan=False) + "\n")


if __name__ == "__main__":
    main()
