"""A recording as the fit takes it: the signals of the driver's hands, and the known.

Between two samples the wheel's angle is the cubic that has the recorded angles and
rates; it is needed at the plant's rate, at which arms and reflex act.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.plant.parameters import CarParameters, ColumnParameters

Signal = NDArray[np.float64]

PLANT_STEPS = 8
"""Plant steps in a control step, as of a simulated trial."""


class Drive(NamedTuple):
    """What a fit needs of a recording, shape `(time,)` each.

    Attributes:
        lateral_position: From the left lane's centre [m].
        lane: That the car is in, counted from the right [-].
        lane_offset: From that lane's centre [m].
        yaw_angle: [rad].
        speed: [m/s].
        steering_wheel_angle: [rad].
        steering_wheel_rate: [rad/s].
        driver_torque: Mean over the control step before [N·m].
        head_yaw: In [-1, 1] [-]; None if it is not recorded.
        free: Rows without a leader near; None if that is not recorded.
        car: Known.
        column: Known.
        dt: Sampling step [s].
    """

    lateral_position: Signal
    lane: Signal
    lane_offset: Signal
    yaw_angle: Signal
    speed: Signal
    steering_wheel_angle: Signal
    steering_wheel_rate: Signal
    driver_torque: Signal
    head_yaw: Signal | None
    free: NDArray[np.bool_] | None
    car: CarParameters
    column: ColumnParameters
    dt: float


class WheelMotion(NamedTuple):
    """Motion of the wheel over each control step, shape `(time - 1,)` each.

    Attributes:
        mean_angle: At the beginnings of the plant steps [rad].
        mean_reflex_angle: The same as the reflex acts on it [rad].
        mean_rate: [rad/s].
        mean_acceleration: [rad/s²].
        sliding: Share of an impulse in the step that still moves the wheel at its end,
            0 where dry friction holds it [-].
    """

    mean_angle: Signal
    mean_reflex_angle: Signal
    mean_rate: Signal
    mean_acceleration: Signal
    sliding: Signal


def angles_between(drive: Drive) -> Signal:
    """Wheel angle at the beginnings of the plant steps, shape `(time - 1, 8)` [rad]."""
    share = np.arange(PLANT_STEPS) / PLANT_STEPS
    angle, rate = drive.steering_wheel_angle, drive.steering_wheel_rate * drive.dt
    weights = np.array(
        [
            1.0 - 3.0 * share**2 + 2.0 * share**3,
            share * (1.0 - share) ** 2,
            3.0 * share**2 - 2.0 * share**3,
            share**2 * (share - 1.0),
        ]
    )
    corners = np.stack([angle[:-1], rate[:-1], angle[1:], rate[1:]], axis=1)
    return np.asarray(corners @ weights)


def sliding_share(drive: Drive) -> Signal:
    """Share of an impulse in a step that still moves the wheel at its end.

    A wheel that dry friction holds at the end of the step kept nothing of it. One
    that broke loose within the step moved for twice the mean over the last rate; the
    impulse of a torque that grows over the step is later rather than earlier.
    """
    angle, rate = drive.steering_wheel_angle, drive.steering_wheel_rate
    before, after, moved = rate[:-1], rate[1:], np.diff(angle)
    travel = np.where(after == 0.0, 1.0, after) * drive.dt
    loose = np.clip(2.0 * moved / travel, 0.0, 1.0)
    share = np.where(before == 0.0, 1.0 - (1.0 - loose) ** 2, 1.0)
    return np.asarray(np.where(after == 0.0, 0.0, share))
