"""Experience with the guidance: it grows within minutes, and every dispute costs trust.

A model of the guidance forms while it is felt (Mars, Deroo and Charron 2014; people get
used to a simulator in about 3 min, McGehee et al. 2001), and fades soon without it.
Who has it relies more on guidance that agrees and stiffens less against what does not
(Pick and Cole 2007). Disputes lower reliance at once (direction: Azevedo-Sa et al.
2020).
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.drivers.reliance import RelianceParameters

PRACTICE = 300.0
"""Guided driving in the practice before a study [s]. Source: the paper, Sec. III-B,
5 to 10 min."""


class LearningParameters(NamedTuple):
    """How a driver gets used to the guidance.

    Attributes:
        share: Of all that follows, 0: nothing is learnt [-]. Source: assumed.
        before: Guided driving before this drive [s]. Source: the order of drives.
        learning_time: Time constant of guided driving [s]. Source: McGehee et al.
            (2001), about 3 min in a simulator.
        forgetting_time: Time constant of driving without [s]. Source: assumed, short
            after-effects.
        noticed_torque: From here on guidance is felt at all [N·m]. Source: assumed.
        first_reliance: Share of the own reliance without experience [-]. Source:
            assumed.
        calming: Share of co-contraction that experience takes away [-]. Source:
            assumed; direction Pick and Cole (2007).
        trust_loss: Share of trust that a dispute costs [-]. Source: assumed;
            direction Azevedo-Sa et al. (2020).
    """

    share: Real = 1.0
    before: Real = PRACTICE
    learning_time: Real = 180.0
    forgetting_time: Real = 30.0
    noticed_torque: Real = 0.05
    first_reliance: Real = 0.5
    calming: Real = 0.3
    trust_loss: Real = 0.2


class LearningState(NamedTuple):
    """What the driver has learnt.

    Attributes:
        experience: Of the guidance, 0 to 1 [-].
        trust: What disputes have left of it, 0 to 1 [-].
        disputes: Whether there was a dispute at the step before.
    """

    experience: Real
    trust: Real
    disputes: Flag


@compiled
def initial_state(parameters: LearningParameters) -> LearningState:
    """As experienced as the driving before makes."""
    unknown = xp.exp(-parameters.before / parameters.learning_time)
    return LearningState(experience=1.0 - unknown, trust=1.0, disputes=False)


@compiled
def step(
    parameters: LearningParameters,
    state: LearningState,
    felt_guidance: Real,
    disputes: Flag,
    dt: Real,
) -> LearningState:
    """Learn for one step.

    Args:
        parameters: Of this driver.
        state: What is known.
        felt_guidance: [N·m].
        disputes: Whether the arms are tense against the guidance.
        dt: Control step [s].
    """
    guided = xp.absolute(felt_guidance) > parameters.noticed_torque
    gain = (1.0 - state.experience) / parameters.learning_time
    loss = -state.experience / parameters.forgetting_time
    experience = state.experience + xp.select(guided, gain, loss) * dt
    begins = disputes & xp.logical_not(state.disputes)
    kept = xp.select(begins, 1.0 - parameters.trust_loss, 1.0)
    recovered = state.trust + (1.0 - state.trust) / parameters.learning_time * dt
    return LearningState(
        experience=experience, trust=recovered * kept, disputes=disputes
    )


@compiled
def experienced(
    parameters: LearningParameters, state: LearningState, own: RelianceParameters
) -> RelianceParameters:
    """Reliance and co-contraction of a driver with this experience.

    Args:
        parameters: How much experience changes.
        state: What is known.
        own: Of the driver who knows the guidance well.
    """
    first = parameters.first_reliance
    known = (first + (1.0 - first) * state.experience) * state.trust
    calm = parameters.calming * state.experience
    share = parameters.share
    tense = (own.cocontraction - 1.0) * (1.0 - share * calm)
    return own._replace(
        reliance=own.reliance * (1.0 - share + share * known),
        cocontraction=xp.select(share > 0.0, 1.0 + tense, own.cocontraction),
    )
