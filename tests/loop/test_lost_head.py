"""A head that the tracker has lost: the network is told so, tick by tick."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.intention.features import (
    FEATURES,
    HEAD_YAW,
    NUM_FEATURES,
    WINDOW_LENGTH,
    feature_series,
)
from costeer.intention.gru import NetworkWeights, random_weights
from costeer.intention.wavefront import crossing_probabilities
from costeer.intention.weights import intention_network, save_weights
from costeer.loop.scenario import TrialSetup
from costeer.loop.tick import intention_sample
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import CarParameters
from costeer.sensing.measurement import Measurement
from tests.drivers.samples import LEFT, RIGHT, driving

SETUP = TrialSetup(
    seed=5,
    condition="strong-normal",
    intention="network",
    length=3000.0,
)
DOES_WITHOUT = random_weights(4, 1)
NEEDS_ALL = DOES_WITHOUT._replace(dispensable=np.zeros(NUM_FEATURES))


def turned(lane: float, tracked: bool) -> Measurement:
    """A driver who looks to the right."""
    car = driving(lane=lane, yaw_angle=0.01)
    return car._replace(head_yaw=-0.3, head_yaw_valid=tracked)


@pytest.mark.parametrize(("lane", "turn"), [(LEFT, 1.0), (RIGHT, -1.0)])
def test_a_lost_head_is_no_number_to_the_network(lane: float, turn: float) -> None:
    seen = intention_sample(CarParameters(), turned(lane, tracked=True))
    lost = intention_sample(CarParameters(), turned(lane, tracked=False))
    assert seen.head_yaw == -0.3 * turn
    assert math.isnan(lost.head_yaw)
    assert lost._replace(head_yaw=seen.head_yaw) == seen


@cache
def columns(needs_all: bool) -> dict[str, NDArray[Any]]:
    weights = NEEDS_ALL if needs_all else DOES_WITHOUT
    with TemporaryDirectory() as folder:
        file = Path(folder) / "network.npz"
        save_weights(file, intention_network(weights, {}))
        record = simulate_trial(SETUP._replace(weights=str(file)))
    return {name: np.ma.getdata(values) for name, values in record.columns.items()}


def verdicts(weights: NetworkWeights, drove: dict[str, NDArray[Any]]) -> Any:
    """What the network says of the record, with NaN where the head was lost."""
    side = np.where(drove["lane"] == 1, -1, 1).astype(np.int8)
    features = feature_series({name: drove[name] for name in FEATURES}, side)
    features[~drove["head_yaw_valid"].astype(bool), HEAD_YAW] = np.nan
    return crossing_probabilities(weights, features)


def test_a_network_that_needs_the_head_is_silent_while_it_is_lost() -> None:
    drove = columns(needs_all=True)
    lost = ~drove["head_yaw_valid"].astype(bool)
    assert lost[WINDOW_LENGTH:].any()
    held = np.convolve(lost, np.ones(WINDOW_LENGTH))[: len(lost)] > 0.5
    held[: WINDOW_LENGTH - 1] = True
    assert not held.all()
    np.testing.assert_array_equal(np.isnan(drove["crossing_probability"]), held)


def test_a_network_that_does_without_speaks_all_the_time() -> None:
    drove = columns(needs_all=False)
    assert (~drove["head_yaw_valid"].astype(bool))[WINDOW_LENGTH:].any()
    said = drove["crossing_probability"]
    assert np.isfinite(said[WINDOW_LENGTH - 1 :]).all()


@pytest.mark.parametrize("needs_all", [True, False])
def test_the_loop_says_what_its_record_says(needs_all: bool) -> None:
    drove = columns(needs_all)
    weights = NEEDS_ALL if needs_all else DOES_WITHOUT
    np.testing.assert_array_equal(
        drove["crossing_probability"], verdicts(weights, drove)
    )
