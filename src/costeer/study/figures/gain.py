"""Gain adjustment: the haptic gain fades out and in, by the law and in a record."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from costeer.controller.strength import StrengthParameters, haptic_gain
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.series import say
from costeer.pages.style import (
    COLUMN_WIDTH_MM,
    FAINT,
    FULL_WIDTH_MM,
    INK,
    NORMAL,
    SHADE,
    SMALL,
    STRENGTH_COLOURS,
    Margins,
    new_figure,
    panel_letter,
    panels,
)
from costeer.study.figures.episodes import Episode, inconsistent_spans

NAME = "gain-adjustment"
TITLE = "Gain adjustment"

_SWITCHES = ((0.0, 4.0), (0.0, 1.0))
"""When the verdict turns inconsistent and when back [s]: let run, and interrupted."""
_STYLES = ("-", (0, (4.0, 1.5)))


def draw(episode: Episode | None, replan_gain: float, no_verdict: str = "") -> Exhibit:
    """Draw Eqs. (10) and (11), and one recorded fade where there is one.

    Args:
        episode: An inconsistency of the study.
        replan_gain: Gain below which the system plans anew [-].
        no_verdict: Why there is no verdict in any trial; empty if there are some.
    """
    if no_verdict:
        return not_drawn(NAME, TITLE, f"No gain is adjusted: {no_verdict}.")
    num_panels = 1 if episode is None else 2
    figure = new_figure(COLUMN_WIDTH_MM if num_panels == 1 else FULL_WIDTH_MM, 58.0)
    margins = Margins(left=13.0, top=7.0, between_columns=14.0)
    axes = panels(figure, 1, num_panels, margins)[0]
    _draw_law(axes[0], replan_gain)
    caption = (
        "The law of Eqs. (10) and (11). The verdict turns inconsistent at 0 s and "
        "consistent again after 4 s (solid), or already after 1 s (dashed): the fade "
        "restarts from the gain it has at the switch. "
        f"Dotted: below a gain of {replan_gain:g} the system plans anew."
    )
    if episode is None:
        missing = " No fade was recorded: no verdict in this study was inconsistent."
        return Exhibit(NAME, TITLE, caption + missing, _description(), figure)
    _draw_record(axes[1], episode, replan_gain)
    for panel, letter in zip(axes, "ab", strict=True):
        panel_letter(panel, letter)
    caption = (
        f"(a) {caption} (b) The same as recorded: participant {episode.participant}, "
        f"condition {episode.condition}; time from the first inconsistent verdict. "
        "Shaded: verdict inconsistent."
    )
    return Exhibit(NAME, TITLE, caption, _description(), figure)


def _description() -> str:
    return (
        "Curves of the haptic gain against time. It falls from 1 towards 0 along a "
        "hyperbolic tangent within two seconds of an inconsistent verdict and rises "
        "the same way when the verdict is consistent again."
    )


def _draw_law(axes: Axes, replan_gain: float) -> None:
    time = np.linspace(-1.0, 8.0, 361)
    for (out, back), line in zip(_SWITCHES, _STYLES, strict=True):
        law = gain_over(time, out, back)
        drawn = axes.plot(time, law, color=INK, linestyle=line)
        say(drawn[0], f"consistent after {back - out:g} s")
    _threshold(axes, replan_gain)
    axes.set_title("Law")
    _note(axes, "Eq. (10)", (0.85, 0.40), "right")
    _note(axes, "Eq. (11)", (5.15, 0.40), "left")
    _note(axes, "re-plan below", (7.9, replan_gain + 0.04), "right")
    _gain_axes(axes, -1.0, 8.0)


def gain_over(
    time: NDArray[np.float64], out: float, back: float
) -> NDArray[np.float64]:
    """Gain K_h [-] when the verdict is inconsistent from `out` to `back`.

    Args:
        time: Where to tell the gain [s], shape `(time,)`.
        out: Time of the first inconsistent verdict [s].
        back: Time of the first consistent one after it [s].
    """
    law = StrengthParameters()
    at_switch = float(haptic_gain(law, False, back - out, 1.0))
    gain = [
        1.0
        if t < out
        else float(haptic_gain(law, False, t - out, 1.0))
        if t < back
        else float(haptic_gain(law, True, t - back, at_switch))
        for t in time
    ]
    return np.array(gain)


def _draw_record(axes: Axes, episode: Episode, replan_gain: float) -> None:
    time = episode.columns["time"] - episode.onset
    for start, end in inconsistent_spans(episode.columns):
        axes.axvspan(
            start - episode.onset,
            end - episode.onset,
            facecolor=SHADE,
            zorder=-1,
            linewidth=0,
        )
    colour = STRENGTH_COLOURS[episode.condition.split("-")[0]]
    gain = episode.columns["haptic_gain"]
    say(axes.plot(time, gain, color=colour, linewidth=1.3)[0], "recorded gain")
    _threshold(axes, replan_gain)
    axes.set_title(f"Recorded: participant {episode.participant}, {episode.condition}")
    start, end = episode.window
    _gain_axes(axes, start - episode.onset, end - episode.onset)


def _threshold(axes: Axes, replan_gain: float) -> None:
    axes.axhline(replan_gain, color=FAINT, linewidth=0.7, linestyle=(0, (1.0, 1.5)))


def _note(axes: Axes, text: str, where: tuple[float, float], align: str) -> None:
    axes.text(*where, text, fontsize=SMALL, color=INK, ha=align, va="center")


def _gain_axes(axes: Axes, start: float, end: float) -> None:
    axes.set_xlim(start, end)
    axes.set_ylim(0.0, 1.04)
    axes.set_yticks([0.0, 0.25, 0.5, 0.75, 1.0])
    axes.set_xlabel("Time since the verdict turned inconsistent [s]", size=NORMAL)
    axes.set_ylabel(r"Haptic gain $K_h$ [–]", size=NORMAL)
