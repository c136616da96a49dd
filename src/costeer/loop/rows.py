"""A sample of the closed loop as one flat row of numbers, in the record's order."""

from __future__ import annotations

import math
from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.loop.events import leader_visible
from costeer.loop.step import Sample


class Row(NamedTuple):
    """The columns of a trial record, all as floats; flags are 0 or 1."""

    time: Real
    longitudinal_position: Real
    lateral_position: Real
    lane: Real
    target_lane: Real
    yaw_angle: Real
    yaw_rate: Real
    longitudinal_velocity: Real
    longitudinal_acceleration: Real
    lateral_velocity: Real
    lateral_acceleration: Real
    steering_wheel_angle: Real
    steering_wheel_rate: Real
    driver_torque: Real
    estimated_driver_torque: Real
    instructed_torque: Real
    applied_torque: Real
    haptic_gain: Real
    head_yaw: Real
    distance_to_adjacent_lane: Real
    lateral_error: Real
    heading_error_rate: Real
    guidance_pseudo_work: Real
    driver_pseudo_work: Real
    torque_agreement: Real
    consistent: Real
    crossing_probability: Real
    intention: Real
    mode: Real
    event: Real
    driver_intention: Real
    lead_distance: Real
    lead_velocity: Real
    lead_lane: Real
    target_lateral_position: Real
    head_yaw_valid: Real
    accelerator: Real
    brake: Real


@compiled
def _number(flag: Flag) -> Real:
    """1 for true, 0 for false."""
    return xp.select(flag, 1.0, 0.0)


@compiled
def row(sample: Sample) -> Row:
    """The sample as a row; NaN where there is no leader."""
    measurement, signals = sample.measurement, sample.signals
    position = measurement.longitudinal_position
    leader = sample.events.leader
    visible = leader_visible(sample.events, position)
    gap = leader.longitudinal_position - position
    return Row(
        time=sample.time,
        longitudinal_position=position,
        lateral_position=measurement.lateral_position,
        lane=measurement.lane,
        target_lane=signals.target.lane,
        yaw_angle=measurement.yaw_angle,
        yaw_rate=measurement.yaw_rate,
        longitudinal_velocity=measurement.longitudinal_velocity,
        longitudinal_acceleration=measurement.longitudinal_acceleration,
        lateral_velocity=measurement.lateral_velocity,
        lateral_acceleration=measurement.lateral_acceleration,
        steering_wheel_angle=measurement.steering_wheel_angle,
        steering_wheel_rate=measurement.steering_wheel_rate,
        driver_torque=measurement.driver_torque,
        estimated_driver_torque=signals.guidance.estimated_driver_torque,
        instructed_torque=signals.guidance.instructed_torque,
        applied_torque=sample.motor_torque,
        haptic_gain=signals.haptic_gain,
        head_yaw=measurement.head_yaw,
        distance_to_adjacent_lane=measurement.distance_to_adjacent_lane,
        lateral_error=signals.preview.lateral_error,
        heading_error_rate=signals.preview.heading_error_rate,
        guidance_pseudo_work=signals.consistency.guidance_pseudo_work,
        driver_pseudo_work=signals.consistency.driver_pseudo_work,
        torque_agreement=signals.consistency.torque_agreement,
        consistent=_number(signals.consistency.consistent),
        crossing_probability=signals.crossing_probability,
        intention=_number(signals.intention),
        mode=signals.target.mode,
        event=sample.events.event,
        driver_intention=sample.action.intention,
        lead_distance=xp.select(visible, gap, math.nan),
        lead_velocity=xp.select(visible, leader.longitudinal_velocity, math.nan),
        lead_lane=xp.select(visible, leader.lane, math.nan),
        target_lateral_position=signals.target.lateral_position,
        head_yaw_valid=_number(measurement.head_yaw_valid),
        accelerator=sample.action.pedals.accelerator,
        brake=sample.action.pedals.brake,
    )
