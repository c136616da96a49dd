"""Sentences of the report on a comparison."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from importlib.metadata import version

from costeer.comparison.criteria import SPEAKING, criterion
from costeer.comparison.effects import LEVEL
from costeer.comparison.mistakes import NONE
from costeer.comparison.results import Results
from costeer.comparison.winners import Loss
from costeer.drivers.population import POPULATION_VERSION
from costeer.pages.numerals import listed, plural

PAPERS = "ibhs"
"""The paper's method."""

RULE = (
    "The method with the best mean wins if it is shown to be better than every other "
    f"(paired by driver, p < {LEVEL:g} after Benjamini-Hochberg over all comparisons "
    "of the measure); else it ties with those that it is not shown to be better than. "
    "Below a winner: its difference to the next best mean, with the 95 % interval."
)

CAUTION = (
    "Thresholds and gains of all methods were set before, on manual and pilot drives "
    "only, never on a comparison; the virtual drivers were calibrated on manual "
    "driving and for none of the methods. The paper's method is not favoured: it is "
    "one of the rows, and the page lists where it loses. With enough virtual drivers "
    "any difference becomes significant: read its size and interval first."
)


def subtitle(results: Results) -> str:
    """Who was compared, in a line."""
    return (
        f"{plural(len(results.methods), 'method')}, "
        f"{plural(len(results.scenarios), 'scenario')}, "
        f"{plural(results.participants, 'virtual driver')}."
    )


def looked_at(results: Results) -> list[str]:
    """What was driven, by whom, and what is missing of it."""
    told = results.configuration
    kilometres = sum(each["length"] for each in told["scenarios"].values()) / 1000.0
    reads = {
        "scripted": "the driver's own plan is known to the system",
        "network": "the intention network reads the driver",
        "off": "the system is told nothing of the driver's intention",
    }
    mistakes = [name for name in results.mistakes if name != NONE]
    sentences = [
        f"{plural(results.participants, 'virtual driver')} (population "
        f"{POPULATION_VERSION}, seed {told['seed']}) drove "
        f"{listed(results.scenarios)}, {kilometres:.3g} km in all, with each of "
        f"{listed(results.methods)}.",
        f"Condition {told['condition']}; intention {told['intention']}: "
        f"{reads[told['intention']]}.",
        f"Mistakes, one at a time: {listed(mistakes)}."
        if mistakes
        else "No mistakes were injected.",
    ]
    if results.num_missing:
        sentences.append(
            f"{plural(results.num_missing, 'trial')} {_is(results.num_missing)} not "
            "driven yet: the first lines of compare.yaml hold the command that goes on."
        )
    if results.failures:
        number = len(results.failures)
        sentences.append(f"{plural(number, 'trial')} failed (section Exclusions).")
    return sentences


def _is(number: int) -> str:
    return "is" if number == 1 else "are"


def loses(found: Sequence[Loss], results: Results) -> str:
    """Where the paper's method is shown to be worse than another, in a sentence."""
    if PAPERS not in results.methods:
        return f"{PAPERS} is not among these methods."
    if not found:
        return (
            f"{PAPERS} is nowhere shown to be worse than another method in a measure "
            "that speaks for an aim. That is no proof that it is as good."
        )
    parts = []
    for each in SPEAKING:
        own = [loss for loss in found if loss.measure == each.name]
        if own:
            winners = Counter(loss.winner for loss in own)
            words = [f"{name} ({number})" for name, number in winners.most_common()]
            parts.append(f"in {lowered(each.title)} to {listed(words)}")
    return (
        f"{PAPERS} loses {'; '.join(parts)}. In brackets: in how many of "
        f"{plural(len(results.scenarios), 'scenario')}."
    )


def methods_paragraphs(results: Results) -> tuple[str, ...]:
    """A paragraph for the methods section of a paper."""
    told = results.configuration
    courses = [
        f"{name} ({each['length'] / 1000.0:g} km, {each['speed'] * 3.6:.0f} km/h)"
        for name, each in told["scenarios"].items()
    ]
    spoken = [f"{each.title} ({each.aim})" for each in SPEAKING]
    return (
        f"{plural(results.participants, 'virtual driver')} were simulated with costeer "
        f"{version('costeer')} (population {POPULATION_VERSION}, calibrated on manual "
        f"driving only) on {listed(courses)}. Every driver drove every scenario with "
        f"every method ({listed(results.methods)}) under the condition "
        f"{told['condition']}; driver, noise and traffic were drawn from seed "
        f"{told['seed']} and are the same for all methods, so that differences are "
        "paired. Guidance that is not finite or over the limit is contained by the "
        "loop and counted.",
        f"The measures that speak for the aims were {listed(spoken)}; they were chosen "
        "before methods were compared. Differences are means over drivers with "
        "Student's 95 % intervals; p values of paired t tests were corrected after "
        "Benjamini and Hochberg over all pairs of methods and scenarios of a measure. "
        "Where all drivers had the same difference an exact sign test stands in. A "
        "method is not ranked where a trial of it failed or fewer than half of the "
        "drivers have a value. Thresholds and gains of the methods were set on manual "
        "and pilot drives.",
    )


def speaking_title(name: str) -> str:
    """Aim and measure of a criterion that speaks for its aim."""
    found = criterion(name)
    return f"{found.aim.capitalize()}: {lowered(found.title)}"


def lowered(title: str) -> str:
    """A title within a sentence: `driver torque RMS`, but `SDLP`."""
    return title if title[:2].isupper() else f"{title[:1].lower()}{title[1:]}"
