"""What people and virtual drivers look like in every figure of the validation."""

from __future__ import annotations

import math

from matplotlib.axes import Axes

from costeer.base.array import Real
from costeer.pages.style import INK, SIGNAL_COLOURS

HUMAN = SIGNAL_COLOURS["driver"]
"""People, and ranges from people."""

OURS = "#a8a8a8"
"""Virtual drivers as an area; as a line they are in ink."""

LINE = INK

_LEAST_BINS = 6


def human_range(axes: Axes, low: Real, high: Real) -> None:
    """Shade a range of people across the panel; nothing without a range."""
    if math.isfinite(low) and math.isfinite(high):
        axes.axvspan(low, high, color=HUMAN, alpha=0.22, lw=0.0, zorder=0)


def num_bins(amount: int, most: int) -> int:
    """Bins of a histogram of so many values: few where there are few."""
    return max(_LEAST_BINS, min(most, round(2.0 * math.sqrt(amount))))


def no_counts(axes: Axes) -> None:
    """Leave out the axis that counts: only the shape is of interest."""
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
