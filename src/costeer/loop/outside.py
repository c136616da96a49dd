"""A trial whose predictor is called from Python, 60 times a second.

Each step is run twice: once on a copy, for its measurement, and again with the verdict
that the predictor gives on it. So a predictor may be anything that takes a window.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import (
    DISTANCE,
    FEATURES,
    WINDOW_LENGTH,
    IntentionSample,
    beyond_bend,
    facing,
    valid_samples,
)
from costeer.intention.predictors.chosen import Judge, chosen_predictor
from costeer.intention.predictors.interface import Predictor
from costeer.intention.predictors.registry import PREDICTORS, predictor
from costeer.loop.endings import has_stopped, still
from costeer.loop.rollout import Advance
from costeer.loop.tick import INTENTION_GIVEN, Script, Verdict, likelier
from costeer.plant.alignment import line_curvature
from costeer.plant.parameters import CarParameters, RoadParameters
from costeer.plant.place import BARRIER
from costeer.plant.road import adjacent_side, distance_to_adjacent_lane
from costeer.records.row import ROW_COLUMNS

Rows = NDArray[np.float64]

_SIGNALS = [ROW_COLUMNS.index(name) for name in FEATURES]
_HEAD = FEATURES.index("head_yaw")
_SEEN = ROW_COLUMNS.index("head_yaw_valid")
_LANE = ROW_COLUMNS.index("lane")
_LATERAL = ROW_COLUMNS.index("lateral_position")
_PLACE = ROW_COLUMNS.index("longitudinal_position")
_SPEED = ROW_COLUMNS.index("longitudinal_velocity")
_CURVATURE = ROW_COLUMNS.index("road_curvature")
_CONTACT = ROW_COLUMNS.index("contact")


def sample_of(
    row: Rows, car: CarParameters, road: RoadParameters, beyond: bool = False
) -> IntentionSample:
    """The predictor's sample of a row, facing right; a lost head is NaN.

    What the road's bend asks for is taken off.

    Args:
        row: In the order of `ROW_COLUMNS`; more may follow.
        car: That is driven.
        road: Tells on which side the adjacent lane is.
        beyond: Whether the other side is taken for that of the adjacent lane.
    """
    values = row[_SIGNALS].tolist()
    if row[_SEEN] < 0.5:
        values[_HEAD] = math.nan
    lane, place = float(row[_LANE]), float(row[_LATERAL])
    side = adjacent_side(road, lane)
    if beyond:
        side = -side
        values[DISTANCE] = distance_to_adjacent_lane(road, place, lane, side)
    bend = line_curvature(float(row[_CURVATURE]), place)
    return facing(beyond_bend(car, IntentionSample(*values), bend), side)


Ask = Callable[[IntentionSample], float]
"""Verdict after one more sample [-]."""


class Outlook:
    """A predictor that is asked for each side of a road on which it matters.

    Args:
        make: Makes what is asked sample by sample, its window empty.
        car: That is driven.
        road: Its lanes.
    """

    def __init__(
        self, make: Callable[[], Ask], car: CarParameters, road: RoadParameters
    ) -> None:
        self._make, self._car, self._road = make, car, road
        self.forget()

    def forget(self) -> None:
        """Begin new windows."""
        self._usual, self._other = self._make(), self._make()

    def after(self, row: Rows) -> Verdict:
        """Verdict after one more row of the record.

        Raises:
            ValueError: If the predictor gives no probability, or breaks.
        """
        usual = self._usual(sample_of(row, self._car, self._road))
        lane = float(row[_LANE])
        side = adjacent_side(self._road, lane)
        if self._road.num_lanes <= 2.0:
            return Verdict(usual, side)
        other = self._other(sample_of(row, self._car, self._road, beyond=True))
        return likelier(self._road, lane, side, usual, other)


class Verdicts:
    """A predictor over the samples of a drive.

    Args:
        judge: Called with each full window.
        name: Of the predictor, for messages.
    """

    def __init__(self, judge: Judge, name: str) -> None:
        self._judge, self._name = judge, name
        self._window: deque[IntentionSample] = deque(maxlen=WINDOW_LENGTH)

    def after(self, sample: IntentionSample) -> float:
        """Verdict on the window that ends with a sample; NaN until it is full [-].

        Raises:
            ValueError: If the predictor gives no probability, or breaks.
        """
        self._window.append(sample)
        if len(self._window) < WINDOW_LENGTH:
            return math.nan
        window = np.array(self._window, dtype=np.float64)
        if not valid_samples(window).all():
            return math.nan
        return self._probability(window)

    def _probability(self, window: Rows) -> float:
        try:
            said: Any = self._judge(window)  # Any: of whoever wrote it
            probability = float(said)
        except Exception as error:
            raise ValueError(
                f"predictor {self._name} broke: {type(error).__name__}: {error}; it is "
                f"given a window of shape {window.shape} and returns one probability"
            ) from error
        if not (math.isnan(probability) or 0.0 <= probability <= 1.0):
            raise ValueError(
                f"predictor {self._name} says {probability:g}; a probability lies "
                "between 0 and 1, NaN is no verdict"
            )
        return probability


def any_predictor(
    wanted: str | Predictor | Judge, weights: str | None = None
) -> Predictor:
    """A predictor of stretches, whatever it is that predicts.

    Args:
        wanted: As `chosen_predictor` takes it; a function of windows is asked at each
            sample.
        weights: File of its numbers.

    Raises:
        ValueError: If there is no such predictor, or its file does not fit.
        OSError: If the file cannot be read.
    """
    if isinstance(wanted, Predictor):
        return wanted
    if wanted in PREDICTORS and not (weights or "").endswith(".onnx"):
        return predictor(str(wanted), None if weights is None else Path(weights))
    chosen = chosen_predictor(wanted, weights)
    judge = chosen.judge
    assert judge is not None  # only costeer's own runs compiled

    def probabilities(features: Rows, absent: tuple[str, ...]) -> Rows:
        verdicts = Verdicts(judge, chosen.name)
        return np.array(
            [verdicts.after(IntentionSample(*row)) for row in features.tolist()]
        )

    return Predictor(chosen.name, chosen.name, "", (), probabilities)


def outside_rollout(
    advance: Advance,
    script: Script,
    verdicts: Outlook,
    noise: Rows,
    road: RoadParameters,
    width: int,
) -> Rows:
    """Run a trial step by step, asking a predictor at each.

    Args:
        advance: Of the trial at its start.
        script: Requests from outside; its intention is not looked at.
        verdicts: Of the predictor, to each side.
        noise: Random numbers, shape `(time, draw)`.
        road: Its length ends the trial.
        width: Numbers in a row.

    Returns:
        Rows of the record's columns, shape `(time, column)`.

    Raises:
        ValueError: If the predictor gives no probability.
    """
    rows = np.empty((len(noise), width))
    asked, standing = script._replace(intention=INTENTION_GIVEN), 0.0
    for k in range(len(noise)):
        now = slice(k, k + 1)
        advance(asked, noise[now], rows[now], keep=False)
        if rows[k, _PLACE] >= road.length:  # where the step before has arrived
            return rows[:k]
        said = verdicts.after(rows[k])
        given = asked._replace(probability=said.probability, side=said.side)
        advance(given, noise[now], rows[now])
        standing = still(standing, float(rows[k, _SPEED]))
        if rows[k, _CONTACT] >= BARRIER or has_stopped(standing):
            return rows[: k + 1]
    return rows
