"""What guidance costs the driver and the ride: opposing torque, conflict, jerk.

They need no verdict of the method, so that any two methods can be compared by them.
"""

from __future__ import annotations

import numpy as np

from costeer.study.definitions import (
    Columns,
    Flags,
    Measure,
    Signal,
    incomplete,
    missing,
    runs,
    under_assistance,
    unknown,
)
from costeer.study.manoeuvres import rms, steering_rate

CONFLICT_TORQUE = 0.5
"""Both torques are above it in a conflict [N·m]. Source: assumed, twice what virtual
drivers need to keep their lane."""

CONFLICT_TIME = 0.2
"""Torques that oppose each other for less are no conflict [s]. Source: spec section 3,
the time after which arms stiffen against guidance."""

_NO_GUIDANCE = "there is no guidance"
_TORQUES = ("time", "driver_torque", "applied_torque")


def opposing_torque_rms(columns: Columns) -> Measure:
    """Root mean square of the guidance's torque against the driver's [N·m].

    Over every sample; 0 where the two torques do not oppose each other.
    """
    reason = _why_not(columns)
    if reason:
        return unknown("N·m", reason)
    guidance = np.asarray(columns["applied_torque"])
    opposed = np.asarray(columns["driver_torque"]) * guidance < 0.0
    return Measure(rms(np.where(opposed, guidance, 0.0)), "N·m")


def conflict_share(columns: Columns) -> Measure:
    """Share of the time in which driver and guidance push against each other [-].

    Their torques have opposite signs, both above `CONFLICT_TORQUE`, for
    `CONFLICT_TIME` or longer.
    """
    reason = _why_not(columns)
    if reason:
        return unknown("-", reason)
    time: Signal = np.asarray(columns["time"])
    step = float(time[-1] - time[0]) / (time.size - 1)
    lasting = [
        rows.stop - rows.start
        for rows in runs(_pushing(columns))
        if (rows.stop - rows.start) * step >= CONFLICT_TIME - step / 2.0
    ]
    return Measure(sum(lasting) / time.size, "-")


def _pushing(columns: Columns) -> Flags:
    """Samples with both torques large and of opposite signs, shape `(time,)`."""
    driver = np.asarray(columns["driver_torque"])
    guidance = np.asarray(columns["applied_torque"])
    large = np.minimum(np.abs(driver), np.abs(guidance)) > CONFLICT_TORQUE
    return np.asarray(large & (driver * guidance < 0.0))


def _why_not(columns: Columns) -> str:
    """Why the guidance's torque is not known; empty if it is."""
    if not under_assistance(columns):
        return _NO_GUIDANCE
    reason = incomplete(columns, *_TORQUES)
    if not reason and len(columns["time"]) < 2:
        return "needs two samples"
    return reason


def lateral_jerk_rms(columns: Columns) -> Measure:
    """Root mean square of the rate of the lateral acceleration [m/s³]."""
    reason = incomplete(columns, "time", "lateral_acceleration")
    if reason or len(columns["time"]) < 2:
        return unknown("m/s³", reason or "needs two samples")
    return Measure(
        rms(np.gradient(columns["lateral_acceleration"], columns["time"])), "m/s³"
    )


def wheel_rate_rms(columns: Columns) -> Measure:
    """Root mean square of the steering-wheel rate over the whole course [rad/s]."""
    reason = missing(columns, "steering_wheel_angle")
    if reason:
        return unknown("rad/s", reason)
    return Measure(rms(steering_rate(columns)), "rad/s")
