"""One inconsistency from trigger to recovery: torques, verdict, gain, mode, path."""

from __future__ import annotations

import itertools
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    INK,
    SHADE,
    SIGNAL_COLOURS,
    SMALL,
    Margins,
    new_figure,
    panels,
)
from costeer.study.figures.episodes import Episode, inconsistent_spans

NAME = "inconsistency"
TITLE = "One inconsistency, from trigger to recovery"

_HEIGHTS = (1.5, 1.2, 1.2, 0.7, 1.0, 1.5)
_STATE_COLOURS = {
    "consistent": "#f6f6f6",
    "inconsistent": "#d9d9d9",
    "lane_keeping": "#f6f6f6",
    "lane_changing": "#cfe3f1",
}
_WIDTH_OF_LETTER = 0.0105
"""Of the panel, per letter of a state's name."""


def draw(episode: Episode | None, no_verdict: str = "") -> Exhibit:
    """Draw one inconsistency, or say that there was none.

    Args:
        episode: An inconsistency of the study.
        no_verdict: Why there is no verdict in any trial; empty if there are some.
    """
    if episode is None:
        why = "No verdict was inconsistent in any trial of this study."
        if no_verdict:
            why = f"There is no verdict in this study: {no_verdict}."
        return not_drawn(NAME, TITLE, why)
    figure = new_figure(FULL_WIDTH_MM, 150.0)
    margins = Margins(left=20.0, right=25.0, top=7.0, bottom=10.0, between_rows=3.0)
    grid = panels(figure, len(_HEIGHTS), 1, margins, row_heights=_HEIGHTS)
    axes = [row[0] for row in grid]
    time = episode.columns["time"] - episode.onset
    _torques(axes[0], time, episode)
    _pseudo_works(axes[1], time, episode)
    _gap(axes[2], time, episode)
    _states(axes[3], time, episode)
    _gain(axes[4], time, episode)
    _position(axes[5], time, episode)
    _common(axes, time, episode)
    return Exhibit(NAME, TITLE, _caption(episode), _description(episode), figure)


def _caption(episode: Episode) -> str:
    trigger = (
        f"the trigger came {episode.onset - episode.trigger:.2f} s before it"
        if np.isfinite(episode.trigger)
        else "no trigger preceded it within 8 s"
    )
    recovery = (
        f"the gain was back at 0.95 after {episode.recovery - episode.onset:.2f} s"
        if np.isfinite(episode.recovery)
        else "the gain was not back at 0.95 within what is shown"
    )
    return (
        f"Participant {episode.participant}, condition {episode.condition}. Time from "
        f"the first inconsistent verdict; {trigger}; {recovery}; lowest gain "
        f"{episode.lowest_gain:.3f}. Shaded: verdict inconsistent (torque agreement "
        "negative and the gap of the pseudo-works above its threshold). Guidance "
        "torque is the instructed one, before gain, strength and limit; applied is "
        "what the motor gives. Positive is to the left. Below the re-plan gain a new "
        "plan may be made at every sample, and the mode alternate, until the verdict "
        "turns; the motor gives next to nothing then. Chosen by rule: the first, in "
        "order of participants and conditions, that followed a trigger, led to a "
        "re-plan and recovered, or else the one nearest to that."
    )


def _description(episode: Episode) -> str:
    return (
        "Six stacked signals against time around one inconsistency of participant "
        f"{episode.participant} in {episode.condition}: driver, guidance and applied "
        "torque; the two pseudo-works; their gap against the threshold; verdict and "
        "mode; haptic gain; lateral position and target."
    )


def _torques(axes: Axes, time: NDArray[np.float64], episode: Episode) -> None:
    columns = episode.columns
    lines = {
        "driver": (columns["driver_torque"], SIGNAL_COLOURS["driver"], "-."),
        "guidance": (columns["instructed_torque"], SIGNAL_COLOURS["guidance"], "-"),
        "applied": (columns["applied_torque"], SIGNAL_COLOURS["guidance"], ":"),
    }
    _lines(axes, time, lines)
    _zero(axes)
    axes.set_ylabel("Torque\n[N·m]")


def _pseudo_works(axes: Axes, time: NDArray[np.float64], episode: Episode) -> None:
    columns = episode.columns
    lines = {
        "driver": (columns["driver_pseudo_work"], SIGNAL_COLOURS["driver"], "-."),
        "guidance": (columns["guidance_pseudo_work"], SIGNAL_COLOURS["guidance"], "-"),
    }
    _lines(axes, time, lines)
    _zero(axes)
    axes.set_ylabel("Pseudo-work\n[W]")


