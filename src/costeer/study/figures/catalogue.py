"""All figures of a study in the order of the report."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial

from costeer.methods.conditions import STRENGTHS
from costeer.pages.exhibit import Exhibit, not_drawn
from costeer.study.disputes import disputes
from costeer.study.figures import (
    agreement,
    bars,
    detection,
    forest,
    gain,
    inconsistency,
    signals,
    timing,
    traffic,
    trajectories,
    workload,
)
from costeer.study.figures.episodes import (
    exemplary_inconsistency,
    own_inconsistencies,
)
from costeer.study.material import StudyMaterial, replan_gain, why_without
from costeer.study.quantities import QUANTITIES, WORKLOAD

FIGURE_NAMES: tuple[str, ...] = (
    forest.NAME,
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


def draw_figures(material: StudyMaterial, only: str = "") -> Iterator[Exhibit]:
    """Draw one figure after the other; call it inside `styled`.

    Args:
        material: The study.
        only: Name of the one that is wanted; all if empty.

    Yields:
        Every figure there is, also those for which the study lacks something.
    """
    for names, draw in _drawings(material):
        if only in ("", *names):
            yield from (
                each
                for each in draw()
                if only in ("", each.name) or each.figure is None
            )


_Drawing = tuple[tuple[str, ...], Callable[[], Sequence[Exhibit]]]
"""Names of figures, and what draws those of them that there are."""


def _drawings(material: StudyMaterial) -> Iterator[_Drawing]:
    """All drawings in the order of the report."""
    yield (forest.NAME,), lambda: [forest.draw(material)]
    for quantity in QUANTITIES:
        yield (bars.file_name(quantity),), _one(bars.draw, material, quantity)
    if not material.num_results:
        yield (trajectories.NAME,), lambda: [trajectories.draw(material)]
    scores = tuple(bars.file_name(each) for each in WORKLOAD)
    asked = (workload.NAME, *scores, workload.ITEMS_NAME)
    yield asked, lambda: workload.draw(material)
    yield (detection.NAME,), lambda: [detection.draw(material)]
    yield from _of_records(material)
    yield (agreement.NAME,), lambda: agreement.draw(material)
    yield (traffic.NAME,), lambda: traffic.draw(material)


def _of_records(material: StudyMaterial) -> Iterator[_Drawing]:
    """The figures of single moments, or why they are not drawn."""
    if material.num_results:
        for name, title in OF_RECORDS:
            yield (name,), _one(not_drawn, name, title, _NO_RECORDS)
        return
    for each in STRENGTHS:
        yield (signals.file_name(each),), _one(signals.draw, material, each)
    limit, records = replan_gain(material), material.records
    silent = why_without(material, "num_inconsistencies")
    shown = cache(lambda: exemplary_inconsistency(records, limit))
    own = partial(own_inconsistencies, records, limit)
    yield (inconsistency.NAME,), lambda: [inconsistency.draw(shown(), silent, own())]
    yield (gain.NAME,), lambda: [gain.draw(shown(), limit, silent)]
    if not silent:
        yield (timing.NAME,), lambda: [timing.draw(material, disputes(material))]


def _one(draw: Callable[..., Exhibit], *of: object) -> Callable[[], Sequence[Exhibit]]:
    """Draw a single figure, later."""
    return lambda: [draw(*of)]


_NO_RECORDS = (
    "It is drawn from the records of all trials, and this study was run with "
    "--no-records."
)
