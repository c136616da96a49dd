"""A predictor outside the loop sees what the network inside sees, when it sees it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.intention.features import DISTANCE
from costeer.intention.wavefront import crossing_probabilities
from costeer.intention.weights import load_weights
from costeer.loop.outside import Verdicts, sample_of
from costeer.loop.scenario import TrialSetup
from costeer.loop.tick import intention_sample
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import CARS, CarParameters, RoadParameters
from costeer.plant.road import adjacent_side, lane_centre
from costeer.records.row import ROW_COLUMNS
from costeer.sensing.measurement import Measurement, facing_beyond, standing_start

SETUP = TrialSetup(condition="strong-normal", participant=2, length=400.0)

Window = NDArray[np.float64]


def imitation(window: Window) -> float:
    """The network that ships with costeer, called from Python on one window."""
    return float(crossing_probabilities(load_weights().weights, window)[-1])


def near_the_line(window: Window) -> float:
    """A predictor that goes by the distance alone."""
    return 0.9 if window[-1, DISTANCE] < 0.8 else 0.1


@pytest.mark.slow
def test_the_network_called_from_outside_drives_the_same_trial() -> None:
    inside = simulate_trial(SETUP._replace(exact_network=True))
    outside = simulate_trial(SETUP._replace(predictor=imitation))
    assert np.isfinite(inside.columns["crossing_probability"]).any()
    assert list(inside.columns) == list(outside.columns)
    for name, values in inside.columns.items():
        if values.dtype.kind == "f":
            found = outside.columns[name]
            np.testing.assert_allclose(found, values, rtol=1e-9, atol=1e-9)
    assert outside.metadata["predictor"] == "imitation"
    assert (
        outside.metadata["intention_model_hash"]
        != (inside.metadata["intention_model_hash"])
    )


def on_a_bend(lane: float) -> Measurement:
    """A car that runs along a bend."""
    road = RoadParameters(num_lanes=3.0)
    return standing_start(road)._replace(
        lane=lane,
        lateral_position=0.2 + lane_centre(road, lane),
        side=adjacent_side(road, lane),
        distance_to_adjacent_lane=1.75,
        yaw_angle=0.01,
        steering_wheel_angle=0.1,
        head_yaw=0.2,
        road_curvature=0.002,
    )


@pytest.mark.parametrize("lane", [0.0, 1.0, 2.0])
@pytest.mark.parametrize("beyond", [False, True])
def test_a_row_in_a_bend_is_the_sample_of_the_loop(lane: float, beyond: bool) -> None:
    road, car = RoadParameters(num_lanes=3.0), CARS["large"]
    measured = facing_beyond(road, facing_beyond(road, on_a_bend(lane)))
    row = np.zeros(len(ROW_COLUMNS))
    for name in set(ROW_COLUMNS) & set(Measurement._fields):
        row[ROW_COLUMNS.index(name)] = getattr(measured, name)
    seen = facing_beyond(road, measured) if beyond else measured
    found = sample_of(row, car, road, beyond)
    assert found == intention_sample(car, seen)
    straight = seen._replace(road_curvature=0.0)
    assert found.steering_wheel_angle != intention_sample(car, straight)[3]


def verdict_of(answer: object) -> float:
    """What comes of an answer to the first full window."""

    def judge(window: Window) -> float:
        assert window.shape == (180, 6)
        return answer  # type: ignore[return-value]  # wrong answers are the point

    sample = intention_sample(CarParameters(), standing_start(RoadParameters()))
    verdicts = Verdicts(judge, "mine")
    assert all(math.isnan(verdicts.after(sample)) for _ in range(179))
    return verdicts.after(sample)


def test_a_probability_and_no_verdict_are_taken() -> None:
    assert verdict_of(0.25) == 0.25
    assert verdict_of(np.array(1.0)) == 1.0
    assert math.isnan(verdict_of(math.nan))


@pytest.mark.parametrize("answer", [2.0, -0.1, math.inf, None, "much", [0.1, 0.2]])
def test_what_is_no_probability_stops_the_trial(answer: object) -> None:
    with pytest.raises(ValueError, match=r"predictor mine (says|broke)"):
        verdict_of(answer)
