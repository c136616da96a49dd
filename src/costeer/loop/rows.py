"""A sample of the closed loop as one flat row of numbers: the columns of a record.

A row is a tuple of a few groups, so that each is made by a function that fits on a
screen; packed, they lie flat in the order of `ROW_COLUMNS`.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.controller.signals import Assistance, Request
from costeer.loop.events import EventState, leader_visible
from costeer.loop.half_step import Sample
from costeer.sensing.measurement import Measurement


class MotionRow(NamedTuple):
    """What is measured of car, wheel and head."""

    longitudinal_position: Real
    lateral_position: Real
    lane: Real
    yaw_angle: Real
    yaw_rate: Real
    longitudinal_velocity: Real
    longitudinal_acceleration: Real
    lateral_velocity: Real
    lateral_acceleration: Real
    steering_wheel_angle: Real
    steering_wheel_rate: Real
    driver_torque: Real
    head_yaw: Real
    head_yaw_valid: Real
    distance_to_adjacent_lane: Real


class GuidanceRow(NamedTuple):
    """What the controller computed."""

    target_lane: Real
    target_lateral_position: Real
    estimated_driver_torque: Real
    instructed_torque: Real
    haptic_gain: Real
    lateral_error: Real
    heading_error_rate: Real
    guidance_pseudo_work: Real
    driver_pseudo_work: Real
    torque_agreement: Real
    consistent: Real
    crossing_probability: Real
    intention: Real
    mode: Real


class LeaderRow(NamedTuple):
    """The car ahead; NaN where there is none."""

    lead_distance: Real
    lead_velocity: Real
    lead_lane: Real


class Row(NamedTuple):
    """The columns of a trial record, all as floats; flags are 0 or 1."""

    time: Real
    motion: MotionRow
    guidance: GuidanceRow
    leader: LeaderRow
    applied_torque: Real
    event: Real
    driver_intention: Real
    accelerator: Real
    brake: Real


ROW_COLUMNS = (
    "time",
    *MotionRow._fields,
    *GuidanceRow._fields,
    *LeaderRow._fields,
    *Row._fields[4:],
)
"""Names of the numbers of a packed row."""


@compiled
def _number(flag: Flag) -> Real:
    """1 for true, 0 for false."""
    return xp.select(flag, 1.0, 0.0)


@compiled
def motion_row(measurement: Measurement) -> MotionRow:
    """The measurement's part of a row."""
    return MotionRow(
        longitudinal_position=measurement.longitudinal_position,
        lateral_position=measurement.lateral_position,
        lane=measurement.lane,
        yaw_angle=measurement.yaw_angle,
        yaw_rate=measurement.yaw_rate,
        longitudinal_velocity=measurement.longitudinal_velocity,
        longitudinal_acceleration=measurement.longitudinal_acceleration,
        lateral_velocity=measurement.lateral_velocity,
        lateral_acceleration=measurement.lateral_acceleration,
        steering_wheel_angle=measurement.steering_wheel_angle,
        steering_wheel_rate=measurement.steering_wheel_rate,
        driver_torque=measurement.driver_torque,
        head_yaw=measurement.head_yaw,
        head_yaw_valid=_number(measurement.head_yaw_valid),
        distance_to_adjacent_lane=measurement.distance_to_adjacent_lane,
    )


@compiled
def guidance_row(signals: Assistance, request: Request) -> GuidanceRow:
    """The controller's part of a row."""
    return GuidanceRow(
        target_lane=signals.target.lane,
        target_lateral_position=signals.target.lateral_position,
        estimated_driver_torque=signals.guidance.estimated_driver_torque,
        instructed_torque=signals.guidance.instructed_torque,
        haptic_gain=signals.haptic_gain,
        lateral_error=signals.preview.lateral_error,
        heading_error_rate=signals.preview.heading_error_rate,
        guidance_pseudo_work=signals.consistency.guidance_pseudo_work,
        driver_pseudo_work=signals.consistency.driver_pseudo_work,
        torque_agreement=signals.consistency.torque_agreement,
        consistent=_number(signals.consistency.consistent),
        crossing_probability=request.crossing_probability,
        intention=_number(signals.intention),
        mode=signals.target.mode,
    )


@compiled
def leader_row(events: EventState, position: Real) -> LeaderRow:
    """The leader's part of a row.

    Args:
        events: The leader.
        position: Of the car along the road [m].
    """
    leader = events.leader
    visible = leader_visible(events, position)
    gap = leader.longitudinal_position - position
    return LeaderRow(
        lead_distance=xp.select(visible, gap, math.nan),
        lead_velocity=xp.select(visible, leader.longitudinal_velocity, math.nan),
        lead_lane=xp.select(visible, leader.lane, math.nan),
    )


@compiled
def row(sample: Sample[Any]) -> Row:
    """The sample as a row."""
    position = sample.measurement.longitudinal_position
    return Row(
        time=sample.time,
        motion=motion_row(sample.measurement),
        guidance=guidance_row(sample.signals, sample.request),
        leader=leader_row(sample.events, position),
        applied_torque=sample.motor_torque,
        event=sample.events.event,
        driver_intention=sample.action.intention,
        accelerator=sample.action.pedals.accelerator,
        brake=sample.action.pedals.brake,
    )
