"""Would more drivers, or a larger network, tell more? The plateau is the limit.

    python -m benchmarks.learning_curve [--drivers N] [--steps N] [--hidden N]

Trains the network of all six signals on 1/16, 1/8, 1/4, 1/2 and all of the training
drivers of `costeer train --simulate N`, and prints what the validation drivers, always
the same, make of it. Where the curve is flat the six signals of the window do not tell
more. Needs the extra `train`; ten minutes.
"""

from __future__ import annotations

import argparse
import os

from costeer.training.augmentation import ALL_SIGNALS, dispensable
from costeer.training.dataset import (
    DatasetParameters,
    shown,
    split_by_driver,
    windows,
)
from costeer.training.fit import FitParameters, fit
from costeer.training.scaling import scaling
from costeer.training.simulation import simulate_recordings

SEED = 1
SHARES = (16, 8, 4, 2, 1)


def main() -> None:
    """Print a row per number of drivers."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--drivers", type=int, default=240)
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--hidden", type=int, default=16)
    arguments = parser.parse_args()
    recordings = simulate_recordings(arguments.drivers, SEED, os.cpu_count() or 1)
    dataset = DatasetParameters()
    split = split_by_driver(recordings, SEED, dataset)
    parameters = FitParameters(
        num_steps=arguments.steps,
        steps_per_check=max(arguments.steps // 4, 1),
        augmentation=ALL_SIGNALS,
    )
    print("drivers   windows   validation log loss   PR-AUC")
    for share in SHARES:
        some = split.training[::share]
        data = windows(shown(some), dataset)
        scale = scaling(some, dispensable(ALL_SIGNALS))
        found = fit(data, scale, split.validation, arguments.hidden, SEED, parameters)
        loss, area = found.best.validation_log_loss, found.best.validation_pr_auc
        row = f"{len(some):7d} {len(data.ends):9d} {loss:21.4f} {area:8.4f}"
        print(row, flush=True)


if __name__ == "__main__":
    main()
