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
