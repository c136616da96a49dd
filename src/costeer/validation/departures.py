"""Lane departures counted, beside those of a Gaussian lane position.

How often a stationary Gaussian signal passes a level outward follows from its mean,
its standard deviation and that of its rate (Rice, 1944). A lane position of the same
SDLP, mean and lateral speed as a driver's would put a wheel over a line that often;
who corrects more firmly near the line departs less.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.records.columns import TrialRecord
from costeer.study.definitions import DEFAULTS, MeasureParameters
from costeer.study.lane_keeping import gathered, lane_departures
from costeer.study.measures import parameters_of
from costeer.study.rates import poisson_interval
from costeer.study.segments import Segments
from costeer.study.trial_measures import Trial, prepare

Signal = NDArray[np.float64]


class LaneHold(NamedTuple):
    """How one driver held the lane in one trial, NaN where there is no lane keeping.

    Attributes:
        sdlp: Standard deviation of the lane position in lane keeping [m].
        mean_position: Mean of it, left positive [m].
        lateral_speed_deviation: Standard deviation of its rate [m/s].
        mean_speed: Along the road in lane keeping [m/s].
        num_departures: Counted over the trial, as `num_lane_departures` is [-].
        distance: Of the trial [m].
    """

    sdlp: Real
    mean_position: Real
    lateral_speed_deviation: Real
    mean_speed: Real
    num_departures: Real
    distance: Real


class Departures(NamedTuple):
    """Departures of a population, arrays of shape `(driver,)`.

    Attributes:
        sdlp: [m].
        mean_position: [m].
        lateral_speed_deviation: [m/s].
        mean_speed: [m/s].
        num_departures: Counted [-].
        distance: In which they were counted [m].
        gaussian_per_km: Of a Gaussian lane position [1/km].
    """

    sdlp: Signal
    mean_position: Signal
    lateral_speed_deviation: Signal
    mean_speed: Signal
    num_departures: Signal
    distance: Signal
    gaussian_per_km: Signal


class DepartureSummary(NamedTuple):
    """Both rates over all drivers.

    Attributes:
        num_departures: Counted [-].
        kilometres: In which they were counted [km].
        counted_per_km: [1/km].
        interval: 95 % interval of the counted rate, if departures are independent
            [1/km].
        gaussian_per_km: Mean over the kilometres of all drivers [1/km].
        usual_per_km: Of one Gaussian lane position with the drivers' mean SDLP, rate
            and speed and no bias: what is lost by leaving out the spread [1/km].
    """

    num_departures: int
    kilometres: Real
    counted_per_km: Real
    interval: tuple[Real, Real]
    gaussian_per_km: Real
    usual_per_km: Real


def gaussian_departures(
    sdlp: Signal,
    mean_position: Signal,
    lateral_speed_deviation: Signal,
    parameters: MeasureParameters = DEFAULTS,
) -> Signal:
    """Outward crossings of a wheel over either line of the lane [1/s], Rice (1944).

    The rate over a level at distance a from the mean is
    s_rate / (2 pi s) exp(-a² / (2 s²)).

    Args:
        sdlp: Standard deviation s of the lane position [m].
        mean_position: From the lane's centre [m].
        lateral_speed_deviation: Standard deviation s_rate of its rate [m/s].
        parameters: Widths of lane and car.
    """
    room = (parameters.lane_width - parameters.car_width) / 2.0
    left, right = (room - mean_position) / sdlp, (room + mean_position) / sdlp
    tails = np.exp(-(left**2) / 2.0) + np.exp(-(right**2) / 2.0)
    return np.asarray(lateral_speed_deviation / (2.0 * math.pi * sdlp) * tails)


def lane_hold(record: TrialRecord) -> LaneHold:
    """How the driver of a record held the lane."""
    trial = prepare(record.columns, parameters_of(record))
    if isinstance(trial.segments, str):
        return LaneHold(*[math.nan] * len(LaneHold._fields))
    found = lane_departures(
        trial.columns, trial.speed, trial.segments, trial.parameters
    )
    along = trial.columns["longitudinal_position"]
    return LaneHold(
        *_keeping(trial, trial.segments),
        num_departures=float(len(found)),
        distance=float(along[-1] - along[0]),
    )


def _keeping(trial: Trial, segments: Segments) -> tuple[Real, Real, Real, Real]:
    """SDLP, mean, deviation of the rate, speed in lane keeping; NaN without any."""
    position, rate, along = (
        gathered(values, segments.lane_keeping)
        for values in (
            trial.columns["lateral_position"],
            trial.speed,
            trial.columns["longitudinal_velocity"],
        )
    )
    if position.size < 2:
        return math.nan, math.nan, math.nan, math.nan
    return (
        float(position.std(ddof=1)),
        float(position.mean()),
        float(rate.std(ddof=1)),
        float(along.mean()),
    )


def departures(holds: Sequence[LaneHold]) -> Departures:
    """Counted departures and those of a Gaussian lane position, driver by driver."""
    table = LaneHold(*np.array(holds, dtype=np.float64).T)
    sdlp, mean, rate, speed = (np.asarray(column) for column in table[:4])
    return Departures(
        sdlp=sdlp,
        mean_position=mean,
        lateral_speed_deviation=rate,
        mean_speed=speed,
        num_departures=np.asarray(table.num_departures),
        distance=np.asarray(table.distance),
        gaussian_per_km=1000.0 * gaussian_departures(sdlp, mean, rate) / speed,
    )


def summarise(found: Departures) -> DepartureSummary:
    """Both rates over all drivers who have lane keeping.

    Raises:
        ValueError: If no driver has any.
    """
    known = np.isfinite(found.gaussian_per_km)
    if not known.any():
        raise ValueError("no driver has any lane keeping; give longer trials")
    found = Departures(*(column[known] for column in found))
    kilometres = float(found.distance.sum()) / 1000.0
    count = int(found.num_departures.sum())
    return DepartureSummary(
        num_departures=count,
        kilometres=kilometres,
        counted_per_km=count / kilometres,
        interval=poisson_interval(count, kilometres),
        gaussian_per_km=float(
            np.average(found.gaussian_per_km, weights=found.distance)
        ),
        usual_per_km=_usual(found),
    )


def _usual(found: Departures) -> Real:
    """Departures of one Gaussian lane position like the drivers' mean [1/km]."""
    per_second = gaussian_departures(
        found.sdlp.mean(), np.zeros(()), found.lateral_speed_deviation.mean()
    )
    return float(1000.0 * per_second / found.mean_speed.mean())
