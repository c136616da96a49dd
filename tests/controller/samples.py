"""Measurements of a car that goes straight in the left lane, and changes to them."""

from __future__ import annotations

import math
from collections.abc import Iterable

from costeer.controller import step as controller
from costeer.controller.signals import Assistance, Request
from costeer.controller.step import ControllerParameters, ControllerState
from costeer.plant.parameters import RoadParameters
from costeer.sensing.measurement import Measurement

DT = 1.0 / 60.0
SPEED = 20.0
ROAD = RoadParameters()
LEFT_LANE = 1.0
RIGHT_LANE = 0.0

STRAIGHT = Measurement(
    longitudinal_position=0.0,
    lateral_position=0.0,
    yaw_angle=0.0,
    yaw_rate=0.0,
    longitudinal_velocity=SPEED,
    longitudinal_acceleration=0.0,
    lateral_velocity=0.0,
    lateral_acceleration=0.0,
    steering_wheel_angle=0.0,
    steering_wheel_rate=0.0,
    front_slip_angle=0.0,
    driver_torque=0.0,
    head_yaw=0.0,
    head_yaw_valid=True,
    lane=LEFT_LANE,
    side=-1.0,
    distance_to_adjacent_lane=1.75,
)

MIRRORED = (
    "yaw_angle",
    "yaw_rate",
    "lateral_velocity",
    "lateral_acceleration",
    "steering_wheel_angle",
    "steering_wheel_rate",
    "front_slip_angle",
    "driver_torque",
    "head_yaw",
    "side",
)


def sample(step: int = 0, **changes: float) -> Measurement:
    """The straight car after some control steps, with some fields changed."""
    position = SPEED * DT * step
    given = {"longitudinal_position": position} | changes
    return Measurement(**(STRAIGHT._asdict() | given))


def mirrored(measurement: Measurement) -> Measurement:
    """The same car in a mirror along the line between the two lanes."""
    turned = {name: -getattr(measurement, name) for name in MIRRORED}
    turned["lateral_position"] = -ROAD.lane_width - measurement.lateral_position
    turned["lane"] = 1.0 - measurement.lane
    return Measurement(**(measurement._asdict() | turned))


def run(
    parameters: ControllerParameters,
    state: ControllerState,
    samples: Iterable[Measurement],
    crossing_probability: float = math.nan,
    requested: bool = False,
) -> tuple[ControllerState, list[Assistance]]:
    """Step the controller through samples; the last state and all that was computed."""
    request = Request(crossing_probability, requested)
    every = []
    for measurement in samples:
        state, signals = controller.step(parameters, state, measurement, request, DT)
        every.append(signals)
    return state, every
