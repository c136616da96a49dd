"""What stands on the page in which order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from costeer.drivers.population import USUAL
from costeer.pages.frame import Picture, Section
from costeer.pages.tables import Table, versions_table
from costeer.validation.departures import summarise
from costeer.validation.manual import compare
from costeer.validation.overview import overview
from costeer.validation.populations import population_told
from costeer.validation.reporting import (
    arm_figures,
    departures_part,
    people_figures,
    pictures,
    spread_figure,
)
from costeer.validation.reporting.evidence import Evidence
from costeer.validation.reporting.people_tables import people_table
from costeer.validation.reporting.population_tables import (
    factors_table,
    parameters_table,
)
from costeer.validation.reporting.single_tables import (
    arms_table,
    resistance_table,
    stability_table,
)
from costeer.validation.reporting.summary import (
    elsewhere_sentence,
    recordings_sentence,
)
from costeer.validation.reporting.target_tables import overview_table, targets_table

Pictures = Mapping[str, Picture]


def page_sections(evidence: Evidence, drawn: Pictures) -> list[Section]:
    """Return all sections; one without its input says so in a sentence.

    Args:
        evidence: All that was simulated.
        drawn: Pictures by name.
    """
    return [
        _targets(evidence, drawn),
        _people(evidence, drawn),
        _departures(evidence, drawn),
        _arms(evidence, drawn),
        _resistance(evidence),
        _stability(evidence),
        _population(evidence, drawn),
        _making(evidence),
    ]


def _chosen(drawn: Pictures, names: Sequence[str]) -> tuple[Table | Picture, ...]:
    return tuple(drawn[name] for name in names if name in drawn)


def _targets(evidence: Evidence, drawn: Pictures) -> Section:
    text = (
        "The drivers were calibrated on these twelve ranges, on seeds of which "
        "docs/decisions/0009-drivers-frozen.md tells: to meet them on another seed "
        "shows that chance did not meet them, not that people drive so.",
        "Each driver drove twice. Where r is high a value is the driver's own, where "
        "it is near zero chance. In people SDLP correlates by 0.80 over two drives of "
        "100 km on the road (Verster and Roth 2011); shorter drives correlate less.",
    )
    items = (
        targets_table(compare(evidence.driving), evidence.spreads),
        *_chosen(drawn, (pictures.MANUAL, spread_figure.NAME)),
        overview_table(overview(evidence.driving)),
    )
    return Section("targets", "Manual driving: M1 to M12", text, items)


def _people(evidence: Evidence, drawn: Pictures) -> Section:
    name, title = "people", "People beside virtual drivers"
    if not evidence.people:
        return Section(name, title, ("Nothing was compared with people.",), ())
    text = (
        "The same quantity, computed in the same way from recordings of people and "
        "from manual trials of the virtual drivers. "
        + recordings_sentence(evidence)
        + elsewhere_sentence(evidence)
        + " Ranges were fixed before, from half of each recording.",
        people_figures.HOW_TO_READ,
    )
    figures = [group.name for group in (*people_figures.GROUPS, people_figures.OTHERS)]
    items = (
        people_table(evidence.people),
        *_chosen(drawn, (*figures, people_figures.SPECTRA)),
    )
    return Section(name, title, text, items)


def _departures(evidence: Evidence, drawn: Pictures) -> Section:
    name, title = "departures", "Lane departures"
    try:
        told = summarise(evidence.departures) if evidence.departures else None
    except ValueError:
        told = None
    if told is None:
        missing = "No driver kept a lane for long enough to tell of departures."
        return Section(name, title, (missing,), ())
    text = (
        "Whoever corrects more firmly near a line departs less often than a Gaussian "
        "lane position of the same spread would; whoever lets go there, more often.",
    )
    items = (
        departures_part.departures_table(told),
        *_chosen(drawn, (departures_part.NAME,)),
    )
    return Section(name, title, text, items)


def _arms(evidence: Evidence, drawn: Pictures) -> Section:
    name, title = "arms", "Arms"
    if not evidence.arms:
        return Section(name, title, ("The arms were not tested.",), ())
    text = (
        "A motor moves the wheel that hands hold with a sum of sines, and the "
        "admittance of hands and arms is read off: relaxed (muscles alone), driving "
        "(with reflex and the intention to go straight) and tense (stiffened too). "
        "The range is assumed: it follows from inertia, damping and stiffness of arms "
        "as the field gives them, not from a table of one study.",
    )
    items = (*_chosen(drawn, (arm_figures.NAME,)), arms_table(evidence.arms))
    return Section(name, title, text, items)


def _resistance(evidence: Evidence) -> Section:
    name, title = "resistance", "Wrong guidance"
    if not evidence.resistance:
        missing = "No wrong guidance was tried."
        return Section(name, title, (missing,), ())
    text = (
        "Drivers keep their lane under strong guidance when the system starts a lane "
        "change that they do not want. They are pilot drivers with a seed of their "
        "own, no participants of any study; nothing is tuned on this test.",
    )
    return Section(name, title, text, (resistance_table(evidence.resistance),))


def _stability(evidence: Evidence) -> Section:
    name, title = "stability", "Stability"
    if evidence.stability is None:
        return Section(name, title, ("Stability was not looked at.",), ())
    text = (
        "Does any driver swing, or leave the road? Eigenvalues of the linear loop of "
        "driver and car, runs without noise from 0.5 m beyond what the driver lets go, "
        "and a manual trial of each driver.",
    )
    return Section(name, title, text, (stability_table(evidence.stability),))


def _population(evidence: Evidence, drawn: Pictures) -> Section:
    who = population_told(evidence.drawn.population).capitalize()
    text = (
        f"{who}. A driver is drawn by seed and number: "
        "correlated normal traits, and from each trait a parameter, log-normal where "
        "it is positive, else normal and clipped to its range.",
    )
    items = (
        *_chosen(drawn, (pictures.POPULATION,)),
        parameters_table(evidence.drawn),
        factors_table(),
    )
    return Section("population", "The population", text, items)


def _making(evidence: Evidence) -> Section:
    number = len(evidence.driving.trials)
    drawn = evidence.drawn
    command = f"costeer drivers --validate --out DIR --participants {number} "
    command += f"--seed {drawn.seed}"
    if drawn.population != USUAL:
        command += f" --population {drawn.population.name}"
    text = (
        f"Run again: {command}, with --data DIR or COSTEER_DATA for the folder with "
        "the recordings of people. The same version, seed, number and recordings give "
        "the same bytes, whatever --jobs; there is no date in them.",
        "The folder holds this page, the verdicts as CSV (targets.csv, real.csv) and "
        "the figures as SVG (figures/).",
    )
    return Section("making", "How to make it again", text, (versions_table(),))
