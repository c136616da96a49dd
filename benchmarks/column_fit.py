"""A steering column from its angle and a torque that was measured on it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from costeer.sensing.torque_observer import TorqueObserverParameters

LEAST_TIME = 10.0
"""Recordings shorter than this do not tell a column [s]."""

_SMOOTHING = 0.35
_MOVING = 0.05

Signal = NDArray[np.float64]


class ColumnFit(NamedTuple):
    """The column that explains a measured torque best.

    Attributes:
        parameters: Its inertia, damping, stiffness and friction.
        offset: Torque at rest straight ahead [N·m].
        explained: Share of the torque's variance that it explains [-].
    """

    parameters: TorqueObserverParameters
    offset: float
    explained: float


def fit_column(steering_wheel_angle: Signal, torque: Signal, dt: float) -> ColumnFit:
    """Least squares of a torque on angle, rate, acceleration and direction.

    Everything else that turns the wheel, as tyres and power assistance, is taken for
    the column's own; so the result holds at about the speed of the recording.

    Args:
        steering_wheel_angle: Shape `(time,)` [rad].
        torque: Measured at the wheel, same shape [N·m].
        dt: Between samples [s].

    Raises:
        ValueError: If the recording is too short, has gaps or never moves.
    """
    angle, measured = np.asarray(steering_wheel_angle), np.asarray(torque)
    _check(angle, measured, dt)
    # A parabola through an odd number of samples, at least five.
    width = max(2 * round(_SMOOTHING / dt / 2.0) + 1, 5)
    smooth, rate, acceleration = (
        savgol_filter(angle, width, 2, deriv=order, delta=dt) for order in range(3)
    )
    direction = savgol_filter(np.clip(rate / _MOVING, -1.0, 1.0), width, 2)
    wanted = savgol_filter(measured, width, 2)
    known = np.column_stack(
        [acceleration, rate, smooth, direction, np.ones_like(angle)]
    )
    solved = np.linalg.lstsq(known, wanted, rcond=None)[0]
    left = wanted - known @ solved
    inertia, damping, stiffness, friction = np.maximum(solved[:4], 0.0).tolist()
    return ColumnFit(
        parameters=TorqueObserverParameters(
            inertia=inertia, damping=damping, stiffness=stiffness, friction=friction
        ),
        offset=float(solved[4]),
        explained=1.0 - float(left.var() / wanted.var()),
    )


def _check(angle: Signal, torque: Signal, dt: float) -> None:
    if angle.shape != torque.shape or angle.ndim != 1:
        raise ValueError(
            f"angle has shape {angle.shape} and torque {torque.shape}; give two series "
            "of the same length"
        )
    if angle.size * dt < LEAST_TIME:
        raise ValueError(
            f"the recording lasts {angle.size * dt:.3g} s; a column needs at least "
            f"{LEAST_TIME:g} s"
        )
    for name, values in (("angle", angle), ("torque", torque)):
        if not np.isfinite(values).all():
            raise ValueError(f"the {name} has gaps; cut the recording to a stretch")
        if np.ptp(values) == 0.0:
            raise ValueError(f"the {name} never changes; record while steering")
