"""How the study was made: settings, versions, thresholds, order, as tables."""

from __future__ import annotations

import json

from costeer.pages.numerals import NOTHING, listed, number
from costeer.pages.tables import Table
from costeer.study.definitions import DEFAULTS
from costeer.study.material import StudyMaterial
from costeer.study.quantities import DEG

_SHOWN_ELSEWHERE = ("order", "conditions")
_PER_TRIAL = (
    "version",
    "git_revision",
    "seed",
    "method",
    "car",
    "driver",
    "driver_torque_source",
    "intention_model_hash",
    "inconsistency_threshold",
    "replan_gain",
    "torque_limit",
)
_MOST_VALUES = 6


def settings_table(material: StudyMaterial) -> Table:
    """Return the configuration of `study.yaml`."""
    configuration = material.study.configuration
    rows = [("conditions", listed(list(configuration.get("conditions", ("–",)))))]
    rows += [
        (str(name), _text(value))
        for name, value in configuration.items()
        if name not in _SHOWN_ELSEWHERE
    ]
    rows.append(("configuration_hash", material.study.hash))
    return Table(
        name="settings",
        title="Settings of the study",
        note="From study.yaml, SI units: all that determines the results."
        if material.people is None
        else "From plan and records, SI units.",
        header=("Setting", "Value"),
        rows=tuple(rows),
        num_labels=2,
        prose=True,
    )


def records_table(material: StudyMaterial) -> Table:
    """Return what the trial records say of themselves, differences included."""
    rows = []
    for name in _PER_TRIAL:
        values = dict.fromkeys(_text(each.get(name)) for each in material.metadata)
        shown = list(values)[:_MOST_VALUES]
        more = len(values) - len(shown)
        text = "; ".join(shown) + (f"; {more} more" if more else "")
        rows.append((name, text or NOTHING))
    hashes = {str(each.get("configuration_hash")) for each in material.metadata}
    rows.append(("different configurations of trials", str(len(hashes))))
    return Table(
        name="records",
        title="What the trial records say",
        note="One value means that all records agree. Each record holds all parameters "
        "of its trial under the key costeer of its Parquet metadata.",
        header=("Field", "Value"),
        rows=tuple(rows),
        num_labels=2,
        prose=True,
    )


def order_table(material: StudyMaterial) -> Table:
    """Return the order in which each participant drove the conditions."""
    known = material.trials.dropna(subset=["order"])
    trials = known.sort_values(["participant", "order"])
    orders = {
        str(participant): tuple(str(name) for name in rows["condition"])
        for participant, rows in trials.groupby("participant")
    }
    places = max((len(each) for each in orders.values()), default=0)
    return Table(
        name="order",
        title="Order of the conditions",
        note="Manual first, then a balanced Latin square (Williams)."
        if material.people is None
        else "As driven; a dash where the order is not known or a trial is missing.",
        header=("Participant", *(str(place + 1) for place in range(places))),
        rows=tuple(
            (who, *names, *[NOTHING] * (places - len(names)))
            for who, names in orders.items()
        ),
        num_labels=places + 1,
    )


def thresholds_table() -> Table:
    """Return the thresholds of the measures."""
    rows = (
        ("A lane change starts and ends at a yaw of", f"{_deg('yaw_threshold')} deg"),
        (
            "The heading is settled when yaw stays within",
            f"{_deg('straight_yaw')} deg for {DEFAULTS.straight_duration:g} s",
        ),
        ("Lane keeping stays clear of it by", f"{DEFAULTS.lane_change_margin:g} s"),
        (
            "Who crosses back within",
            f"{DEFAULTS.minimum_stay:g} s has not changed lanes",
        ),
        ("A reversal of the wheel is larger than", f"{_deg('reversal_angle')} deg"),
        ("after a low-pass filter at", f"{DEFAULTS.reversal_cutoff:g} Hz"),
        ("A trigger is true up to", f"{DEFAULTS.prediction_horizon:g} s before"),
        ("and early up to", f"{DEFAULTS.early_horizon:g} s before the crossing"),
        ("Triggers are one within", f"{DEFAULTS.trigger_merge:g} s"),
        ("An inconsistency is over from a gain of", f"{DEFAULTS.recovery_gain:g}"),
        ("A false trigger is followed for", f"{DEFAULTS.episode_duration:g} s"),
        (
            "A settled car is straight and this near its lane's centre",
            f"{DEFAULTS.settled_offset:g} m for {DEFAULTS.settled_duration:g} s",
        ),
    )
    return Table(
        name="thresholds",
        title="Thresholds of the measures",
        note="",
        header=("Threshold", "Value"),
        rows=rows,
        num_labels=2,
        prose=True,
    )


def _deg(name: str) -> str:
    return number(float(getattr(DEFAULTS, name)) * DEG, 1)


def _text(value: object) -> str:
    if value is None:
        return NOTHING
    if isinstance(value, float):
        return f"{value:.6g}"
    return value if isinstance(value, str) else json.dumps(value, sort_keys=True)
