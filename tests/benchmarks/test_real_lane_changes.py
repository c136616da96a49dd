"""People are judged by what learned from other people only."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks import real_lane_changes as transfer
from costeer.intention.gru import random_weights
from costeer.intention.predictors.interface import Probabilities
from costeer.training.recordings import Recording, lacking
from costeer.training.tuning import DEFAULTS
from tests.training.synthetic import drive

MOTION = ("head_yaw", "steering_wheel_angle")


@cache
def people() -> list[Recording]:
    """Eight people, without the signals of motion."""
    return [lacking(drive(driver, num_changes=2), MOTION) for driver in range(8)]


def test_nobody_is_judged_by_what_learned_from_him() -> None:
    taught: list[set[str]] = []

    def learn(recordings: list[Recording]) -> Probabilities:
        taught.append({r.driver for r in recordings})
        mark = float(len(taught))

        def predict(
            features: NDArray[np.float64], absent: tuple[str, ...]
        ) -> NDArray[np.float64]:
            return np.full(len(features), mark)

        return predict

    said = transfer.out_of_fold(people(), 4, 1, learn)
    assert len(taught) == 4
    for person, verdicts in zip(people(), said, strict=True):
        (mark,) = set(verdicts)
        assert person.driver not in taught[int(mark) - 1]
        assert len(verdicts) == len(person.side)


def test_the_drivers_to_choose_by_change_lanes() -> None:
    quiet = [lacking(drive(driver, num_changes=0), MOTION) for driver in range(20, 26)]
    training, choosing = transfer._two_parts([*people()[:2], *quiet])
    assert transfer._changes_lanes(training)
    assert transfer._changes_lanes(choosing)
    assert transfer._two_parts(quiet) == (quiet, quiet)


@pytest.mark.usefixtures("few_resamplings")
@pytest.mark.slow  # trains in two folds
def test_the_network_stands_beside_what_learned_from_people(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    short = DEFAULTS._replace(num_steps=2, batch_size=16)
    monkeypatch.setattr(transfer, "TUNING", short)
    monkeypatch.setattr(transfer, "RIVALS", ("line-time", "head-only"))
    found = transfer.transfer(random_weights(3, seed=1), people(), seed=1, num_folds=2)
    names = [one.name for one in found.judged]
    assert names == ["line-time", "gru", "logistic-people", "gru-people"]
    assert [one.name for one in found.excluded] == ["head-only"]
    # Two lane changes a drive teach a logistic regression more than chance tells.
    areas = {o.name: o.judgement.facts["samples"]["pr_auc"] for o in found.judged}
    assert areas["logistic-people"] > 3.0 * areas["gru"]
