"""The trace of the wheel: every plant step at its time.

In a pause the trial's time stands still, and so does that of the trace, which goes on
until the torque is zero.
"""

from __future__ import annotations

import math

import numpy as np

from costeer.runtime.cabin import Cabin
from costeer.runtime.frame import TRACE_COLUMNS
from costeer.runtime.setup import PLANT_DT, PLANT_STEPS
from costeer.runtime.shared import Ring


class Tracer:
    """Writes a row for every plant step of the trial under torque.

    Args:
        ring: Of the trace.
    """

    def __init__(self, ring: Ring) -> None:
        self._ring = ring
        self._row = np.full(len(TRACE_COLUMNS), math.nan)
        self._goes_on = False

    def leave(self) -> None:
        """The trial is over; what the wheel does now belongs to no other."""
        self._goes_on = False

    def follow(self, late: float, took: float, cabin: Cabin) -> None:
        """Add a row while the trial stands still, until the torque is zero."""
        if self._goes_on:
            self._goes_on = cabin.wheel_torque != 0.0
            self._write(self._row[0], late, took, cabin)

    def put(self, control_time: float, late: float, took: float, cabin: Cabin) -> None:
        """Add a row of the running trial.

        Args:
            control_time: Of the trial at the last control step [s].
            late: How late the plant step began [s].
            took: How long it took [s].
            cabin: With the wheel.
        """
        before, last = self._row[0], (PLANT_STEPS - 1.5) * PLANT_DT
        follows = control_time <= before < control_time + last
        moment = before + PLANT_DT if follows else control_time
        self._goes_on = True
        self._write(moment, late, took, cabin)

    def _write(self, moment: float, late: float, took: float, cabin: Cabin) -> None:
        reading = cabin.reading
        self._row[:] = (
            moment,
            late,
            cabin.steering_wheel_angle,
            math.nan if reading is None else reading.steering_wheel_rate,
            cabin.wheel_torque,
            math.nan if reading is None else cabin.driver_torque,
            took,
        )
        self._ring.put(self._row)
