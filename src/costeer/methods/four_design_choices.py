"""Haptic guidance by four design choices: van Paassen et al. 2017.

A human-compatible reference, the strength of haptic feedback (SoHF), the level of
haptic support (LoHS) and the level of haptic authority (LoHA), as implemented in
public. Steering-wheel angles, not torques, are what it reckons in.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

from costeer.base.array import Real, compiled
from costeer.controller import actuation, preview
from costeer.controller.actuation import ActuationParameters
from costeer.controller.preview import PreviewParameters
from costeer.controller.signals import Assistance, Guidance, Preview, Request
from costeer.methods.ibhs import like_ibhs, shared_tunables
from costeer.methods.interface import Method, Tunable
from costeer.methods.lane_keeping import LaneKeepingState
from costeer.methods.lanes import LaneParameters, followed_lane, lane_target
from costeer.plant.parameters import (
    CarParameters,
    ColumnParameters,
    RoadParameters,
    holding_stiffness,
)
from costeer.sensing.measurement import Measurement

AT_THE_CAR = PreviewParameters(preview_time=0.0)
"""The errors of this law are those at the car, none is extrapolated."""


class DesignChoices(NamedTuple):
    """The four choices but the reference, which is the lane's centre.

    Attributes:
        lateral_error_gain: k_y, wheel angle over lateral error [rad/m]. Source: van
            Paassen et al. 2017 as implemented in public, 0.15.
        heading_error_gain: k_psi, wheel angle over heading error [-]. Source: as
            above, 2.5.
        feedback_strength: SoHF, factor on the feedback [-]. Source: as above, 1.
        support_level: LoHS, share of the feed-forward torque [-]. Source: as above, 1.
        authority_level: LoHA, stiffness about the wanted angle [N·m/rad]. Source: as
            above, 0.
    """

    lateral_error_gain: Real = 0.15
    heading_error_gain: Real = 2.5
    feedback_strength: Real = 1.0
    support_level: Real = 1.0
    authority_level: Real = 0.0


class FourDesignChoicesParameters(NamedTuple):
    """Lane keeping by four design choices.

    Attributes:
        car: Nominal car [SI units]. Source: plant/parameters.py.
        column: Nominal column [SI units]. Source: plant/parameters.py.
        road: Lanes [SI units]. Source: plant/parameters.py.
        lanes: When the followed lane changes [SI units]. Source: methods/lanes.py.
        choices: Gains and levels [SI units]. Source: van Paassen et al. 2017.
        actuation: Strength and limits [SI units]. Source: Eq. (6), Table IV.
    """

    car: CarParameters = CarParameters()
    column: ColumnParameters = ColumnParameters()
    road: RoadParameters = RoadParameters()
    lanes: LaneParameters = LaneParameters()
    choices: DesignChoices = DesignChoices()
    actuation: ActuationParameters = ActuationParameters()


@compiled
def initial_state(
    parameters: FourDesignChoicesParameters, lane: Real
) -> LaneKeepingState:
    """Follow the lane that the car starts in."""
    return LaneKeepingState(lane=lane, actuation=actuation.initial_state())


@compiled
def instructed_torque(
    choices: DesignChoices, errors: Preview, angle: Real, stiffness: Real
) -> Real:
    """K_s (LoHS ff + fb) + LoHA (ff + fb - theta) [N·m].

    The errors are car minus reference here and reference minus car there: fb has the
    other sign.

    Args:
        choices: Gains and levels.
        errors: At the car, with the wheel angle ff of the planned motion.
        angle: theta, of the steering wheel [rad].
        stiffness: K_s, torque that holds the wheel over its angle [N·m/rad].
    """
    feedforward = errors.planned_steering_angle
    feedback = -choices.feedback_strength * (
        choices.lateral_error_gain * errors.lateral_error
        + choices.heading_error_gain * errors.heading_error
    )
    support = stiffness * (choices.support_level * feedforward + feedback)
    authority = choices.authority_level * (feedforward + feedback - angle)
    return support + authority


@compiled
def step(
    parameters: FourDesignChoicesParameters,
    state: LaneKeepingState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[LaneKeepingState, Assistance]:
    """Support along the centre of the followed lane.

    Args:
        parameters: Lanes, choices, limits.
        state: Followed lane and last torque.
        measurement: This step's sample.
        request: Not looked at.
        dt: Control step [s].
    """
    road, car = parameters.road, parameters.car
    lane = followed_lane(parameters.lanes, road, state.lane, measurement)
    target = lane_target(road, lane, measurement)
    errors = preview.preview(AT_THE_CAR, car, target, measurement)
    speed = measurement.longitudinal_velocity
    wanted = instructed_torque(
        parameters.choices,
        errors,
        measurement.steering_wheel_angle,
        holding_stiffness(car, parameters.column, speed),
    )
    limited, torque = actuation.step(
        parameters.actuation, state.actuation, 1.0, wanted, dt
    )
    new_state = LaneKeepingState(lane=lane, actuation=limited)
    return new_state, Assistance(
        applied_torque=torque,
        target=target,
        preview=errors,
        guidance=Guidance(instructed_torque=wanted),
    )


METHOD = Method(
    name="four-design-choices",
    version="1",
    source="van Paassen et al. 2017: four design choices for haptic shared control",
    parameters=partial(like_ibhs, FourDesignChoicesParameters),
    initial_state=initial_state,
    step=step,
    tunables=(
        *(
            Tunable(leaf, f"choices.{leaf}", unit, 0.0, high, label)
            for leaf, unit, high, label in (
                ("lateral_error_gain", "rad/m", 0.5, "k_y, lateral error"),
                ("heading_error_gain", "-", 8.0, "k_psi, heading error"),
                ("feedback_strength", "-", 2.0, "SoHF"),
                ("support_level", "-", 1.5, "LoHS"),
                ("authority_level", "N·m/rad", 10.0, "LoHA"),
            )
        ),
        *shared_tunables(FourDesignChoicesParameters),
    ),
)
