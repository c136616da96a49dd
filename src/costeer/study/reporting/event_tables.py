"""The tables of the report that count events: lane changes, triggers, disputes."""

from __future__ import annotations

import math

import pandas as pd

from costeer.methods.conditions import MANUAL
from costeer.pages.numerals import NOTHING, count, number, percent
from costeer.pages.tables import Table
from costeer.study.material import StudyMaterial, conditions_driven, why_without
from costeer.study.reporting.overview import tallies, total, weighted


def lane_changes_table(material: StudyMaterial) -> Table:
    """Return planned, completed and dropped lane changes per condition."""
    parts = tallies(material)
    changes = material.lane_changes
    assisted = changes[changes["assisted"].astype(bool)].groupby("condition").size()
    rows = []
    for each in (*parts, total(parts)):
        helped = assisted.sum() if each.name == "all" else assisted.get(each.name, 0)
        rows.append(
            (
                each.name,
                count(each.trials),
                count(each.planned),
                count(each.completed),
                percent(each.completed, each.planned),
                count(each.planned - each.completed),
                count(each.dropped),
                NOTHING if each.name == MANUAL else count(float(helped)),
            )
        )
    return Table(
        name="lane-changes",
        title="Lane changes planned, completed and dropped",
        note="Missing: planned minus completed. Dropped: crossings of the line that "
        "make no lane change by the definition; each is named with the dropped data. "
        "Assisted: completed while the guidance followed a lane-change path.",
        header=(
            "Condition",
            "Trials",
            "Planned",
            "Completed",
            "Share",
            "Missing",
            "Dropped",
            "Assisted",
        ),
        rows=tuple(rows),
    )


def durations_table(material: StudyMaterial) -> Table:
    """Return the duration of a lane change under each definition."""
    columns = {
        "duration": "Yaw 0.5 deg",
        "duration_quarter_degree": "Yaw 0.25 deg",
        "duration_one_degree": "Yaw 1 deg",
        "duration_by_speed": "Lateral speed 0.1 m/s",
        "onset_to_crossing": "Onset to crossing",
        "duration_until_settled": "Until settled",
    }
    changes = material.lane_changes
    known = {name: title for name, title in columns.items() if name in changes}
    rows = [
        (name, *(_median_text(changes, name, column, 2) for column in known))
        for name in conditions_driven(material)
    ]
    return Table(
        name="durations",
        title="Lane change duration by definition [s]",
        note="Median over lane changes, below it the 10th and 90th percentile. The "
        "tests use the first column; onset is a lateral speed of 0.1 m/s. Until "
        "settled: from the start by yaw until the yaw stays within 0.3 deg for 2 s.",
        header=("Condition", *known.values()),
        rows=tuple(rows),
    )


def _median_text(table: pd.DataFrame, name: str, column: str, digits: int) -> str:
    return spread_text(table.loc[table["condition"] == name, column], digits)


def spread_text(column: pd.Series, digits: int) -> str:
    """Return the median, below it the 10th and 90th percentile; or a dash."""
    values = column.dropna()
    if values.empty:
        return NOTHING
    low, middle, high = (float(values.quantile(q)) for q in (0.1, 0.5, 0.9))
    return f"{number(middle, digits)}\n{number(low, digits)} to {number(high, digits)}"


