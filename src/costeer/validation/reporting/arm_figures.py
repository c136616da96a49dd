"""The arms of the drivers beside the range of people's arms."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from costeer.pages.exhibit import Exhibit
from costeer.pages.numerals import percent
from costeer.pages.style import FULL_WIDTH_MM, SMALL, Margins, new_figure, panels
from costeer.validation.arms import PUBLISHED, ArmTest, arms_in_range
from costeer.validation.look import HUMAN, LINE, OURS

NAME = "arms"

_PERCENTILES = (5.0, 50.0, 95.0)
_MARGINS = Margins(left=14.0, right=3.0, top=8.0, bottom=10.0, between_columns=6.0)


def draw_arms(tests: Sequence[ArmTest]) -> Exhibit:
    """Draw the admittance of each task over its range; call inside `styled`."""
    figure = new_figure(FULL_WIDTH_MM, 66.0)
    (row,) = panels(figure, 1, len(tests), _MARGINS)
    for axes, test in zip(row, tests, strict=True):
        _task(axes, test)
        axes.sharey(row[0])
        axes.tick_params(labelleft=axes is row[0])
    row[0].set_ylabel("Admittance [rad/(N·m)]")
    row[0].legend(loc="lower left")
    inside = ", ".join(
        f"{test.task} {percent(float(arms_in_range(test).mean()), 1.0)}"
        for test in tests
    )
    return Exhibit(
        name=NAME,
        title="How far the arms give way",
        caption="Magnitude of the admittance of hands and arms at the wheel that a "
        f"motor shakes. Of all drivers and frequencies within the range: {inside}.",
        description="Admittance over frequency from 0.1 to 10 Hz, flat at low and "
        f"falling at high frequencies, per task; within the range: {inside}.",
        figure=figure,
    )


def _task(axes: Axes, test: ArmTest) -> None:
    band = PUBLISHED[test.task]
    low, middle, high = np.percentile(np.abs(test.admittance), _PERCENTILES, axis=0)
    axes.fill_between(
        test.frequency,
        band.low,
        band.high,
        color=HUMAN,
        alpha=0.22,
        lw=0.0,
        label="people, assumed",
    )
    axes.fill_between(
        test.frequency,
        low,
        high,
        color=OURS,
        alpha=0.8,
        lw=0.0,
        label="drivers, 5 to 95 %",
    )
    axes.plot(test.frequency, middle, color=LINE, label="drivers, median")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xticks([0.1, 1.0, 10.0], ["0.1", "1", "10"])
    axes.set_xlabel("Frequency [Hz]")
    axes.set_title(test.task, size=SMALL + 1.0)
