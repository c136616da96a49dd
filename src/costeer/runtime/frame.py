"""What the real-time process tells 60 times a second: a row of the record and more."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from costeer.plant.fleet import MOST_CARS
from costeer.records.cars import CAR_SIGNALS
from costeer.records.columns import CAR_PREFIX, COLUMNS, Column


def _told(name: str, unit: str, description: str, stepped: bool = False) -> Column:
    return Column(name, unit, "float64", description, stepped=stepped)


EXTRA_COLUMNS = (
    _told("run_state", "-", "place in `RUN_STATES`", stepped=True),
    _told("fault", "-", "place in `FAULTS`", stepped=True),
    _told("wheel_torque", "N·m", "asked of the steering wheel"),
    _told("fade", "-", "share of the torque that is let through, in [0, 1]"),
    _told("intended_angle", "rad", "of the virtual hands"),
    _told("input_sequence", "-", "number of the last input that acted", stepped=True),
    _told("wheel_time", "s", "when the wheel was read, process clock", stepped=True),
    _told("sent_time", "s", "when the frame was sent, process clock", stepped=True),
    _told("compute_time", "s", "how long the control step took"),
    _told("lateness", "s", "largest since the last control step"),
    _told("strength_factor", "-", "of the guidance, 0 in manual driving", stepped=True),
    _told("condition", "-", "place among the conditions", stepped=True),
    _told("indicator", "-", "-1 right, 0 off, +1 left", stepped=True),
)
"""Besides the record: state, safety, virtual hands and timing."""

FRAME = (*COLUMNS, *EXTRA_COLUMNS)
"""The numbers of a frame."""

FRAME_COLUMNS = tuple(column.name for column in FRAME)
"""Their names."""

MOST_METHOD_COLUMNS = 16
"""As many columns of its own a method may have in a drive: what is kept for them."""

WIDTH = len(FRAME) + MOST_METHOD_COLUMNS + len(CAR_SIGNALS) * MOST_CARS
"""Numbers of a frame; the method's own and those of other cars are the last, and may be
fewer."""


def frame_columns(added: Sequence[Column]) -> tuple[Column, ...]:
    """The numbers of a frame with those that a method and a scenario add."""
    return (*FRAME, *added)


def absent(column: Column) -> float:
    """What a method's column is while another method runs."""
    return 0.0 if column.labels else math.nan


class FrameRow:
    """Room for one frame.

    Args:
        added: Columns of the method of the drive, then of other cars.
    """

    def __init__(self, added: Sequence[Column]) -> None:
        own = [each for each in added if not each.name.startswith(CAR_PREFIX)]
        self.numbers = np.full(WIDTH, np.nan)
        self._absent = np.array([absent(each) for each in own])
        self._num_cars = len(added) - len(own)

    def fill(self, row: NDArray[np.float64], extra: Sequence[float]) -> None:
        """Take over a row of the loop and the numbers of `EXTRA_COLUMNS`.

        Another method than the drive's may run: its own columns have no place here.
        """
        numbers, usual, first = self.numbers, len(COLUMNS), len(FRAME)
        numbers[:usual] = row[:usual]
        numbers[usual:first] = extra
        cars = len(row) - self._num_cars
        of_method, missing = row[usual:cars], self._absent
        is_ours = len(of_method) == len(missing)
        last = first + len(missing)
        numbers[first:last] = of_method if is_ours else missing
        numbers[last : last + self._num_cars] = row[cars:]


PLACE = {name: place for place, name in enumerate(FRAME_COLUMNS)}
"""Where each stands."""

TRACE = (
    _told("time", "s", "of the trial at the start of the plant step"),
    _told("lateness", "s", "how late the plant step began"),
    _told("steering_wheel_angle", "rad", "left positive"),
    _told("steering_wheel_rate", "rad/s", "its time derivative"),
    _told("wheel_torque", "N·m", "asked of the steering wheel"),
    _told("driver_torque", "N·m", "of the driver at the wheel"),
    _told("step_time", "s", "how long the plant step took, the device included"),
)
"""Of the wheel at the plant's rate."""

TRACE_COLUMNS = tuple(column.name for column in TRACE)
"""Their names."""
