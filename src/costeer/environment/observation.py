"""What an agent sees: the signals of its seat, as one array within bounds."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.loop.events import lead_of
from costeer.loop.step import LoopState
from costeer.sensing.measurement import Measurement


class Signal(NamedTuple):
    """One number that an agent sees.

    Attributes:
        name: As records have it.
        unit: SI, "-" if there is none.
        bound: Largest value to either side; what is beyond it is seen at the bound.
        missing: What stands for a value that is undefined.
    """

    name: str
    unit: str
    bound: float
    missing: float = 0.0


MEASURED = (
    Signal("lateral_position", "m", 20.0),
    Signal("yaw_angle", "rad", 3.2),
    Signal("yaw_rate", "rad/s", 3.0),
    Signal("longitudinal_velocity", "m/s", 60.0),
    Signal("longitudinal_acceleration", "m/s²", 30.0),
    Signal("lateral_velocity", "m/s", 20.0),
    Signal("lateral_acceleration", "m/s²", 30.0),
    Signal("steering_wheel_angle", "rad", 20.0),
    Signal("steering_wheel_rate", "rad/s", 100.0),
    Signal("driver_torque", "N·m", 50.0),
    Signal("head_yaw", "-", 1.0),
    Signal("lane", "-", 8.0),
    Signal("side", "-", 1.0),
    Signal("distance_to_adjacent_lane", "m", 20.0),
    Signal("road_curvature", "1/m", 1.0),
)
"""Fields of the measurement, which both seats see."""

FELT = (
    Signal("guidance_torque", "N·m", 50.0),
    Signal("lead_distance", "m", 200.0, missing=200.0),
    Signal("lead_velocity", "m/s", 60.0),
)
"""What a driver sees and feels besides: the motor's torque, and the car ahead."""

SIGNALS = {"guidance": MEASURED, "driver": MEASURED + FELT}
"""What each agent sees, in the order of its observation."""


def observation(
    state: LoopState[Any],  # Any: the state of any method
    measurement: Measurement,
    signals: tuple[Signal, ...],
) -> NDArray[np.float32]:
    """What an agent sees before a step, shape `(signal,)`.

    Args:
        state: Of the loop.
        measurement: This step's sample.
        signals: Of the agent's seat.
    """
    lead = lead_of(state.control.events, measurement.longitudinal_position)
    known: dict[str, Real] = measurement._asdict() | {
        "guidance_torque": state.world.column.motor_torque,
        "lead_distance": lead.distance,
        "lead_velocity": lead.velocity,
    }
    values = np.array([known[each.name] for each in signals], dtype=np.float64)
    missing = np.array([each.missing for each in signals])
    bounds = np.array([each.bound for each in signals])
    found = np.where(np.isfinite(values), values, missing)
    return np.clip(found, -bounds, bounds).astype(np.float32)
