"""Lane keeping with an integrator: a method of assistance with a state of its own."""

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.controller.signals import Assistance, Request
from costeer.methods.interface import Method, Tunable
from costeer.records.columns import Column
from costeer.sensing.measurement import Measurement


class Gains(NamedTuple):
    """What tunes the law.

    Attributes:
        lane_width: Of the road [m]. Source: the trial.
        strength: Factor on the torque [-]. Source: the condition.
        offset: Torque over the offset from the lane [N·m/m]. Source: assumed.
        yaw: Torque over the yaw angle [N·m/rad]. Source: assumed.
        integral: Torque over the integral of the offset [N·m/(m·s)]. Source: assumed.
        limit: Largest torque [N·m]. Source: assumed.
    """

    lane_width: Real
    strength: Real
    offset: Real = 1.2
    yaw: Real = 25.0
    integral: Real = 0.2
    limit: Real = 3.0


class State(NamedTuple):
    """Integral of the offset [m·s]."""

    integral: Real


@compiled
def begin(gains: Gains, lane: Real) -> State:
    """Nothing has been integrated."""
    return State(integral=0.0)


@compiled
def step(
    gains: Gains, state: State, measured: Measurement, request: Request, dt: Real
) -> tuple[State, Assistance]:
    """Torque against offset, yaw angle and what has been integrated."""
    to_line = measured.distance_to_adjacent_lane
    offset = measured.side * (gains.lane_width / 2.0 - to_line)
    integral = xp.clip(state.integral + offset * dt, -2.0, 2.0)
    wanted = gains.offset * offset + gains.integral * integral
    torque = -wanted - gains.yaw * measured.yaw_angle
    applied = gains.strength * xp.clip(torque, -gains.limit, gains.limit)
    return State(integral), Assistance(applied_torque=applied)


SUM = Column("method_integral", "m·s", "float64", "of the offset", "method.integral")
METHOD = Method(
    name="pi-keeping",
    version="1",
    source="an example of costeer",
    parameters=lambda condition, car, column, road: Gains(
        lane_width=road.lane_width, strength=condition.strength_factor
    ),
    initial_state=begin,
    step=step,
    columns=(SUM._replace(mirrored="flipped"),),
    tunables=(Tunable("offset", "offset", "N·m/m", 0.0, 3.0, "offset gain"),),
)
