"""Arms: intended wheel angle to torque, at the plant's rate.

Saleh et al. (2013) give the torque of a steered wheel: a holding torque from an
internal model of the wheel (K_r) and a stiffness towards the intended angle (K_t),
both through the neuromuscular lag. Pick and Cole (2008) split such a stiffness into
what the co-contracted muscle gives at once (intrinsic) and what the stretch reflex
gives after its delay and the muscle's activation. The arms' inertia and damping move
with the wheel: they are added to the column while it is held.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.base.filters import low_pass, pade_delay
from costeer.plant.parameters import ColumnParameters


class ArmParameters(NamedTuple):
    """Two arms on the wheel.

    Attributes:
        holding_gain: K_r, share of the holding torque that is supplied without a
            deviation [-]. Source: Saleh et al. (2013), 0.75.
        stiffness: K_t, torque per lasting deviation from the intended angle
            [N·m/rad]. Source: Saleh et al. (2013), 8 to 20.
        intrinsic_share: Share of K_t that relaxed muscles give at once; the reflex
            gives the rest [-]. Source: assumed, 5 N·m/rad for a relaxed arm.
        lag: Neuromuscular time constant [s]. Source: Saleh et al. (2013), 0.1.
        reflex_delay: Wheel to reflex, before the lag [s]. Source: assumed; Pick and
            Cole (2008) have 0.04.
        inertia: Of both arms about the wheel's axis [kg·m²]. Source: assumed.
        damping: Of the relaxed muscles [N·m·s/rad]. Source: assumed.
        hands_on: 1 with the hands on the wheel, 0 without [-]. Source: assumed.
    """

    holding_gain: Real = 0.75
    stiffness: Real = 12.0
    intrinsic_share: Real = 0.4
    lag: Real = 0.1
    reflex_delay: Real = 0.04
    inertia: Real = 0.09
    damping: Real = 1.0
    hands_on: Real = 1.0


class ArmState(NamedTuple):
    """What muscles and reflex remember.

    Attributes:
        equilibrium: Intended angle after the neuromuscular lag [rad].
        delayed: Memory of the reflex delay [rad].
        reflex: Deviation that the reflex acts on, after delay and lag [rad].
        relief: Torque left to the guidance [N·m].
        torque: Of the hands on the wheel, mean over the last control step [N·m].
    """

    equilibrium: Real
    delayed: Real
    reflex: Real
    relief: Real
    torque: Real


class ArmCommand(NamedTuple):
    """What the brain asks of the arms, held over a control step.

    Attributes:
        intended_angle: Of the steering wheel [rad].
        holding_stiffness: Of the car's wheel in steady cornering [N·m/rad].
        stiffening: Co-contraction, factor on the lasting stiffness; what it adds acts
            at once [-].
        guidance: Torque felt from the guidance [N·m].
        reliance: Share of agreeing guidance that replaces own torque [-].
        torque: Given besides, whatever the wheel does [N·m].
    """

    intended_angle: Real = 0.0
    holding_stiffness: Real = 0.0
    stiffening: Real = 1.0
    guidance: Real = 0.0
    reliance: Real = 0.0
    torque: Real = 0.0


@compiled
def initial_state() -> ArmState:
    """Hands resting on a wheel that is straight ahead."""
    return ArmState(equilibrium=0.0, delayed=0.0, reflex=0.0, relief=0.0, torque=0.0)


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
def step(
    parameters: ArmParameters,
    state: ArmState,
    command: ArmCommand,
    steering_wheel_angle: Real,
    dt: Real,
) -> ArmState:
    """Muscles and reflex one plant step later.

    Args:
        parameters: Of the arms.
        state: Of the arms.
        command: Of the brain.
        steering_wheel_angle: Now [rad].
        dt: Plant step [s].
    """
    intended, lag = command.intended_angle, parameters.lag
    delayed, felt_angle = pade_delay(
        state.delayed, steering_wheel_angle, parameters.reflex_delay, dt
    )
    wanted = wanted_torque(parameters, command, steering_wheel_angle)
    relief = command.reliance * shared_torque(wanted, command.guidance)
    return ArmState(
        equilibrium=low_pass(state.equilibrium, intended, dt, lag),
        delayed=delayed,
        reflex=low_pass(state.reflex, intended - felt_angle, dt, lag),
        relief=low_pass(state.relief, relief, dt, lag),
        torque=state.torque,
    )


@compiled
def muscle_torque(
    parameters: ArmParameters,
    state: ArmState,
    command: ArmCommand,
    steering_wheel_angle: Real,
) -> Real:
    """Torque of the muscles on the wheel [N·m]; none without hands.

    Args:
        parameters: K_r, K_t and its intrinsic share.
        state: Of muscles and reflex.
        command: Stiffening.
        steering_wheel_angle: Now [rad].
    """
    holding = parameters.holding_gain * command.holding_stiffness
    at_once = parameters.intrinsic_share + command.stiffening - 1.0
    intrinsic = at_once * (state.equilibrium - steering_wheel_angle)
    reflex = (1.0 - parameters.intrinsic_share) * state.reflex
    elastic = parameters.stiffness * (intrinsic + reflex)
    muscles = holding * state.equilibrium + elastic - state.relief
    return parameters.hands_on * (muscles + command.torque)


@compiled
def arm_damping(parameters: ArmParameters, stiffening: Real) -> Real:
    """Damping of the muscles at a stiffening [N·m·s/rad].

    It grows with the root of the stiffness, which keeps the damping ratio of an arm
    of one inertia.
    """
    return parameters.hands_on * parameters.damping * xp.sqrt(stiffening)


@compiled
def held_column(
    parameters: ArmParameters, column: ColumnParameters, stiffening: Real
) -> ColumnParameters:
    """The steering column with the arms that move with it.

    Args:
        parameters: Inertia and damping of the arms.
        column: By itself.
        stiffening: Co-contraction, factor on the stiffness [-].
    """
    return column._replace(
        inertia=column.inertia + parameters.hands_on * parameters.inertia,
        damping=column.damping + arm_damping(parameters, stiffening),
    )


@compiled
def hand_torque(
    parameters: ArmParameters,
    muscles: Real,
    stiffening: Real,
    steering_wheel_rate: Real,
    steering_wheel_acceleration: Real,
) -> Real:
    """Torque between hands and wheel [N·m]: muscles less what moves the arms.

    Args:
        parameters: Inertia and damping of the arms.
        muscles: Their torque [N·m].
        stiffening: Co-contraction [-].
        steering_wheel_rate: [rad/s].
        steering_wheel_acceleration: [rad/s²].
    """
    damping = arm_damping(parameters, stiffening) * steering_wheel_rate
    inertia = parameters.hands_on * parameters.inertia * steering_wheel_acceleration
    return muscles - damping - inertia
