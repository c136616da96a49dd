"""Whether virtual drivers swing, and whether they stay on the road.

Three looks at manual driving. The linear loop: central differences of the very
functions of a control step, for all drivers at once, without noise and dry friction,
about straight driving; its eigenvalues give damping. The nonlinear loop: a start beside
the aim without noise, swings and settling without dry friction. And a manual trial
with everything, how far the car strays.

With dry friction and without noise the car hunts slowly about the aim, because the
arms stop pushing before the friction lets go: its amplitude is told (`hunting`), not
judged, as the driver's own noise keeps the wheel moving in a trial.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.drivers.driver import DriverParameters
from costeer.drivers.population import participant_driver
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.rollout import rollout
from costeer.loop.scenario import TrialSetup, loop_parameters, trial_car
from costeer.loop.tick import INTENTION_OFF, PREDICTION_HORIZON, Script
from costeer.loop.trial import idle_network, simulate_trial
from costeer.methods.manual import MANUAL
from costeer.plant.parameters import CARS, CarParameters, RoadParameters
from costeer.records.row import ROW_COLUMNS
from costeer.validation.driver_loop import (
    least_damped,
    poles,
    quiet,
    smooth,
    transition,
)
from costeer.validation.threads import in_threads

Signal = NDArray[np.float64]

SPEEDS = (50.0 / 3.6, 70.0 / 3.6, 90.0 / 3.6, 110.0 / 3.6)
"""Speeds of the figures [m/s]."""

OFFSET = 0.5
"""Distance from the aim that a run without noise starts with [m]."""

SETTLED = 0.1
"""An offset within this has been corrected [m]."""

SMALLEST_SWING = 0.02
"""Swings smaller than this are not looked at [m]."""

_RUN = 60.0
_LATE = 40.0
_LATERAL = ROW_COLUMNS.index("lateral_position")


class StabilityBounds(NamedTuple):
    """What a driver may do; see `faults`.

    Attributes:
        damping_ratio: Least of a swing [-]. At 0.07 each swing is 0.8 of the last.
        swing_ratio: Largest of a swing to the one before it [-].
        settling_time: Of a 0.5 m offset to within 0.1 m [s].
        edge_strip: A wheel farther beyond the road's outer line than this has left
            the road [m]. Assumed, less than a paved shoulder.
    """

    damping_ratio: Real = 0.07
    swing_ratio: Real = 0.8
    settling_time: Real = 10.0
    edge_strip: Real = 0.5


class Stability(NamedTuple):
    """One car at one speed under many drivers, arrays of shape `(driver,)`.

    Attributes:
        car: Its name.
        speed: [m/s].
        damping_ratio: Smallest of all swings of the linear loop, 1 if none [-].
        frequency: Of that swing, NaN if none [rad/s].
        largest_modulus: Of the eigenvalues of a control step; stable below 1 [-].
        settling_time: After which an offset of 0.5 m stays within 0.1 m, without
            noise and dry friction; infinite if it does not [s].
        swing_ratio: Largest ratio of a swing to the one before it then, 0 if there
            is no second swing [-].
        hunting: Amplitude of lateral position long after, with dry friction [m].
        edge_margin: Least distance of a wheel from the road's outer lines in a
            manual trial, negative beyond them [m].
    """

    car: str
    speed: Real
    damping_ratio: Signal
    frequency: Signal
    largest_modulus: Signal
    settling_time: Signal
    swing_ratio: Signal
    hunting: Signal
    edge_margin: Signal


def amplitude(signal: NDArray[np.float64]) -> Real:
    """Half of the span of a signal."""
    return float(np.ptp(signal)) / 2.0


def manual_setup(
    car: str | CarParameters, speed: Real, duration: Real = _RUN
) -> TrialSetup:
    """Manual driving on an empty road for `duration` [s]."""
    return TrialSetup(
        condition="manual",
        intention="off",
        car=car,
        speed=speed,
        length=speed * duration,
        events=False,
    )


@cache
def _no_intention() -> Script:
    return Script(INTENTION_OFF, PREDICTION_HORIZON, np.empty(0))


def offset_run(parameters: LoopParameters[Any], offset: Real = OFFSET) -> Signal:
    """Distance from the aim after a start beside it, without noise, `(time,)` [m].

    Args:
        parameters: Of a manual trial on an empty road.
        offset: From the driver's aim at the start [m].
    """
    bias: float = parameters.driver.tracking.lane_bias
    start = parameters.start._replace(lateral_offset=bias + offset)
    rows = rollout(
        MANUAL,
        parameters._replace(start=start),
        _no_intention(),
        idle_network(),
        quiet(round(_RUN / DT)),
        "numba",
    )
    return rows[:, _LATERAL] - bias


def swings(signal: Signal) -> Signal:
    """Farthest distance from zero between two crossings of it, in order [m]."""
    turns = np.flatnonzero(np.diff(np.signbit(signal))) + 1
    return np.array([np.abs(part).max() for part in np.split(signal, turns)])


def swing_ratio(signal: Signal) -> Real:
    """Largest ratio of a swing to the one before it, 0 with one swing only [-]."""
    size = swings(signal)
    before, after = size[:-1], size[1:]
    seen = (before > SMALLEST_SWING) & (after > SMALLEST_SWING)
    return float(np.max(after / before, where=seen, initial=0.0))


def settling_time(signal: Signal) -> Real:
    """Time from which a distance stays within `SETTLED` [s], infinite if never."""
    outside = np.flatnonzero(np.abs(signal) > SETTLED)
    if outside.size == 0:
        return 0.0
    last = int(outside[-1]) + 1
    return last * DT if last < len(signal) else np.inf


def edge_margin(setup: TrialSetup) -> Real:
    """Least distance of a wheel from the road's outer lines in a trial [m]."""
    position = simulate_trial(setup).columns["lateral_position"]
    road, half = RoadParameters(), trial_car(setup).width / 2.0
    left = road.lane_width / 2.0 - half - position.max()
    right = position.min() - half + (road.num_lanes - 0.5) * road.lane_width
    return float(min(left, right))


