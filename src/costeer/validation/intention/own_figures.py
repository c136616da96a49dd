"""Figures of the judged predictor itself: calibration, and how it learned."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.style import (
    COLUMN_WIDTH_MM,
    FAINT,
    FULL_WIDTH_MM,
    INK,
    SHADE,
    Margins,
    new_figure,
    panel_letter,
    panels,
)
from costeer.training import metrics
from costeer.training.verdicts import DriverVerdicts, judged_samples
from costeer.validation.intention.material import Material

CALIBRATION, LEARNING = "calibration", "learning-curves"
_DOTTED = (0.0, (1.0, 1.5))
_BINS = 10
_COLOURS = ("#62B0DE", "#0072B2", "#009E73", "#E69F00", "#D55E00", "#CC79A7")


def draw_calibration(material: Material) -> Exhibit:
    """Draw what was said against what came; call inside `styled`."""
    one = material.assessment.judged
    figure = new_figure(COLUMN_WIDTH_MM, 88.0)
    margins = Margins(left=14.0, right=3.0, top=5.0, bottom=9.0, between_rows=3.0)
    rows = panels(figure, 2, 1, margins, row_heights=(3.2, 1.0))
    upper, lower = rows[0][0], rows[1][0]
    bins = one.judgement.facts["calibration"]
    said = np.array([each["probability"] for each in bins])
    seen = np.array([each["observed"] for each in bins])
    upper.plot([0.0, 1.0], [0.0, 1.0], color=FAINT, linewidth=0.7, linestyle=_DOTTED)
    _driver_band(upper, one.judgement.drivers)
    upper.plot(
        said, seen, "o-", color=INK, markersize=3.5, linewidth=1.2, clip_on=False
    )
    numbers = np.array([each["num_samples"] for each in bins], np.float64)
    edges = np.minimum((said * _BINS).astype(int), _BINS - 1)
    shares = numbers / numbers.sum()
    lower.bar((edges + 0.5) / _BINS, shares, 0.085, color=FAINT)
    lower.set_yscale("log")
    lower.set_ylim(min(1e-4, float(shares.min()) / 2.0), 1.5)
    _calibration_axes(upper, lower)
    error = one.judgement.facts["samples"]["calibration_error"]
    return Exhibit(
        name=CALIBRATION,
        title="Calibration",
        caption=f"{one.title}. Above: share of the samples that a crossing followed "
        "within 3 s, against the probability that was said, in tenths; band: 10 to "
        "90 % of the drivers with at least 30 samples in that tenth. Below: share of "
        f"all samples in each tenth. Mean distance from the diagonal: {error:.4f}.",
        description=f"Points near the diagonal; mean distance {error:.4f}.",
        figure=figure,
    )


def _calibration_axes(upper: Axes, lower: Axes) -> None:
    for axes in (upper, lower):
        axes.set_xlim(0.0, 1.0)
    upper.set_ylim(0.0, 1.02)
    upper.tick_params(labelbottom=False)
    upper.set_ylabel("Observed share [-]")
    lower.set_ylabel("Samples [-]")
    lower.set_xlabel("Probability that was said [-]")
    lower.minorticks_off()


def _driver_band(axes: Axes, drivers: list[DriverVerdicts], fewest: int = 30) -> None:
    """Shade what most drivers have; nothing with too few of them."""
    found: list[list[tuple[float, float]]] = [[] for _ in range(_BINS)]
    for one in drivers:
        for each in metrics.calibration(*judged_samples([one])):
            place = min(int(each.probability * _BINS), _BINS - 1)
            if each.num_samples >= fewest:
                found[place].append((each.probability, each.observed))
    points = [
        (float(np.mean(said)), *np.percentile(seen, [10, 90]))
        for said, seen in (
            zip(*pairs, strict=True) for pairs in found if len(pairs) > 4
        )
    ]
    if points:
        x, low, high = zip(*points, strict=True)
        axes.fill_between(x, low, high, color=SHADE, linewidth=0.0, zorder=0.5)


def draw_learning(material: Material) -> Exhibit:
    """Draw the learning curves in the network's file; call inside `styled`."""
    title = "How the network learned"
    curves = _curves(material.network)
    if not curves:
        lacking = "The file of the predictor holds no learning curves."
        return not_drawn(LEARNING, title, lacking)
    figure = new_figure(FULL_WIDTH_MM, 64.0)
    margins = Margins(left=14.0, right=3.0, top=7.0, between_columns=18.0)
    left, right = panels(figure, 1, 2, margins)[0]
    for place, (hidden, points) in enumerate(curves.items()):
        step, training, validation, area = np.array(points).T
        chosen = hidden == str(material.network.get("hidden_size"))
        colour = INK if chosen else _COLOURS[place % len(_COLOURS)]
        width = 1.5 if chosen else 0.9
        words = f"{hidden} units" + (", chosen" if chosen else "")
        left.plot(step, validation, color=colour, linewidth=width, label=words)
        left.plot(step, training, color=colour, linewidth=0.7, linestyle=_DOTTED)
        right.plot(step, area, color=colour, linewidth=width, label=words)
    left.set_ylabel("Log loss [nat]")
    right.set_ylabel("Area under precision and recall [-]")
    for axes, letter in ((left, "a"), (right, "b")):
        axes.set_xlabel("Training step")
        axes.set_xlim(left=0.0)
        panel_letter(axes, letter)
    left.set_ylim(0.0, _highest(curves))
    right.legend(loc="lower right", title="Hidden size")
    return Exhibit(
        name=LEARNING,
        title=title,
        caption="(a) Log loss on the validation drivers (lines, mean over the variants "
        "with signals taken away) and in training (dotted; its windows are chosen and "
        "weighted, so the two are not on one scale), and (b) area under precision and "
        "recall on the validation drivers with all signals, for each hidden size.",
        description="Losses fall and areas rise over the training steps.",
        figure=figure,
    )


def _curves(network: dict[str, Any]) -> dict[str, list[list[float]]]:
    """Step, training loss, validation loss and area by hidden size, small ones first.

    What stands behind these four in the file is left out.
    """
    curves = network.get("curves", {})
    return {
        hidden: [[float(value) for value in point[:4]] for point in curves[hidden]]
        for hidden in sorted(curves, key=int)
        if curves[hidden]
    }


def _highest(curves: dict[str, list[list[float]]]) -> float:
    """An end of the axis that leaves out the first steps, which tell nothing."""
    late = [max(point[1:3]) for points in curves.values() for point in points[1:]]
    every = [max(point[1:3]) for points in curves.values() for point in points]
    return 1.15 * max(late or every)
