"""Tables of what only some scenarios have: contacts, other cars, zones."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from costeer.pages.numerals import NOTHING, count
from costeer.pages.tables import Table
from costeer.study.material import StudyMaterial, conditions_driven
from costeer.study.quantities import DEG
from costeer.study.reporting.event_tables import spread_text
from costeer.study.scenario_measures import WHOLE_COURSE
from costeer.study.traffic import CONTACTS

_CONTACTS = dict(zip(CONTACTS, ("Strip", "Barrier", "Car"), strict=True))

_NEAR = {
    "time_to_collision_minimum": ("Least TTC [s]", 1.0, 1),
    "time_to_collision_15th_percentile": ("TTC, 15th percentile [s]", 1.0, 1),
    "time_headway_mean": ("Mean headway [s]", 1.0, 2),
    "lead_time_gap": ("Lead gap [s]", 1.0, 2),
    "lag_time_gap": ("Lag gap [s]", 1.0, 2),
}

_IN_ZONES = {
    "sdlp": ("SDLP [m]", 1.0, 3),
    "swrr": ("SWRR [1/min]", 1.0, 2),
    "driver_torque_rms": ("Driver torque RMS [N·m]", 1.0, 3),
    "steering_velocity_rms": ("Steering velocity RMS [deg/s]", DEG, 2),
    "steering_beyond_curve_rms": ("Angle beyond curve, RMS [deg]", DEG, 2),
    "time_to_collision_minimum": ("Least TTC [s]", 1.0, 1),
}


def contacts_table(material: StudyMaterial) -> Table | None:
    """Return contacts, nearness and accepted gaps per condition; None without any."""
    if material.scenario is None:
        return None
    whole = material.scenario[material.scenario["zone"] == WHOLE_COURSE]
    rows = []
    for name in conditions_driven(material):
        own = whole[whole["condition"] == name]
        touched = [count(float(_values(own, each).sum())) for each in _CONTACTS]
        rows.append((name, *touched, *_spreads(own, _NEAR)))
    titles = (title for title, *_ in _NEAR.values())
    return Table(
        name="contacts",
        title="Contacts, nearness and accepted gaps",
        note="Contacts are counts over all trials. The others are medians over trials, "
        "or over lane changes for the gaps, below them the 10th and 90th percentile. "
        "TTC: time to collision.",
        header=("Condition", *_CONTACTS.values(), *titles),
        rows=tuple(rows),
    )


def zones_table(material: StudyMaterial) -> Table | None:
    """Return measures of each zone of the scenario per condition; None without any."""
    if material.scenario is None:
        return None
    table = material.scenario
    zones = [each for each in table["zone"].unique() if each != WHOLE_COURSE]
    if not zones:
        return None
    rows = [
        (zone, name, *_spreads(own, _IN_ZONES))
        for zone in zones
        for name in conditions_driven(material)
        for own in [table[(table["zone"] == zone) & (table["condition"] == name)]]
    ]
    titles = (title for title, *_ in _IN_ZONES.values())
    return Table(
        name="zones",
        title="Measures of each zone",
        note="Medians over trials, below them the 10th and 90th percentile. Reversals "
        "and steering velocity are of the wheel's angle as it is; the angle beyond "
        "the curve is less what the road's curvature asks for.",
        header=("Zone", "Condition", *titles),
        rows=tuple(rows),
        num_labels=2,
    )


def _values(rows: pd.DataFrame, measure: str) -> pd.Series:
    return rows.loc[rows["measure"] == measure, "value"]


def _spreads(
    rows: pd.DataFrame, wanted: dict[str, tuple[str, float, int]]
) -> Sequence[str]:
    """Median and percentiles of each measure; a dash where it is not defined."""
    return [
        spread_text(scale * _values(rows, name), digits) or NOTHING
        for name, (_, scale, digits) in wanted.items()
    ]
