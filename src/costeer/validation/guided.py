"""Whether driver and guidance, who hold one wheel, make it swing.

Three looks, each of which a driver who swings fails. The linear loop of a population
with the guidance at a gain (driver_loop.py), without the friction compensation and with
its slope at zero, the truth lying between: its damping. The whole simulation from
beside the aim, without noise and dry friction: a swing that lasts. The whole simulation
with dry friction and the driver's own noise: an oscillation of the wheel.

Who tolerates moves the wheel by single corrections, often by more than a degree: not
the size tells an oscillation, but that it repeats (swing.py). With dry friction and
without noise the car hunts about the lane's centre, as without hands, and the driver
corrects it: what sticks and slips repeats, so that this is told and not judged.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.drivers.driver import DriverParameters
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.rollout import rollout
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.tick import INTENTION_OFF, PREDICTION_HORIZON, Script
from costeer.loop.trial import idle_network
from costeer.methods.ibhs import IBHS
from costeer.records.row import ROW_COLUMNS
from costeer.validation.driver_loop import (
    least_damped,
    poles,
    quiet,
    smooth,
    transition,
)
from costeer.validation.pilot import UNDISPUTED
from costeer.validation.stability import OFFSET, amplitude
from costeer.validation.swing import LEAST_DAMPING, MOST_KEPT, kept_after_a_period
from costeer.validation.threads import in_threads

Values = tuple[tuple[str, Real], ...]

CONSTANT: Values = (("guidance.steering_gain_speed", 100.0),)
"""The gains as they are at low speed, at every speed."""

MOST_SWING = np.radians(1.0)
"""Amplitude of the wheel up to which an oscillation may last while driving [rad].
Assumed, above the hunting of dry friction."""

SMALLEST_SWING = np.radians(0.1)
"""The same without dry friction and noise [rad]. Assumed: nothing else moves there."""

_RUN = 60.0
_DRIVE = 120.0
_AGAIN = 300.0
_BEGIN = 20.0
_LATE = 40.0
_ANGLE = ROW_COLUMNS.index("steering_wheel_angle")
_PLACE = ROW_COLUMNS.index("lateral_position")


class Wheel(NamedTuple):
    """How the wheel moves from 20 s after a start beside the aim.

    Attributes:
        amplitude: Half of its span, infinite if the car did not stay on the road [rad].
        kept: Share of its motion that is found again a period later [-].
    """

    amplitude: Real
    kept: Real


class Guided(NamedTuple):
    """One car at one speed with guidance, arrays of shape `(driver,)`.

    Attributes:
        car: Its name.
        speed: [m/s].
        damping_ratio: Smallest of all swings of the linear loop, of both cases of the
            compensation [-].
        frequency: Of that swing, NaN if none [rad/s].
        free: The wheel without noise and dry friction [rad, -].
        driven: The wheel with both [rad, -].
        hunting: Amplitude of the wheel from 40 to 60 s, with dry friction and without
            noise [rad].
        drift: The same of the car [m].
    """

    car: str
    speed: Real
    damping_ratio: NDArray[np.float64]
    frequency: NDArray[np.float64]
    free: Wheel
    driven: Wheel
    hunting: NDArray[np.float64]
    drift: NDArray[np.float64]


def guided_parameters(
    car: str, speed: Real, values: Values = ()
) -> LoopParameters[Any]:
    """Strong guidance that keeps a lane and never fades.

    Args:
        car: Its name.
        speed: [m/s].
        values: Parameters to set by name.
    """
    return loop_parameters(
        TrialSetup(
            condition="strong-normal",
            car=car,
            speed=speed,
            length=2.0 * speed * _AGAIN,  # nobody arrives
            intention="off",
            events=False,
            parameters=(*UNDISPUTED, *values),
        )
    )


def without_compensation(parameters: LoopParameters[Any]) -> LoopParameters[Any]:
    """The same with guidance that knows of no dry friction."""
    method = parameters.controller
    column = method.column._replace(friction=0.0)
    return parameters._replace(controller=method._replace(column=column))


def _started(
    parameters: LoopParameters[Any], noise: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The rows of a run from beside the aim, fewer than `noise` off the road."""
    aim = parameters.driver.tracking.lane_bias
    start = parameters.start._replace(lateral_offset=aim + OFFSET)
    script = Script(INTENTION_OFF, PREDICTION_HORIZON, np.empty(0))
    given = parameters._replace(start=start)
    return rollout(IBHS, given, script, idle_network(), noise, "numba")


