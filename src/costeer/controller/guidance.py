"""Torque instruction: driver-torque estimate and guidance torque (Eqs. (4), (5)).

Reading: measured angle, rate and acceleration in Eq. (4) would make an algebraic
loop, so its column terms are those of the planned motion. J_eq theta_d'' is left out:
the quintic's steering rate jumps at its ends, and inside the manoeuvre the term is
under 0.05 N·m. See docs/paper.md.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.controller.signals import Guidance, Preview
from costeer.plant.parameters import CarParameters, ColumnParameters


class GuidanceParameters(NamedTuple):
    """Gains of the preview driver, Eq. (5).

    Attributes:
        lateral_error_gain: K_y [N·m/m]. Source: assumed; puts preview and bandwidth
            where two public tunings lie, 0.9 to 1.0 rad/s.
        heading_error_rate_gain: K_yd [N·m·s/rad]. Source: assumed, hands-off runs of
            three cars with stiction; with 2.0 the large one's wheel swings by 4.7 deg
            at 110 km/h, with 4.0 by 0.7 deg.
        steering_angle_gain: K_theta [N·m/rad]. Source: assumed, as above.
        slip_angle_gain: K_alpha [N·m/rad]. Source: assumed, 0.45 of the car's
            self-aligning stiffness k_s.
        friction_smoothing: Torque over which the friction compensation rises [N·m].
            Source: assumed, hands-off runs; 0.3 hunts by 0.09 m at 50 km/h.
        friction_rate_weight: Weight of the planned damping torque in the direction of
            the friction [-]. Source: assumed.
        steering_gain_speed: Up to here K_theta is as given; above it rises with the
            square of the speed [m/s]. Source: assumed, 80 km/h; see `at_speed`.
    """

    lateral_error_gain: Real = 1.5
    heading_error_rate_gain: Real = 4.0
    steering_angle_gain: Real = 3.0
    slip_angle_gain: Real = 0.45 * 0.6 * 0.026 * 110e3 / 16.0
    friction_smoothing: Real = 0.2
    friction_rate_weight: Real = 4.0
    steering_gain_speed: Real = 80.0 / 3.6


@compiled
def at_speed(parameters: GuidanceParameters, speed: Real) -> GuidanceParameters:
    """The gains at a speed: K_theta rises above `steering_gain_speed`.

    The error at the preview point grows with the speed (T_p v times the heading error),
    and so does the car's answer to the wheel; K_theta, which resists turning the wheel
    away from the plan, has to grow along. With a constant one the large car swings at
    110 km/h, most of all with hands on the wheel, whose inertia is then part of the
    column (docs/stability.md).

    Args:
        parameters: With K_theta.
        speed: Of the car [m/s].
    """
    usual = parameters.steering_gain_speed
    share = xp.maximum(speed, usual) / usual
    gain = parameters.steering_angle_gain * share * share
    return parameters._replace(steering_angle_gain=gain)


@compiled
def estimated_driver_torque(parameters: GuidanceParameters, preview: Preview) -> Real:
    """tau'_dr, Eq. (5) [N·m]; the preview driver's own torque is its negative."""
    return (
        parameters.lateral_error_gain * preview.lateral_error
        + parameters.heading_error_rate_gain * preview.heading_error_rate
        + parameters.steering_angle_gain * preview.steering_angle_error
        + parameters.slip_angle_gain * preview.slip_angle_error
    )


@compiled
def disturbance_torque(
    parameters: GuidanceParameters,
    car: CarParameters,
    column: ColumnParameters,
    preview: Preview,
    estimated_torque: Real,
) -> Real:
    """tau_dis: self-aligning torque of the planned motion and friction [N·m].

    Args:
        parameters: How the friction's sign is smoothed.
        car: Its self-aligning stiffness k_s.
        column: Its damping and friction.
        preview: The planned wheel.
        estimated_torque: tau'_dr [N·m].
    """
    damping = column.damping * preview.planned_steering_rate
    pull = parameters.friction_rate_weight * damping - estimated_torque
    friction = column.friction * xp.tanh(pull / parameters.friction_smoothing)
    return friction - car.aligning_stiffness * preview.planned_slip_angle


@compiled
def instructed_torque(
    column: ColumnParameters,
    preview: Preview,
    disturbance: Real,
    estimated_torque: Real,
) -> Real:
    """tau_hapi, Eq. (4) for the planned motion [N·m].

    Args:
        column: B_eq and K_Fz.
        preview: The planned wheel.
        disturbance: tau_dis [N·m].
        estimated_torque: tau'_dr [N·m].
    """
    damping = column.damping * preview.planned_steering_rate
    stiffness = column.stiffness * preview.planned_steering_angle
    return damping + stiffness + disturbance - estimated_torque


@compiled
def guide(
    parameters: GuidanceParameters,
    car: CarParameters,
    column: ColumnParameters,
    preview: Preview,
) -> Guidance:
    """All torques before the gain."""
    estimated = estimated_driver_torque(parameters, preview)
    disturbance = disturbance_torque(parameters, car, column, preview, estimated)
    return Guidance(
        estimated_driver_torque=estimated,
        disturbance_torque=disturbance,
        instructed_torque=instructed_torque(column, preview, disturbance, estimated),
    )