def _gap(axes: Axes, time: NDArray[np.float64], episode: Episode) -> None:
    columns = episode.columns
    gap = np.abs(columns["guidance_pseudo_work"] - columns["driver_pseudo_work"])
    threshold = np.full(len(time), episode.threshold)
    lines = {
        "gap": (gap, SIGNAL_COLOURS["gap"], "-"),
        "threshold": (threshold, SIGNAL_COLOURS["gap"], ":"),
    }
    _lines(axes, time, lines)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("Gap\n[W]")


def _states(axes: Axes, time: NDArray[np.float64], episode: Episode) -> None:
    """Two strips, verdict above mode, with the name of each state in it."""
    consistent = np.ma.filled(episode.columns["consistent"], True)
    verdict = np.where(consistent, "consistent", "inconsistent")
    _strip(axes, time, verdict, 1.0)
    _strip(axes, time, episode.columns["mode"], 0.0)
    axes.axhline(1.0, color="white", linewidth=2.0)
    axes.set_ylim(0.0, 2.0)
    axes.set_yticks([0.5, 1.5], ["mode", "verdict"])
    axes.tick_params(axis="y", length=0)
    for side in ("left", "bottom"):
        axes.spines[side].set_visible(False)
    axes.set_ylabel("State\n[–]")


def _strip(
    axes: Axes, time: NDArray[np.float64], states: NDArray[np.str_], floor: float
) -> None:
    edges = [0, *(np.flatnonzero(states[1:] != states[:-1]) + 1), len(states) - 1]
    for start, end in itertools.pairwise(edges):
        name, low, high = str(states[start]), time[start], time[end]
        colour = _STATE_COLOURS.get(name, "white")
        axes.barh(floor, high - low, 1.0, low, align="edge", color=colour)
        text = name.replace("_", " ")
        if high - low > _WIDTH_OF_LETTER * len(text) * (time[-1] - time[0]):
            place = (low + high) / 2.0, floor + 0.47
            axes.text(*place, text, size=SMALL, ha="center", va="center")


def _gain(axes: Axes, time: NDArray[np.float64], episode: Episode) -> None:
    axes.plot(time, episode.columns["haptic_gain"], color=INK)
    axes.set_ylim(0.0, 1.05)
    axes.set_yticks([0.0, 0.5, 1.0])
    axes.set_ylabel("Gain $K_h$\n[–]")


def _position(axes: Axes, time: NDArray[np.float64], episode: Episode) -> None:
    columns = episode.columns
    lines = {
        "car": (columns["lateral_position"], INK, "-"),
        "target": (columns["target_lateral_position"], INK, ":"),
    }
    _lines(axes, time, lines)
    low, high = axes.get_ylim()
    if low < -1.75 < high:
        axes.axhline(-1.75, color=FAINT, linewidth=0.7, linestyle=(0, (6.0, 4.0)))
    axes.set_ylabel("Lateral\nposition [m]")


def _lines(
    axes: Axes,
    time: NDArray[np.float64],
    lines: dict[str, tuple[NDArray[Any], str, str]],
) -> None:
    """Draw signals, named at the right of the panel."""
    for name, (values, colour, line) in lines.items():
        axes.plot(time, values, color=colour, linestyle=line, label=name)
    axes.legend(loc="center left", bbox_to_anchor=(1.005, 0.5))


def _zero(axes: Axes) -> None:
    axes.axhline(0.0, color=FAINT, linewidth=0.5, zorder=0)


def _common(axes: list[Axes], time: NDArray[np.float64], episode: Episode) -> None:
    """Time axis, shading and the moments that matter, the same in every panel."""
    for start, end in inconsistent_spans(episode.columns):
        for panel in axes[:3] + axes[4:]:
            panel.axvspan(
                start - episode.onset,
                end - episode.onset,
                facecolor=SHADE,
                zorder=-1,
                linewidth=0,
            )
    moments = {
        "trigger": episode.trigger,
        "inconsistent": episode.onset,
        "recovered": episode.recovery,
    }
    for name, moment in moments.items():
        if np.isfinite(moment):
            _mark(axes, moment - episode.onset, name)
    for panel in axes:
        panel.set_xlim(time[0], time[-1])
        panel.tick_params(labelbottom=panel is axes[-1])
    axes[0].figure.align_ylabels(axes)
    axes[-1].set_xlabel("Time since the verdict turned inconsistent [s]")


def _mark(axes: list[Axes], moment: float, name: str) -> None:
    # Trigger and onset may be close: their words lean away from each other.
    align: Literal["left", "right"] = "right" if name == "trigger" else "left"
    for panel in axes:
        panel.axvline(moment, color=FAINT, linewidth=0.7, zorder=0)
    axes[0].annotate(
        name,
        xy=(moment, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(0.0, 2.0),
        textcoords="offset points",
        fontsize=SMALL,
        ha=align,
    )
