"""What stands on the page in which order, and the numbers of tables and figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from costeer.pages.frame import Picture, Section
from costeer.pages.tables import Table, versions_table
from costeer.study.lanes import home_lane, keeps_home
from costeer.study.material import StudyMaterial, is_virtual, why_without
from costeer.study.quantities import BY_STRENGTH, WORKLOAD
from costeer.study.reporting import (
    event_tables,
    making,
    people_tables,
    statistics_tables,
    tables,
)
from costeer.study.reporting.comparisons import shown_quantities
from costeer.study.reporting.methods import methods_paragraphs
from costeer.study.reporting.network import network_table
from costeer.study.reporting.traffic_tables import contacts_table, zones_table
from costeer.study.reporting.trigger_tables import trigger_costs_table


def page_sections(
    material: StudyMaterial, pictures: Mapping[str, Picture]
) -> list[Section]:
    """Return all sections; every picture stands in one of them.

    Args:
        material: The study.
        pictures: By name.
    """
    sections = [
        _results(material),
        _agreement(material, pictures),
        _lane_keeping(material, pictures),
        _lane_changes(material, pictures),
        _effort(material, pictures),
        _intention(material, pictures),
        _inconsistencies(material, pictures),
        _surroundings(material, pictures),
        _signals(pictures),
        _again(material),
        _tests(material),
        _trials(material),
        _exclusions(material),
        Section("methods", "Methods, ready to paste", methods_paragraphs(material), ()),
        _making(material),
    ]
    return [each for each in sections if each is not None]


def _results(material: StudyMaterial) -> Section:
    items = (tables.measures_table(material), event_tables.lane_changes_table(material))
    return Section("results", "Results in two tables", (), items)


def _agreement(
    material: StudyMaterial, pictures: Mapping[str, Picture]
) -> Section | None:
    if material.beside is None:
        return None
    text = (people_tables.agreement_sentence(material, material.beside),)
    table = people_tables.agreement_table(material, material.beside)
    items = (*_chosen(pictures, ("agreement",)), table)
    return Section("agreement", "People beside virtual drivers", text, items)


def _lane_keeping(material: StudyMaterial, pictures: Mapping[str, Picture]) -> Section:
    where = "left" if home_lane(material.road) else "right"
    kept = f"the {where} lane" if keeps_home(material.road) else "the lane driven in"
    text = (
        f"Measured in {kept}, away from lane changes and overtaking. SDLP is "
        "the standard deviation of the lane position; the reversal rate counts turns "
        "of the steering wheel larger than 3 deg.",
    )
    items = _chosen(pictures, BY_STRENGTH)
    items += (tables.strengths_table(material), event_tables.driving_table(material))
    return Section("lane-keeping", "Lane keeping", text, items)


def _lane_changes(material: StudyMaterial, pictures: Mapping[str, Picture]) -> Section:
    names = (
        "trajectories",
        "overshoot",
        "duration",
        "steering_velocity_rms",
        "peak_steering_angle",
    )
    text = (
        "A lane change lasts from the last yaw within 0.5 deg before the crossing of "
        "the line to the first after it. Overshoot is the distance from the new lane's "
        "centre at the first lateral extremum after the crossing, on either side: a "
        "car that turns back short of the centre counts too.",
    )
    items = (*_chosen(pictures, names), event_tables.durations_table(material))
    return Section("lane-change-measures", "Lane changes", text, items)


def _effort(material: StudyMaterial, pictures: Mapping[str, Picture]) -> Section:
    scores = tuple(each.name for each in WORKLOAD)
    items = _chosen(
        pictures, ("driver_torque_rms", "workload", *scores, "workload-items")
    )
    if material.answers is not None:
        items += (people_tables.answers_table(material.answers),)
    text = ("Root mean square of the driver's torque over the whole course.",)
    return Section("effort", "Effort", text, items)


def _intention(material: StudyMaterial, pictures: Mapping[str, Picture]) -> Section:
    items = (*_chosen(pictures, ("detection",)), event_tables.detection_table(material))
    optional = (trigger_costs_table(material), network_table(material))
    items += tuple(each for each in optional if each is not None)
    text = _INTENTION_TEXTS.get(
        str(material.study.configuration.get("intention", "network")), ()
    )
    return Section("intention", "Reading the intention", text, items)


_INTENTION_TEXTS = {
    "network": (
        "The network gives the probability that the car crosses a lane line within the "
        "next 3 s. A trigger needs several verdicts above the threshold in a row. Each "
        "trigger is judged here in the loop, against what the driver wanted.",
    ),
    "scripted": (
        "In this study the intention was scripted: the system was told the driver's "
        "own plan. The numbers below describe that script; they say nothing about how "
        "well a network reads drivers.",
    ),
}


def _inconsistencies(
    material: StudyMaterial, pictures: Mapping[str, Picture]
) -> Section:
    names = ("inconsistency-timing", "inconsistency", "gain-adjustment")
    items = _chosen(pictures, names)
    both = (
        event_tables.inconsistencies_table(material),
        people_tables.timing_table(material),
    )
    items += tuple(each for each in both if each is not None)
    why = why_without(material, "num_inconsistencies")
    text = (f"Nothing can be told: {why}.",) if why else _INCONSISTENT
    return Section("inconsistency", "Inconsistency and gain", text, items)


_INCONSISTENT = (
    "Driver and guidance are inconsistent when their torques point to opposite "
    "sides and their pseudo-works differ by more than a threshold. The gain then "
    "fades out; below the re-plan gain the system plans anew; the gain fades in "
    "again.",
)


def _surroundings(
    material: StudyMaterial, pictures: Mapping[str, Picture]
) -> Section | None:
    """What only some scenarios have; nothing on the paper's."""
    if material.scenario is None:
        return None
    both = (
        contacts_table(material),
        zones_table(material),
    )
    items = _chosen(pictures, ("traffic",))
    items += tuple(each for each in both if each is not None)
    return Section("scenario", "Other cars, curves and zones", _NEARNESS, items)


