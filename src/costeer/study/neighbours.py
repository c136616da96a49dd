"""The other cars of a record: which is next ahead and behind in a lane, and how far.

Distances are along the road, from bumper to bumper. A car is in the lane that its
middle is in.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.records.cars import CAR_COLUMN, CAR_SIGNALS
from costeer.study.definitions import (
    Columns,
    MeasureParameters,
    Signal,
    missing,
)
from costeer.study.lanes import centres, lanes
from costeer.study.scenario import Surroundings

_USUAL_LENGTH = 4.5
"""Of a car whose length is not known [m]. Source: assumed, as that of ours."""

_LEADER = ("lead_distance", "lead_velocity", "lead_lane")


class Others(NamedTuple):
    """All other cars of a record, shape `(car, time)`; NaN while one is not there.

    Attributes:
        distance: From the middle of the driven car, ahead positive [m].
        lane: That each is in, counted from the right; -1 while it is not there.
        velocity: Along the road [m/s].
        length: [m], shape `(car,)`.
    """

    distance: NDArray[np.float64]
    lane: NDArray[np.int64]
    velocity: NDArray[np.float64]
    length: NDArray[np.float64]


class Neighbours(NamedTuple):
    """The next cars ahead and behind in a lane, shape `(time,)`; NaN without one.

    Attributes:
        lead_gap: From the own front to the rear of the next car ahead [m]; negative
            beside it.
        lead_velocity: Of that car [m/s].
        lead_length: Of that car [m].
        lag_gap: From the front of the next car behind to the own rear [m]; negative
            beside it.
        lag_velocity: Of that car [m/s].
    """

    lead_gap: Signal
    lead_velocity: Signal
    lead_length: Signal
    lag_gap: Signal
    lag_velocity: Signal


def others(
    columns: Columns, around: Surroundings, parameters: MeasureParameters
) -> Others | str:
    """The other cars of a record, the leader of an overtaking event among them.

    Args:
        columns: With `longitudinal_position`, shape `(time,)` each.
        around: Sizes of the cars.
        parameters: The road.

    Returns:
        The cars, or the reason why there are none.
    """
    reason = missing(columns, "longitudinal_position", "longitudinal_velocity")
    if reason:
        return reason
    rows = [*_cars(columns, around, parameters), *_leader(columns, around, parameters)]
    if not rows:
        return "there are no other cars"
    place, side, velocity, length = zip(*rows, strict=True)
    there = np.isfinite(place)
    lane = np.where(there, lanes(np.nan_to_num(np.array(side)), parameters), -1)
    return Others(np.array(place), lane, np.array(velocity), np.array(length))


_Row = tuple[Signal, Signal, Signal, float]
"""Distance, lateral position and velocity of a car, and its length."""


def _cars(
    columns: Columns, around: Surroundings, parameters: MeasureParameters
) -> list[_Row]:
    own = np.asarray(columns["longitudinal_position"])
    numbers = sorted({m[1] for name in columns if (m := CAR_COLUMN.fullmatch(name))})
    found = []
    for number in numbers:
        names = [f"car_{number}_{signal}" for signal in CAR_SIGNALS]
        if missing(columns, *names):
            continue
        position, lateral, velocity = (np.asarray(columns[name]) for name in names)
        place = int(number) - 1
        known = 0 <= place < around.lengths.size
        length = float(around.lengths[place]) if known else _USUAL_LENGTH
        found.append((position - own, lateral, velocity, length))
    return found


def _leader(
    columns: Columns, around: Surroundings, parameters: MeasureParameters
) -> list[_Row]:
    """The car that is overtaken; it is as long as the driven one."""
    if missing(columns, *_LEADER):
        return []
    distance, velocity, lane = (np.ma.asarray(columns[name]) for name in _LEADER)
    lateral = centres(parameters, np.ma.filled(lane, 0).astype(np.int64))
    gone = np.ma.getmaskarray(lane) | np.isnan(np.ma.filled(distance, np.nan))
    away = np.where(gone, np.nan, np.ma.filled(distance, np.nan))
    speed = np.ma.filled(velocity, np.nan)
    return [(away, np.asarray(lateral), speed, float(around.car.length))]


def at(cars: Others, row: int) -> Others:
    """The other cars at one sample."""
    rows = slice(row, row + 1)
    return Others(
        distance=cars.distance[:, rows],
        lane=cars.lane[:, rows],
        velocity=cars.velocity[:, rows],
        length=cars.length,
    )


def neighbours(cars: Others, lane: NDArray[np.int64], own_length: float) -> Neighbours:
    """The next cars in a lane.

    Args:
        cars: All of them.
        lane: In which to look, shape `(time,)`.
        own_length: Of the driven car [m].
    """
    half = (cars.length[:, np.newaxis] + own_length) / 2.0
    here = cars.lane == lane
    with np.errstate(invalid="ignore"):
        ahead = here & (cars.distance >= 0.0)
        behind = here & (cars.distance < 0.0)
    lead_gap, lead = _next(np.where(ahead, cars.distance - half, np.inf))
    lag_gap, lag = _next(np.where(behind, -cars.distance - half, np.inf))
    every = np.arange(lane.size)
    return Neighbours(
        lead_gap=lead_gap,
        lead_velocity=np.where(np.isnan(lead_gap), np.nan, cars.velocity[lead, every]),
        lead_length=np.where(np.isnan(lead_gap), np.nan, cars.length[lead]),
        lag_gap=lag_gap,
        lag_velocity=np.where(np.isnan(lag_gap), np.nan, cars.velocity[lag, every]),
    )


def _next(gaps: NDArray[np.float64]) -> tuple[Signal, NDArray[np.int64]]:
    """Smallest gap at each sample, NaN if there is none, and of which car."""
    index = np.argmin(gaps, axis=0)
    least = gaps[index, np.arange(gaps.shape[1])]
    return np.where(np.isinf(least), np.nan, least), index
