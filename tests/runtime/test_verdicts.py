"""The network process gives the verdicts that the studies would have given."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.intention.predictors.chosen import chosen_predictor
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import CARS, CarParameters, RoadParameters
from costeer.records.row import ROW_COLUMNS
from costeer.runtime.frame import FRAME_COLUMNS, PLACE
from costeer.runtime.verdicts import Reader

SETUP = TrialSetup(seed=4, length=1500.0)


def frames_of(columns: dict[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Frames of a drive that was recorded."""
    frames = np.full((len(columns["time"]), len(FRAME_COLUMNS)), np.nan)
    for name in set(ROW_COLUMNS) - {"mode"}:
        values = np.ma.filled(np.ma.asarray(columns[name], float), np.nan)
        frames[:, PLACE[name]] = values
    return frames


@pytest.fixture(scope="module")
def record() -> dict[str, NDArray[np.float64]]:
    # A person's drive takes exact windows.
    return simulate_trial(SETUP._replace(exact_network=True)).columns


def check_frames(car: str, drove: dict[str, NDArray[np.float64]]) -> None:
    """Read the frames of a drive and hold the verdicts against those of the trial."""
    reader = Reader(CARS[car], RoadParameters(), (), chosen_predictor())
    probabilities, sides = zip(*map(reader.read, frames_of(drove)), strict=True)
    np.testing.assert_array_equal(probabilities, drove["crossing_probability"])
    np.testing.assert_array_equal(sides, drove["crossing_side"])


def test_verdicts_in_bends_are_those_of_the_trial() -> None:
    setup = SETUP._replace(
        exact_network=True, car="compact", scenario="expressway-curves", length=900.0
    )
    drove = simulate_trial(setup).columns
    assert drove["road_curvature"].any()
    check_frames("compact", drove)


def test_verdicts_over_frames_are_those_of_the_trial(
    record: dict[str, NDArray[np.float64]],
) -> None:
    check_frames("default", record)
    assert (record["lane"] == 0).any()  # both sides were part of it
    assert not record["head_yaw_valid"].all()  # and a lost head


def test_gap_and_restart_begin_a_new_window(
    record: dict[str, NDArray[np.float64]],
) -> None:
    frames = frames_of(record)[:400]
    reader = Reader(CarParameters(), RoadParameters(), (), chosen_predictor())
    for frame in frames[:200]:
        before = reader.read(frame).probability
    after_gap = [reader.read(frame).probability for frame in frames[205:390]]
    again = [reader.read(frame).probability for frame in frames[:180]]
    assert np.isfinite(before)
    assert np.isnan(after_gap[:179]).all()
    assert np.isfinite(after_gap[179:]).all()
    assert np.isnan(again[:179]).all()
    assert again[179] == record["crossing_probability"][179]


def test_drive_without_a_tracker_is_judged_by_motion_alone(
    record: dict[str, NDArray[np.float64]],
) -> None:
    frames = frames_of(record)[:240]
    turned = frames.copy()
    turned[:, PLACE["head_yaw"]] = 0.9
    there, here = (
        Reader(CarParameters(), RoadParameters(), ("head_yaw",), chosen_predictor())
        for _ in range(2)
    )
    assert [here.read(f) for f in frames][-1] == [there.read(f) for f in turned][-1]
