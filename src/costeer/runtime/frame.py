"""What the real-time process tells 60 times a second: a row of the record and more."""

from __future__ import annotations

from costeer.loop.rows import ROW_COLUMNS

EXTRA_COLUMNS = (
    "run_state",
    "fault",
    "wheel_torque",
    "fade",
    "intended_angle",
    "input_sequence",
    "wheel_time",
    "sent_time",
    "compute_time",
    "lateness",
    "strength_factor",
    "condition",
    "indicator",
)
"""Besides the record: state, safety, virtual hands and timing."""

FRAME_COLUMNS = (*ROW_COLUMNS, *EXTRA_COLUMNS)
"""Names of the numbers of a frame."""

PLACE = {name: place for place, name in enumerate(FRAME_COLUMNS)}
"""Where each stands."""

WAITING, RUNNING, PAUSED, ENDED = 0, 1, 2, 3
RUN_STATES = ("waiting", "running", "paused", "ended")
"""Of a drive, by the number in a frame."""

NO_FAULT, WHEEL_LOST, BROWSER_LOST, SENSOR_STALE, NOT_FINITE, STALLED = range(6)
FAULTS = (
    "",
    "the steering wheel is lost: plug it in and resume",
    "the page is lost: open it again and resume",
    "the steering wheel says nothing new: check its cable and resume",
    "a number was not finite: restart the trial",
    "the real-time process stood still: resume, and see costeer doctor for priority",
)
"""What is wrong, by the number in a frame, and the way out."""

TRACE_COLUMNS = (
    "time",
    "lateness",
    "steering_wheel_angle",
    "steering_wheel_rate",
    "wheel_torque",
    "driver_torque",
    "step_time",
)
"""Of the wheel at the plant's rate: `time` of the trial at the start of the plant
step, `lateness` how late it began, `step_time` how long it took, the device included.
"""

TRACE_UNITS = ("s", "s", "rad", "rad/s", "N·m", "N·m", "s")
