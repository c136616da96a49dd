"""Hands that feel: trust in guidance that agrees, stiffness against what opposes."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.base.filters import low_pass
from costeer.sensing.measurement import Measurement


class RelianceParameters(NamedTuple):
    """How the driver takes the guidance.

    Attributes:
        reliance: Share of agreeing guidance that replaces own torque, in [0, 1] [-].
            Source: assumed, spread over the population.
        feeling_time: Time constant of feeling a torque [s]. Source: assumed.
        noticed_torque: Guidance weaker than this is not noticed as opposing [N·m].
            Source: assumed, about the friction of the column.
        opposing_time: Opposition lasts so long before the arms stiffen [s]. Source:
            assumed, a reaction time.
        cocontraction: Stiffness of tense over relaxed arms [-]. Source: assumed, 1.5
            to 3 in studies of arm admittance.
        tensing_time: Time constant of stiffening and of relaxing [s]. Source:
            assumed, tense within 0.3 to 0.5 s.
        leading_horizon: Guidance that brings the car to the wanted lane within it
            leads and does not oppose; 0: there is no such difference [s]. Source:
            assumed.
    """

    reliance: Real = 0.5
    feeling_time: Real = 0.1
    noticed_torque: Real = 0.3
    opposing_time: Real = 0.2
    cocontraction: Real = 2.2
    tensing_time: Real = 0.2
    leading_horizon: Real = 1.5


class RelianceState(NamedTuple):
    """What the hands remember.

    Attributes:
        felt_guidance: [N·m].
        time_opposed: How long the guidance has been opposing [s].
        stiffening: Factor on the arm's stiffness [-].
    """

    felt_guidance: Real
    time_opposed: Real
    stiffening: Real


@compiled
def initial_state() -> RelianceState:
    """Relaxed."""
    return RelianceState(felt_guidance=0.0, time_opposed=0.0, stiffening=1.0)


@compiled
def leads(
    parameters: RelianceParameters,
    measurement: Measurement,
    guidance: Real,
    goal: Real,
    steered: Real,
) -> Flag:
    """Whether guidance takes the car to where a lane change goes, if sooner.

    What is missing to the goal after `leading_horizon` at the present lateral speed
    says to which side the driver still wants to go.

    Args:
        parameters: Horizon.
        measurement: Where the car is, and how it moves across the road.
        guidance: Felt at the wheel [N·m].
        goal: Lateral position of the wanted lane's centre [m].
        steered: Side that the driver steers to, 0 for none [-].
    """
    across = measurement.longitudinal_velocity * measurement.yaw_angle
    speed = across + measurement.lateral_velocity
    ahead = measurement.lateral_position + speed * parameters.leading_horizon
    towards = guidance * (goal - ahead) > 0.0
    return (parameters.leading_horizon > 0.0) & (steered != 0.0) & towards


@compiled
def step(
    parameters: RelianceParameters,
    state: RelianceState,
    guidance_torque: Real,
    wanted_torque: Real,
    leading: Flag,
    dt: Real,
) -> RelianceState:
    """Feel the guidance for one step and stiffen against it if it opposes.

    Args:
        parameters: Of the hands.
        state: Of the hands.
        guidance_torque: At the wheel [N·m].
        wanted_torque: That the relaxed arm would give by itself [N·m].
        leading: Whether the guidance leads to where the driver wants to go.
        dt: Control step [s].
    """
    felt = low_pass(state.felt_guidance, guidance_torque, dt, parameters.feeling_time)
    noticed = (felt > parameters.noticed_torque) | (felt < -parameters.noticed_torque)
    opposes = noticed & (felt * wanted_torque < 0.0) & xp.logical_not(leading)
    time_opposed = xp.select(opposes, state.time_opposed + dt, 0.0)
    tense = time_opposed > parameters.opposing_time
    aim = xp.select(tense, parameters.cocontraction, 1.0)
    return RelianceState(
        felt_guidance=felt,
        time_opposed=time_opposed,
        stiffening=low_pass(state.stiffening, aim, dt, parameters.tensing_time),
    )
