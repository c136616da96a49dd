"""All figures of a study in the order of the report."""

from __future__ import annotations

from collections.abc import Iterator

from costeer.methods.conditions import STRENGTHS
from costeer.pages.exhibit import Exhibit
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


def draw_figures(material: StudyMaterial) -> Iterator[Exhibit]:
    """Draw one figure after the other; call it inside `styled`.

    Args:
        material: The study.

    Yields:
        Every figure there is, also those for which the study lacks something.
    """
    gain_limit = replan_gain(material)
    episode = exemplary_inconsistency(material.records, gain_limit)
    for quantity in QUANTITIES:
        yield bars.draw(material, quantity)
    yield trajectories.draw(material)
    yield from workload.draw(material)
    yield detection.draw(material)
    for strength in STRENGTHS:
        yield signals.draw(material, strength)
    no_verdict = why_without(material, "num_inconsistencies")
    yield inconsistency.draw(episode, no_verdict)
    yield gain.draw(episode, gain_limit, no_verdict)
    if not no_verdict:
        yield timing.draw(material, disputes(material))
    yield from agreement.draw(material)
    yield from traffic.draw(material)
