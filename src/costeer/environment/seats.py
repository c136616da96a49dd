"""A method and a driver without a law of their own: what they do comes from outside.

The loop runs them like any other. What they are to do at a step is a parameter, which
whoever is outside sets before it.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base.array import Real, compiled
from costeer.controller.signals import Assistance, Request
from costeer.drivers.arm import ArmCommand, ArmParameters
from costeer.drivers.interface import (
    Action,
    DriverModel,
    DriverNoise,
    Knowledge,
    Perception,
)
from costeer.drivers.longitudinal import Pedals
from costeer.drivers.replayed import NO_ARMS
from costeer.methods.interface import Method
from costeer.sensing.measurement import Measurement


class Nothing(NamedTuple):
    """What they remember: a count of steps, which nobody reads [-]."""

    steps: Real = 0.0


@compiled
def begin(parameters: object, place: Real) -> Nothing:
    """Either of them begins, wherever the car is."""
    return Nothing()


@compiled
def after(state: Nothing) -> Nothing:
    """What either remembers after a step."""
    return Nothing(state.steps + 1.0)


SOURCE = "costeer, environment/seats.py"
"""Of either, as records tell it."""


class GivenTorque(NamedTuple):
    """What the guidance is to do.

    Attributes:
        torque: Asked of the motor [N·m]. Source: the agent.
    """

    torque: Real = 0.0


@compiled
def give_torque(
    parameters: GivenTorque,
    state: Nothing,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[Nothing, Assistance]:
    """Ask for the torque that was given."""
    return after(state), Assistance(applied_torque=parameters.torque)


GUIDANCE = Method(
    name="agent",
    version="1",
    source=SOURCE,
    parameters=lambda condition, car, column, road: GivenTorque(),
    initial_state=begin,
    step=give_torque,
)
"""Guidance whose torque comes from outside."""


class GivenHands(NamedTuple):
    """What the driver is to do.

    Attributes:
        torque: Of the hands on the wheel [N·m]. Source: the agent.
        accelerator: Pedal position in [0, 1] [-]. Source: the agent.
        brake: Pedal position in [0, 1] [-]. Source: the agent.
        arm: That passes the torque on [SI units]. Source: drivers/replayed.py.
    """

    torque: Real = 0.0
    accelerator: Real = 0.0
    brake: Real = 0.0
    arm: ArmParameters = NO_ARMS


@compiled
def act(
    parameters: GivenHands,
    state: Nothing,
    knowledge: Knowledge,
    perception: Perception,
    noise: DriverNoise,
    dt: Real,
) -> tuple[Nothing, Action]:
    """Do what was given; nobody knows what such a driver intends."""
    pedals = Pedals(accelerator=parameters.accelerator, brake=parameters.brake)
    hands = ArmCommand(torque=parameters.torque)
    return after(state), Action(arm=hands, pedals=pedals)


DRIVER = DriverModel(
    name="agent",
    version="1",
    source=SOURCE,
    parameters=lambda draw: GivenHands(),
    initial_state=begin,
    act=act,
)
"""Driver whose hands and feet are moved from outside."""
