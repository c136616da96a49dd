"""How other cars drive: IDM behind a car, MOBIL between lanes.

Intelligent driver model: Treiber, Hennecke and Helbing (2000), Congested traffic states
in empirical observations and microscopic simulations. MOBIL: Kesting, Treiber and
Helbing (2007), General lane-changing model MOBIL for car-following models.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled

LONGEST_GAP = 1e6
"""Gap to a car that is not there [m]."""


class FollowingParameters(NamedTuple):
    """How all other cars follow and change lanes.

    Attributes:
        headway: T, time gap that is kept [s]. Source: Treiber et al. (2000), 1.6.
        acceleration: a, on a free road [m/s²]. Source: Treiber et al. (2000), 0.73.
        deceleration: b, comfortable [m/s²]. Source: Treiber et al. (2000), 1.67.
        standstill_gap: s_0, between cars that stand [m]. Source: Treiber et al.
            (2000), 2.
        hardest_braking: No car brakes harder [m/s²]. Source: assumed, dry asphalt.
        politeness: p, weight of what others gain or lose by a lane change [-]. Source:
            Kesting et al. (2007), 0 to 0.5 is realistic.
        changing_threshold: Least advantage of a lane change [m/s²]. Source: Kesting et
            al. (2007), 0.1.
        safe_braking: b_safe, that a lane change may ask of the car behind [m/s²].
            Source: Kesting et al. (2007), 4.
        home_bias: Advantage of the lane that is driven in when nobody is overtaken
            [m/s²]. Source: Kesting et al. (2007), 0.3.
        change_duration: Of a lane change of another car [s]. Source: assumed, the
            middle of what is measured on motorways, 3 to 6.
        pause: Between two lane changes of a car [s]. Source: assumed.
    """

    headway: Real = 1.6
    acceleration: Real = 0.73
    deceleration: Real = 1.67
    standstill_gap: Real = 2.0
    hardest_braking: Real = 8.0
    politeness: Real = 0.2
    changing_threshold: Real = 0.1
    safe_braking: Real = 4.0
    home_bias: Real = 0.3
    change_duration: Real = 4.5
    pause: Real = 4.0


class Ahead(NamedTuple):
    """The next car in one direction.

    Attributes:
        gap: Bumper to bumper, `LONGEST_GAP` if there is none [m].
        velocity: Of that car [m/s].
        desired: Speed it wants to drive [m/s].
        lateral: Where it is, from the left lane's centre [m].
        width: Of that car [m].
    """

    gap: Real = LONGEST_GAP
    velocity: Real = 0.0
    desired: Real = 0.0
    lateral: Real = 0.0
    width: Real = 0.0


@compiled
def following_acceleration(
    law: FollowingParameters, velocity: Real, desired: Real, gap: Real, ahead: Real
) -> Real:
    """Acceleration of the intelligent driver model [m/s²].

    Args:
        law: T, a, b and s_0.
        velocity: Of the car [m/s].
        desired: v_0 [m/s].
        gap: To the car ahead, bumper to bumper [m].
        ahead: Velocity of that car [m/s].
    """
    ratio = velocity / xp.maximum(desired, 0.1)
    square = ratio * ratio
    braking = 2.0 * xp.sqrt(law.acceleration * law.deceleration)
    approach = velocity * (velocity - ahead) / braking
    dynamic = xp.maximum(velocity * law.headway + approach, 0.0)
    closeness = (law.standstill_gap + dynamic) / xp.maximum(gap, 0.1)
    wanted = law.acceleration * (1.0 - square * square - closeness * closeness)
    return xp.maximum(wanted, -law.hardest_braking)


class LaneOutlook(NamedTuple):
    """What a car would meet in a lane.

    Attributes:
        ahead: The next car there.
        behind: The car that would follow.
    """

    ahead: Ahead = Ahead()
    behind: Ahead = Ahead()


@compiled
def _of(law: FollowingParameters, car: Ahead, gap: Real, ahead: Real) -> Real:
    """Acceleration of a car that follows another one [m/s²]."""
    return following_acceleration(law, car.velocity, car.desired, gap, ahead)


@compiled
def advantage(
    law: FollowingParameters,
    velocity: Real,
    desired: Real,
    length: Real,
    own: LaneOutlook,
    other: LaneOutlook,
) -> tuple[Flag, Real]:
    """Whether a lane change is safe, and what it is worth by MOBIL [m/s²].

    Args:
        law: Politeness and limits.
        velocity: Of the car [m/s].
        desired: Speed it wants to drive [m/s].
        length: Of the car [m].
        own: The lane it is in.
        other: The lane it might change to.
    """
    now = following_acceleration(
        law, velocity, desired, own.ahead.gap, own.ahead.velocity
    )
    then = following_acceleration(
        law, velocity, desired, other.ahead.gap, other.ahead.velocity
    )
    follower, left_alone = other.behind, own.behind
    between = other.ahead.gap + other.behind.gap + length
    before = _of(law, follower, between, other.ahead.velocity)
    after = _of(law, follower, other.behind.gap, velocity)
    held_up = _of(law, left_alone, left_alone.gap, velocity)
    freed = _of(
        law, left_alone, left_alone.gap + own.ahead.gap + length, own.ahead.velocity
    )
    others = (after - before) + (freed - held_up)
    fits = (other.ahead.gap > law.standstill_gap) & (
        other.behind.gap > law.standstill_gap
    )
    safe = fits & (after > -law.safe_braking) & (then > -law.safe_braking)
    return safe, then - now + law.politeness * others
