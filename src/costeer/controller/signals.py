"""What comes into a method, what each stage hands on to the next, what comes out.

Numbers that a method does not compute are NaN without its saying so.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.base.array import Flag, Real
from costeer.base.bezier import Quintic

LANE_KEEPING = 1.0
"""Mode: guidance to the centre of a lane."""

LANE_CHANGING = 2.0
"""Mode: guidance along a path to the adjacent lane."""

NO_PATH = Quintic(*[math.nan] * len(Quintic._fields))
"""Where nothing is planned."""


class Request(NamedTuple):
    """What is asked of a method at one step, by predictor, person or script.

    Attributes:
        crossing_probability: That the car crosses soon into the lane on `side`; NaN
            for no verdict [-].
        requested: A lane change asked for from outside: indicator or script.
        change_duration: That a lane change is to take; NaN: the method's own [s].
        indicator: Side that the driver's indicator is set to, -1 right, 0 off, +1
            left [-].
        side: That probability or request are about, -1 right, +1 left; 0: the usual
            one. A method hears it as `Measurement.side` [-].
    """

    crossing_probability: Real = math.nan
    requested: Flag = False
    change_duration: Real = math.nan
    indicator: Real = 0.0
    side: Real = 0.0


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

    mode: Real = LANE_KEEPING
    lane: Real = math.nan
    lateral_position: Real = math.nan
    heading: Real = math.nan
    curvature: Real = math.nan
    curvature_rate: Real = math.nan
    path: Quintic = NO_PATH


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

    lateral_error: Real = math.nan
    heading_error: Real = math.nan
    heading_error_rate: Real = math.nan
    steering_angle_error: Real = math.nan
    slip_angle_error: Real = math.nan
    planned_steering_angle: Real = math.nan
    planned_steering_rate: Real = math.nan
    planned_slip_angle: Real = math.nan


class Guidance(NamedTuple):
    """Torques before the gain.

    Attributes:
        estimated_driver_torque: tau'_dr, Eq. (5) [N·m].
        disturbance_torque: tau_dis, what the planned motion has to overcome [N·m].
        instructed_torque: tau_hapi, Eq. (4) [N·m].
    """

    estimated_driver_torque: Real = math.nan
    disturbance_torque: Real = math.nan
    instructed_torque: Real = math.nan


class Consistency(NamedTuple):
    """Whether driver and system want the same path.

    Attributes:
        guidance_pseudo_work: W_hapi, Eq. (7) [W]; NaN until the window is full.
        driver_pseudo_work: W_dr, Eq. (8) [W]; NaN until the window is full.
        torque_agreement: S_c, Eq. (9) [N²·m²].
        consistent: The verdict of Table III.
    """

    guidance_pseudo_work: Real = math.nan
    driver_pseudo_work: Real = math.nan
    torque_agreement: Real = math.nan
    consistent: Flag = True


class Assistance(NamedTuple):
    """All that a method computed at one step; only the torque has an effect.

    Attributes:
        applied_torque: tau_hapa, asked of the motor [N·m].
        haptic_gain: K_h [-].
        intention: The debounced trigger of a lane change.
        target: Mode and planned motion.
        preview: Errors and planned wheel.
        guidance: Torques before the gain.
        consistency: Pseudo-work, agreement, verdict.
        replan: Whether a new plan was called for at this step.
    """

    applied_torque: Real = 0.0
    haptic_gain: Real = math.nan
    intention: Flag = False
    target: Target = Target()
    preview: Preview = Preview()
    guidance: Guidance = Guidance()
    consistency: Consistency = Consistency()
    replan: Flag = False
