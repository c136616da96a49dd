"""The measures as people read them: names, units and digits.

Files hold SI units; figures and report show the angles in degrees. Every place that
shows a measure takes it from here, so that a figure and a table never disagree.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

DEG = 180.0 / math.pi
"""Degrees in a radian."""

SCORE = "0–100"
"""In place of a unit: the range of a score."""

CONFIDENCE = 0.95
"""Level of every interval. Source: assumed, the level of the paper's bar charts."""


class Quantity(NamedTuple):
    """One measure of section III-F as it is shown.

    Attributes:
        name: Column of the table, and name of the figure.
        table: `trials` or `lane_changes`.
        title: In words.
        label: The same as short as an axis needs it.
        unit: As shown.
        factor: Shown value of one unit of the file.
        digits: Decimals shown.
        less: Word for a lower value.
        more: Word for a higher value.
    """

    name: str
    table: str
    title: str
    label: str
    unit: str
    factor: float = 1.0
    digits: int = 2
    less: str = "lower"
    more: str = "higher"


QUANTITIES: tuple[Quantity, ...] = (
    Quantity("sdlp", "trials", "SDLP", "SDLP", "m", digits=3),
    Quantity("swrr", "trials", "Steering wheel reversal rate", "SWRR", "1/min"),
    Quantity(
        "driver_torque_rms",
        "trials",
        "Driver torque RMS",
        "Driver torque RMS",
        "N·m",
        digits=3,
    ),
    Quantity("overshoot", "lane_changes", "Overshoot", "Overshoot", "m", digits=3),
    Quantity(
        "steering_velocity_rms",
        "lane_changes",
        "RMS steering wheel velocity",
        "RMS steering velocity",
        "deg/s",
        factor=DEG,
    ),
    Quantity(
        "peak_steering_angle",
        "lane_changes",
        "Peak steering wheel angle",
        "Peak steering angle",
        "deg",
        factor=DEG,
    ),
    Quantity(
        "duration",
        "lane_changes",
        "Lane change duration",
        "Lane change duration",
        "s",
        less="shorter",
        more="longer",
    ),
)
WORKLOAD: tuple[Quantity, ...] = (
    Quantity("tlx_raw", "trials", "NASA-TLX, raw", "NASA-TLX, raw", SCORE, digits=1),
    Quantity(
        "tlx_weighted",
        "trials",
        "NASA-TLX, weighted",
        "NASA-TLX, weighted",
        SCORE,
        digits=1,
    ),
)
"""Asked of people after every trial; virtual drivers leave these cells empty."""

WORKLOAD_ITEMS: tuple[Quantity, ...] = tuple(
    Quantity(name, "answers", title, title, SCORE, digits=1)
    for name, title in (
        ("mental_demand", "Mental demand"),
        ("physical_demand", "Physical demand"),
        ("temporal_demand", "Temporal demand"),
        ("performance", "Performance"),
        ("effort", "Effort"),
        ("frustration", "Frustration"),
    )
)
"""The six items of the NASA-TLX; more is load, also of performance."""

BY_STRENGTH = ("sdlp", "swrr")
"""Measures of lane keeping, which the paper also compares by strength alone."""


def half_width(values: NDArray[np.float64]) -> float:
    """Return half of Student's interval of a mean; NaN with fewer than two values.

    Args:
        values: What is not finite is left out.
    """
    from scipy.special import stdtrit

    finite = values[np.isfinite(values)]
    if finite.size < 2:
        return math.nan
    quantile = float(stdtrit(finite.size - 1, 0.5 + CONFIDENCE / 2.0))
    return quantile * float(finite.std(ddof=1)) / math.sqrt(finite.size)
