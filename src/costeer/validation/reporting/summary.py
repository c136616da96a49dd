"""What stands above all else: what was looked at, and what came out."""

from __future__ import annotations

from collections.abc import Sequence

from costeer.pages.numerals import listed, number, percent, plural
from costeer.validation.arms import arms_in_range
from costeer.validation.departures import Departures, summarise
from costeer.validation.manual import (
    TargetCheck,
    columns_of,
    compare,
    missed_by,
)
from costeer.validation.people.findings import known
from costeer.validation.populations import population_told
from costeer.validation.reporting.evidence import Evidence
from costeer.validation.reporting.verdicts import (
    largest_miss,
    largest_share,
    num_met,
)
from costeer.validation.reporting.words import (
    ELSEWHERE,
    MET,
    MISSED,
    NOT_KNOWN,
    REPORTED,
    real_verdict,
    short,
    span,
)
from costeer.validation.stability import leaves_road, oscillates

Point = tuple[str, str]


def subtitle(evidence: Evidence) -> str:
    """Which population this is."""
    drawn = evidence.drawn
    amount = plural(len(evidence.driving.trials), "virtual driver")
    return f"{amount}, {population_told(drawn.population)}, seed {drawn.seed}."


def looked_at(evidence: Evidence) -> list[str]:
    """What was simulated, in sentences."""
    driving, drawn = evidence.driving, evidence.drawn
    distance = float(columns_of(driving.trials)("distance").sum()) / 1000.0
    sentences = [
        f"{plural(len(driving.trials), 'driver')} of "
        f"{population_told(drawn.population)}, drawn with seed {drawn.seed}, drove the "
        "course of the "
        f"experiment manually ({number(distance, 0)} km, "
        f"{plural(len(driving.changes), 'lane change')}), and once more with other "
        "noise."
    ]
    if evidence.num_onsets:
        sentences.append(
            f"{evidence.num_onsets} of them corrected heading errors of 1 and 2 deg."
        )
    if evidence.arms:
        sentences.append("A motor shook the wheel in their hands.")
    if evidence.resistance:
        pilots = len(evidence.resistance[0].deviation)
        sentences.append(
            f"{plural(pilots, 'pilot driver')}, who are in no study, resisted lane "
            "changes that they did not want."
        )
    if evidence.stability is not None:
        amount = len(evidence.stability.damping_ratio)
        sentences.append(f"{plural(amount, 'driver')} were tested for stability.")
    return sentences


def outcomes(evidence: Evidence) -> list[Point]:
    """Heading and sentence of each thing that came out."""
    points = [("Human ranges", targets_sentence(compare(evidence.driving)))]
    if evidence.people:
        points.append(("Beside people", people_sentence(evidence)))
    if evidence.departures is not None:
        points.append(("Lane departures", departures_sentence(evidence.departures)))
    if evidence.arms:
        points.append(("Arms", _arms_sentence(evidence)))
    if evidence.resistance:
        points.append(("Wrong guidance", _resistance_sentence(evidence)))
    if evidence.stability is not None:
        points.append(("Stability", _stability_sentence(evidence)))
    return points


def targets_sentence(comparisons: Sequence[TargetCheck]) -> str:
    """How many targets are met, and which is missed most."""
    told = f"{num_met(comparisons)} of {len(comparisons)} targets are met."
    worst = largest_miss(comparisons)
    if worst is None:
        return told
    target = worst.target
    amount = f"{short(missed_by(worst), 2)} {target.unit}"
    return (
        f"{told} The largest miss is {target.name}, {target.quantity}: "
        f"{short(worst.value)} {target.unit} where people have "
        f"{span(target.low, target.high)}, missed by {amount}, "
        f"{short(100.0 * largest_share(comparisons), 2)} % of the limit."
    )


def people_sentence(evidence: Evidence) -> str:
    """How many quantities of people are met, and whether people are there."""
    verdicts = [real_verdict(each) for each in evidence.people]
    missed = [e.name for e in evidence.people if real_verdict(e) == MISSED]
    held = verdicts.count(MET) + len(missed)
    told = f"{verdicts.count(MET)} of {held} quantities of people are met"
    told += f"; missed: {listed(missed)}." if missed else "."
    told += elsewhere_sentence(evidence)
    if verdicts.count(REPORTED):
        told += f" {verdicts.count(REPORTED)} more are reported without a range."
    if verdicts.count(NOT_KNOWN):
        told += f" {verdicts.count(NOT_KNOWN)} have no value of the drivers."
    return f"{told} {recordings_sentence(evidence)}"


def elsewhere_sentence(evidence: Evidence) -> str:
    """Which quantities are of another domain than the drivers; empty if none is."""
    names = [e.name for e in evidence.people if real_verdict(e) == ELSEWHERE]
    if not names:
        return ""
    domains = sorted({each.domain for each in evidence.people if each.elsewhere})
    return (
        f" {listed(names)} are of another domain ({listed(domains)}; these drivers: "
        f"{evidence.drawn.population.domain}), and their ranges are not held against "
        "the drivers."
    )


def recordings_sentence(evidence: Evidence) -> str:
    """Whether the recordings of people are there."""
    there = sum(known(each.people).size > 0 for each in evidence.people)
    if there == len(evidence.people):
        return "All recordings of people were there."
    if there:
        return (
            f"Recordings of people were there for {there} of {len(evidence.people)}; "
            "for the others published values stand."
        )
    return (
        "Recordings of people were not there; published values stand in their place. "
        "Name their folder with --data DIR or COSTEER_DATA."
    )


def departures_sentence(found: Departures) -> str:
    """Departures counted, beside those of a Gaussian lane position."""
    try:
        told = summarise(found)
    except ValueError:
        return "No driver kept a lane for long enough."
    return (
        f"{told.num_departures} in {number(told.kilometres, 0)} km, "
        f"{short(told.counted_per_km, 2)} per km "
        f"({' to '.join(short(end, 2) for end in told.interval)}); Gaussian lane "
        f"positions like these would give {short(told.gaussian_per_km, 2)} per km."
    )


def _arms_sentence(evidence: Evidence) -> str:
    shares = [
        f"{test.task} {percent(float(arms_in_range(test).mean()), 1.0)}"
        for test in evidence.arms
    ]
    return (
        "Admittances of drivers from 0.1 to 10 Hz within the assumed range of people: "
        f"{listed(shares)}."
    )


def _resistance_sentence(evidence: Evidence) -> str:
    told = []
    for system in dict.fromkeys(each.system for each in evidence.resistance):
        own = [each for each in evidence.resistance if each.system == system]
        crossed = sum(float(each.crossed_line.mean()) for each in own) / len(own)
        told.append(f"{percent(crossed, 1.0)} against one that {system}")
    return (
        "A lane change that the system starts against the driver's will takes a wheel "
        f"over the line in {listed(told)}."
    )


def _stability_sentence(evidence: Evidence) -> str:
    found = evidence.stability
    if found is None:
        return ""
    amount = len(found.damping_ratio)
    return (
        f"Of {plural(amount, 'driver')} {int(oscillates(found).sum())} oscillate and "
        f"{int(leaves_road(found).sum())} leave the road."
    )
