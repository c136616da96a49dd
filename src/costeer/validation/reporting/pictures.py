"""All figures of the validation report, drawn one after the other."""

from __future__ import annotations

from collections.abc import Iterator

from costeer.pages.exhibit import Exhibit
from costeer.pages.frame import Picture, picture
from costeer.pages.style import styled
from costeer.validation import figure as manual_figure
from costeer.validation.departures import summarise
from costeer.validation.drawn_figure import draw_parameters, parameters_description
from costeer.validation.reporting.arm_figures import draw_arms
from costeer.validation.reporting.departures_part import draw_departures
from costeer.validation.reporting.evidence import Evidence
from costeer.validation.reporting.people_figures import draw_people, draw_spectra
from costeer.validation.reporting.spread_figure import draw_twice

MANUAL, POPULATION = "manual-driving", "population"


def draw_pictures(evidence: Evidence) -> dict[str, Picture]:
    """Return every figure that there is something to draw of, by name."""
    with styled():
        return {each.name: picture(each) for each in _exhibits(evidence)}


def _exhibits(evidence: Evidence) -> Iterator[Exhibit]:
    yield _manual(evidence)
    yield draw_twice(evidence.driving, evidence.again, evidence.spreads)
    yield from draw_people(evidence.people)
    if evidence.spectra is not None:
        yield draw_spectra(evidence.spectra)
    if evidence.departures is not None:
        yield from _departures(evidence)
    if evidence.arms:
        yield draw_arms(evidence.arms)
    yield _population(evidence)


def _manual(evidence: Evidence) -> Exhibit:
    driving = evidence.driving
    return Exhibit(
        name=MANUAL,
        title="Distributions of manual driving",
        caption="Grey: how many drivers or lane changes have that value; line: mean "
        "or median of the population; green: human range of that mean or median. "
        "Standard deviations and their ranges stand above the panels.",
        description=manual_figure.description(driving),
        figure=manual_figure.draw_population(driving),
    )


def _departures(evidence: Evidence) -> Iterator[Exhibit]:
    """Nothing where no driver keeps a lane."""
    if evidence.departures is not None:
        try:
            told = summarise(evidence.departures)
        except ValueError:
            return
        yield draw_departures(evidence.departures, told)


def _population(evidence: Evidence) -> Exhibit:
    return Exhibit(
        name=POPULATION,
        title="Parameters of the drivers and what goes together",
        caption="Histograms over the drivers with their median; correlations of the "
        "traits behind them, and the factors that they share.",
        description=parameters_description(evidence.drawn),
        figure=draw_parameters(evidence.drawn),
    )
