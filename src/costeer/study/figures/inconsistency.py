"""One inconsistency from trigger to recovery: torques, verdict, gain, mode, path."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.series import Other, say, spans
from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    INK,
    SHADE,
    SIGNAL_COLOURS,
    Margins,
    new_figure,
    panels,
)
from costeer.study.figures.episodes import Episode, inconsistent_spans

NAME = "inconsistency"
TITLE = "One inconsistency, from trigger to recovery"

_HEIGHTS = {
    "torque": 1.5,
    "work": 1.2,
    "gap": 1.2,
    "state": 0.6,
    "gain": 1,
    "path": 1.5,
}
_LABELS = {
    "torque": "Torque\n[N·m]",
    "work": "Pseudo-work\n[W]",
    "gap": "Gap\n[W]",
    "state": "State\n[–]",
    "gain": "Gain $K_h$\n[–]",
    "path": "Lateral\nposition [m]",
}
_STATE = "state"


class Trace(NamedTuple):
    """A line: its panel, its name, how it looks."""

    panel: str
    name: str
    colour: str
    style: str = "-"


_DRIVER, _GUIDANCE, _GAP = (SIGNAL_COLOURS[n] for n in ("driver", "guidance", "gap"))
_TRACES = (
    Trace("torque", "driver", _DRIVER, "-."),
    Trace("torque", "guidance", _GUIDANCE),
    Trace("torque", "applied", _GUIDANCE, ":"),
    Trace("work", "driver", _DRIVER, "-."),
    Trace("work", "guidance", _GUIDANCE),
    Trace("gap", "gap", _GAP),
    Trace("gap", "threshold", _GAP, ":"),
    Trace("state", "inconsistent", FAINT),
    Trace("state", "lane changing", "#7fb2d6"),
    Trace("gain", "gain", INK),
    Trace("path", "car", INK),
    Trace("path", "target", INK, ":"),
)
_SHADED, _MOMENTS = "shaded", "moments"

Values = dict[str, tuple[NDArray[Any], NDArray[Any]]]


def draw(
    episode: Episode | None, no_verdict: str = "", others: Sequence[Episode] = ()
) -> Exhibit:
    """Draw one inconsistency, or say that there was none.

    Args:
        episode: An inconsistency of the study.
        no_verdict: Why there is no verdict in any trial; empty if there are some.
        others: One of each participant, to choose from.
    """
    if episode is None:
        why = "No verdict was inconsistent in any trial of this study."
        if no_verdict:
            why = f"There is no verdict in this study: {no_verdict}."
        return not_drawn(NAME, TITLE, why)
    figure = new_figure(FULL_WIDTH_MM, 150.0)
    margins = Margins(left=20.0, right=25.0, top=4.0, bottom=10.0, between_rows=3.0)
    heights = tuple(_HEIGHTS.values())
    grid = panels(figure, len(heights), 1, margins, row_heights=heights)
    axes = dict(zip(_HEIGHTS, (row[0] for row in grid), strict=True))
    window = _window([episode, *others])
    values = [_values(each, window) for each in others]
    _draw(axes, _values(episode, window), values)
    _limits(axes, window)
    figure.align_ylabels(list(axes.values()))
    chosen = tuple(
        Other(str(each.participant), _caption(each), own)
        for each, own in zip(others, values, strict=True)
    )
    words = _caption(episode)
    return Exhibit(NAME, TITLE, words, _description(), figure, others=chosen)


def _window(episodes: Sequence[Episode]) -> tuple[float, float]:
    """From the earliest start to the latest end, seconds from each onset."""
    starts = [each.window[0] - each.onset for each in episodes]
    ends = [each.window[1] - each.onset for each in episodes]
    return min(starts), max(ends)


def _values(episode: Episode, window: tuple[float, float]) -> Values:
    """All that is drawn of an episode, by key."""
    since = episode.columns["time"] - episode.onset
    shown = (since >= window[0]) & (since <= window[1])
    columns = {name: values[shown] for name, values in episode.columns.items()}
    time, guidance = since[shown], columns["guidance_pseudo_work"]
    changing = columns["mode"] == "lane_changing"
    lines = {
        "torque driver": columns["driver_torque"],
        "torque guidance": columns["instructed_torque"],
        "torque applied": columns["applied_torque"],
        "work driver": columns["driver_pseudo_work"],
        "work guidance": guidance,
        "gap gap": np.abs(guidance - columns["driver_pseudo_work"]),
        "gap threshold": np.full(len(time), episode.threshold),
        "state inconsistent": _flag(~np.ma.filled(columns["consistent"], True), 1.0),
        "state lane changing": _flag(changing, 0.0),
        "gain gain": columns["haptic_gain"],
        "path car": columns["lateral_position"],
        "path target": columns["target_lateral_position"],
    }
    moments = np.array([episode.trigger, episode.recovery]) - episode.onset
    moments = moments[np.isfinite(moments)]
    shaded = np.array(inconsistent_spans(columns)).reshape(-1, 2) - episode.onset
    values: Values = {name: (time, each) for name, each in lines.items()}
    half = 0.001 * (window[1] - window[0])
    values[_SHADED] = shaded[:, 0], shaded[:, 1]
    values[_MOMENTS] = moments - half, moments + half
    for name, panel in itertools.product((_SHADED, _MOMENTS), _HEIGHTS):
        values[f"{panel} {name}"] = values[name]
    return values


def _flag(flags: NDArray[np.bool_], height: float) -> NDArray[np.float64]:
    """A line at that height while a flag holds, until the first row after it."""
    held = flags | np.concatenate(([False], flags[:-1]))
    return np.where(held, height, np.nan)


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
        "negative and the gap of the pseudo-works above its threshold). Upright lines: "
        "trigger, first inconsistent verdict, gain back at 0.95. Guidance torque "
        "is the instructed one, before gain, strength and limit; applied is "
        "what the motor gives. Positive is to the left. Below the re-plan gain a new "
        "plan may be made at every sample, and the mode alternate, until the verdict "
        "turns; the motor gives next to nothing then. The one shown first is chosen by "
        "rule: the first, in order of participants and conditions, that followed a "
        "trigger, led to a re-plan and recovered, or else the one nearest to that."
    )


def _description() -> str:
    return (
        "Six stacked signals against time around one inconsistency: driver, guidance "
        "and applied torque; the two pseudo-works; their gap against the threshold; "
        "verdict and mode; haptic gain; lateral position and target."
    )


def _draw(axes: dict[str, Axes], own: Values, others: Sequence[Values]) -> None:
    """Draw lines and shading; every panel is high enough for all participants."""
    for trace in _TRACES:
        panel, key = axes[trace.panel], f"{trace.panel} {trace.name}"
        look: dict[str, Any] = {"color": trace.colour, "linestyle": trace.style}
        if trace.panel == _STATE:
            look |= {"linewidth": 5.0, "solid_capstyle": "butt"}
        else:
            look |= {"label": trace.name}
        say(panel.plot(*own[key], **look)[0], trace.name, key=key)
        for each in others:
            panel.update_datalim(np.column_stack(each[key]))
    for name, panel in axes.items():
        panel.autoscale_view()
        if name != _STATE:
            spans(panel, *own[_SHADED], SHADE, key=f"{name} {_SHADED}")
        spans(panel, *own[_MOMENTS], FAINT, key=f"{name} {_MOMENTS}")
        panel.axvline(0.0, color=FAINT, linewidth=0.7, zorder=0)
        panel.set_ylabel(_LABELS[name])
        if len(panel.get_legend_handles_labels()[1]) > 1:
            panel.legend(loc="center left", bbox_to_anchor=(1.005, 0.5))


def _limits(axes: dict[str, Axes], window: tuple[float, float]) -> None:
    for name in ("torque", "work"):
        axes[name].axhline(0.0, color=FAINT, linewidth=0.5, zorder=0)
    axes["gap"].set_ylim(bottom=0.0)
    axes["gain"].set_ylim(0.0, 1.05)
    axes["gain"].set_yticks([0.0, 0.5, 1.0])
    states = axes[_STATE]
    states.set_ylim(-0.6, 1.6)
    states.yaxis.tick_right()
    states.set_yticks([0.0, 1.0], ["lane changing", "inconsistent"])
    states.tick_params(axis="y", length=0)
    low, high = axes["path"].get_ylim()
    if low < -1.75 < high:
        line = (0, (6.0, 4.0))
        axes["path"].axhline(-1.75, color=FAINT, linewidth=0.7, linestyle=line)
    *_, last = axes.values()
    for panel in axes.values():
        panel.set_xlim(*window)
        panel.tick_params(labelbottom=panel is last)
    last.set_xlabel("Time since the verdict turned inconsistent [s]")
