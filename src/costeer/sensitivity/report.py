"""The report of a sensitivity analysis: indices, curves to choose by, tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from costeer.base.files import write_text
from costeer.pages.frame import Section, picture, render_page, write_figures
from costeer.pages.numerals import plural
from costeer.pages.style import styled
from costeer.pages.tables import Table, versions_table
from costeer.sensitivity.factors import AIMS, FACTORS
from costeer.sensitivity.figures import curves, shares
from costeer.sensitivity.run import Index, Outcome, Point, Settings, indices_of, points
from costeer.study.trial_tables import write_csv

REPORT_FILE, INDICES_FILE, SAMPLES_FILE = "report.html", "indices.csv", "samples.csv"
_LITTLE = 0.05
"""Share of a variance that nobody would choose a factor for [-]."""

Indices = dict[str, list[Index] | str]


def write_report(folder: Path, settings: Settings, outcomes: Sequence[Outcome]) -> Path:
    """Write `report.html`, `indices.csv`, `samples.csv` and `figures/`.

    Args:
        folder: Of the analysis.
        settings: As it was driven.
        outcomes: Of all samples, in order.

    Returns:
        Path of the page.

    Raises:
        OSError: If a file cannot be written.
    """
    drawn = points(settings)
    values = {aim.name: np.array([each[aim.name] for each in outcomes]) for aim in AIMS}
    found: Indices = {n: indices_of(settings, n, v) for n, v in values.items()}
    _write_tables(folder, drawn, outcomes, found)
    with styled():
        indices = picture(shares(found))
        drawings = [picture(curves(aim, drawn, values[aim.name])) for aim in AIMS]
    write_figures(folder / "figures", [indices, *drawings])
    sections = (
        Section("indices", "What decides what", (), (indices, _index_table(found))),
        Section("curves", "Curves to choose by", (_HOW,), tuple(drawings)),
        Section("bounds", "What was varied", (), (_bounds_table(),)),
        Section("made", "How this was made", (), (versions_table(),)),
    )
    words = {
        "title": "Sensitivity",
        "heading": "Sensitivity of the intention-based guidance",
        "subtitle": f"costeer, {plural(settings.drivers, 'pilot driver')}",
        "looked_at": [
            f"{len(drawn)} samples of {len(FACTORS)} factors (Saltelli's scheme from "
            f"{settings.base}), each driven by the same "
            f"{plural(settings.drivers, 'pilot driver')} over "
            f"{settings.length / 1000.0:g} km with the same noise."
        ],
        "outcomes": _outcomes(found),
        "caution": (
            "These are virtual drivers who are in no study.",
            "Nothing here changes a default; an index is of these bounds.",
        ),
    }
    write_text(folder / REPORT_FILE, render_page("judgement.html", sections, words))
    return folder / REPORT_FILE


_HOW = (
    "Each panel has one factor, in eighths of its range, while all others vary: the "
    "line is the mean of a measure with the 95 % interval of that mean, the grey band "
    "holds 80 % of the samples, dashed is the published value. A flat line is a factor "
    "that changes the measure little, except together with others: see the total "
    f"indices. All samples are in {SAMPLES_FILE}."
)


def _write_tables(
    folder: Path, drawn: Sequence[Point], outcomes: Sequence[Outcome], found: Indices
) -> None:
    names = [each.place for each in FACTORS]
    rows = [
        {**dict(zip(names, point, strict=True)), **outcome}
        for point, outcome in zip(drawn, outcomes, strict=True)
    ]
    write_csv(folder / SAMPLES_FILE, rows)
    known = [each for each in found.values() if not isinstance(each, str)]
    indices = [row._asdict() for each in known for row in each]
    write_csv(folder / INDICES_FILE, indices, Index._fields)


def _outcomes(found: Indices) -> list[tuple[str, str]]:
    """The factors that count most for each measure, and those that count for none."""
    told = [(aim.title, _what_counts(found[aim.name])) for aim in AIMS]
    free = idle(found)
    if free:
        words = (
            f"{', '.join(free)}: at most {100.0 * _LITTLE:g} % of the variance of any "
            "measure above that these samples decide."
        )
        told.append(("Matters for none", words))
    return told


def _what_counts(rows: list[Index] | str) -> str:
    """The two largest total indices, as far as these samples decide them."""
    if isinstance(rows, str):
        return f"no index: {rows}."
    widest = max(rows, key=lambda row: row.total_half_width)
    if not decided(rows):
        return (
            f"not decided by these samples: {_with_interval(widest)} (total index); "
            "drive more."
        )
    known = [row for row in rows if row.total > row.total_half_width]
    largest = sorted(known, key=lambda row: -row.total)[:2]
    if not largest:
        return "no factor can be told from none."
    return f"{', then '.join(map(_with_interval, largest))} (total index)."


def _with_interval(row: Index) -> str:
    return f"{row.factor} {row.total:.2f} ± {row.total_half_width:.2f}"


def decided(rows: list[Index]) -> bool:
    """Whether every 95 % interval of a total is narrower than an index can be wide."""
    return all(row.total_half_width <= 0.5 for row in rows)


def idle(found: Indices) -> list[str]:
    """Factors whose total index is under 5 % for every measure, interval included."""
    known = [
        rows for rows in found.values() if not isinstance(rows, str) and decided(rows)
    ]
    return [
        factor.name
        for place, factor in enumerate(FACTORS)
        if known
        and all(
            rows[place].total + rows[place].total_half_width <= _LITTLE
            for rows in known
        )
    ]


def _index_table(found: Indices) -> Table:
    rows = []
    for aim in AIMS:
        each = found[aim.name]
        if isinstance(each, str):
            rows.append((aim.title, *["–"] * len(FACTORS)))
        else:
            cells = (f"{row.total:.2f} ± {row.total_half_width:.2f}" for row in each)
            rows.append((aim.title, *cells))
    return Table(
        name="total-indices",
        title="Total indices",
        note="With half the width of the 95 % interval. An interval that holds 0 is a "
        "factor that these samples cannot tell from none.",
        header=("Measure", *(each.name for each in FACTORS)),
        rows=tuple(rows),
    )


def _bounds_table() -> Table:
    return Table(
        name="bounds",
        title="Factors and bounds",
        note="Uniform between the bounds.",
        header=("Factor", "Parameter", "From", "To", "Published", "Unit", "Source"),
        rows=tuple(
            (
                f.name,
                f.place,
                f"{f.low:g}",
                f"{f.high:g}",
                f"{f.usual:g}",
                f.unit,
                f.source,
            )
            for f in FACTORS
        ),
        num_labels=2,
        num_words=2,
        prose=True,
    )


def _three(low: float, high: float, usual: float) -> tuple[str, str, str]:
    return f"{low:g}", f"{high:g}", f"{usual:g}"
