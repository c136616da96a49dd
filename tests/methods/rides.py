"""Rides that methods are shown, sample by sample, and what they make of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

from costeer.base.described import with_value_at
from costeer.controller.signals import Assistance, Request
from costeer.methods.conditions import condition
from costeer.methods.registry import AnyMethod
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.sensing.measurement import Measurement
from tests.controller.samples import DT, LEFT_LANE, RIGHT_LANE, SPEED, sample

WIDTH = RoadParameters().lane_width
NOTHING = Request()


class Answers(NamedTuple):
    """States and assistance after each step."""

    states: list[Any]  # Any: of the method's own kind
    given: list[Assistance]

    @property
    def torques(self) -> list[float]:
        """Asked for at each step [N·m]."""
        return [one.applied_torque for one in self.given]


def parameters_of(
    method: AnyMethod,
    name: str = "strong-normal",
    road: RoadParameters | None = None,
    **values: float,
) -> Any:
    """A method's parameters; `values` with __ for the dot."""
    known = road or RoadParameters()
    given = method.parameters(
        condition(name), CarParameters(), ColumnParameters(), known
    )
    for leaf, value in values.items():
        given = with_value_at(given, leaf.replace("__", "."), value)
    return given


def shown(
    method: AnyMethod,
    parameters: Any,
    samples: Sequence[Measurement],
    requests: Iterable[Request] | Request = NOTHING,
) -> Answers:
    """Answers of a method that starts in the lane of the first sample."""
    asked = [requests] * len(samples) if isinstance(requests, Request) else requests
    state = method.initial_state(parameters, samples[0].lane)
    states, given = [], []
    for measurement, request in zip(samples, asked, strict=True):
        state, answer = method.step(parameters, state, measurement, request, DT)
        states.append(state)
        given.append(answer)
    return Answers(states, given)


def placed(
    step: int, lateral_position: float, velocity: float = 0.0, **changes: float
) -> Measurement:
    """The car at a place across the two lanes, with a velocity across the road."""
    left = lateral_position > -WIDTH / 2.0
    side = -1.0 if left else 1.0
    offset = lateral_position - (0.0 if left else -WIDTH)
    given = {
        "lateral_position": lateral_position,
        "yaw_angle": math.asin(velocity / SPEED),
        "lane": LEFT_LANE if left else RIGHT_LANE,
        "side": side,
        "distance_to_adjacent_lane": WIDTH / 2.0 - side * offset,
    }
    return sample(step, **(given | changes))


def still(seconds: float, lateral_position: float, **changes: float) -> list[Any]:
    """The car that stays where it is across the road."""
    return [placed(k, lateral_position, **changes) for k in range(round(seconds / DT))]


def moved(
    seconds: float, place: Callable[[float], float], **changes: float
) -> list[Measurement]:
    """The car at a place across the road that is a function of time."""
    times = [k * DT for k in range(round(seconds / DT))]
    return [
        placed(k, place(t), (place(t + 1e-4) - place(t - 1e-4)) / 2e-4, **changes)
        for k, t in enumerate(times)
    ]


def change_to_the_right(time: float, duration: float = 6.0) -> float:
    """Place of a car that changes to the right lane with least jerk [m]."""
    s = min(max(time / duration, 0.0), 1.0)
    return -WIDTH * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