def wheel(parameters: LoopParameters[Any], noise: NDArray[np.float64]) -> Wheel:
    """How the wheel moves after a start beside the aim.

    Args:
        parameters: Of a trial with guidance.
        noise: Draws of the driver, `(num_steps, draw)`, of at least 60 s.
    """
    rows = _started(parameters, noise)
    if len(rows) < len(noise):
        return Wheel(np.inf, 1.0)
    angle = rows[round(_BEGIN / DT) :, _ANGLE]
    return Wheel(amplitude(angle), kept_after_a_period(angle))


def hunting(parameters: LoopParameters[Any]) -> tuple[Real, Real]:
    """Amplitude of wheel [rad] and car [m] long after a start, without noise."""
    rows = _started(parameters, quiet(round(_RUN / DT)))[round(_LATE / DT) :]
    if len(rows) == 0:
        return np.inf, np.inf
    return amplitude(rows[:, _ANGLE]), amplitude(rows[:, _PLACE])


def driven_wheel(parameters: LoopParameters[Any], seed: int, number: int) -> Wheel:
    """How the wheel moves in a drive with the driver's own noise.

    Corrections at random times fall into line by chance now and then, an oscillation
    does so always: where the wheel seems to oscillate, a second drive with other noise
    counts, which lasts longer.

    Args:
        parameters: Of a trial with guidance.
        seed: Of the noise.
        number: Of the driver.
    """
    first = driver_noise(seed, number, "strong-normal", round(_DRIVE / DT))
    seen = wheel(parameters, first)
    if not lasts(seen, MOST_SWING):
        return seen
    other = driver_noise(seed, number, "strong-gentle", round(_AGAIN / DT))
    return wheel(parameters, other)


def _looks(runs: tuple[LoopParameters[Any], int, int]) -> tuple[Real, ...]:
    """Wheel without friction and noise, wheel with both, wheel and car hunting.

    Args:
        runs: Parameters, seed and number of the driver.
    """
    parameters, seed, number = runs
    free = wheel(smooth(parameters), quiet(round(_RUN / DT)))
    drive = driven_wheel(parameters, seed, number)
    return (*free, *drive, *hunting(parameters))


def least_damping(
    drivers: Sequence[DriverParameters], car: str, speed: Real, values: Values = ()
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Least damping ratio [-] and its frequency [rad/s] of each linear loop.

    Args:
        drivers: Who holds the wheel.
        car: Its name.
        speed: [m/s].
        values: Parameters to set by name.

    Returns:
        Shape `(driver,)` each, of the worse case of the compensation.
    """
    steep = guided_parameters(car, speed, values)
    cases = [
        least_damped(poles(transition(parameters, drivers, 1.0)))
        for parameters in (steep, without_compensation(steep))
    ]
    (one, fast), (other, slow) = cases
    return np.minimum(one, other), np.where(one <= other, fast, slow)


def guided_drivers(
    seed: int,
    drivers: Sequence[DriverParameters],
    car: str,
    speed: Real,
    values: Values = (),
    jobs: int = 2,
) -> Guided:
    """Look at drivers who hold the wheel with strong guidance at full gain.

    Args:
        seed: Of their noise.
        drivers: Participants 1, 2, ... of a population, or others.
        car: Its name.
        speed: [m/s].
        values: Parameters to set by name.
        jobs: Threads.
    """
    ratio, frequency = least_damping(drivers, car, speed, values)
    parameters = guided_parameters(car, speed, values)
    runs = [
        (parameters._replace(driver=driver), seed, number)
        for number, driver in enumerate(drivers, start=1)
    ]
    found = np.array(in_threads(_looks, runs, jobs, None)).T
    return Guided(
        car=car,
        speed=speed,
        damping_ratio=ratio,
        frequency=frequency,
        free=Wheel(*found[0:2]),
        driven=Wheel(*found[2:4]),
        hunting=found[4],
        drift=found[5],
    )


def lasts(wheel: Wheel, most: Real) -> NDArray[np.bool_]:
    """Which wheels oscillate by more than `most` [rad], shape `(driver,)`."""
    large = np.asarray(wheel.amplitude) > most
    return np.asarray(large & (np.asarray(wheel.kept) > MOST_KEPT))


def swinging(found: Guided) -> NDArray[np.bool_]:
    """Which drivers swing, shape `(driver,)`."""
    slow = found.damping_ratio < LEAST_DAMPING
    free = lasts(found.free, SMALLEST_SWING)
    return np.asarray(slow | free | lasts(found.driven, MOST_SWING))
