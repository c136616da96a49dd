"""Lateral force of an axle's tyres: the Fiala brush model."""

from __future__ import annotations

from costeer.base import array as xp
from costeer.base.array import Real, compiled


@compiled
def lateral_force(
    slip_tangent: Real, cornering_stiffness: Real, friction_force: Real
) -> Real:
    """Lateral force of one axle [N], positive to the left; against the slip.

    Fiala's brush model (Pacejka, Tire and Vehicle Dynamics, 2012, Sec. 3.2): linear
    with `cornering_stiffness` at small slip, full sliding from
    tan(slip) = 3 F / C on. The model knows the slip angle by its tangent only.

    Args:
        slip_tangent: Tangent of the slip angle, the direction of the tyre's velocity
            minus that of the wheel [-].
        cornering_stiffness: Of the axle, positive [N/rad].
        friction_force: Largest force, friction times axle load [N].
    """
    slide = 3.0 * friction_force / cornering_stiffness
    slip = xp.clip(slip_tangent, -slide, slide)
    share = xp.select(slip < 0.0, -slip, slip) / slide
    return -cornering_stiffness * slip * (1.0 - share + share * share / 3.0)
