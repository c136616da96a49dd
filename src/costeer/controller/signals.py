"""The record that each stage of the controller hands on to the next."""

from __future__ import annotations

from typing import NamedTuple

from costeer.base.array import Flag, Real
from costeer.base.bezier import Quintic

LANE_KEEPING = 1.0
"""Mode: guidance to the centre of a lane."""

LANE_CHANGING = 2.0
"""Mode: guidance along a path to the adjacent lane."""


class Intention(NamedTuple):
    """What the driver is about to do.

    Attributes:
        detected: The debounced trigger.
        side: Of the lane that the driver is about to enter, -1 right, +1 left [-].
    """

    detected: Flag
    side: Real


class Target(NamedTuple):
    """The planned motion at the car's place.

    Attributes:
        mode: `LANE_KEEPING` or `LANE_CHANGING` [-].
        lane: That the plan ends in [-].
        lateral_position: y_d [m].
        heading: psi_p of the path [rad].
        curvature: kappa_d [1/m].
        curvature_rate: Its time derivative along the path [1/(m·s)].
        path: Of the last lane change; means nothing in lane keeping.
    """

    mode: Real
    lane: Real
    lateral_position: Real
    heading: Real
    curvature: Real
    curvature_rate: Real
    path: Quintic


class Preview(NamedTuple):
    """Car minus target, and the planned wheel, at the preview point.

    Attributes:
        lateral_error: e_y, extrapolated by the preview time [m].
        heading_error: psi - psi_d [rad].
        heading_error_rate: e_theta' = yaw rate - V_x kappa_d [rad/s].
        steering_angle_error: theta - theta_d [rad].
        slip_angle_error: alpha - alpha_d [rad].
        planned_steering_angle: theta_d [rad].
        planned_steering_rate: theta_d' [rad/s].
        planned_slip_angle: alpha_d [rad].
    """

    lateral_error: Real
    heading_error: Real
    heading_error_rate: Real
    steering_angle_error: Real
    slip_angle_error: Real
    planned_steering_angle: Real
    planned_steering_rate: Real
    planned_slip_angle: Real


class Guidance(NamedTuple):
    """Torques before the gain.

    Attributes:
        estimated_driver_torque: tau'_dr, Eq. (5) [N·m].
        disturbance_torque: tau_dis, what the planned motion has to overcome [N·m].
        instructed_torque: tau_hapi, Eq. (4) [N·m].
    """

    estimated_driver_torque: Real
    disturbance_torque: Real
    instructed_torque: Real


class Consistency(NamedTuple):
    """Whether driver and system want the same path.

    Attributes:
        guidance_pseudo_work: W_hapi, Eq. (7) [W]; NaN until the window is full.
        driver_pseudo_work: W_dr, Eq. (8) [W]; NaN until the window is full.
        torque_agreement: S_c, Eq. (9) [N²·m²].
        consistent: The verdict of Table III.
    """

    guidance_pseudo_work: Real
    driver_pseudo_work: Real
    torque_agreement: Real
    consistent: Flag


class Signals(NamedTuple):
    """All that one step of the controller computed.

    Attributes:
        crossing_probability: Of the intention network [-].
        intention: Its debounced trigger.
        target: Mode and planned motion.
        preview: Errors and planned wheel.
        guidance: Torques before the gain.
        consistency: Pseudo-work, agreement, verdict.
        haptic_gain: K_h [-].
        replan: Whether a new plan was called for at this step.
        applied_torque: tau_hapa, asked of the motor [N·m].
    """

    crossing_probability: Real
    intention: Flag
    target: Target
    preview: Preview
    guidance: Guidance
    consistency: Consistency
    haptic_gain: Real
    replan: Flag
    applied_torque: Real
