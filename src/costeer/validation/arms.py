"""Torque perturbation of the held wheel: how far the arms give way.

As Pick and Cole (2007, 2008) did at the wheel and Abbink et al. (2011) at a pedal, a
motor moves the wheel that hands hold, and the arms' admittance, angle over the torque
that the hands feel, is read off at the frequencies of the perturbation. The wheel's own
inertia, damping and stiffness are thereby left out, whatever wheel it is; this one is
the plant's, without the car's self-aligning torque and without dry friction, which
would make the test depend on its size.

Those papers are named for the method. `PUBLISHED` is a band assumed from published
second-order parameters of arms (inertia 0.06 to 0.15 kg·m², damping 0.3 to 2.5
N·m·s/rad, stiffness 2 to 80 N·m/rad from relaxed to tense): the order of size that such
studies give, not checked against a table of theirs. Firm are only that inertia rules at
10 Hz and that tense arms give way less than relaxed ones below 1 Hz.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real, compiled
from costeer.base.entry import entry
from costeer.base.packing import packed, unpack
from costeer.drivers import arm
from costeer.drivers.arm import ArmCommand, ArmParameters
from costeer.drivers.driver import DriverParameters
from costeer.plant.parameters import ColumnParameters
from costeer.plant.steering import steering_wheel_rate

Signal = NDArray[np.float64]
Spectrum = NDArray[np.complex128]

TASKS = ("relaxed", "driving", "tense")
"""Muscles alone; with the reflex and the intention to go straight; stiffened too."""

FREQUENCIES = np.array([0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0])
"""Of the perturbation [Hz]: all have whole periods in `PERIOD`."""

PERIOD = 10.0
"""After which the perturbation repeats [s]: one to settle, one to measure."""

TORQUE = 0.3
"""Amplitude of each sine [N·m]."""

PLANT_RATE = 480
"""Steps per second, as in a trial [Hz]."""


class ArmRange(NamedTuple):
    """Smallest and largest second-order parameters of arms in one task.

    Attributes:
        inertia: [kg·m²].
        damping: [N·m·s/rad].
        stiffness: [N·m/rad].
    """

    inertia: tuple[Real, Real]
    damping: tuple[Real, Real]
    stiffness: tuple[Real, Real]


ARM_RANGES = {
    "relaxed": ArmRange((0.06, 0.12), (0.3, 1.0), (2.0, 10.0)),
    "driving": ArmRange((0.06, 0.12), (0.5, 1.5), (8.0, 25.0)),
    "tense": ArmRange((0.06, 0.15), (0.7, 2.5), (20.0, 80.0)),
}
"""Assumed, the order of size in the field's studies; see this file's docstring."""


class Band(NamedTuple):
    """Range of the admittance's magnitude, shape `(frequency,)` [rad/(N·m)]."""

    low: Signal
    high: Signal


class ArmTest(NamedTuple):
    """One task of all drivers.

    Attributes:
        task: "relaxed", "driving" or "tense".
        frequency: Shape `(frequency,)` [Hz].
        admittance: Angle over torque on the hands, shape `(driver, frequency)`
            [rad/(N·m)].
    """

    task: str
    frequency: Signal
    admittance: Spectrum


class ArmRow(NamedTuple):
    """One task at one frequency, magnitudes of the admittance [rad/(N·m)].

    Attributes:
        task: "relaxed", "driving" or "tense".
        frequency: [Hz].
        percentiles: 5, 50 and 95 % of the drivers.
        low: Of the band.
        high: Of the band.
        share_inside: Drivers within the band [-].
    """

    task: str
    frequency: Real
    percentiles: tuple[Real, Real, Real]
    low: Real
    high: Real
    share_inside: Real


def band(arms: ArmRange, frequency: Signal = FREQUENCIES) -> Band:
    """Least and largest |1 / (J s² + B s + K)| over a range of arms.

    Damping only adds to the impedance, so one of its ends is the extreme; stiffness
    less inertia times frequency squared counts by its distance from zero.

    Args:
        arms: Ranges of J, B and K.
        frequency: Shape `(frequency,)` [Hz].
    """
    turn = 2.0 * math.pi * frequency
    softest = arms.stiffness[0] - arms.inertia[1] * turn**2
    stiffest = arms.stiffness[1] - arms.inertia[0] * turn**2
    nearest = np.maximum(np.maximum(softest, -stiffest), 0.0)
    farthest = np.maximum(np.abs(softest), np.abs(stiffest))
    low = 1.0 / np.hypot(farthest, arms.damping[1] * turn)
    return Band(low=low, high=1.0 / np.hypot(nearest, arms.damping[0] * turn))


PUBLISHED = {task: band(arms) for task, arms in ARM_RANGES.items()}
"""Band of each task at `FREQUENCIES`."""


class _Held(NamedTuple):
    """Arms, wheel and what the brain asks, for compiled code."""

    arm: ArmParameters
    column: ColumnParameters
    command: ArmCommand
    dt: Real


_LIKE = _Held(
    ArmParameters(), ColumnParameters(), ArmCommand(0.0, 0.0, 1.0, 0.0, 0.0), 0.0
)


