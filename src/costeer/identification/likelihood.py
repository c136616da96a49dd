"""Likelihood of the recorded torque, given what the driver saw and felt.

What the hands do moves the wheel within the same step, so wheel and torque are known
together: the density of the torque is that of the muscles times how much more the
muscles had to give than the hands show (log-Jacobian), because arms and wheel move
together. Where dry friction holds the wheel both are the same. Noise of a torque
sensor moves no wheel: the log-Jacobian then counts for the share of the prediction
errors that is the driver's, so that inertia and damping stay unbiased.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from costeer.base.filters import decay
from costeer.drivers.arm import ArmParameters
from costeer.drivers.driver import DriverParameters
from costeer.identification.kernel import innovations_compiled
from costeer.identification.model import (
    filter_inputs,
    filter_parameters,
    part,
    reflex_angle,
    start,
)
from costeer.identification.signals import PLANT_STEPS, Drive, Signal, WheelMotion
from costeer.plant.parameters import ColumnParameters
from costeer.plant.steering import steering_wheel_rate

SETTLING_TIME = 4.0
"""The filter runs so long before a prediction counts [s]: it then knows the wander,
which is not independent of where the car was when the stretch began."""


class TorqueNoise(NamedTuple):
    """Noise of the measured torque, which the driver does not feel.

    Attributes:
        deviation: Of each sample [N·m].
        driven_share: Of a prediction error's variance the part that moved the wheel.
    """

    deviation: float
    driven_share: float


NO_NOISE = TorqueNoise(deviation=1e-5, driven_share=1.0)
"""A simulator's own torque; what the cubic between samples misses is left."""


class Evidence(NamedTuple):
    """What a fit looks at.

    Attributes:
        drive: The recording.
        motion: Of its wheel.
        stretches: Rows of lane keeping.
        noise: Of the measured torque.
    """

    drive: Drive
    motion: WheelMotion
    stretches: Sequence[slice]
    noise: TorqueNoise = NO_NOISE


class Prediction(NamedTuple):
    """One-step predictions in lane keeping, shape `(time,)` each.

    Attributes:
        errors: Of the muscles' torque [N·m].
        variances: Of the errors [N²·m²].
        log_jacobian: Of muscle torque by hand torque [-].
    """

    errors: Signal
    variances: Signal
    log_jacobian: Signal


def shown_share(arm: ArmParameters, column: ColumnParameters, dt: float) -> float:
    """Hand torque per torque of the equilibrium within a step on a sliding wheel [-].

    Args:
        arm: Inertia, damping, stiffness.
        column: Of the car; its dry friction does not change with a small torque.
        dt: Control step [s].
    """
    short = dt / PLANT_STEPS
    held = column._replace(
        inertia=column.inertia + arm.inertia,
        damping=column.damping + arm.damping,
        friction=0.0,
    )
    growing = 1.0 - decay(short, arm.lag) ** np.arange(1, PLANT_STEPS + 1)
    asked = growing / growing.mean()
    angles = np.zeros(PLANT_STEPS + 1)
    rate, share, muscles = 0.0, arm.intrinsic_share, np.zeros(PLANT_STEPS)
    for k in range(PLANT_STEPS):
        reflex = reflex_angle(arm, angles[: k + 1], short)[-1]
        felt = share * angles[k] + (1.0 - share) * reflex
        muscles[k] = asked[k] - arm.stiffness * felt
        rate = steering_wheel_rate(held, angles[k], rate, muscles[k], short)
        angles[k + 1] = angles[k] + short * rate
    moved = arm.damping * angles[-1] + arm.inertia * rate
    return float(muscles.mean() - moved / dt)


def predicted(driver: DriverParameters, evidence: Evidence) -> Prediction:
    """Predict every torque of the stretches from what was before it."""
    drive, motion = evidence.drive, evidence.motion
    parameters = filter_parameters(driver, drive.dt, evidence.noise.deviation)
    inputs = filter_inputs(driver, drive, motion)
    skipped = round(SETTLING_TIME / drive.dt)
    errors, variances, sliding = [], [], []
    for rows in evidence.stretches:
        stretch = part(inputs, rows)
        mean, covariance = start(parameters, stretch, driver.vision)
        error, variance = np.empty((2, len(stretch.torque)))
        innovations_compiled(parameters, stretch, mean, covariance, error, variance)
        errors.append(error[skipped:])
        variances.append(variance[skipped:])
        sliding.append(motion.sliding[rows][skipped:])
    hidden = 1.0 - shown_share(driver.arm, drive.column, drive.dt)
    return Prediction(
        errors=np.concatenate(errors),
        variances=np.concatenate(variances),
        log_jacobian=-evidence.noise.driven_share
        * np.log(1.0 - hidden * np.concatenate(sliding)),
    )


def log_likelihoods(found: Prediction) -> Signal:
    """Logarithm of the density of each torque, shape `(time,)`."""
    spread = np.log(2.0 * np.pi * found.variances)
    misfit = found.errors**2 / found.variances
    return np.asarray(found.log_jacobian - 0.5 * (spread + misfit))
