"""What one could know who knew the driver's plan: a limit that no signal reaches.

    python -m benchmarks.plan_oracle [--drivers N] [--seed N]

The oracle says yes while the plan of the virtual driver crosses the line within 3 s. It
errs where the car crosses sooner or later than planned, and where a planned change is
given up. Beside it stands the network on the same drivers, who trained nothing.
"""

from __future__ import annotations

import argparse
import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from costeer.intention.predictors.registry import OURS, predictor
from costeer.loop.trial import simulate_trial
from costeer.training.comparison import Contender, compare_verdicts, contender
from costeer.training.recordings import recordings_of
from costeer.training.simulation import FIRST_UNSEEN, manual_setup


def main() -> None:
    """Print both."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--drivers", type=int, default=24)
    parser.add_argument("--seed", type=int, default=7)
    arguments = parser.parse_args()
    setups = [
        manual_setup(FIRST_UNSEEN + k, arguments.seed, k)._replace(intention="scripted")
        for k in range(arguments.drivers)
    ]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        records = list(pool.map(simulate_trial, setups))
    recordings = [one for r in records for one in recordings_of(r, "simulated")]
    plans = [np.asarray(r.columns["crossing_probability"], float) for r in records]
    rows = [
        contender(predictor(OURS), recordings),
        Contender("oracle", "Knows the plan", "", plans),
    ]
    for one in compare_verdicts(rows, recordings, OURS).judged:
        facts = one.judgement.facts
        samples, triggers = facts["samples"], facts["triggers"]
        print(
            f"{one.title}: accuracy {samples['accuracy']:.4f}, balanced "
            f"{samples['balanced_accuracy']:.4f}, PR-AUC {samples['pr_auc']:.4f}, "
            f"false/km {triggers['false_per_km']:.3f}, missed "
            f"{triggers['missed']:.0f} of {triggers['num_crossings']:.0f}, lead "
            f"{triggers['lead_time_median']:.2f} s"
        )


if __name__ == "__main__":
    main()
