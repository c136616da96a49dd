"""Intention-based haptic guidance steering: the paper's own method."""

from __future__ import annotations

import math
from typing import Any

from costeer.controller import step as controller
from costeer.controller.actuation import ActuationParameters
from costeer.controller.guidance import GuidanceParameters
from costeer.controller.step import ControllerParameters
from costeer.controller.trajectory import TrajectoryParameters
from costeer.methods.conditions import Condition
from costeer.methods.interface import Method, Tunable
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters

SLIP_ANGLE_GAIN_SHARE = 0.45
"""K_alpha over the car's self-aligning stiffness [-]."""

TUNABLES = tuple(
    Tunable(leaf.rpartition(".")[2], leaf, unit, low, high, label)
    for leaf, unit, low, high, label in (
        ("actuation.strength_factor", "-", 0.0, 1.0, "strength factor on K_h"),
        ("trajectory.change_duration", "s", 2.0, 12.0, "duration of a lane change"),
        ("guidance.lateral_error_gain", "N·m/m", 0.0, 3.0, "K_y, lateral error"),
        (
            "guidance.heading_error_rate_gain",
            "N·m·s/rad",
            0.0,
            8.0,
            "K_yd, heading-error rate",
        ),
        (
            "guidance.steering_angle_gain",
            "N·m/rad",
            0.0,
            6.0,
            "K_theta, steering angle",
        ),
        ("guidance.slip_angle_gain", "N·m/rad", 0.0, 100.0, "K_alpha, slip angle"),
        ("preview.preview_time", "s", 0.5, 3.0, "preview time"),
        (
            "inference.threshold",
            "-",
            0.05,
            0.999,
            "crossing probability that triggers",
        ),
        (
            "consistency.inconsistency_threshold",
            "W",
            0.0,
            1.0,
            "threshold of Table III",
        ),
        ("consistency.hold_time", "s", 0.0, 1.0, "hold of the verdict"),
        ("strength.steepness", "1/s", 1.0, 8.0, "lambda of the fade"),
        ("replanning.replan_gain", "-", 0.01, 0.5, "K_h below which to plan anew"),
        ("actuation.torque_limit", "N·m", 0.0, 5.0, "largest guidance torque"),
    )
)
"""In the order in which pages list them; the limits of the wheel itself stay fixed."""


def parameters(
    condition: Condition,
    car: CarParameters,
    column: ColumnParameters,
    road: RoadParameters,
) -> ControllerParameters:
    """The controller under a condition; it knows nominal car, column and road."""
    duration = condition.change_duration
    usual = TrajectoryParameters()
    return ControllerParameters(
        car=car,
        column=column,
        road=road,
        trajectory=usual
        if math.isnan(duration)
        else usual._replace(change_duration=duration),
        guidance=GuidanceParameters(
            slip_angle_gain=SLIP_ANGLE_GAIN_SHARE * car.aligning_stiffness
        ),
        actuation=ActuationParameters(strength_factor=condition.strength_factor),
    )


def like_ibhs(
    kind: type[Any],  # Any: parameters of a method that shares stages with this one
    condition: Condition,
    car: CarParameters,
    column: ColumnParameters,
    road: RoadParameters,
) -> Any:
    """Parameters of another kind, whose groups of the same name are as here.

    Two methods that share a stage share its numbers, so that what they differ in is
    their law.
    """
    usual = parameters(condition, car, column, road)._asdict()
    shared = {name: usual[name] for name in kind._fields if name in usual}
    return kind(**shared)


def shared_tunables(kind: type[Any]) -> tuple[Tunable, ...]:
    """Those tunables that another kind of parameters has, too."""
    shared = set(kind._fields)
    return tuple(t for t in TUNABLES if t.leaf.partition(".")[0] in shared)


IBHS = Method(
    name="ibhs",
    version="1",
    source="Yan et al., IEEE Transactions on Intelligent Vehicles",
    parameters=parameters,
    initial_state=controller.initial_state,
    step=controller.step,
    tunables=TUNABLES,
)
