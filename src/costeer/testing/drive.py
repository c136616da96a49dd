"""A random drive that is shown to a method step by step, and its mirror image."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.packing import packed
from costeer.controller.signals import Assistance, Request
from costeer.loop.parameters import DT
from costeer.methods.conditions import CONDITIONS
from costeer.methods.registry import AnyMethod
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.road import (
    adjacent_side,
    cruising_lane,
    distance_to_adjacent_lane,
    lane_at,
)
from costeer.records.columns import COLUMNS
from costeer.sensing.measurement import Measurement, standing_start

Rows = NDArray[np.float64]

STEPS = 600
"""Steps of the random drive."""

_SPREAD = {
    "yaw_angle": 0.05,
    "yaw_rate": 0.1,
    "longitudinal_acceleration": 1.0,
    "lateral_velocity": 0.3,
    "lateral_acceleration": 2.0,
    "steering_wheel_angle": 0.5,
    "steering_wheel_rate": 1.0,
    "front_slip_angle": 0.03,
    "driver_torque": 2.0,
    "head_yaw": 0.4,
}
"""Standard deviation of each signal of the random drive, in the signal's unit."""

_FLIPPED = {"side", "front_slip_angle"} | {
    column.source.rpartition(".")[2]
    for column in COLUMNS
    if column.mirrored == "flipped"
}


class MethodError(ValueError):
    """A method lacks a property that every method must have."""


class Moment(NamedTuple):
    """What a method is given at one step."""

    measurement: Measurement
    request: Request


class Drive(NamedTuple):
    """Answers of a method to a drive: state and assistance after each step."""

    states: list[Any]  # Any: of the method's own kind
    answers: list[Assistance]

    @property
    def torques(self) -> Rows:
        """Torque asked for at each step [N·m]."""
        return np.array([answer.applied_torque for answer in self.answers])


def random_drive(generator: np.random.Generator, road: RoadParameters) -> list[Moment]:
    """Smooth random signals over both lanes, with random requests."""
    kept, moments = 0.97, []
    walk = np.zeros(len(_SPREAD) + 2)
    start = standing_start(road)
    for k in range(STEPS):
        walk = kept * walk + math.sqrt(1.0 - kept**2) * generator.normal(size=walk.size)
        signals = dict(zip(_SPREAD, walk[2:] * list(_SPREAD.values()), strict=True))
        place = float(-road.lane_width / 2.0 + walk[0] * road.lane_width / 2.0)
        lane = lane_at(road, place)
        side = adjacent_side(road, lane)
        seen: Any = {name: float(value) for name, value in signals.items()}
        measurement = start._replace(
            longitudinal_position=20.0 * k * DT,
            lateral_position=place,
            longitudinal_velocity=20.0 + float(np.clip(4.0 * walk[1], -10.0, 10.0)),
            lane=lane,
            side=side,
            distance_to_adjacent_lane=distance_to_adjacent_lane(
                road, place, lane, side
            ),
            head_yaw_valid=bool(generator.random() > 0.02),
            **seen,
        )
        moments.append(Moment(measurement, _random_request(generator)))
    return moments


def _random_request(generator: np.random.Generator) -> Request:
    """Mostly a verdict, now and then a request from outside."""
    draw = generator.random(4)
    return Request(
        crossing_probability=math.nan if draw[0] < 0.1 else float(draw[1] ** 0.25),
        requested=bool(draw[2] < 0.02),
        change_duration=4.0 + 4.0 * float(draw[3]) if draw[3] < 0.5 else math.nan,
    )


def strong_parameters(method: AnyMethod, road: RoadParameters) -> Any:
    """Parameters of a method on a road, under strong guidance."""
    return method.parameters(CONDITIONS[1], CarParameters(), ColumnParameters(), road)


def driven(method: AnyMethod, moments: Sequence[Moment], road: RoadParameters) -> Drive:
    """A drive in plain Python.

    Raises:
        MethodError: If a step changes what it is given, or breaks.
    """
    given = strong_parameters(method, road)
    state = method.initial_state(given, cruising_lane(road))
    drive = Drive([], [])
    numbers = packed(given)
    for k, (measurement, request) in enumerate(moments):
        before = packed(state)
        try:
            new, answer = method.step(given, state, measurement, request, DT)
        except Exception as error:  # whatever somebody else's code raises
            raise MethodError(
                f"method '{method.name}' breaks at step {k} of a random drive: "
                f"{type(error).__name__}: {error}; given {measurement}"
            ) from error
        if not (same(packed(state), before) and same(packed(given), numbers)):
            raise MethodError(
                f"method '{method.name}' is not pure: step {k} changes the parameters "
                "or the state that it is given; make new arrays, as base.window does"
            )
        drive.states.append(new)
        drive.answers.append(answer)
        state = new
    return drive


def same(one: Rows, other: Rows) -> bool:
    """Whether two arrays are equal to the bit; NaN equals NaN."""
    return bool(np.array_equal(one, other, equal_nan=True))


def mirrored_moment(moment: Moment, road: RoadParameters) -> Moment:
    """The same moment with left and right swapped."""
    seen = moment.measurement
    across = (road.num_lanes - 1.0) * road.lane_width
    flipped: Any = {
        name: -getattr(seen, name) for name in seen._fields if name in _FLIPPED
    }
    return moment._replace(
        measurement=seen._replace(
            lateral_position=-across - seen.lateral_position,
            lane=road.num_lanes - 1.0 - seen.lane,
            **flipped,
        )
    )


def without_signals(moment: Moment) -> Moment:
    """The same moment with all measured numbers NaN; the lane is known."""
    lost: Any = dict.fromkeys(_SPREAD, math.nan)
    return moment._replace(
        measurement=moment.measurement._replace(
            lateral_position=math.nan,
            longitudinal_velocity=math.nan,
            distance_to_adjacent_lane=math.nan,
            **lost,
        )
    )
