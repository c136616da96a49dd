"""Whether driver and guidance, who hold one wheel, make it swing.

The linear loop of a population with the guidance at a gain (driver_loop.py), without
the friction compensation and with its slope at zero: the truth lies between. And runs
of the whole simulation from beside the aim, with dry friction and without noise, at
full gain: how much the wheel still moves long after.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.drivers.population import participant_driver
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.rollout import rollout
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.tick import INTENTION_OFF, PREDICTION_HORIZON, Script
from costeer.loop.trial import idle_network
from costeer.methods.ibhs import IBHS
from costeer.records.row import ROW_COLUMNS
from costeer.validation.driver_loop import least_damped, poles, quiet, transition
from costeer.validation.pilot import UNDISPUTED
from costeer.validation.stability import OFFSET, amplitude
from costeer.validation.threads import in_threads

Values = tuple[tuple[str, Real], ...]

CONSTANT: Values = (("guidance.steering_gain_speed", 100.0),)
"""The gains as they are at low speed, at every speed."""

LEAST_DAMPING = 0.1
"""Damping ratio that no driver with guidance falls below [-]. Assumed: each swing is
half of the last."""

MOST_SWING = np.radians(1.0)
"""Amplitude of the wheel that may last [rad]. Assumed, above the hunting of dry
friction."""

_RUN = 60.0
_LATE = 40.0
_ANGLE = ROW_COLUMNS.index("steering_wheel_angle")


class Guided(NamedTuple):
    """One car at one speed with guidance, arrays of shape `(driver,)`.

    Attributes:
        car: Its name.
        speed: [m/s].
        damping_ratio: Smallest of all swings of the linear loop, of both cases of the
            compensation [-].
        frequency: Of that swing, NaN if none [rad/s].
        swing: Amplitude of the wheel from 40 to 60 s after a start beside the aim
            [rad].
    """

    car: str
    speed: Real
    damping_ratio: NDArray[np.float64]
    frequency: NDArray[np.float64]
    swing: NDArray[np.float64]


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
            length=speed * _RUN,
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


def lasting_swing(parameters: LoopParameters[Any]) -> Real:
    """Amplitude of the wheel long after a start beside the aim, without noise [rad]."""
    aim = parameters.driver.tracking.lane_bias
    start = parameters.start._replace(lateral_offset=aim + OFFSET)
    script = Script(INTENTION_OFF, PREDICTION_HORIZON, np.empty(0))
    given = parameters._replace(start=start)
    steps = quiet(round(_RUN / DT))
    rows = rollout(IBHS, given, script, idle_network(), steps, "numba")
    return amplitude(rows[round(_LATE / DT) :, _ANGLE])


def guided_drivers(
    seed: int,
    num_drivers: int,
    car: str,
    speed: Real,
    values: Values = (),
    jobs: int = 2,
) -> Guided:
    """Look at a population that holds the wheel with strong guidance at full gain.

    Args:
        seed: Of the population.
        num_drivers: How many.
        car: Its name.
        speed: [m/s].
        values: Parameters to set by name.
        jobs: Threads.
    """
    drivers = [participant_driver(seed, n + 1, speed) for n in range(num_drivers)]
    steep = guided_parameters(car, speed, values)
    cases = [
        least_damped(poles(transition(parameters, drivers, 1.0)))
        for parameters in (steep, without_compensation(steep))
    ]
    (one, fast), (other, slow) = cases
    runs = [steep._replace(driver=driver) for driver in drivers]
    return Guided(
        car=car,
        speed=speed,
        damping_ratio=np.minimum(one, other),
        frequency=np.where(one <= other, fast, slow),
        swing=np.array(in_threads(lasting_swing, runs, jobs, None)),
    )


def swinging(found: Guided) -> NDArray[np.bool_]:
    """Which drivers swing, shape `(driver,)`."""
    slow = found.damping_ratio < LEAST_DAMPING
    return np.asarray(slow | (found.swing > MOST_SWING))
