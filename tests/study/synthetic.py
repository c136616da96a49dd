"""Plausible trial records without a simulator, for tests of what reads records.

A car drives 8 km at 70 km/h, overtakes four leaders with quintic lane changes of its
own durations, wanders in its lane and is steered with some noise. The motion is exact
kinematics without side slip, so many measures have a closed form. No human and no
virtual driver made these numbers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.records.columns import COLUMNS, TrialRecord
from costeer.records.row import record_columns

Signal = NDArray[np.float64]

RATE = 60.0
LANE_WIDTH = 3.5
EVENT_POSITIONS = (1000.0, 3000.0, 5000.0, 7000.0)
CONDITIONS: dict[str, tuple[float, float]] = {
    "manual": (0.0, float("nan")),
    "strong-rapid": (1.0, 4.0),
    "strong-normal": (1.0, 6.0),
    "strong-gentle": (1.0, 8.0),
    "weak-rapid": (0.4, 4.0),
    "weak-normal": (0.4, 6.0),
    "weak-gentle": (0.4, 8.0),
}


class Motion(NamedTuple):
    """The car along one trial, shape `(time,)` each."""

    time: Signal
    position: Signal
    velocity: Signal
    lateral: Signal
    changes: tuple[tuple[float, float, int, float], ...]
    """Start [s], duration [s], direction and trigger [s] of each lane change."""
    event: NDArray[np.int8]


def synthetic_record(
    condition: str = "manual",
    participant: int = 1,
    seed: int = 1,
    length: float = 8000.0,
    wander: float = 0.2,
) -> TrialRecord:
    """A trial record of 8 km with eight lane changes.

    Args:
        condition: One of `CONDITIONS`.
        participant: Draws this driver's pace, whatever the condition.
        seed: Draws everything else, with participant and condition.
        length: Of the road [m]; events beyond it are left out.
        wander: Standard deviation of the position in the lane [m].
    """
    order = list(CONDITIONS).index(condition)
    rng = np.random.default_rng([seed, participant, order])
    pace = 5.0 + 1.5 * np.random.default_rng([seed, participant]).random()
    assisted = condition != "manual"
    planned = CONDITIONS[condition][1] if assisted else pace
    motion = _motion(rng, planned, length, wander)
    columns = _car(motion, rng) | _traffic(motion)
    columns |= _intention(motion, rng)
    columns |= _guidance(motion, columns, rng, CONDITIONS[condition])
    blank = record_columns(np.zeros((motion.time.size, len(COLUMNS))), assisted=False)
    return TrialRecord(_metadata(condition, participant, seed), blank | columns)


def quintic(progress: Signal) -> Signal:
    """10 s³ - 15 s⁴ + 6 s⁵, held at 0 before and 1 after."""
    s = np.clip(progress, 0.0, 1.0)
    return np.asarray(s**3 * (10.0 - 15.0 * s + 6.0 * s**2))


def smooth_noise(
    rng: np.random.Generator, num_rows: int, cutoff_hz: float, deviation: float
) -> Signal:
    """Gaussian noise below a frequency, of a given standard deviation."""
    spectrum = np.fft.rfft(rng.normal(size=num_rows))
    frequency = np.fft.rfftfreq(num_rows, 1.0 / RATE)
    spectrum *= np.exp(-((frequency / cutoff_hz) ** 2)) * (frequency > 0)
    noise = np.fft.irfft(spectrum, num_rows)
    return np.asarray(noise * (deviation / max(noise.std(), 1e-12)))


def _motion(
    rng: np.random.Generator, planned: float, length: float, wander: float
) -> Motion:
    speed = 70.0 / 3.6
    time = np.arange(int(length / speed * RATE)) / RATE
    velocity = speed + smooth_noise(rng, time.size, 0.02, 0.4)
    position = np.cumsum(velocity) / RATE
    lateral = smooth_noise(rng, time.size, 0.06, wander)
    event = np.zeros(time.size, np.int8)
    changes: list[tuple[float, float, int, float]] = []
    for number, place in enumerate((p for p in EVENT_POSITIONS if p < length - 700), 1):
        appears = place / speed
        for start, direction in ((appears + 4.0, -1), (appears + 18.0, 1)):
            duration = planned * float(np.exp(0.12 * rng.normal()))
            trigger = start + rng.uniform(0.0, 0.8)
            changes.append((start, duration, direction, trigger))
            lateral += direction * LANE_WIDTH * quintic((time - start) / duration)
        event[(time >= appears) & (time <= start + duration)] = number
    return Motion(time, position, velocity, lateral, tuple(changes), event)


def _car(motion: Motion, rng: np.random.Generator) -> dict[str, np.ndarray]:
    rate = np.gradient(motion.lateral, motion.time)
    yaw = np.arctan2(rate, motion.velocity)
    yaw_rate = np.gradient(yaw, motion.time)
    angle = 16.0 * 2.9 * yaw_rate / motion.velocity
    angle = angle + smooth_noise(rng, angle.size, 0.25, np.radians(1.2))
    lane = (motion.lateral >= -LANE_WIDTH / 2).astype(np.int8)
    to_line = np.where(lane == 1, motion.lateral + 1.75, -1.75 - motion.lateral)
    zero = np.zeros(angle.size)
    return {
        "time": motion.time,
        "longitudinal_position": motion.position,
        "lateral_position": motion.lateral,
        "lane": lane,
        "yaw_angle": yaw,
        "yaw_rate": yaw_rate,
        "longitudinal_velocity": motion.velocity,
        "longitudinal_acceleration": np.gradient(motion.velocity, motion.time),
        "lateral_velocity": zero,
        "lateral_acceleration": motion.velocity * yaw_rate,
        "steering_wheel_angle": angle,
        "steering_wheel_rate": np.gradient(angle, motion.time),
        "distance_to_adjacent_lane": to_line,
        "accelerator": zero + 0.2,
        "brake": zero,
    }


def _traffic(motion: Motion) -> dict[str, np.ndarray]:
    gap = np.full(motion.time.size, np.nan)
    for number in range(1, int(motion.event.max(initial=0)) + 1):
        rows = np.flatnonzero(motion.event == number)
        gap[rows] = 100.0 - 2.8 * (motion.time[rows] - motion.time[rows[0]])
    gap[gap < 0] = np.nan
    absent = np.isnan(gap)
    return {
        "event": motion.event,
        "lead_distance": gap,
        "lead_velocity": np.where(absent, np.nan, motion.velocity - 2.8),
        "lead_lane": np.ma.MaskedArray(np.ones(gap.size, np.int8), mask=absent),
    }


def _intention(motion: Motion, rng: np.random.Generator) -> dict[str, np.ndarray]:
    time = motion.time
    decision = np.zeros(time.size, np.int8)
    probability = 0.02 + 0.02 * rng.random(time.size)
    head = smooth_noise(rng, time.size, 0.5, 0.03)
    for start, duration, direction, seen in motion.changes:
        decision[(time >= start - 2.0) & (time <= start + duration)] = direction
        probability[(time >= seen) & (time <= start + duration / 2)] = 0.9
        head[np.abs(time - start + 1.0) < 0.4] = 0.6 * direction
    probability[:179] = np.nan
    return {
        "driver_intention": np.ma.MaskedArray(decision, mask=False),
        "crossing_probability": probability,
        "intention": np.nan_to_num(probability) >= 0.5,
        "head_yaw": head,
        "head_yaw_valid": np.ones(time.size, bool),
    }


def _guidance(
    motion: Motion,
    car: dict[str, np.ndarray],
    rng: np.random.Generator,
    strength: tuple[float, float],
) -> dict[str, np.ndarray]:
    num_rows = motion.time.size
    effort = 3.0 * car["steering_wheel_angle"] + smooth_noise(rng, num_rows, 0.4, 0.1)
    if strength[0] == 0.0:
        return {"driver_torque": effort}
    disputed = _disputed(motion)
    gain = faded_gain(~disputed)
    mode = np.full(num_rows, "lane_keeping", dtype="<U13")
    target = car["lane"].copy()
    for start, duration, direction, trigger in motion.changes:
        rows = (motion.time >= trigger) & (motion.time < start + duration)
        mode[rows] = "lane_changing"
        target[rows] = 0 if direction < 0 else 1
    share = strength[0] * gain
    error = smooth_noise(rng, num_rows, 0.3, 0.2)
    error_rate = np.gradient(error, motion.time) / motion.velocity
    return {
        "driver_torque": (1.0 - 0.6 * share) * effort,
        "estimated_driver_torque": -effort,
        "instructed_torque": effort,
        "applied_torque": np.clip(share * effort, -5.0, 5.0),
        "haptic_gain": gain,
        "lateral_error": error,
        "heading_error_rate": error_rate,
        "guidance_pseudo_work": effort * error_rate,
        "driver_pseudo_work": (1.0 - 0.6 * share) * effort * error_rate,
        "torque_agreement": (1.0 - 0.6 * share) * effort**2 * np.where(disputed, -1, 1),
        "consistent": np.ma.MaskedArray(~disputed, mask=False),
        "mode": mode,
        "target_lane": np.ma.MaskedArray(target, mask=False),
        "target_lateral_position": motion.lateral - 0.1 * error,
    }


def _disputed(motion: Motion) -> NDArray[np.bool_]:
    """Inconsistent for 1.4 s from the crossing of every third lane change."""
    disputed = np.zeros(motion.time.size, bool)
    for start, duration, *_ in motion.changes[::3]:
        elapsed = motion.time - start - duration / 2
        disputed |= (elapsed >= 0.0) & (elapsed < 1.4)
    return disputed


def faded_gain(consistent: NDArray[np.bool_]) -> Signal:
    """Haptic gain after Eqs. (10) to (13): steepness 4 per second, midpoint 1 s."""
    gain = np.ones(consistent.size)
    held, since = 1.0, 10.0
    for row in range(1, consistent.size):
        since += 1.0 / RATE
        if consistent[row] != consistent[row - 1]:
            held, since = gain[row - 1], 0.0
        goal = 1.0 if consistent[row] else 0.0
        gain[row] = held + (goal - held) * (1 + np.tanh(4.0 * (since - 1.0))) / 2
    return gain


def _metadata(condition: str, participant: int, seed: int) -> dict[str, object]:
    factor, duration = CONDITIONS[condition]
    return {
        "version": "0.0.0",
        "seed": seed,
        "participant": participant,
        "condition": condition,
        "strength_factor": factor,
        "change_duration": None if condition == "manual" else duration,
        "method": "manual" if condition == "manual" else "ibhs",
        "car": "default",
        "speed": 70.0 / 3.6,
        "driver": "synthetic",
        "intention_model_hash": "0" * 16,
        "inconsistency_threshold": 0.03,
        "replan_gain": 0.05,
        "torque_limit": 5.0,
        "configuration": {},
        "configuration_hash": "0" * 16,
        "driver_torque_source": "simulated",
        "git_revision": "unknown",
        "driver_kind": "virtual",
        "record_version": 2,
    }
