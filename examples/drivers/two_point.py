"""Salvucci and Gray (2004): a driver of two points, as a driver model of one file.

The steering rate follows the rates of the angles to a near and a far point, and the
near angle itself. A driver who keeps the lane and the speed, without decisions.
"""

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.drivers.arm import ArmCommand, ArmParameters
from costeer.drivers.interface import (
    Action,
    DriverModel,
    DriverNoise,
    Knowledge,
    Perception,
)
from costeer.drivers.longitudinal import Pedals
from costeer.plant.parameters import holding_stiffness


class TwoPoint(NamedTuple):
    """One driver.

    Attributes:
        far_gain: Wheel rate over the far angle's rate [-]. Source: assumed; the
            published 16 is of another car without arms.
        near_gain: Wheel rate over the near angle's rate [-]. Source: assumed.
        near_integral: Wheel rate over the near angle [1/s]. Source: assumed.
        near_time: To the near point [s]. Source: assumed.
        far_time: To the far point [s]. Source: assumed.
        speed: That is kept [m/s]. Source: the trial.
        arm: Hands and arms [SI units]. Source: drivers/arm.py.
    """

    speed: Real
    far_gain: Real = 5.0
    near_gain: Real = 2.5
    near_integral: Real = 1.5
    near_time: Real = 0.6
    far_time: Real = 2.0
    arm: ArmParameters = ArmParameters()


class Seen(NamedTuple):
    """What is remembered: centre of the lane [m], angles and intention [rad]."""

    centre: Real
    near: Real
    far: Real
    intended: Real


@compiled
def begin(driver: TwoPoint, lane_centre: Real) -> Seen:
    """Straight ahead in the lane."""
    return Seen(centre=lane_centre, near=0.0, far=0.0, intended=0.0)


@compiled
def act(
    driver: TwoPoint,
    state: Seen,
    knowledge: Knowledge,
    perception: Perception,
    noise: DriverNoise,
    dt: Real,
) -> tuple[Seen, Action]:
    """Steer by two points, hold the speed."""
    car = perception.measurement
    speed = xp.maximum(car.longitudinal_velocity, 1.0)
    offset = state.centre - car.lateral_position
    near = offset / (speed * driver.near_time) - car.yaw_angle
    far = offset / (speed * driver.far_time) - car.yaw_angle
    change = driver.far_gain * (far - state.far) + driver.near_gain * (
        near - state.near
    )
    intended = state.intended + change + driver.near_integral * near * dt
    hands = ArmCommand(
        intended_angle=intended,
        holding_stiffness=holding_stiffness(knowledge.car, knowledge.column, speed),
    )
    return Seen(state.centre, near, far, intended), Action(
        arm=hands,
        pedals=Pedals(
            accelerator=xp.clip(0.15 + 0.3 * (driver.speed - speed), 0.0, 1.0),
            brake=0.0,
        ),
    )


DRIVER = DriverModel(
    name="two-point",
    version="1",
    source="Salvucci and Gray (2004), Perception 33: a two-point visual control model",
    parameters=lambda draw: TwoPoint(speed=draw.speed),
    initial_state=begin,
    act=act,
)
