"""Signals of one participant around one lane change, manual beside assisted."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from costeer.methods.conditions import MANUAL, condition
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.pages.series import Other, say, spans
from costeer.pages.style import (
    FAINT,
    FULL_WIDTH_MM,
    SHADE,
    STRENGTH_COLOURS,
    Margins,
    new_figure,
    panels,
)
from costeer.records.record import read_record
from costeer.study.crossings import RIGHT
from costeer.study.definitions import MeasureParameters
from costeer.study.figures.colours import condition_colour
from costeer.study.figures.episodes import falls, rises, to_choose
from costeer.study.lanes import centre, lines
from costeer.study.material import StudyMaterial
from costeer.study.people import Who
from costeer.study.quantities import DEG

_BEFORE, _AFTER = 8.0, 8.0
"""Shown around the crossing [s]. Source: assumed; the longest planned change is 8 s."""

_EVERY = 2
"""Rows drawn, one of so many: 30 Hz is finer than a line is wide."""


class Signal(NamedTuple):
    """One row of panels: a column of the record, its label, shown value per unit."""

    column: str
    label: str
    factor: float = 1.0


SIGNALS = (
    Signal("lateral_position", "Lateral\nposition [m]"),
    Signal("steering_wheel_angle", "Steering wheel\nangle [deg]", DEG),
    Signal("driver_torque", "Driver\ntorque [N·m]"),
    Signal("applied_torque", "Guidance\ntorque [N·m]"),
    Signal("haptic_gain", "Haptic gain\n$K_h$ [–]"),
    Signal("head_yaw", "Head yaw\n[–]"),
    Signal("crossing_probability", "Crossing\nprobability [–]"),
)
_ONLY_ASSISTED = ("applied_torque", "haptic_gain")
_UNIT_RANGE = ("haptic_gain", "crossing_probability")
_SHADED = "lane changing"

Values = dict[str, tuple[NDArray[np.float64], NDArray[Any]]]


class Moment(NamedTuple):
    """One lane change of one trial: time since the crossing [s], and the columns."""

    time: NDArray[np.float64]
    columns: dict[str, NDArray[Any]]  # of several element types


def file_name(strength: str) -> str:
    """Return the stem of the figure's file."""
    return f"signals-{strength}"


def title(strength: str) -> str:
    """Return the title of the figure."""
    return f"Signals of one participant, {strength}"


def draw(material: StudyMaterial, strength: str) -> Exhibit:
    """Draw the conditions of one strength, with manual in grey behind each."""
    name, shown_title = file_name(strength), title(strength)
    participant = _most_complete(material, strength)
    moments = {} if participant is None else _moments(material, participant, strength)
    assisted = [key for key in moments if key != MANUAL]
    if participant is None or not assisted:
        lacking = f"No trial with {strength} guidance holds a lane change to the right."
        return not_drawn(name, shown_title, lacking)
    shown = _told([moments[key] for key in assisted])
    figure = new_figure(FULL_WIDTH_MM, 178.0 / len(SIGNALS) * len(shown))
    margins = Margins(left=18.0, top=10.0, bottom=10.0, between_columns=5.0)
    grid = panels(figure, len(shown), len(assisted), margins)
    others = {
        each: _values(_moments(material, each, strength), assisted)
        for each in to_choose(material.records)
    }
    own = _values(moments, assisted)
    for column, key in enumerate(assisted):
        axes = dict(zip(shown, (row[column] for row in grid), strict=True))
        _draw_column(axes, key, own, list(others.values()))
    for signal, row in zip(shown, grid, strict=True):
        _share_range(row, signal, material.road)
    figure.align_ylabels([row[0] for row in grid])
    handles = _legend(strength, MANUAL in moments)
    figure.legend(handles=handles, ncols=len(handles), loc="upper right")
    left_out = _left_out(shown)
    caption = _caption(participant, strength, MANUAL in moments) + left_out
    chosen = tuple(
        Other(str(who), _caption(who, strength, _has_manual(each)) + left_out, each)
        for who, each in others.items()
        if each
    )
    description = _description(strength)
    return Exhibit(name, shown_title, caption, description, figure, others=chosen)


def _values(moments: dict[str, Moment], assisted: list[str]) -> Values:
    """All that is drawn of a participant, by panel and what it is."""
    values: Values = {}
    for key in assisted:
        for signal in SIGNALS:
            for name in (key, MANUAL):
                if name in moments:
                    y = moments[name].columns[signal.column] * signal.factor
                    values[f"{signal.column} {key} {name}"] = (moments[name].time, y)
            if key in moments:
                shaded = _changing(moments[key])
                values[f"{signal.column} {key} {_SHADED}"] = shaded
    return values


def _has_manual(values: Values) -> bool:
    return any(key.endswith(f" {MANUAL}") for key in values)