_NEARNESS = (
    "A gap ends at the rear bumper of the car ahead, a headway at its front bumper "
    "(SAE J2944). Time to collision is the gap over the closing speed, of the next car "
    "ahead in the lane that is driven in. Each value stands in scenario_measures.csv.",
)


def _signals(pictures: Mapping[str, Picture]) -> Section:
    items = _chosen(pictures, ("signals-strong", "signals-weak"))
    return Section("signals", "Signals of one participant", (), items)


def _again(material: StudyMaterial) -> Section | None:
    """What was driven more than once; nothing where nothing was."""
    table = statistics_tables.again_table(material)
    if table is None:
        return None
    text = (
        "All other sections are of the first trial of each condition. Here a later one "
        "is laid beside it, of those who drove both.",
    )
    return Section("again", "Driven again", text, (table,))


def _tests(material: StudyMaterial) -> Section:
    items: list[Table] = [statistics_tables.effects_table(material)]
    optional = statistics_tables.mixed_table(material)
    items += [optional] if optional else []
    items += [
        statistics_tables.pairs_table(material, each)
        for each in shown_quantities(material)
    ]
    dropped = statistics_tables.dropped_table(material)
    items += [dropped] if dropped else []
    text = _TWO_ANALYSES if dropped else (*_TWO_ANALYSES, "No data had to be dropped.")
    return Section("tests", "Tests", text, tuple(items))


_TWO_ANALYSES = (
    "Two sets of tests stand side by side. As published, or pooled: every trial or "
    "lane change counts as if another driver had made it. The paper's F(6, 652), F(2, "
    "559) and F(6, 77) show by their degrees of freedom that its tests were made "
    "that way; pooled tests let this study be laid beside it. Within subjects: the "
    "values of a participant in a condition are averaged first, and an effect is "
    "compared with how much it varies from participant to participant. Every "
    "participant drove every condition, so this is the set to draw conclusions from.",
    "The two can disagree in both directions. Where participants merely differ in "
    "level, pooling buries effects under differences between people. Where each of "
    "them answers a condition in a personal way, pooling finds effects that are those "
    "of the few who came: eight lane changes of one driver are not eight drivers.",
    "F tests within subjects are corrected after Greenhouse and Geisser, comparisons "
    "after Benjamini and Hochberg over the comparisons of a measure with manual (over "
    "the three pairs of strengths apart). Nothing is corrected across measures. "
    "Differences are first minus second with 95 % intervals; d and d_z are Cohen's, "
    "on different scales.",
)


def _trials(material: StudyMaterial) -> Section:
    return Section("every-trial", "Every trial", (), (tables.trials_table(material),))


def _exclusions(material: StudyMaterial) -> Section | None:
    if material.people is None:
        return None
    table = people_tables.exclusions_table(material.people)
    gone = material.people.num_withdrawn
    text = [] if table else ["No drive was excluded, and no trial is missing."]
    text += [f"{gone} withdrew; nothing of them is left."] if gone else []
    return Section(
        "exclusions", "Exclusion log", tuple(text), (table,) if table else ()
    )


def _making(material: StudyMaterial) -> Section:
    virtual = (
        "Each trial was simulated: car, steering column, leaders and driver at a "
        "whole number of steps per control step of 60 Hz. A virtual driver is drawn "
        "from seed and number, its noise also from the condition, so the same "
        "settings give the same bytes.",
    )
    answers = (
        "makes all but the records again; with people it leaves the first three "
        "tables, which hold their answers, as they are."
        if material.people is None
        else "makes all but records and answers again."
    )
    text = (
        "This page, the tables and the figures hold nothing but what follows from the "
        "records and settings below; there is no date in them. The folder holds the "
        "records (records/), the tables as CSV (trials, lane_changes, triggers, tests, "
        "pairs, summaries, dropped) and the figures as SVG (figures/). costeer report "
        f"{answers}",
    )
    items = (
        making.settings_table(material),
        making.records_table(material),
        making.thresholds_table(),
        making.order_table(material),
        versions_table(),
    )
    whole = (*virtual, *text) if is_virtual(material) else text
    return Section("making", "How it was made", whole, items)


def _chosen(
    pictures: Mapping[str, Picture], names: Sequence[str]
) -> tuple[Table | Picture, ...]:
    found = (pictures.get(name.replace("_", "-")) for name in names)
    return tuple(each for each in found if each is not None)
