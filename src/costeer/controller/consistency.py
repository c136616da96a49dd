"""Do driver and system want the same path: pseudo-work and verdict (Eqs. (7)-(9))."""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.base.window import Window, empty_window, full, mean, push
from costeer.controller.signals import Consistency

WINDOW_LENGTH = 60
"""ΔT of Eqs. (7) and (8) in control steps: 1 s at 60 Hz."""


class ConsistencyParameters(NamedTuple):
    """When two torques are in conflict, Table III.

    Attributes:
        inconsistency_threshold: δ, least gap of the pseudo-works [W]. Source:
            assumed, twice the 99.9th percentile of agreeing runs of pilot drivers,
            docs/decisions/0006-threshold.md.
        hold_time: A verdict that changes stays at least this long [s]. Source:
            paper, none; a literal Table III can chatter when a torque crosses zero.
        hands_on_threshold: Least driver torque that disagrees, measured and beyond
            what relaxed arms give; 0 gives Table III as printed [N·m]. Source:
            assumed, above a torque sensor's noise; without it hands that rest on the
            rim keep the gain at 0 for ever.
    """

    inconsistency_threshold: Real = 0.023
    hold_time: Real = 0.0
    hands_on_threshold: Real = 0.1


class ConsistencyState(NamedTuple):
    """What the verdict remembers.

    Attributes:
        guidance_power: Last products of guidance torque and heading-error rate [W].
        driver_power: Last products of driver torque and heading-error rate [W].
        consistent: Verdict of the step before.
        time_in_verdict: Since it last changed [s].
    """

    guidance_power: Window
    driver_power: Window
    consistent: Flag
    time_in_verdict: Real


@compiled
def initial_state() -> ConsistencyState:
    """Empty windows, consistent."""
    return ConsistencyState(
        guidance_power=empty_window(WINDOW_LENGTH),
        driver_power=empty_window(WINDOW_LENGTH),
        consistent=True,
        time_in_verdict=0.0,
    )


@compiled
def torque_agreement(instructed_torque: Real, driver_torque: Real) -> Real:
    """S_c, Eq. (9) [N²·m²]: positive while both turn the wheel the same way."""
    return instructed_torque * driver_torque


@compiled
def power(torque: Real, heading_error_rate: Real) -> Real:
    """Product whose mean is a pseudo-work [W]; nothing where it is not finite.

    A NaN in the window would blind the verdict for as long as it stays there.
    """
    product = torque * heading_error_rate
    return xp.select(xp.isfinite(product), product, 0.0)


@compiled
def is_consistent(
    parameters: ConsistencyParameters,
    guidance_pseudo_work: Real,
    driver_pseudo_work: Real,
    agreement: Real,
) -> Flag:
    """Verdict of Table III.

    Args:
        parameters: δ.
        guidance_pseudo_work: W_hapi [W].
        driver_pseudo_work: W_dr [W].
        agreement: S_c [N²·m²].
    """
    gap = guidance_pseudo_work - driver_pseudo_work
    threshold = parameters.inconsistency_threshold
    apart = (gap > threshold) | (gap < -threshold)
    return xp.logical_not((agreement < 0.0) & apart)


@compiled
def pushes(
    parameters: ConsistencyParameters, driver_torque: Real, own_torque: Real
) -> Flag:
    """Whether the driver does more than rest the hands on the wheel.

    Args:
        parameters: Hands-on threshold.
        driver_torque: tau_dr [N·m].
        own_torque: What relaxed arms do not explain of it (controller/hands.py) [N·m].
    """
    least = parameters.hands_on_threshold
    turns = (driver_torque >= least) | (driver_torque <= -least)
    wants = (own_torque >= least) | (own_torque <= -least)
    return turns & wants


@compiled
def step(
    parameters: ConsistencyParameters,
    state: ConsistencyState,
    instructed_torque: Real,
    driver_torque: Real,
    heading_error_rate: Real,
    dt: Real,
    own_torque: Real = math.inf,
) -> tuple[ConsistencyState, Consistency]:
    """Advance both windows by one sample and judge: nobody disagrees without pushing.

    Without a finite torque of both there is no new verdict: the last one stays, so
    that a lost sample does not start a fade anew.

    Args:
        parameters: δ, hold time, hands-on threshold.
        state: Windows and last verdict.
        instructed_torque: tau_hapi, before gain, strength and limit [N·m].
        driver_torque: tau_dr [N·m].
        heading_error_rate: e_theta' [rad/s].
        dt: Control step [s].
        own_torque: What relaxed arms do not explain of tau_dr [N·m].
    """
    guidance_power = push(
        state.guidance_power, power(instructed_torque, heading_error_rate)
    )
    driver_power = push(state.driver_power, power(driver_torque, heading_error_rate))
    ready = full(guidance_power)
    guidance_work = xp.select(ready, mean(guidance_power), math.nan)
    driver_work = xp.select(ready, mean(driver_power), math.nan)
    agreement = torque_agreement(instructed_torque, driver_torque)
    printed = is_consistent(parameters, guidance_work, driver_work, agreement)
    resting = xp.logical_not(pushes(parameters, driver_torque, own_torque))
    held = state.time_in_verdict < parameters.hold_time - dt / 2.0
    unknown = xp.logical_not(xp.isfinite(agreement))
    consistent = xp.select(held | unknown, state.consistent, printed | resting)
    switched = consistent != state.consistent
    new_state = ConsistencyState(
        guidance_power=guidance_power,
        driver_power=driver_power,
        consistent=consistent,
        time_in_verdict=xp.select(switched, dt, state.time_in_verdict + dt),
    )
    return new_state, Consistency(
        guidance_pseudo_work=guidance_work,
        driver_pseudo_work=driver_work,
        torque_agreement=agreement,
        consistent=consistent,
    )
