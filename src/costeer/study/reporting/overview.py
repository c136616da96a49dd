"""What was run and how it went: trials, lane changes, triggers, inconsistencies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import pandas as pd

from costeer.methods.conditions import CONDITION_NAMES
from costeer.pages.numerals import listed, number, percent, plural
from costeer.scenarios.definition import Scenario
from costeer.scenarios.reading import scenario_named, scenario_of, shipped
from costeer.study.configuration import differences
from costeer.study.material import (
    StudyMaterial,
    conditions_driven,
    is_virtual,
    strengths_driven,
    why_without,
)
from costeer.study.scenario import PAPERS

CHANGES_PER_EVENT = 2
"""One to the right, one back to the left. Source: the paper, Sec. III-B."""


class Tally(NamedTuple):
    """Lane changes of one condition, or of the study.

    Attributes:
        name: Of the condition.
        trials: Trials driven.
        planned: Lane changes planned in them; NaN where the scenario plans none.
        completed: Lane changes completed.
        dropped: Crossings that make no lane change; reasons in `trials.csv`.
    """

    name: str
    trials: int
    planned: float
    completed: int
    dropped: int


def planned_changes(length: float, scenario: Scenario | None = None) -> float:
    """Return the lane changes planned on a course of that length [m].

    Args:
        length: Of the course [m].
        scenario: With cars to overtake; None for the paper's. NaN where other cars or
            requests make people change lanes as well, or nobody is to be overtaken.
    """
    scenario = scenario or scenario_named(PAPERS)
    events, cars = scenario.overtaking, scenario.overtaking.cars
    asked = any(each.kind == "lane-change" for each in scenario.events)
    if cars == 0 or asked or scenario.actors or scenario.stream.cars:
        return math.nan
    places = [events.first + number * events.spacing for number in range(cars)]
    return float(CHANGES_PER_EVENT * sum(place < length for place in places))


def _scenario(material: StudyMaterial) -> Scenario | None:
    """The scenario of a study, or the one that its records tell of."""
    configuration = material.study.configuration
    told = configuration.get("scenario_content")
    told = told or next((each.get("scenario") for each in material.metadata), None)
    if isinstance(told, Mapping):
        return scenario_of(told)
    name = configuration.get("scenario", PAPERS)
    return scenario_named(name) if name in shipped() else None


def tallies(material: StudyMaterial) -> list[Tally]:
    """Return the lane changes planned, completed and dropped per condition."""
    planned = planned_changes(_course(material), _scenario(material))
    trials = material.trials.groupby("condition")
    return [
        Tally(
            name=name,
            trials=len(rows),
            planned=planned * len(rows),
            completed=int(rows["num_lane_changes"].sum()),
            dropped=int(rows["num_dropped_changes"].sum()),
        )
        for name in conditions_driven(material)
        for rows in [trials.get_group(name)]
    ]


def total(parts: list[Tally]) -> Tally:
    """Return the sum over conditions."""
    return Tally(
        name="all",
        trials=sum(each.trials for each in parts),
        planned=sum(each.planned for each in parts),
        completed=sum(each.completed for each in parts),
        dropped=sum(each.dropped for each in parts),
    )


def _course(material: StudyMaterial) -> float:
    """Length of the course [m]."""
    length = material.study.configuration.get("length", math.nan)
    return float(length)


def run_sentences(material: StudyMaterial) -> list[str]:
    """Say who drove what, how much of it is there, and how the intention was read."""
    sentences = [_drivers_sentence(material), _trials_sentence(material)]
    sentences += [_changes_sentence(material), _method_sentence(material)]
    return [*sentences, *_series_sentences(material)]


def _series_sentences(material: StudyMaterial) -> list[str]:
    """Say which of several series of trials this is, and how its trials ended."""
    told = []
    if material.people is not None and material.people.which:
        told.append(material.people.which)
    ended = material.trials.get("ended_by")
    if ended is not None and (hit := int((ended == "collision").sum())):
        told.append(f"{plural(hit, 'trial')} ended with a collision.")
    return told


def drivers(material: StudyMaterial, amount: int) -> str:
    """Return `12 virtual drivers` or `12 participants`."""
    return plural(amount, "virtual driver" if is_virtual(material) else "participant")


def subtitle(material: StudyMaterial) -> str:
    """Return one line on who drove what."""
    who = drivers(material, int(material.trials["participant"].nunique()))
    names = conditions_driven(material)
    if len(names) == len(CONDITION_NAMES):
        return (
            f"{who}: manual driving beside guidance of two strengths and three "
            "lane-change durations."
        )
    return f"{who}: {listed(names)}."


def _drivers_sentence(material: StudyMaterial) -> str:
    names = conditions_driven(material)
    amount = int(material.trials["participant"].nunique())
    configuration = material.study.configuration
    speed = float(configuration.get("speed", math.nan)) * 3.6
    kilometres = _course(material) / 1000.0
    if len(names) == len(CONDITION_NAMES):
        where = "all seven conditions"
    else:
        where = f"the condition{'s' if len(names) > 1 else ''} {listed(names)}"
    course = (
        f", each over a course of {number(kilometres, 1)} km at a suggested "
        f"{number(speed, 0)} km/h"
        if math.isfinite(kilometres) and math.isfinite(speed)
        else ""
    )
    return f"{drivers(material, amount)} drove {where}{course}."


def _trials_sentence(material: StudyMaterial) -> str:
    configuration = material.study.configuration
    wanted = int(configuration.get("participants", 0)) * len(
        configuration.get("conditions", ())
    )
    there = len(material.trials)
    if there >= wanted:
        return f"All {plural(there, 'trial')} are there."
    return f"The study is not complete: {there} of {plural(wanted, 'trial')} are there."


def _changes_sentence(material: StudyMaterial) -> str:
    parts = tallies(material)
    whole = total(parts)
    if math.isnan(_course(material)) or math.isnan(whole.planned):
        changes = plural(whole.completed, "lane change")
        verb = "was" if whole.completed == 1 else "were"
        return f"{changes} {verb} completed; {_dropped(whole)}."
    if whole.planned == 0:
        return (
            "The course is too short for an overtaking event: no lane change planned."
        )
    fewest = min(each.completed / each.planned for each in parts)
    text = (
        f"Of {plural(int(whole.planned), 'planned lane change')} {whole.completed} "
        f"were completed ({percent(whole.completed, whole.planned)}); "
        f"{_dropped(whole)}."
    )
    if fewest == 1.0:
        return text
    least = [each for each in parts if each.completed / each.planned == fewest]
    where = listed([each.name for each in least])
    each_of = "each " if len(least) > 1 else ""
    return (
        f"{text} Fewest were completed in {where}: {each_of}{least[0].completed} of "
        f"{least[0].planned:.0f}."
    )


def _dropped(whole: Tally) -> str:
    if whole.dropped == 0:
        return "no crossing of the line had to be dropped"
    crossings = plural(whole.dropped, "crossing")
    return f"{crossings} of the line made no lane change and dropped out"


def _method_sentence(material: StudyMaterial) -> str:
    configuration = material.study.configuration
    method = str(configuration.get("method_name", configuration.get("method", "ibhs")))
    intention = str(configuration.get("intention", "network"))
    model = str(configuration.get("intention_model_hash") or "")[:12]
    reading = {
        "network": "read by the network" + (f" with weights {model}" if model else ""),
        "indicator": "told by the indicator",
        "scripted": "scripted: the system was told the driver's own plan, so that "
        "nothing here judges a network",
        "off": "not read",
    }.get(intention, intention)
    return " ".join(
        [
            f"The guidance was the method {method}; the driver's intention was "
            f"{reading}.",
            *_difference_sentences(configuration),
            *_fault_sentences(material),
        ]
    )


def _difference_sentences(configuration: Mapping[str, Any]) -> list[str]:
    """Say what is other than in the published study."""
    told = [
        f"{name} = {value}" + (f" instead of {usual}" if usual else "")
        for name, value, usual in differences(configuration)
    ]
    return [f"Other than in the published study: {'; '.join(told)}."] if told else []


def _fault_sentences(material: StudyMaterial) -> list[str]:
    """Say whether the method asked for torques that had to be contained."""
    counts = [int(str(each.get("torque_faults") or 0)) for each in material.metadata]
    if not any(counts):
        return []
    trials = plural(sum(count > 0 for count in counts), "trial")
    return [
        f"In {plural(sum(counts), 'control step')} of {trials} the method asked for a "
        "torque that was not finite or over the motor's limit; it was contained "
        "(column torque_fault of the records)."
    ]


def detection_sentence(material: StudyMaterial) -> str:
    """Say how many intended lane changes were announced, how early, at what cost."""
    trials, changes = material.trials, material.lane_changes
    known = trials.dropna(subset=["num_false_triggers"])
    if known.empty:
        return "No trial has triggers to judge."
    silent = why_without(material, "num_triggers")
    only = f"In manual driving alone, as {silent}: " if silent else ""
    distance = float(known["distance"].sum()) / 1000.0
    false, early = (
        int(known[f"num_{kind}_triggers"].sum()) for kind in ("false", "early")
    )
    missed = int(known["num_missed"].sum())
    return (
        f"{only}{_announced(changes)} Missed: {missed}. "
        f"{plural(false, 'false trigger')} in {number(distance, 0)} km "
        f"({number(false / distance, 3)} per km, {_rate_interval(false, distance)}), "
        f"and {early} early, 3 to 5 s before the crossing."
    )


def _rate_interval(count: int, distance: float) -> str:
    """Exact 95 % interval of a Poisson rate (Garwood 1936), as a text.

    Args:
        count: Of events.
        distance: In which they were counted [km].
    """
    from scipy.stats import chi2  # its import takes seconds

    low = float(chi2.ppf(0.025, 2 * count)) / 2.0 if count else 0.0
    high = float(chi2.ppf(0.975, 2 * count + 2)) / 2.0
    return f"95 % interval {number(low / distance, 3)} to {number(high / distance, 3)}"


def _announced(changes: pd.DataFrame) -> str:
    leads = changes["detection_lead_time"].dropna()
    announced = leads[leads > 0.0]
    if leads.empty:
        return "No completed lane change was intended by the driver."
    if announced.empty:
        return f"Of {plural(len(leads), 'intended lane change')} none was announced."
    return (
        f"{len(announced)} of {plural(len(leads), 'completed intended lane change')} "
        f"({percent(len(announced), len(leads))}) were announced, half of them at "
        f"least {number(float(announced.median()), 2)} s before the crossing."
    )


def inconsistency_sentence(material: StudyMaterial) -> str:
    """Say how often driver and guidance were found to want different paths."""
    known = material.trials.dropna(subset=["num_inconsistencies"])
    if known.empty:
        why = why_without(material, "num_inconsistencies") or "no trial is assisted"
        return f"There is no verdict on inconsistency: {why}."
    amount = int(known["num_inconsistencies"].sum())
    changes = int(known["num_lane_changes"].sum())
    text = (
        f"{plural(amount, 'inconsistency', 'inconsistencies')} in "
        f"{plural(len(known), 'assisted trial')} with {plural(changes, 'lane change')}"
    )
    if amount == 0:
        return f"{text}."
    recovery = weighted(known, "recovery_time")
    lowest = float(known["inconsistency_gain_minimum"].min())
    return (
        f"{text}; mean time from the first inconsistent verdict until the gain was "
        f"back {number(recovery, 1)} s; lowest gain {number(lowest, 3)}."
    )


def weighted(trials: pd.DataFrame, column: str) -> float:
    """Mean over inconsistencies of a column that holds one mean per trial."""
    known = trials.dropna(subset=[column])
    weights = known["num_inconsistencies"]
    if float(weights.sum()) == 0.0:
        return math.nan
    return float((known[column] * weights).sum() / weights.sum())


def departure_sentence(material: StudyMaterial) -> str:
    """Say how often a wheel was over a line outside a lane change."""
    trials = material.trials
    parts = []
    for strength in strengths_driven(material):
        rows = trials[trials["strength"] == strength]
        hours = float(rows["duration"].sum()) / 3600.0
        amount = int(rows["num_lane_departures"].sum())
        parts.append(f"{strength} {amount} in {number(hours, 2)} h")
    return f"A wheel over a line outside lane changes: {listed(parts)} of driving."
