"""Vision to intended steering-wheel angle: near and far point.

Saleh, Chevrel, Mars, Lafay and Claveau (2013), Human-like cybernetic driver model for
lane keeping: anticipation from the far point, compensation from the near point
through a lead-lag and a processing delay. The far angle is the direction of the
wanted path there; on a straight road it is the vanishing point of their model.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.base.filters import coloured_noise, low_pass
from costeer.drivers.tracking import Aim
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
    """

    far_gain: Real = 3.4
    near_gain: Real = 15.0
    lead_time: Real = 1.75
    lag_time: Real = 1.0
    delay: Real = 0.04
    near_time: Real = 0.4
    anticipation_time: Real = 0.35
    curvature_gain: Real = 0.9
    near_noise: Real = 0.009
    motor_noise: Real = 0.011
    noise_time: Real = 0.35


class VisionState(NamedTuple):
    """What vision remembers.

    Attributes:
        delayed: State of the delay [rad].
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
        near_position: Wanted lateral position there [m].
        distance: To the near point [m].
    """
    offset = near_position - measurement.lateral_position
    return xp.atan(offset / distance) - measurement.yaw_angle


@compiled
def intended_angle(
    parameters: VisionParameters,
    car: CarParameters,
    measurement: Measurement,
    aim: Aim,
    compensation: Real,
) -> Real:
    """Steering-wheel angle that the driver wants [rad].

    Args:
        parameters: Gains.
        car: Known by experience: angle for a curvature.
        measurement: Speed and direction of the car.
        aim: The wanted path.
        compensation: Near angle after delay and lead-lag [rad].
    """
    speed = xp.maximum(measurement.longitudinal_velocity, 1.0)
    far = xp.atan(aim.far_slope) - measurement.yaw_angle
    ahead = steady_steering_wheel_angle(car, speed, aim.far_curvature)
    return (
        parameters.far_gain * far
        + parameters.near_gain / speed * compensation
        + parameters.curvature_gain * ahead
    )


@compiled
def delayed_angle(state: Real, angle: Real, delay: Real, dt: Real) -> tuple[Real, Real]:
    """First-order Pade approximation of a delay, as Saleh et al. use it.

    Args:
        state: Of the approximation [rad].
        angle: Seen now [rad].
        delay: [s].
        dt: Control step [s].

    Returns:
        New state [rad] and delayed angle [rad].
    """
    new_state = low_pass(state, angle, dt, delay / 2.0)
    return new_state, 2.0 * new_state - angle


@compiled
def step(
    parameters: VisionParameters,
    state: VisionState,
    angle: Real,
    near_normal: Real,
    motor_normal: Real,
    dt: Real,
) -> tuple[VisionState, Real]:
    """Process the near angle; return the state and the compensation [rad].

    Args:
        parameters: Delay, lead-lag, noise.
        state: Of vision.
        angle: To the near point [rad].
        near_normal: Standard normal draw for what is seen.
        motor_normal: Standard normal draw for what is intended.
        dt: Control step [s].
    """
    correlation = parameters.noise_time
    near_noise = coloured_noise(
        state.near_noise, near_normal, parameters.near_noise, dt, correlation
    )
    motor_noise = coloured_noise(
        state.motor_noise, motor_normal, parameters.motor_noise, dt, correlation
    )
    delayed, seen = delayed_angle(
        state.delayed, angle + near_noise, parameters.delay, dt
    )
    lagged = low_pass(state.lagged, seen, dt, parameters.lag_time)
    lead = parameters.lead_time / parameters.lag_time
    new_state = VisionState(
        delayed=delayed, lagged=lagged, near_noise=near_noise, motor_noise=motor_noise
    )
    return new_state, lagged + lead * (seen - lagged)
