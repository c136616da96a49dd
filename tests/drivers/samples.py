"""A car, a leader and a measurement for tests of the driver's parts."""

from __future__ import annotations

from costeer.plant.traffic import LeaderState, no_leader
from costeer.sensing.measurement import Measurement

DT = 1.0 / 60.0
SPEED = 70.0 / 3.6
LEFT, RIGHT = 1.0, 0.0


def driving(
    position: float = 0.0,
    lateral_position: float = 0.0,
    speed: float = SPEED,
    lane: float = LEFT,
    yaw_angle: float = 0.0,
) -> Measurement:
    """A car that runs straight."""
    return Measurement(
        longitudinal_position=position,
        lateral_position=lateral_position,
        yaw_angle=yaw_angle,
        yaw_rate=0.0,
        longitudinal_velocity=speed,
        longitudinal_acceleration=0.0,
        lateral_velocity=0.0,
        lateral_acceleration=0.0,
        steering_wheel_angle=0.0,
        steering_wheel_rate=0.0,
        front_slip_angle=0.0,
        driver_torque=0.0,
        head_yaw=0.0,
        head_yaw_valid=True,
        lane=lane,
        side=-1.0 if lane == LEFT else 1.0,
        distance_to_adjacent_lane=1.75,
    )


def leader(position: float, speed: float, lane: float = LEFT) -> LeaderState:
    """A car ahead."""
    return LeaderState(
        present=True,
        longitudinal_position=position,
        longitudinal_velocity=speed,
        lane=lane,
        num_appeared=1.0,
    )


NO_LEADER = no_leader()
