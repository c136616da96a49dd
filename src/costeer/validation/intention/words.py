"""The opening of the page: what was judged, and what came out."""

from __future__ import annotations

from costeer.pages.numerals import listed, plural
from costeer.training.bootstrap import AT_RATE
from costeer.training.comparison import BETTER, TIE, UNKNOWN, WORSE, Comparison
from costeer.validation.intention.material import Material
from costeer.validation.intention.tables import shown_number

_SCORES = {
    AT_RATE: "Median lead at the rate",
    "pr_auc": "Area under precision and recall",
}


def subtitle(material: Material) -> str:
    """What was judged on, and how much it is."""
    facts = material.facts
    return (
        f"{material.assessment.judged.title} on {material.source}: "
        f"{plural(facts['num_drivers'], 'driver')}, {facts['hours']:.1f} h, "
        f"{facts['kilometres']:.0f} km, {plural(facts['num_crossings'], 'crossing')}"
    )


def looked_at(material: Material) -> list[str]:
    """What the numbers are of, in sentences."""
    facts = material.facts
    name = material.assessment.judged.title
    return [
        "Asked is at each sample whether the car crosses to the adjacent lane within "
        f"3 s; a trigger is three answers in a row at or above a threshold. {name} was "
        f"judged over {facts['num_samples']} samples at natural prevalence.",
        "Intervals are 95 %, by resampling drivers.",
    ]


def outcomes(material: Material) -> list[tuple[str, str]]:
    """What came out, a few words and a sentence each."""
    comparison = material.assessment.comparison
    found = [("Lead time", _lead(material)), ("Accuracy", _accuracy(material))]
    if comparison is not None:
        found += [
            (f"{words} against the others", _verdicts(comparison, score))
            for score, words in _SCORES.items()
        ]
    return found


def _lead(material: Material) -> str:
    facts = material.facts
    rated, allowed = facts["at_false_rate"], facts["false_per_km_allowed"]
    if not rated:
        return f"No threshold keeps to {allowed:g} false triggers per km."
    ends = facts["interval_95"].get(AT_RATE)
    within = (
        f" (95 % {ends[0]:.2f} to {ends[1]:.2f} s)"
        if ends and facts["num_drivers"] > 1
        else ""
    )
    return (
        f"At no more than {allowed:g} false triggers per km the median crossing is "
        f"announced {rated['lead_time_median']:.2f} s before{within}, 10 to 90 % "
        f"{rated['lead_time_p10']:.2f} to {rated['lead_time_p90']:.2f} s; "
        f"{rated['missed']:.0f} of {rated['num_crossings']:.0f} are missed."
    )


def _accuracy(material: Material) -> str:
    samples, balanced = material.facts["samples"], material.facts["balanced"]
    return (
        f"{shown_number(samples['accuracy'], 4)} where the answer “never” has "
        f"{shown_number(samples['accuracy_of_never'], 4)}; "
        f"{shown_number(balanced['accuracy'], 3)} if half of the samples were positive."
    )


def _verdicts(comparison: Comparison, score: str) -> str:
    """Against whom the reference is better, tied, worse, or not known to be."""
    words = {WORSE: "better than", TIE: "tied with", BETTER: "worse than"}
    words[UNKNOWN] = "not to be told from (too few drivers)"
    told = []
    for verdict, relation in words.items():
        names = [
            one.title
            for one in comparison.judged
            if score in one.differences and one.differences[score].verdict == verdict
        ]
        if names:
            told.append(f"{relation} {listed(names)}")
    text = "; ".join(told) or "no other predictor could judge these recordings"
    return text[0].upper() + text[1:] + "."
