"""Arms: intended wheel angle to torque, at the plant's rate.

Saleh et al. (2013): a holding torque from an internal model of the wheel (K_r), the
stretch reflex towards the intended angle (K_t), both through the neuromuscular lag.
The arm's own damping acts at once.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.base.filters import low_pass


class ArmParameters(NamedTuple):
    """Two arms on the wheel.

    Attributes:
        holding_gain: K_r, share of the holding torque that is supplied without a
            deviation [-]. Source: Saleh et al. (2013), 0.75.
        stiffness: K_t, torque per deviation from the intended angle [N·m/rad].
            Source: Saleh et al. (2013), 8 to 20.
        lag: Neuromuscular time constant [s]. Source: Saleh et al. (2013), 0.1.
        damping: Of the passive arm [N·m·s/rad]. Source: assumed; Pick and Cole (2007)
            measured 0.4 to 1.2 for relaxed to tense arms.
        hands_on: 1 with the hands on the wheel, 0 without [-]. Source: assumed.
    """

    holding_gain: Real = 0.75
    stiffness: Real = 12.0
    lag: Real = 0.1
    damping: Real = 0.5
    hands_on: Real = 1.0


class ArmCommand(NamedTuple):
    """What the brain asks of the arms, held over a control step.

    Attributes:
        intended_angle: Of the steering wheel [rad].
        holding_stiffness: Of the car's wheel in steady cornering [N·m/rad].
        stiffening: Co-contraction, factor on the stiffness [-].
        guidance: Torque felt from the guidance [N·m].
        reliance: Share of agreeing guidance that replaces own torque [-].
    """

    intended_angle: Real
    holding_stiffness: Real
    stiffening: Real
    guidance: Real
    reliance: Real


@compiled
def wanted_torque(
    parameters: ArmParameters, command: ArmCommand, steering_wheel_angle: Real
) -> Real:
    """Torque that would bring the wheel to the intended angle [N·m].

    Args:
        parameters: K_r and K_t.
        command: Intended angle and stiffening.
        steering_wheel_angle: Now [rad].
    """
    holding = parameters.holding_gain * command.holding_stiffness
    stiffness = parameters.stiffness * command.stiffening
    deviation = command.intended_angle - steering_wheel_angle
    return holding * command.intended_angle + stiffness * deviation


@compiled
def shared_torque(wanted: Real, guidance: Real) -> Real:
    """Part of the guidance that does what the driver wants [N·m].

    The smaller of the two where they agree in sign, nothing where they do not; so it
    has no jump.
    """
    left = xp.maximum(xp.minimum(wanted, guidance), 0.0)
    right = xp.minimum(xp.maximum(wanted, guidance), 0.0)
    return left + right


@compiled
def active_torque(
    parameters: ArmParameters,
    active: Real,
    command: ArmCommand,
    steering_wheel_angle: Real,
    dt: Real,
) -> Real:
    """Muscle torque one plant step later [N·m].

    Args:
        parameters: Of the arms.
        active: Muscle torque now [N·m].
        command: Of the brain.
        steering_wheel_angle: Now [rad].
        dt: Plant step [s].
    """
    wanted = wanted_torque(parameters, command, steering_wheel_angle)
    left_to_guidance = command.reliance * shared_torque(wanted, command.guidance)
    return low_pass(active, wanted - left_to_guidance, dt, parameters.lag)


@compiled
def driver_torque(
    parameters: ArmParameters, active: Real, steering_wheel_rate: Real
) -> Real:
    """Torque of the hands on the wheel [N·m]: muscles minus the passive arm."""
    passive = parameters.damping * steering_wheel_rate
    return parameters.hands_on * (active - passive)
