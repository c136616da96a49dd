"""All figures of a study in the order of the report."""

from __future__ import annotations

from collections.abc import Iterator

from costeer.methods.conditions import STRENGTHS
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.study.disputes import disputes
from costeer.study.figures import (
    agreement,
    bars,
    detection,
    gain,
    inconsistency,
    signals,
    timing,
    traffic,
    trajectories,
    workload,
)
from costeer.study.figures.episodes import exemplary_inconsistency
from costeer.study.material import StudyMaterial, replan_gain, why_without
from costeer.study.quantities import QUANTITIES, WORKLOAD

FIGURE_NAMES: tuple[str, ...] = (
    *(bars.file_name(each) for each in (*QUANTITIES, *WORKLOAD)),
    trajectories.NAME,
    workload.ITEMS_NAME,
    detection.NAME,
    *(signals.file_name(each) for each in STRENGTHS),
    inconsistency.NAME,
    gain.NAME,
    timing.NAME,
    agreement.NAME,
    traffic.NAME,
)
"""Stems of all files in `figures/`."""


OF_RECORDS = (
    (trajectories.NAME, trajectories.TITLE),
    *((signals.file_name(each), signals.title(each)) for each in STRENGTHS),
    (inconsistency.NAME, inconsistency.TITLE),
    (gain.NAME, gain.TITLE),
    (timing.NAME, timing.TITLE),
)
"""Name and title of the figures that need every trial's record."""


def draw_figures(material: StudyMaterial) -> Iterator[Exhibit]:
    """Draw one figure after the other; call it inside `styled`.

    Args:
        material: The study.

    Yields:
        Every figure there is, also those for which the study lacks something.
    """
    for quantity in QUANTITIES:
        yield bars.draw(material, quantity)
    if not material.num_results:
        yield trajectories.draw(material)
    yield from workload.draw(material)
    yield detection.draw(material)
    yield from _of_records(material)
    yield from agreement.draw(material)
    yield from traffic.draw(material)


def _of_records(material: StudyMaterial) -> Iterator[Exhibit]:
    """The figures of single moments, or why they are not drawn."""
    if material.num_results:
        for name, title in OF_RECORDS:
            yield not_drawn(name, title, _NO_RECORDS)
        return
    for strength in STRENGTHS:
        yield signals.draw(material, strength)
    gain_limit = replan_gain(material)
    episode = exemplary_inconsistency(material.records, gain_limit)
    no_verdict = why_without(material, "num_inconsistencies")
    yield inconsistency.draw(episode, no_verdict)
    yield gain.draw(episode, gain_limit, no_verdict)
    if not no_verdict:
        yield timing.draw(material, disputes(material))


_NO_RECORDS = (
    "It is drawn from the records of all trials, and this study was run with "
    "--no-records."
)