def detection_table(material: StudyMaterial) -> Table:
    """Return triggers, missed lane changes and lead times per condition."""
    counted = {
        "num_triggers": "Triggers",
        "num_true_triggers": "True",
        "num_early_triggers": "Early",
        "num_false_triggers": "False",
        "num_missed": "Missed",
    }
    rows = []
    for name in conditions_driven(material):
        trials = material.trials[material.trials["condition"] == name]
        known = trials.dropna(subset=["num_triggers"])
        distance = float(known["distance"].sum()) / 1000.0
        sums = [float(known[column].sum()) for column in counted]
        rates = [each / distance if distance > 0.0 else math.nan for each in sums[3:]]
        cells = [count(each) if len(known) else NOTHING for each in sums]
        leads = material.lane_changes["detection_lead_time"]
        seen = material.lane_changes[leads > 0.0]
        lead = _median_text(seen, name, "detection_lead_time", 2)
        rows.append((name, *cells, *(number(each, 3) for each in rates), lead))
    return Table(
        name="detection",
        title="Triggers of the intention inference",
        note="True: the driver crosses to that side on purpose within 3 s; early: "
        "within 3 to 5 s; false: else. Triggers within 1 s count once. Lead time [s] "
        "from the "
        "first trigger to the crossing, of lane changes that were announced: median, "
        f"below it the 10th and 90th percentile.{not_judged(material)}",
        header=(
            "Condition",
            *counted.values(),
            "False per km",
            "Missed per km",
            "Lead time",
        ),
        rows=tuple(rows),
    )


def not_judged(material: StudyMaterial) -> str:
    """Say why nothing is counted under assistance; empty if something may be."""
    silent = why_without(material, "num_triggers")
    return f" Under assistance nothing is counted: {silent}." if silent else ""


def inconsistencies_table(material: StudyMaterial) -> Table | None:
    """Return inconsistencies and their course per condition; None if none is judged."""
    rows = [
        _inconsistency_row(name, known)
        for name in conditions_driven(material)
        if not (known := _with_verdict(material, name)).empty
    ]
    if not rows:
        return None
    return Table(
        name="inconsistencies",
        title="Inconsistencies between driver and guidance",
        note="Means over inconsistencies, lowest gain over all. Recovery: from the "
        "first inconsistent verdict until the gain is back at 0.95. Frozen: time with "
        "the "
        "gain half-way and nearly constant.",
        header=(
            "Condition",
            "Number",
            "Per lane change",
            "Inconsistent [s]",
            "Lowest gain [–]",
            "Recovery [s]",
            "Flips of verdict",
            "Frozen [s]",
        ),
        rows=tuple(rows),
    )


def _with_verdict(material: StudyMaterial, name: str) -> pd.DataFrame:
    trials = material.trials[material.trials["condition"] == name]
    return trials.dropna(subset=["num_inconsistencies"])


def _inconsistency_row(name: str, known: pd.DataFrame) -> tuple[str, ...]:
    amount = float(known["num_inconsistencies"].sum())
    changes = float(known["num_lane_changes"].sum())
    return (
        name,
        count(amount),
        number(amount / changes if changes else math.nan, 3),
        number(weighted(known, "inconsistency_duration"), 2),
        number(float(known["inconsistency_gain_minimum"].min()), 3),
        number(weighted(known, "recovery_time"), 2),
        number(weighted(known, "verdict_flips"), 1),
        number(weighted(known, "frozen_time"), 2),
    )


def driving_table(material: StudyMaterial) -> Table:
    """Return speed, lane keeping and departures per condition."""
    rows = []
    for name in conditions_driven(material):
        trials = material.trials[material.trials["condition"] == name]
        rows.append(
            (
                name,
                number(float(trials["mean_speed"].mean()) * 3.6, 1),
                number(float(trials["lane_keeping_duration"].sum()) / 60.0, 1),
                count(float(trials["num_lane_departures"].sum())),
                number(float(trials["line_crossing_time_minimum"].min()), 2),
                number(float(trials["line_crossing_time_median"].median()), 1),
                count(float(trials["num_events"].sum())),
            )
        )
    return Table(
        name="driving",
        title="Driving",
        note="Time to lane crossing in lane keeping: the smallest, and the median of "
        "the trials' medians. Departures: a wheel over a line outside a lane change.",
        header=(
            "Condition",
            "Mean speed [km/h]",
            "Lane keeping [min]",
            "Lane departures",
            "Smallest time to crossing [s]",
            "Median time to crossing [s]",
            "Overtaking events",
        ),
        rows=tuple(rows),
    )
