"""What false and missed triggers cost, beside crossings that were announced."""

from __future__ import annotations

import pandas as pd

from costeer.methods.conditions import MANUAL
from costeer.pages.numerals import NOTHING, count, interval, number
from costeer.pages.tables import Table
from costeer.study.definitions import DEFAULTS
from costeer.study.detection import EARLY, FALSE, TRUE
from costeer.study.material import StudyMaterial, conditions_driven
from costeer.study.rates import poisson_interval
from costeer.study.reporting.event_tables import not_judged, spread_text
from costeer.study.trigger_episodes import MISSED

EVENTS = {
    FALSE: "false",
    MISSED: "missed",
    EARLY: "early",
    TRUE: "in time",
}
"""Kinds of `triggers.csv` as the table calls them."""

_ALL = "all assisted"
_UNIT = 100.0
"""Rates are per so many kilometres."""

_SPREADS = {
    "deviation": ("Deviation [m]", 2),
    "peak_driver_torque": ("Peak driver torque [N·m]", 2),
    "driver_torque_rms": ("Driver torque RMS [N·m]", 2),
    "peak_opposing_torque": ("Peak opposing torque [N·m]", 2),
    "gain_minimum": ("Lowest gain [–]", 2),
    "time_to_recover": ("Gain back after [s]", 1),
    "time_to_settle": ("Settled after [s]", 1),
}
_COUNTS = {
    "Left lane": ("left_lane",),
    "Conflict, new plan": ("inconsistent", "replanned"),
}


def trigger_costs_table(material: StudyMaterial) -> Table | None:
    """Return what each kind of trigger and crossing cost; None if nobody measured."""
    if material.triggers is None:
        return None
    events = counted_once(material.triggers)
    driven = conditions_driven(material)
    assisted = tuple(name for name in driven if name != MANUAL)
    parts: list[tuple[str, tuple[str, ...]]] = [(name, (name,)) for name in driven]
    parts += [(_ALL, assisted)] if len(assisted) > 1 else []
    rows = [
        (title, *cells)
        for title, names in parts
        for cells in _condition_rows(material, events, names)
    ]
    return Table(
        name="trigger-costs",
        title="What false and missed triggers cost",
        note=_NOTE + not_judged(material),
        header=(
            "Condition",
            "Event",
            "Number",
            f"Per {_UNIT:g} km",
            *(title for title, _ in _SPREADS.values()),
            *_COUNTS,
        ),
        rows=tuple(rows),
        num_labels=2,
    )


_NOTE = (
    "False triggers; crossings that the system missed, announced early and announced "
    "in time. Median, below it the 10th and 90th percentile. A false trigger is "
    f"followed for {DEFAULTS.episode_duration:g} s, or until the next trigger or "
    "intended lane change; a crossing from start to end of its lane change, counted "
    "once, by its first trigger. Deviation: the largest from the centre of the lane "
    "that the driver meant to keep; of a crossing, the overshoot. Opposing: guidance "
    "applied while it disagrees with the driver. Gain back: after the last "
    "inconsistent verdict, where there is one. Settled: straight and near the centre "
    "of the meant lane, the guidance aiming at it. Both from the start. Conflict: in "
    "how many a verdict was inconsistent, and in how many the gain then fell below "
    "that of re-planning, of how many. A crossing that became no completed lane change "
    "has no costs: it counts in Number and not in these columns. Manual: nothing "
    "follows a trigger, so the costs "
    f"are what driving is without guidance. Per {_UNIT:g} km: in brackets the exact "
    "95 % interval of a Poisson count; where nothing was counted its upper end, "
    "-ln(0.025) over the distance."
)


def counted_once(triggers: pd.DataFrame) -> pd.DataFrame:
    """Return false triggers, and each intended crossing by its first trigger.

    Args:
        triggers: Rows of `triggers.csv`, those of a trial in order of time.
    """
    false = triggers["kind"] == FALSE
    same = triggers.duplicated(["participant", "condition", "crossing_time"])
    kept = triggers[false | ~same]
    beyond = kept["largest_deviation"].where(kept["kind"] == FALSE, kept["overshoot"])
    return kept.assign(deviation=beyond)


def _condition_rows(
    material: StudyMaterial, events: pd.DataFrame, names: tuple[str, ...]
) -> list[tuple[str, ...]]:
    """The rows of these conditions together; none where triggers are not judged."""
    trials = material.trials[material.trials["condition"].isin(names)]
    judged = trials.dropna(subset=["num_triggers"])
    distance = float(judged["distance"].sum()) / 1000.0
    own = events[events["condition"].isin(names)]
    if not distance > 0.0:
        return []
    return [
        (title, *_cells(own[own["kind"] == kind], kind, distance))
        for kind, title in EVENTS.items()
    ]


def _cells(events: pd.DataFrame, kind: str, distance: float) -> tuple[str, ...]:
    """Number, rate and costs of one kind in so many kilometres."""
    rate = NOTHING if kind == TRUE else rate_text(len(events), distance)
    spreads = (spread_text(events[k], digits) for k, (_, digits) in _SPREADS.items())
    shares = (_holds(events, names) for names in _COUNTS.values())
    return (count(len(events)), rate, *spreads, *shares)


def rate_text(amount: int, distance: float) -> str:
    """Return events per 100 km with their interval, or how rare they are at most.

    Args:
        amount: Events counted.
        distance: In which they were counted [km].
    """
    low, high = (end * _UNIT for end in poisson_interval(amount, distance))
    if amount == 0:
        return f"none in {number(distance, 1)} km\nat most {number(high, 2)}"
    return f"{number(amount / distance * _UNIT, 2)}\n{interval(low, high, 2)}"


def _holds(events: pd.DataFrame, names: tuple[str, ...]) -> str:
    """In how many events each of these holds, of those of which it is known."""
    known = events[list(names)].dropna()
    if known.empty:
        return NOTHING
    amounts = (count(float(known[name].astype(bool).sum())) for name in names)
    return f"{', '.join(amounts)}\nof {len(known)}"
