"""Speed: a preferred speed that wanders, following, speeding up to overtake."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.base.filters import coloured_noise, low_pass
from costeer.drivers.decision import (
    CHANGING,
    PASSING,
    PREPARING,
    DecisionState,
)
from costeer.plant.parameters import CarParameters
from costeer.plant.traffic import LeaderState
from costeer.plant.vehicle import resistance
from costeer.sensing.measurement import Measurement


class LongitudinalParameters(NamedTuple):
    """Intelligent driver model with a preferred speed that wanders.

    Treiber, Hennecke and Helbing (2000) in the form of Schakel, van Arem and Netten
    (2010): the smaller of free and following acceleration, so that a driver comes up
    to the wanted gap behind a slower leader.

    Attributes:
        preferred_speed: On a free road [m/s]. Source: paper, about 70 km/h.
        speed_deviation: Standard deviation of its slow wander [m/s]. Source: assumed.
        speed_time: Correlation time of the wander [s]. Source: assumed.
        overtaking_speed: Faster than preferred from the decision to overtake until
            the return [m/s]. Source: assumed, spread over the population; some
            drivers do not.
        acceleration: Comfortable [m/s²]. Source: assumed; Treiber et al. (2000) have
            0.73.
        deceleration: Comfortable [m/s²]. Source: assumed, near the 1.67 of Treiber et
            al. (2000).
        headway: Time gap when following [s]. Source: assumed.
        overtaking_headway: Time gap accepted when about to overtake [s]. Source:
            assumed.
        standstill_gap: Smallest distance of the two cars' centres [m]. Source:
            assumed, 2 m between bumpers of 4.5 m cars.
        pedal_time: Time constant of the foot [s]. Source: assumed.
    """

    preferred_speed: Real = 70.0 / 3.6
    speed_deviation: Real = 0.4
    speed_time: Real = 20.0
    overtaking_speed: Real = 2.0
    acceleration: Real = 1.2
    deceleration: Real = 1.8
    headway: Real = 1.0
    overtaking_headway: Real = 0.5
    standstill_gap: Real = 6.5
    pedal_time: Real = 0.4


class LongitudinalState(NamedTuple):
    """What the foot remembers.

    Attributes:
        speed_wander: Of the preferred speed [m/s].
        wanted_acceleration: Behind the pedals [m/s²].
    """

    speed_wander: Real
    wanted_acceleration: Real


class Pedals(NamedTuple):
    """Positions of the pedals.

    Attributes:
        accelerator: In [0, 1] [-].
        brake: In [0, 1] [-].
    """

    accelerator: Real
    brake: Real


@compiled
def initial_state() -> LongitudinalState:
    """Holding the speed."""
    return LongitudinalState(speed_wander=0.0, wanted_acceleration=0.0)


@compiled
def wanted_speed(
    parameters: LongitudinalParameters, state: LongitudinalState, phase: Real
) -> Real:
    """Speed that the driver aims at in this phase [m/s]."""
    overtaking = (phase == PREPARING) | (phase == CHANGING) | (phase == PASSING)
    more = xp.select(overtaking, parameters.overtaking_speed, 0.0)
    return parameters.preferred_speed + state.speed_wander + more


@compiled
def interaction(
    parameters: LongitudinalParameters,
    measurement: Measurement,
    leader: LeaderState,
    phase: Real,
) -> Real:
    """Square of wanted over present gap: 1 where the gap is as wanted [-].

    Args:
        parameters: Of the intelligent driver model.
        measurement: Of the own car.
        leader: In the own lane and ahead, or without effect.
        phase: A driver about to overtake comes closer [-].
    """
    speed = measurement.longitudinal_velocity
    gap = leader.longitudinal_position - measurement.longitudinal_position
    relevant = leader.present & (leader.lane == measurement.lane) & (gap > 0.0)
    overtaking = (phase == PREPARING) | (phase == CHANGING)
    headway = xp.select(overtaking, parameters.overtaking_headway, parameters.headway)
    closing = xp.maximum(speed - leader.longitudinal_velocity, 0.0)
    braking = 2.0 * xp.sqrt(parameters.acceleration * parameters.deceleration)
    approach = xp.select(overtaking, 0.5, 1.0) * speed * closing / braking
    wanted_gap = parameters.standstill_gap + speed * headway + approach
    ratio = wanted_gap / xp.maximum(gap, 0.5)
    return xp.select(relevant, ratio * ratio, 0.0)


@compiled
def step(
    parameters: LongitudinalParameters,
    state: LongitudinalState,
    measurement: Measurement,
    leaders: tuple[LeaderState, LeaderState],
    decision: DecisionState,
    normal: Real,
    dt: Real,
) -> LongitudinalState:
    """Choose an acceleration for one step.

    Args:
        parameters: Of this driver.
        state: Of the foot.
        measurement: Of the own car.
        leaders: The car ahead, and the next one in the lane that is steered to.
        decision: What the driver is up to.
        normal: Standard normal draw, wander of the preferred speed.
        dt: Control step [s].
    """
    aim = wanted_speed(parameters, state, decision.phase)
    ratio = measurement.longitudinal_velocity / xp.maximum(aim, 1.0)
    free = 1.0 - ratio * ratio * ratio * ratio
    own_lane = interaction(parameters, measurement, leaders[0], decision.phase)
    beside = interaction(parameters, measurement, leaders[1], decision.phase)
    following = 1.0 - xp.maximum(own_lane, beside)
    wanted = parameters.acceleration * xp.minimum(free, following)
    wanted = xp.maximum(wanted, -3.0 * parameters.deceleration)
    return LongitudinalState(
        speed_wander=coloured_noise(
            state.speed_wander,
            normal,
            parameters.speed_deviation,
            dt,
            parameters.speed_time,
        ),
        wanted_acceleration=low_pass(
            state.wanted_acceleration, wanted, dt, parameters.pedal_time
        ),
    )


@compiled
def braking_hard(
    parameters: LongitudinalParameters,
    state: LongitudinalState,
    before: Real,
    braking: Real,
    speed: Real,
    dt: Real,
) -> LongitudinalState:
    """The foot in an emergency.

    Args:
        parameters: Of this driver.
        state: What the foot would do without one.
        before: Acceleration that was wanted a step before [m/s²].
        braking: Asked for now; 0 without an emergency [m/s²].
        speed: Of the own car [m/s].
        dt: Control step [s].
    """
    brakes = (braking > 0.0) & (speed > 0.5)
    pressed = low_pass(before, -braking, dt, parameters.pedal_time / 2.0)
    return state._replace(
        wanted_acceleration=xp.select(brakes, pressed, state.wanted_acceleration)
    )


@compiled
def pedals(car: CarParameters, wanted_acceleration: Real, speed: Real) -> Pedals:
    """Pedals that give an acceleration at this speed.

    Args:
        car: Its limits and losses.
        wanted_acceleration: [m/s²].
        speed: [m/s].
    """
    drive = wanted_acceleration + resistance(car, speed)
    return Pedals(
        accelerator=xp.clip(drive / car.acceleration_limit, 0.0, 1.0),
        brake=xp.clip(-drive / car.braking_limit, 0.0, 1.0),
    )
