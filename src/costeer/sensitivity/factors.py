"""What is varied, between which bounds and why, and what is measured."""

from __future__ import annotations

from typing import NamedTuple

STRENGTH, DURATION = "strength_factor", "change_duration"
"""Factors that a trial's condition decides, not a parameter by name."""


class Factor(NamedTuple):
    """A parameter of the guidance that is varied.

    Attributes:
        name: In the paper's letters or words.
        place: Dotted name of the parameter, as of `--set`.
        low: Least value, in its unit.
        high: Largest value.
        usual: Value of the published study.
        unit: Of all three.
        source: Of the bounds.
        whole: Whether only whole numbers are values.
    """

    name: str
    place: str
    low: float
    high: float
    usual: float
    unit: str
    source: str
    whole: bool = False


FACTORS = (
    Factor(
        "δ",
        "consistency.inconsistency_threshold",
        0.0114,
        0.046,
        0.023,
        "W",
        "decision 6: the 99.9th percentile of agreeing runs itself, and twice δ",
    ),
    Factor(
        "γ", "strength.midpoint", 0.5, 2.0, 1.0, "s", "half and twice the paper's 1 s"
    ),
    Factor(
        "λ", "strength.steepness", 2.0, 8.0, 4.0, "1/s", "half and twice the paper's 4"
    ),
    Factor("strength", STRENGTH, 0.4, 1.0, 1.0, "-", "Table IV, weak to strong"),
    Factor("duration", DURATION, 4.0, 8.0, 6.0, "s", "Table IV, rapid to gentle"),
    Factor(
        "preview time",
        "preview.preview_time",
        1.0,
        2.0,
        1.5,
        "s",
        "assumed: a third about two public tunings, 1.4 and 1.5 s",
    ),
    Factor(
        "hold time",
        "consistency.hold_time",
        0.0,
        0.5,
        0.0,
        "s",
        "assumed: none, as printed, to what benchmarks/hold_time.py tries",
    ),
    Factor(
        "hands-on threshold",
        "consistency.hands_on_threshold",
        0.05,
        0.3,
        0.1,
        "N·m",
        "assumed: half to three times what is above a torque sensor's noise",
    ),
    Factor(
        "trigger samples",
        "inference.trigger_samples",
        1.0,
        30.0,
        3.0,
        "-",
        "assumed: one sample to half a second",
        whole=True,
    ),
)


class Aim(NamedTuple):
    """A measure of which the indices are computed.

    Attributes:
        name: As in `trials.csv` or `lane_changes.csv`.
        title: In words, with the unit.
        of_changes: Whether it is the mean over a trial's lane changes.
        is_better: -1 if less is better, +1 if more is.
    """

    name: str
    title: str
    of_changes: bool
    is_better: int


AIMS = (
    Aim("sdlp", "SDLP [m]", False, -1),
    Aim("swrr", "Reversal rate [1/min]", False, -1),
    Aim("driver_torque_rms", "Driver torque RMS [N·m]", False, -1),
    Aim("overshoot", "Overshoot [m]", True, -1),
    Aim("steering_velocity_rms", "Wheel rate RMS in lane changes [rad/s]", True, -1),
    Aim("peak_steering_angle", "Peak wheel angle in lane changes [rad]", True, -1),
    Aim("num_inconsistencies", "Inconsistencies a trial [-]", False, -1),
    Aim("false_triggers_per_km", "False triggers [1/km]", False, -1),
    Aim("detection_lead_time", "Detection lead time [s]", False, 1),
)