@compiled
def _shake(held: _Held, torque: Signal, angles: Signal, felt: Signal) -> None:
    """Fill angle and torque of the hands while `torque` [N·m] acts on the wheel.

    The angle is that at the start of a step: the step's acceleration is its second
    difference there, so that no time passes between the two.
    """
    state, angle, rate = arm.initial_state(), 0.0, 0.0
    stiffening = held.command.stiffening
    column = arm.held_column(held.arm, held.column, stiffening)
    for k in range(len(torque)):
        state = arm.step(held.arm, state, held.command, angle, held.dt)
        muscles = arm.muscle_torque(held.arm, state, held.command, angle)
        before = rate
        rate = steering_wheel_rate(column, angle, before, muscles + torque[k], held.dt)
        angles[k] = angle
        angle = angle + held.dt * rate
        felt[k] = arm.hand_torque(
            held.arm, muscles, stiffening, rate, (rate - before) / held.dt
        )


@entry
def _shake_compiled(
    given: Signal, torque: Signal, angles: Signal, felt: Signal
) -> None:
    _shake(unpack(_LIKE, given), torque, angles, felt)


def perturbation(amplitude: Real = TORQUE) -> Signal:
    """Sum of sines over two periods, shape `(time,)` [N·m].

    All begin at zero, so that the wheel is not struck.

    Args:
        amplitude: Of each [N·m].
    """
    time = np.arange(round(2.0 * PERIOD * PLANT_RATE)) / PLANT_RATE
    sines = np.sin(2.0 * math.pi * FREQUENCIES[:, None] * time)
    return np.asarray(amplitude * sines.sum(axis=0))


def _held(driver: DriverParameters, task: str) -> _Held:
    """The wheel in the hands of this driver.

    Relaxed arms are their intrinsic stiffness alone; the intended angle is always
    straight ahead, so that the holding torque never shows.
    """
    hands = driver.arm
    if task == "relaxed":
        stiffness = hands.stiffness * hands.intrinsic_share
        hands = hands._replace(stiffness=stiffness, intrinsic_share=1.0)
    tense = driver.reliance.cocontraction if task == "tense" else 1.0
    return _Held(
        arm=hands,
        column=ColumnParameters()._replace(friction=0.0),
        command=_LIKE.command._replace(stiffening=tense),
        dt=1.0 / PLANT_RATE,
    )


def shaken(
    driver: DriverParameters, task: str, torque: Signal, engine: str = "numba"
) -> tuple[Signal, Signal]:
    """Shake the wheel that a driver holds.

    Args:
        driver: Whose arms.
        task: "relaxed", "driving" or "tense".
        torque: On the wheel, shape `(time,)` [N·m].
        engine: "numba" or "python".

    Returns:
        Angle of the wheel [rad] and torque of the wheel on the hands [N·m], shape
        `(time,)` each.

    Raises:
        ValueError: If the task is not known.
    """
    if task not in TASKS:
        known = ", ".join(TASKS)
        raise ValueError(f"task '{task}' is not known; choose one of {known}")
    held = _held(driver, task)
    angles, felt = np.empty(len(torque)), np.empty(len(torque))
    if engine == "python":
        _shake(held, torque, angles, felt)
    else:
        _shake_compiled(packed(held), torque, angles, felt)
    return angles, -felt


def coefficients(signal: Signal) -> Spectrum:
    """Fourier coefficients of the last period, shape `(frequency,)`."""
    last = signal[-round(PERIOD * PLANT_RATE) :]
    spectrum = np.fft.rfft(last)
    cycles = np.rint(FREQUENCIES * PERIOD).astype(int)
    return np.asarray(spectrum[cycles], dtype=np.complex128)


def arm_admittance(
    driver: DriverParameters, task: str, engine: str = "numba"
) -> Spectrum:
    """Admittance of one driver's arms, shape `(frequency,)` [rad/(N·m)]."""
    angles, felt = shaken(driver, task, perturbation(), engine)
    return np.asarray(coefficients(angles) / coefficients(felt))


def arm_tests(drivers: Sequence[DriverParameters]) -> list[ArmTest]:
    """The three tasks of these drivers."""
    return [
        ArmTest(
            task=task,
            frequency=FREQUENCIES,
            admittance=np.array([arm_admittance(each, task) for each in drivers]),
        )
        for task in TASKS
    ]


def arms_in_range(test: ArmTest) -> NDArray[np.bool_]:
    """Whether each magnitude lies in its band, shape `(driver, frequency)`."""
    size, limits = np.abs(test.admittance), PUBLISHED[test.task]
    return np.asarray((size >= limits.low) & (size <= limits.high))


def arm_rows(tests: Sequence[ArmTest]) -> list[ArmRow]:
    """The tests as a table: a row per task and frequency."""
    rows = []
    for test in tests:
        limits, inside = PUBLISHED[test.task], arms_in_range(test)
        for k, frequency in enumerate(test.frequency.tolist()):
            low, middle, high = np.percentile(
                np.abs(test.admittance[:, k]), [5, 50, 95]
            )
            rows.append(
                ArmRow(
                    task=test.task,
                    frequency=frequency,
                    percentiles=(float(low), float(middle), float(high)),
                    low=float(limits.low[k]),
                    high=float(limits.high[k]),
                    share_inside=float(inside[:, k].mean()),
                )
            )
    return rows
