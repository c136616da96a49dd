"""Whether virtual drivers swing, and whether they stay on the road.

Three looks at manual driving. The linear loop: central differences of the very
functions of a control step, for all drivers at once, without noise and dry friction,
about straight driving; its eigenvalues give damping. Nothing is let go there. The
nonlinear loop is that of the whole driver: a start beside the aim without noise, swings
and settling without dry friction. And a manual trial with everything, how far the car
strays.

Who tolerates a distance (drivers/tolerance.py) does not come to rest at the aim: the
car drifts until the distance is worth a correction, and is corrected. That is no swing
of the loop, and does not grow: a start is so much farther out, settled is so much
wider, and swings within it do not count (`let_go`). With dry friction and without noise
the car hunts about the aim even without tolerance, because the arms stop pushing before
the friction lets go: that amplitude is told (`hunting`), not judged, as the driver's
own noise keeps the wheel moving in a trial.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.drivers.driver import DriverParameters
from costeer.drivers.population import USUAL, Population
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.rollout import rollout
from costeer.loop.scenario import (
    TrialSetup,
    loop_parameters,
    trial_car,
    trial_driver,
)
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
"""Distance from what is let go that a run without noise starts with [m]."""

SETTLED = 0.1
"""An offset within this, beyond what is let go, has been corrected [m]."""

SMALLEST_SWING = 0.02
"""Swings smaller than this, beyond what is let go, are not looked at [m]."""

DRIFTING = 2.0
"""What is let go while the car drifts, over what is when it stands beside the aim [-].
Assumed: it drifts on while the evidence gathers and the hands move."""

_RUN = 60.0
_LATE = 40.0
_LATERAL = ROW_COLUMNS.index("lateral_position")


class StabilityBounds(NamedTuple):
    """What a driver may do; see `faults`.

    Attributes:
        damping_ratio: Least of a swing [-]. At 0.07 each swing is 0.8 of the last.
        swing_ratio: Largest of a swing to the one before it [-].
        settling_time: From 0.5 m to within 0.1 m, both beyond what is let go [s].
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
        settling_time: After which an offset of 0.5 m stays within 0.1 m, both beyond
            what is let go, without noise and dry friction; infinite if it does not [s].
        swing_ratio: Largest ratio of a swing to the one before it then, 0 if there
            is no second swing beyond what is let go [-].
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


def let_go(driver: DriverParameters, speed: Real) -> Real:
    """Distance from the aim that a driver does not correct, and drifts within [m].

    Beside the aim and along the road the near point asks for K_c y / (v² t_near). It is
    let go while r τ (|angle| / b - 1) stays below 1: the evidence is never complete.

    Args:
        driver: Whose tolerance it is; 0 for one without.
        speed: [m/s].
    """
    own, eyes = driver.tolerance, driver.vision
    angle = own.band * (1.0 + 1.0 / (own.evidence_rate * own.forgetting_time))
    return DRIFTING * angle * eyes.near_time * speed**2 / eyes.near_gain


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


def swing_ratio(signal: Signal, room: Real = 0.0) -> Real:
    """Largest ratio of a swing to the one before it, 0 with one swing only [-].

    Args:
        signal: Distance from the aim, shape `(time,)` [m].
        room: What is let go [m].
    """
    size = swings(signal)
    before, after = size[:-1], size[1:]
    smallest = SMALLEST_SWING + room
    seen = (before > smallest) & (after > smallest)
    return float(np.max(after / before, where=seen, initial=0.0))


def settling_time(signal: Signal, room: Real = 0.0) -> Real:
    """Time from which a distance stays within `SETTLED` [s], infinite if never.

    Args:
        signal: Distance from the aim, shape `(time,)` [m].
        room: What is let go, beyond which it counts [m].
    """
    outside = np.flatnonzero(np.abs(signal) > SETTLED + room)
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
    driver = trial_driver(setup)
    parameters, room = parameters._replace(driver=driver), let_go(driver, setup.speed)
    free = offset_run(smooth(parameters), OFFSET + room)
    rubbing = offset_run(parameters)[round(_LATE / DT) :]
    return (
        settling_time(free, room),
        swing_ratio(free, room),
        amplitude(rubbing),
        edge_margin(setup),
    )


def driver_stability(
    seed: int,
    num_drivers: int,
    jobs: int = 2,
    progress: Callable[[int], None] | None = None,
    car: str = "default",
    speed: Real = 70.0 / 3.6,
    population: Population = USUAL,
) -> Stability:
    """Look at a population in manual driving.

    Args:
        seed: Of the population.
        num_drivers: How many.
        jobs: Threads.
        progress: Called with the number of drivers just done.
        car: Its name.
        speed: [m/s].
        population: Who is drawn from.
    """
    manual = TrialSetup(
        seed=seed,
        driver=population.name,
        intention="off",
        car=car,
        speed=speed,
    )
    setups = [manual._replace(participant=n) for n in range(1, num_drivers + 1)]
    parameters = loop_parameters(manual_setup(car, speed))
    matrices = transition(parameters, [trial_driver(setup) for setup in setups])
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
