"""How fast a virtual driver answers a heading error, as people were asked to.

The reading of Goodridge et al. (2022), from the program that made their table: the
steering-wheel angle per frame of 1/60 s is smoothed by a cubic over 11 frames; the
onset is the first frame in which it exceeds 0.02 deg (1.2 deg/s) towards the
correction, in trials where it exceeds 0.05 deg (3 deg/s) at all; the peak is the
largest angle. They count the frame in which the line appears as the first.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.signal import savgol_filter

from costeer.base.array import Real
from costeer.controller.actuation import ActuationParameters
from costeer.controller.signals import Request
from costeer.controller.step import ControllerParameters
from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import DriverNoise
from costeer.drivers.population import USUAL, Population, participant_driver
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT, LoopParameters, StartParameters
from costeer.loop.rows import rules_of
from costeer.loop.step import LoopState, initial_state, sense, step
from costeer.methods.manual import MANUAL
from costeer.validation.people.findings import Values
from costeer.validation.people.leeds import HEADINGS

SPEED = 8.0
"""Of the experiment [m/s]."""

VISIBLE = 3.0
"""How long a correction is watched [s]."""

ONSET_STEP = math.radians(0.02)
"""Wheel angle per frame that is an onset [rad]."""

STEERED_STEP = math.radians(0.05)
"""Wheel angle per frame without which a trial is no correction [rad]."""

_SMOOTHING = 11
_CUBIC = 3


class Correction(NamedTuple):
    """One correction.

    Attributes:
        onset: After the error appears [s]; NaN if the driver did not steer.
        peak: Largest steering-wheel angle towards the correction [rad]; NaN likewise.
    """

    onset: Real
    peak: Real


class OnsetTest(NamedTuple):
    """Medians of one virtual driver at heading errors of 1 and 2 deg.

    Attributes:
        participant: Number of the driver.
        onset: Of the steering [s].
        peak: Largest steering-wheel angle [rad].
    """

    participant: int
    onset: tuple[Real, Real]
    peak: tuple[Real, Real]


def correction(angle: Values) -> Correction:
    """Onset and peak of a steering-wheel angle that counts from the error's start.

    Args:
        angle: Positive towards the correction, 60 Hz, shape `(time,)` [rad].
    """
    steps = savgol_filter(np.diff(angle, prepend=angle[:1]), _SMOOTHING, _CUBIC)
    if not steps.max() > STEERED_STEP:
        return Correction(math.nan, math.nan)
    first = int(np.argmax(steps > ONSET_STEP))
    return Correction(onset=(first + 1) * DT, peak=float(angle.max()))


def steering_onset(
    driver: DriverParameters,
    heading_error: Real,
    noise: Values,
    speed: Real = SPEED,
) -> Correction:
    """Let a driver correct a heading error on a straight road without leaders.

    The car starts in the middle of the lane, the wheel straight, without guidance.

    Args:
        driver: Who steers.
        heading_error: Yaw of the car at the start [rad], left positive.
        noise: Of `driver_noise`, shape `(step, draw)`; as many steps are run.
        speed: Of the car [m/s].
    """
    parameters = LoopParameters(
        driver=driver,
        controller=ControllerParameters(
            actuation=ActuationParameters(strength_factor=0.0)
        ),
        start=StartParameters(speed=speed, lateral_offset=0.0, events=0.0),
    )
    rules = rules_of(MANUAL)
    state = _turned(initial_state(rules, parameters), heading_error)
    angles = [state.world.column.steering_wheel_angle]
    for row in noise[:-1]:
        now = DriverNoise(*map(float, row))
        seen = sense(parameters, state)
        state, _ = step(rules, parameters, state, seen, Request(), now)
        angles.append(state.world.column.steering_wheel_angle)
    return correction(-math.copysign(1.0, heading_error) * np.array(angles))


def _turned(state: LoopState[Any], yaw_angle: Real) -> LoopState[Any]:
    """The same state with another yaw [rad]."""
    vehicle = state.world.vehicle._replace(yaw_angle=yaw_angle)
    return state._replace(world=state.world._replace(vehicle=vehicle))


def onset_test(
    seed: int,
    participant: int,
    repeats: int = 4,
    speed: Real = SPEED,
    population: Population = USUAL,
) -> OnsetTest:
    """Let one driver of a population correct errors to both sides.

    Plain Python, about a tenth of a second per correction.

    Args:
        seed: Of the population.
        participant: Number of the driver.
        repeats: Corrections per heading error, to the left and right in turn.
        speed: Of the car, and the driver's [m/s].
        population: Who is drawn from.
    """
    driver = participant_driver(seed, participant, speed, population)
    num_steps = round(VISIBLE / DT)
    medians = []
    for heading in HEADINGS:
        found = [
            steering_onset(
                driver,
                math.radians(heading) * (1.0 if trial % 2 == 0 else -1.0),
                driver_noise(
                    seed, participant, f"onset-{heading:g}-{trial}", num_steps
                ),
                speed,
            )
            for trial in range(repeats)
        ]
        medians.append(_median([c for c in found if math.isfinite(c.onset)]))
    one, two = medians
    return OnsetTest(participant, (one.onset, two.onset), (one.peak, two.peak))


def _median(found: list[Correction]) -> Correction:
    if not found:
        return Correction(math.nan, math.nan)
    onset, peak = np.median(np.array(found), axis=0)
    return Correction(float(onset), float(peak))
