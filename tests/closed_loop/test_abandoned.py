"""Lane changes that are given up, driven: manual trials of fickle drivers."""

from __future__ import annotations

import itertools
import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.drivers.decision import DecisionParameters
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial

FAITHFUL = TrialSetup(seed=3, intention="off", length=2500.0)
FICKLE = FAITHFUL._replace(abandoned_share=1.0)
DT = 1.0 / 60.0
PARTICIPANTS = range(1, 5)


@cache
def columns(setup: TrialSetup) -> dict[str, NDArray[Any]]:
    found = simulate_trial(setup).columns
    return {name: np.ma.getdata(values) for name, values in found.items()}


def stretches(intention: NDArray[Any]) -> list[tuple[int, int, int]]:
    """Value, first row and row after the last of each run of one intention."""
    edges = [0, *(np.flatnonzero(np.diff(intention)) + 1), len(intention)]
    return [(int(intention[a]), a, b) for a, b in itertools.pairwise(edges)]


def test_a_driver_whose_lot_is_not_drawn_drives_as_without_a_share() -> None:
    plain = columns(FAITHFUL)
    assert set(plain["driver_intention"]) == {-1, 0, 1}
    for name, values in columns(FAITHFUL._replace(abandoned_share=1e-12)).items():
        np.testing.assert_array_equal(values, plain[name])


@pytest.mark.parametrize("participant", PARTICIPANTS)
def test_a_fickle_driver_means_to_overtake_again_and_again(participant: int) -> None:
    meant = columns(FICKLE._replace(participant=participant))["driver_intention"]
    runs = stretches(meant)
    assert len(runs) > 8
    assert [value for value, _, _ in runs[1:5]] == [-1, 0, -1, 0]
    longest = DecisionParameters()
    for value, first, last in runs[1:-1]:
        lasted = (last - first) * DT
        if value == 0:
            assert lasted >= longest.abandoned_pause - DT
        else:
            # Three standard deviations of both times.
            preparation = longest.preparation_time * math.exp(3.0 * 0.35)
            duration = longest.change_duration * math.exp(3.0 * 0.4)
            assert lasted < preparation + longest.abandoned_latest * duration


@pytest.mark.parametrize("participant", PARTICIPANTS)
def test_a_fickle_driver_steers_towards_the_line_and_back(participant: int) -> None:
    drove = columns(FICKLE._replace(participant=participant))
    runs, lateral = stretches(drove["driver_intention"]), drove["lateral_position"]
    begun = runs[1][1]
    assert lateral[begun:].min() < lateral[:begun].min() - 0.2
    assert lateral[begun:].max() > -0.3


def test_few_fickle_drivers_swing_over_the_line_and_all_come_back() -> None:
    times, begun = [], 0
    for participant in PARTICIPANTS:
        drove = columns(FICKLE._replace(participant=participant))
        begun += sum(value != 0 for value, _, _ in stretches(drove["driver_intention"]))
        there = stretches((drove["lane"] == 0).astype(np.int8))
        times += [(last - first) * DT for out, first, last in there if out]
    # Uniform up to 0.35 of the path's duration; from about 0.3 on the path back leads
    # over the line, one in eight of 1,250 changes by 40 drivers. Of the 50 to 60 here
    # more than a quarter would be seven standard deviations too many.
    assert len(times) < 0.25 * begun
    assert max(times, default=0.0) < 5.0
