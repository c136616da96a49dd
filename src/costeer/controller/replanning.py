"""When to plan anew (Sec. II-E)."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled


class ReplanningParameters(NamedTuple):
    """When the guidance counts as faded.

    Attributes:
        replan_gain: A new plan is made below this K_h [-]. Source: assumed, the paper
            says "when K_h reaches 0", which tanh never does.
    """

    replan_gain: Real = 0.05


@compiled
def replan(
    parameters: ReplanningParameters, haptic_gain: Real, consistent: Flag
) -> Flag:
    """Whether a new plan is called for: faded while the verdict is inconsistent."""
    return (haptic_gain < parameters.replan_gain) & xp.logical_not(consistent)
