"""All fits in one go: names, facts, and the same numbers for the same seed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from costeer.intention.gru import random_weights
from costeer.intention.predictors.registry import fitted_predictor
from costeer.intention.predictors.store import (
    Baseline,
    baselines_hash,
    save_baselines,
)
from costeer.training.dataset import Split
from costeer.training.predictors import baselines
from costeer.training.predictors.baselines import (
    FITTED,
    train_baselines,
    with_paper_network,
)
from costeer.training.predictors.crossing_time import (
    CrossingTimeParameters,
    initial_cells,
)
from costeer.training.predictors.descent import DescentParameters
from costeer.training.predictors.head_only import HeadParameters
from costeer.training.predictors.judge import predictor_scores
from costeer.training.predictors.kept import (
    Kept,
    kept_beside,
    let_go,
    recordings_hash,
)
from costeer.training.predictors.line_time import LineTimeParameters
from costeer.training.predictors.logistic import LogisticParameters
from costeer.training.predictors.support_vectors import MachineParameters
from tests.training.synthetic import drives

SHORT = DescentParameters(
    batch_size=32, learning_rate=0.02, num_steps=30, steps_per_check=30
)
TINY = baselines.BaselineParameters(
    num_windows=500,
    line_time=LineTimeParameters(time_constants=(0.1,)),
    logistic=LogisticParameters(variants=("full", "head"), penalty_inverses=(0.1,)),
    machine=MachineParameters(
        variants=("motion",),
        num_trial_windows=60,
        num_windows=100,
        num_vectors=30,
        penalties=(1.0,),
        widths=(0.2,),
        evidence_shares=(0.0,),
    ),
    head=HeadParameters(hidden_sizes=(3,), descent=SHORT),
    crossing_time=CrossingTimeParameters(
        variants=("motion",), hidden_size=2, horizons=(5.0,), descent=SHORT
    ),
)
FEW = SHORT._replace(num_steps=2, steps_per_check=2)
SHORTER = TINY._replace(
    head=TINY.head._replace(descent=FEW),
)
RECORDINGS = drives(5, num_changes=1)
SPLIT = Split(RECORDINGS[:3], RECORDINGS[3:4], RECORDINGS[4:])


@pytest.mark.slow
def test_all_are_fitted_with_their_facts() -> None:
    done: list[int] = []
    found = train_baselines(SPLIT, 1, done.append, parameters=TINY)
    assert tuple(found) == FITTED
    assert done == [1] * len(FITTED)
    for one in found.values():
        assert one.facts["seed"] == 1
        assert one.facts["drivers"]["test"] == ["driver 4"]
        for scores in one.facts["validation"].values():
            assert scores["pr_auc"] > 0.1
    assert found["support-vectors"].variants["motion"].dual.size <= 30


@pytest.mark.slow  # three rounds of fits
def test_the_same_seed_gives_the_same_numbers() -> None:
    # The LSTM goes down the same way as the head's network, and takes longer.
    drawn = ("support-vectors", "head-only")
    first, again = (
        train_baselines(SPLIT, 1, names=drawn, parameters=SHORTER) for _ in range(2)
    )
    for one, two in zip(initial_cells(3, 2, 1), initial_cells(3, 2, 1), strict=True):
        np.testing.assert_array_equal(one, two)
    assert baselines_hash(again) == baselines_hash(first)
    other = train_baselines(SPLIT, 2, names=("head-only",), parameters=SHORTER)
    assert baselines_hash(other) != baselines_hash({"head-only": first["head-only"]})


def test_a_few_can_be_fitted_alone() -> None:
    found = train_baselines(SPLIT, 1, names=("line-time",), parameters=TINY)
    assert tuple(found) == ("line-time",)
    with pytest.raises(ValueError, match="'paper-gru' is none of the fits line-time"):
        train_baselines(SPLIT, 1, names=("paper-gru",), parameters=TINY)


@pytest.mark.slow
def test_the_papers_network_joins_the_others() -> None:
    weights = random_weights(3, seed=1)
    found = with_paper_network({}, weights, {"source": "thin air"})
    one = fitted_predictor("paper-gru", found["paper-gru"])
    said = one.probabilities(RECORDINGS[0].features, ())
    assert np.isfinite(said[179:]).all()


def test_a_predictor_that_says_nothing_has_no_scores() -> None:
    network = with_paper_network({}, random_weights(3, seed=1), {})["paper-gru"]
    silent = [one._replace(absent=("head_yaw",)) for one in RECORDINGS[:1]]
    assert predictor_scores(fitted_predictor("paper-gru", network), silent) == {}


MADE_FROM = {"--seed": "1", "content of the recordings": recordings_hash(SPLIT)}


@pytest.mark.slow  # fits three times
def test_a_stop_loses_no_fit_that_is_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = ("line-time", "head-only")
    out = tmp_path / "fits.npz"
    fitted, asked = baselines._fitted, []

    def stopped(name: str, *rest: Any) -> Baseline:
        asked.append(name)
        if name == "head-only" and len(asked) == 2:
            raise KeyboardInterrupt
        return fitted(name, *rest)

    def fit(kept: Kept | None) -> dict[str, Baseline]:
        return train_baselines(SPLIT, 1, None, names, SHORTER, kept)

    monkeypatch.setattr(baselines, "_fitted", stopped)
    with pytest.raises(KeyboardInterrupt):
        fit(kept_beside(out, MADE_FROM))
    assert set(kept_beside(out, MADE_FROM).done) == {"line-time"}
    found = fit(kept_beside(out, MADE_FROM))
    assert asked == ["line-time", "head-only", "head-only"]
    save_baselines(out, found)
    save_baselines(tmp_path / "whole.npz", fit(None))
    assert out.read_bytes() == (tmp_path / "whole.npz").read_bytes()
    assert list(kept_beside(out, MADE_FROM).done) == list(names)
    let_go(kept_beside(out, MADE_FROM))
    assert sorted(file.name for file in tmp_path.iterdir()) == ["fits.npz", "whole.npz"]


def test_fits_of_something_else_are_refused_and_stay(tmp_path: Path) -> None:
    out = tmp_path / "fits.npz"
    kept = kept_beside(out, MADE_FROM)
    found = train_baselines(SPLIT, 1, names=("line-time",), parameters=TINY, kept=kept)
    changed = {"--seed": "2", "content of the recordings": "another"}
    with pytest.raises(ValueError, match="with another --seed, content of the rec"):
        kept_beside(out, changed)
    again = kept_beside(out, MADE_FROM).done
    assert baselines_hash(again) == baselines_hash(found)


def test_recordings_are_told_apart_by_what_they_hold() -> None:
    first = SPLIT.training[0]
    other = first._replace(features=first.features + 1e-12)
    same = first._replace(features=first.features.copy())
    rest = SPLIT.training[1:]
    with_other = recordings_hash(SPLIT._replace(training=[other, *rest]))
    with_same = recordings_hash(SPLIT._replace(training=[same, *rest]))
    moved = SPLIT._replace(training=rest, validation=[first, *SPLIT.validation])
    assert with_same == recordings_hash(SPLIT)
    assert len({with_same, with_other, recordings_hash(moved)}) == 3
