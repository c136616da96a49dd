"""What the real sets hold, as the network sees them.

    python -m benchmarks.real_sets --data FOLDER [SET ...]

A run is the view to one side, so hours and kilometres of runs count a road with lanes
on both sides twice. Judged are samples with a full window and a known answer; before
crossings to the side of the run the signs are checked: yaw and head go further to the
right, where every run faces, than to the left.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from costeer.intention.features import FEATURES, SAMPLE_RATE, full_windows
from costeer.training.datasets.catalogue import DATASETS, read_dataset
from costeer.training.recordings import Recording


class Inventory(NamedTuple):
    """What is in a set.

    Attributes:
        stretches: Drives without interruption, one or two runs each.
        runs: Views to one side with at least one full window.
        drivers: Vehicles, scenarios or days, whatever is never split.
        hours: Of runs [h].
        kilometres: Of runs [km].
        left: Crossings to the left, in runs to the left.
        right: Crossings to the right.
        judged_crossings: Of both, those with a full window just before.
        full: Share of samples with a full window.
        judged: Share of samples that also have a known answer.
        prevalence: Share of positives among these.
    """

    stretches: int
    runs: int
    drivers: int
    hours: float
    kilometres: float
    left: int
    right: int
    judged_crossings: int
    full: float
    judged: float
    prevalence: float


def inventory(recordings: Sequence[Recording]) -> Inventory:
    """Count what is in the recordings of a set."""
    features = np.concatenate([r.features for r in recordings])
    crossed = np.concatenate([r.intended for r in recordings])
    full = np.concatenate([full_windows(r.features, r.absent) for r in recordings])
    known = full & np.concatenate([r.labels.known for r in recordings])
    positive = np.concatenate([r.labels.positive for r in recordings])
    velocity = features[:, FEATURES.index("longitudinal_velocity")]
    return Inventory(
        stretches=len({r.name.rpartition(":")[0] for r in recordings}),
        runs=len(recordings),
        drivers=len({r.driver for r in recordings}),
        hours=len(features) / SAMPLE_RATE / 3600.0,
        kilometres=float(np.nansum(velocity)) / SAMPLE_RATE / 1000.0,
        left=int((crossed == 1).sum()),
        right=int((crossed == -1).sum()),
        judged_crossings=int((full[:-1] & (crossed[1:] != 0)).sum()),
        full=float(full.mean()),
        judged=float(known.mean()),
        prevalence=float(positive[known].mean()),
    )


def turns(recordings: Sequence[Recording], side: int, name: str) -> list[float]:
    """Sum of the extremes of an angle over the last 4 s before crossings to a side.

    Negative if it went further to the right, where every run faces.
    """
    column, found = FEATURES.index(name), []
    for one in recordings:
        for row in np.flatnonzero(one.intended == side):
            last = one.features[max(0, row - round(4.0 * SAMPLE_RATE)) : row, column]
            if np.isfinite(last).any():
                found.append(float(np.nanmin(last) + np.nanmax(last)))
    return found


def signs(recordings: Sequence[Recording]) -> str:
    """Share of crossings before which yaw and head turn to the side of the run."""
    parts = []
    for side, word in ((-1, "right"), (1, "left")):
        for name in ("yaw_angle", "head_yaw"):
            sums = turns(recordings, side, name)
            if sums:
                share = float(np.mean(np.array(sums) < 0.0))
                parts.append(f"{name} before {word}: {share:.0%} of {len(sums)}")
    return "; ".join(parts) or "no crossing"


def show(name: str, recordings: Sequence[Recording]) -> None:
    """Print one set."""
    found = inventory(recordings)
    print(f"{name}: without {', '.join(recordings[0].absent)}")
    print(
        f"  {found.stretches} stretches, {found.runs} runs, {found.drivers} drivers, "
        f"{found.hours:.2f} h, {found.kilometres:.1f} km"
    )
    print(
        f"  crossings: {found.left} left, {found.right} right, "
        f"{found.judged_crossings} with a full window before"
    )
    print(
        f"  samples: {found.full:.1%} with a full window, {found.judged:.1%} judged, "
        f"{found.prevalence:.2%} of these positive"
    )
    print(f"  facing the side: {signs(recordings)}")
    for note in dict.fromkeys(note for one in recordings for note in one.notes):
        print(f"  note: {note}")


def main() -> None:
    """Print the inventory of the sets that are there."""
    parser = argparse.ArgumentParser(description="What the real sets hold.")
    parser.add_argument("--data", type=Path, required=True, help="folder of the sets")
    parser.add_argument("sets", nargs="*", help="by name; all if none is given")
    given = parser.parse_args()
    for name in given.sets or DATASETS:
        try:
            show(name, read_dataset(name, given.data))
        except ValueError as fault:
            print(f"{name}: left out: {fault}")


if __name__ == "__main__":
    main()