def _changing(moment: Moment) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Starts and ends of the mode lane changing [s]."""
    changing = moment.columns["mode"] == "lane_changing"
    return moment.time[rises(changing)], moment.time[falls(changing)]


def _told(moments: list[Moment]) -> list[Signal]:
    """The signals that say something in one of these moments."""
    return [
        signal
        for signal in SIGNALS
        if any(np.isfinite(each.columns[signal.column]).any() for each in moments)
    ]


def _left_out(shown: list[Signal]) -> str:
    names = [signal.column for signal in SIGNALS if signal not in shown]
    return f" Undefined throughout, not drawn: {', '.join(names)}." if names else ""


def _caption(participant: Who, strength: str, with_manual: bool) -> str:
    manual = (
        "Grey: the same participant's manual drive. "
        if with_manual
        else "This participant has no manual trial to compare with. "
    )
    return (
        f"Participant {participant}, the first lane change to the right of each trial "
        f"with {strength} guidance; time from the crossing of the lane line. {manual}"
        "Shaded: mode lane changing. Guidance torque is what the motor gives. Left is "
        "positive; lateral position is measured from the left lane's centre, dashed is "
        "a line between two lanes. The one shown first is chosen by rule: the first "
        "participant with the most conditions driven."
    )


def _description(strength: str) -> str:
    return (
        "Signals of one participant against time, a column of panels "
        f"for each duration of {strength} guidance, each over the manual drive."
    )


def _most_complete(material: StudyMaterial, strength: str) -> Who | None:
    """First participant with the most trials of this strength and manual."""
    wanted = (strength, MANUAL)
    keys = [key for key in material.records if condition(key[1]).strength in wanted]
    counts = {each: sum(key[0] == each for key in keys) for each, _ in keys}
    return max(counts, key=lambda each: counts[each], default=None)


def _moments(
    material: StudyMaterial, participant: Who, strength: str
) -> dict[str, Moment]:
    """The first lane change to the right of each trial of this strength and manual."""
    changes = material.lane_changes
    chosen = changes[
        (changes["participant"] == participant) & (changes["direction"] == RIGHT)
    ]
    crossings = chosen.groupby("condition")["crossing_time"].min()
    return {
        key: _moment(path, float(crossings[key]))
        for (who, key), path in material.records.items()
        if who == participant
        and condition(key).strength in (strength, MANUAL)
        and key in crossings.index
    }


def _moment(path: Path, crossing: float) -> Moment:
    names = [signal.column for signal in SIGNALS]
    record = read_record(path, [*names, "mode"])
    time = record.columns["time"] - crossing
    shown = (time >= -_BEFORE) & (time <= _AFTER)
    columns = {name: values[shown][::_EVERY] for name, values in record.columns.items()}
    return Moment(time=time[shown][::_EVERY], columns=columns)


def _draw_column(
    axes: dict[Signal, Axes], key: str, own: Values, others: list[Values]
) -> None:
    """Draw one condition; every panel is high enough for all participants."""
    *_, last = axes.values()
    colours = {MANUAL: STRENGTH_COLOURS[MANUAL], key: condition_colour(key)}
    for signal, panel in axes.items():
        place = f"{signal.column} {key}"
        spans(panel, *own[f"{place} {_SHADED}"], SHADE, key=f"{place} {_SHADED}")
        for name, colour in colours.items():
            line = f"{place} {name}"
            if line not in own or (name == MANUAL and signal.column in _ONLY_ASSISTED):
                continue
            say(panel.plot(*own[line], color=colour)[0], name, key=line)
            for each in others:
                panel.update_datalim(np.column_stack(each.get(line, ((), ()))))
        panel.autoscale_view()
        panel.axvline(0.0, color=FAINT, linewidth=0.5, zorder=0)
        panel.set_xlim(-_BEFORE, _AFTER)
        panel.set_xticks([-8, -4, 0, 4, 8])
        panel.tick_params(labelbottom=panel is last)
    chosen = condition(key)
    next(iter(axes.values())).set_title(
        f"{chosen.duration} ({chosen.change_duration:g} s)"
    )
    last.set_xlabel("Time from crossing [s]")


def _lane_ticks(road: MeasureParameters) -> list[float]:
    """Centres of the lanes; of two lanes also the line between them [m]."""
    ticks = [centre(road, lane) for lane in range(int(road.num_lanes))]
    return sorted([*ticks, *(-line for line in lines(road) if len(ticks) == 2)])


def _share_range(row: list[Axes], signal: Signal, road: MeasureParameters) -> None:
    """Give the panels of a row one range, and only the first its label and numbers."""
    if signal.column in _UNIT_RANGE:
        low, high = -0.03, 1.06
        row[0].set_yticks([0.0, 0.5, 1.0])
    else:
        if signal.column == "lateral_position":
            row[0].set_yticks(_lane_ticks(road))
        low = min(panel.get_ylim()[0] for panel in row)
        high = max(panel.get_ylim()[1] for panel in row)
    for panel in row:
        panel.set_yticks(row[0].get_yticks())
        panel.set_ylim(low, high)
        panel.tick_params(labelleft=panel is row[0])
        if signal.column == "lateral_position":
            for line in lines(road):
                panel.axhline(-line, color=FAINT, linewidth=0.7, linestyle=(0, (6, 4)))
    row[0].set_ylabel(signal.label)


def _legend(strength: str, with_manual: bool) -> list[Line2D]:
    manual = [Line2D([], [], color=STRENGTH_COLOURS[MANUAL], label=MANUAL)]
    assisted = Line2D(
        [], [], color=STRENGTH_COLOURS[strength], label=f"{strength} guidance"
    )
    return (manual if with_manual else []) + [assisted]