def _runs(setup: TrialSetup) -> tuple[Real, Real, Real, Real]:
    """Settling time, swing ratio, hunting and edge margin of a setup's driver."""
    parameters = loop_parameters(manual_setup(setup.car, setup.speed))
    parameters = parameters._replace(driver=_driver(setup))
    free = offset_run(smooth(parameters))
    rubbing = offset_run(parameters)[round(_LATE / DT) :]
    return (
        settling_time(free),
        swing_ratio(free),
        amplitude(rubbing),
        edge_margin(setup),
    )


def _driver(setup: TrialSetup) -> DriverParameters:
    return participant_driver(setup.seed, setup.participant, setup.speed)


def driver_stability(
    seed: int,
    num_drivers: int,
    jobs: int = 2,
    progress: Callable[[int], None] | None = None,
    car: str = "default",
    speed: Real = 70.0 / 3.6,
) -> Stability:
    """Look at a population in manual driving.

    Args:
        seed: Of the population.
        num_drivers: How many.
        jobs: Threads.
        progress: Called with the number of drivers just done.
        car: Its name.
        speed: [m/s].
    """
    manual = TrialSetup(seed=seed, intention="off", car=car, speed=speed)
    setups = [manual._replace(participant=n) for n in range(1, num_drivers + 1)]
    parameters = loop_parameters(manual_setup(car, speed))
    matrices = transition(parameters, [_driver(setup) for setup in setups])
    ratio, frequency = least_damped(poles(matrices))
    runs = np.array(in_threads(_runs, setups, jobs, progress))
    return Stability(
        car=car,
        speed=speed,
        damping_ratio=ratio,
        frequency=frequency,
        largest_modulus=np.abs(np.linalg.eigvals(matrices)).max(axis=1),
        settling_time=runs[:, 0],
        swing_ratio=runs[:, 1],
        hunting=runs[:, 2],
        edge_margin=runs[:, 3],
    )


def every_stability(seed: int, num_drivers: int, jobs: int = 2) -> list[Stability]:
    """The same population in all cars at all speeds of the figures."""
    return [
        driver_stability(seed, num_drivers, jobs, None, car, speed)
        for car in CARS
        for speed in SPEEDS
    ]


def oscillates(
    found: Stability, bounds: StabilityBounds | None = None
) -> NDArray[np.bool_]:
    """Which drivers swing for long, shape `(driver,)`."""
    bounds = bounds or StabilityBounds()
    return np.asarray(
        ~(found.largest_modulus < 1.0)
        | ~(found.damping_ratio >= bounds.damping_ratio)
        | ~(found.swing_ratio <= bounds.swing_ratio)
        | ~(found.settling_time <= bounds.settling_time)
    )


def leaves_road(
    found: Stability, bounds: StabilityBounds | None = None
) -> NDArray[np.bool_]:
    """Which drivers leave the road in their trial, shape `(driver,)`."""
    bounds = bounds or StabilityBounds()
    return np.asarray(~(found.edge_margin >= -bounds.edge_strip))
