"""Vision to intended steering-wheel angle: near and far point.

Saleh, Chevrel, Mars, Lafay and Claveau (2013), Human-like cybernetic driver model for
lane keeping: anticipation from the far point, compensation from the near point
through a lead-lag, and a processing delay on their sum. The far angle is the direction
of the wanted path there; on a straight road it is the vanishing point of their model.
What the driver steers ahead for the own path's curvature is planned, not seen: it has
no delay.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.base.filters import coloured_noise, low_pass, pade_delay
from costeer.plant.parameters import CarParameters, steady_steering_wheel_angle
from costeer.sensing.measurement import Measurement


class VisionParameters(NamedTuple):
    """From what is seen to the wheel angle that is wanted.

    Attributes:
        far_gain: K_p on the far angle [-]. Source: Saleh et al. (2013), 3.4.
        near_gain: K_c on the near angle, over speed [m/s]. Source: Saleh et al.
            (2013), 15.
        lead_time: T_L of the compensation [s]. Source: Saleh et al. (2013), 1 to 2.5.
        lag_time: T_I of the compensation [s]. Source: Saleh et al. (2013), 1.
        delay: Of visual processing [s]. Source: Saleh et al. (2013), 0.04.
        near_time: Time to the near point [s]. Source: assumed, Salvucci and Gray
            (2004) place it at 6.2 m.
        anticipation_time: Time to the far point on a path, makes up for delay, arm
            and car [s]. Source: assumed.
        curvature_gain: Share of the wanted path's curvature that is steered ahead
            [-]. Source: assumed, an internal model of the car.
        near_noise: Standard deviation of the seen near angle [rad]. Source: assumed,
            calibrated on the manual steering reversal rate.
        motor_noise: Standard deviation of the intended angle [rad]. Source: assumed,
            as above.
        noise_time: Correlation time of both noises [s]. Source: assumed.
        signal_noise: What `motor_noise` grows by per intended angle, as motor noise
            does with the torque that is given (Harris and Wolpert 1998) [-]. Source:
            assumed.
        sight: How far the road can be seen [m]. Source: assumed, no fog.
    """

    far_gain: Real = 3.4
    near_gain: Real = 15.0
    lead_time: Real = 1.75
    lag_time: Real = 1.0
    delay: Real = 0.04
    near_time: Real = 0.4
    anticipation_time: Real = 0.35
    curvature_gain: Real = 0.9
    near_noise: Real = 0.0055
    motor_noise: Real = 0.0065
    noise_time: Real = 0.35
    signal_noise: Real = 0.1
    sight: Real = 1000.0


class VisionNoise(NamedTuple):
    """Random numbers of one control step, standard normal.

    Attributes:
        near: For the seen near angle.
        motor: For the intended angle.
    """

    near: Real
    motor: Real


class VisionState(NamedTuple):
    """What vision remembers.

    Attributes:
        delayed: Memory of the delay [rad].
        lagged: State of the lead-lag [rad].
        near_noise: Of the seen near angle [rad].
        motor_noise: Of the intended angle [rad].
    """

    delayed: Real
    lagged: Real
    near_noise: Real
    motor_noise: Real


@compiled
def initial_state() -> VisionState:
    """At rest."""
    return VisionState(delayed=0.0, lagged=0.0, near_noise=0.0, motor_noise=0.0)


@compiled
def near_angle(measurement: Measurement, near_position: Real, distance: Real) -> Real:
    """Angle from the car's direction to the wanted near point [rad].

    Args:
        measurement: Where the car is and points.
        near_position: Wanted lateral position there, from the road's tangent at the
            car [m].
        distance: To the near point [m].
    """
    offset = near_position - measurement.lateral_position
    return xp.atan(offset / distance) - measurement.yaw_angle


@compiled
def far_angle(measurement: Measurement, slope: Real, turn: Real = 0.0) -> Real:
    """Angle from the car's direction to the wanted path's at the far point [rad].

    Args:
        measurement: Where the car points.
        slope: Of the path along the road there [-].
        turn: How far the road turns until there [rad].
    """
    return xp.atan(slope) + turn - measurement.yaw_angle


@compiled
def compensation(parameters: VisionParameters, lagged: Real, angle: Real) -> Real:
    """Near angle through the lead-lag (1 + T_L s) / (1 + T_I s) [rad].

    Args:
        parameters: T_L and T_I.
        lagged: The angle through 1 / (1 + T_I s) [rad].
        angle: Now [rad].
    """
    lead = parameters.lead_time / parameters.lag_time
    return lagged + lead * (angle - lagged)


@compiled
def planned_angle(
    parameters: VisionParameters, car: CarParameters, speed: Real, curvature: Real
) -> Real:
    """Steering-wheel angle that is steered ahead for the own path [rad].

    Args:
        parameters: Share of it that is.
        car: Known by experience: angle for a curvature.
        speed: [m/s].
        curvature: Of the wanted path at the far point [1/m].
    """
    ahead = steady_steering_wheel_angle(car, speed, curvature)
    return parameters.curvature_gain * ahead


@compiled
def step(
    parameters: VisionParameters,
    state: VisionState,
    far: Real,
    near: Real,
    speed: Real,
    noise: VisionNoise,
    dt: Real,
) -> tuple[VisionState, Real]:
    """Process what is seen; return the state and the angle it asks for [rad].

    The state has the hand's noise of this step; `performed` adds it.

    Args:
        parameters: Gains, lead-lag, delay, noise.
        state: Of vision.
        far: Angle to the far point [rad].
        near: Angle to the near point [rad].
        speed: [m/s].
        noise: Draws of this step.
        dt: Control step [s].
    """
    correlation = parameters.noise_time
    near_noise = coloured_noise(
        state.near_noise, noise.near, parameters.near_noise, dt, correlation
    )
    motor_noise = coloured_noise(
        state.motor_noise, noise.motor, parameters.motor_noise, dt, correlation
    )
    seen = near + near_noise
    lagged = low_pass(state.lagged, seen, dt, parameters.lag_time)
    asked = parameters.far_gain * far + parameters.near_gain / speed * compensation(
        parameters, lagged, seen
    )
    delayed, angle = pade_delay(state.delayed, asked, parameters.delay, dt)
    new_state = VisionState(
        delayed=delayed, lagged=lagged, near_noise=near_noise, motor_noise=motor_noise
    )
    return new_state, angle


@compiled
def performed(
    parameters: VisionParameters, state: VisionState, intended: Real, planned: Real
) -> Real:
    """The angle that the hand goes to, with its own noise [rad].

    Args:
        parameters: Size of the noise.
        state: Of vision, with the noise of this step.
        intended: After what is seen [rad].
        planned: Ahead of it [rad].
    """
    usual = xp.maximum(parameters.motor_noise, 1e-9)
    growth = parameters.signal_noise * xp.absolute(intended + planned) / usual
    return intended + state.motor_noise * (1.0 + growth) + planned
