"""`costeer train --fit baselines`: the rivals of the network, one after another."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from costeer.intention.predictors.store import Baseline
    from costeer.training.dataset import Split
    from costeer.training.predictors.kept import Kept
    from costeer.training.recordings import Recording


def fit_baselines(
    recordings: list[Recording], seed: int, made_from: Mapping[str, str], out: Path
) -> None:
    """Fit the rivals on the drivers that the network learns from, and write them.

    Args:
        recordings: Of all drivers.
        seed: Of the split and the fits.
        made_from: What else decides the fits, by the name that a person knows it by.
        out: File; fits that are done are kept beside it until all are.

    Raises:
        ValueError: If fits of another call are kept there, naming what differs.
    """
    from costeer.cli.console import note, print_table, progress
    from costeer.intention.predictors.store import save_baselines
    from costeer.training.dataset import DatasetParameters, shown, split_by_driver
    from costeer.training.predictors.baselines import FITTED, train_baselines
    from costeer.training.predictors.kept import kept_beside, let_go, recordings_hash

    split = split_by_driver(recordings, seed, DatasetParameters())
    content = {"content of the recordings": recordings_hash(split)}
    kept = kept_beside(out, {**made_from, **content})
    if kept.done:
        note(f"already fitted: {', '.join(kept.done)}")
    wider = split._replace(training=shown(split.training))
    with progress("baselines", len(FITTED)) as advance:
        found = train_baselines(wider, seed, advance, kept=kept)
    found["paper-gru"] = _paper_network(split, seed, kept)
    save_baselines(out, found)
    let_go(kept)
    note(f"written: {out}")
    rows = [[name, ", ".join(one.variants)] for name, one in found.items()]
    print_table(["predictor", "variants"], rows, title="Fitted")


def _paper_network(split: Split, seed: int, kept: Kept) -> Baseline:
    """The paper's network, unless an earlier call has fitted it."""
    from costeer.cli.console import progress
    from costeer.training.predictors.baselines import with_paper_network
    from costeer.training.predictors.kept import keep
    from costeer.training.predictors.paper_gru import FIT, fit_paper_network

    if "paper-gru" in kept.done:
        return kept.done["paper-gru"]
    with progress("training steps of the paper's network", FIT.num_steps) as advance:
        paper = fit_paper_network(split, seed, advance)
    fitted = with_paper_network({}, paper.variants["full"], paper.facts)["paper-gru"]
    keep(kept, "paper-gru", fitted)
    return fitted
