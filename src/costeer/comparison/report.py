"""Tables, figures and `report.html` of a comparison, from the results in its folder."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from costeer.base.files import write_text
from costeer.comparison.dictionary import (
    COLUMNS_FILE,
    EFFECTS_FILE,
    EXCLUSIONS_FILE,
    MEANS_FILE,
    WINNERS_FILE,
    ColumnRow,
    column_rows,
)
from costeer.comparison.drawings import worst_drawings
from costeer.comparison.effects import (
    EffectRow,
    MeanRow,
    effect_rows,
    mean_rows,
)
from costeer.comparison.figures import effects_against, trade_offs
from costeer.comparison.folder import read_comparison
from costeer.comparison.mistakes import NONE
from costeer.comparison.results import Failure, Results, gathered
from costeer.comparison.tables import (
    compared_table,
    exclusions_table,
    losses_table,
    means_table,
    mistakes_table,
    winners_table,
    worst_table,
)
from costeer.comparison.timing import NAME as TIMING
from costeer.comparison.timing import TITLE as TIMING_TITLE
from costeer.comparison.timing import inconsistency_timing
from costeer.comparison.winners import Loss, WinnerRow, losses, winner_rows
from costeer.comparison.words import (
    CAUTION,
    PAPERS,
    RULE,
    looked_at,
    loses,
    methods_paragraphs,
    subtitle,
)
from costeer.comparison.worst import WORST, WORST_FILE, WorstCase
from costeer.methods.conditions import MANUAL
from costeer.pages.frame import Picture, Section, picture, render_page, write_figures
from costeer.pages.style import styled
from costeer.pages.tables import versions_table
from costeer.study.locks import locked
from costeer.study.run import ignore
from costeer.study.trial_tables import write_csv

REPORT_FILE = "report.html"
BASELINES = (MANUAL, PAPERS)
NUM_STEPS = 2


class Material(NamedTuple):
    """What the page is made of."""

    results: Results
    effects: Sequence[EffectRow]
    means: Sequence[MeanRow]
    winners: Sequence[WinnerRow]
    lost: Sequence[Loss]
    cases: Sequence[WorstCase]


def remake_report(folder: Path, tell: Callable[[str], None] = ignore) -> Path:
    """Make tables, figures and page of a comparison again, finished or not.

    Nothing is simulated.

    Raises:
        ValueError: If it is no comparison, or in use.
        OSError: If a file cannot be read or written.
    """
    read_comparison(folder)
    with locked(folder):
        return write_report(folder, tell)


def write_report(folder: Path, tell: Callable[[str], None] = ignore) -> Path:
    """Write tables, figures and `report.html`; the same results give the same bytes.

    Args:
        folder: Of the comparison.
        tell: Called with a few words before each step.

    Returns:
        Path of the page.

    Raises:
        ValueError: If it is no comparison.
        OSError: If a file cannot be read or written.
    """
    tell("effects")
    results = gathered(read_comparison(folder))
    effects = effect_rows(results)
    material = Material(
        results=results,
        effects=effects,
        means=mean_rows(results),
        winners=winner_rows(results, effects),
        lost=losses(effects, PAPERS),
        cases=_worst_cases(folder),
    )
    _write_tables(folder, material)
    tell("figures")
    pictures = _pictures(folder, material)
    write_figures(folder / "figures", pictures.values())
    words = {
        "subtitle": subtitle(results),
        "rule": RULE,
        "winners": winners_table(results, material.winners, speaking=True),
        "loses": loses(material.lost, results),
        "looked_at": looked_at(results),
        "caution": CAUTION,
    }
    page = render_page(
        "comparison.html", _sections(material, pictures), words, "costeer.comparison"
    )
    write_text(folder / REPORT_FILE, page)
    return folder / REPORT_FILE


def _write_tables(folder: Path, material: Material) -> None:
    tables: tuple[tuple[str, Sequence[NamedTuple], tuple[str, ...]], ...] = (
        (EFFECTS_FILE, material.effects, EffectRow._fields),
        (MEANS_FILE, material.means, MeanRow._fields),
        (WINNERS_FILE, material.winners, WinnerRow._fields),
        (EXCLUSIONS_FILE, material.results.failures, Failure._fields),
        (COLUMNS_FILE, column_rows(), ColumnRow._fields),
    )
    for file, rows, columns in tables:
        write_csv(folder / file, [row._asdict() for row in rows], columns)


def _worst_cases(folder: Path) -> list[WorstCase]:
    """The cases of `worst.csv` whose records are there."""
    file = folder / WORST_FILE
    if not file.exists():
        return []
    with file.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    return [
        WorstCase(
            method=row["method"],
            scenario=row["scenario"],
            mistake=row["mistake"],
            participant=int(row["participant"]),
            num_collisions=int(row["num_collisions"]),
            num_lane_departures=int(row["num_lane_departures"]),
            what=row["what"],
            time=float(row["time"]),
            position=float(row["position"]),
            record=row["record"],
        )
        for row in rows
        if (folder / WORST / row["record"]).exists()
    ]


def _pictures(folder: Path, material: Material) -> dict[str, Picture]:
    results = material.results
    with styled():
        exhibits = [
            effects_against(results, material.effects, name)
            for name in BASELINES
            if name in results.methods
        ]
        exhibits += [
            trade_offs(results),
            inconsistency_timing(results),
            worst_drawings(folder, material.cases),
        ]
        return {each.name: picture(each) for each in exhibits}


def _sections(material: Material, pictures: dict[str, Picture]) -> list[Section]:
    results = material.results
    against = [p for name, p in pictures.items() if name.startswith("against-")]
    lost = (losses_table(material.lost),) if material.lost else ()
    sections = [
        Section(
            "winners",
            "Winners and ties",
            (),
            (winners_table(results, material.winners, speaking=False),),
        ),
        Section(
            "loses",
            "Where the paper's method loses",
            () if lost else (loses(material.lost, results),),
            lost,
        ),
        Section(
            "effects",
            "Paired effects",
            (),
            (*against, means_table(results, material.means)),
        ),
        Section("trade-offs", "Trade-offs", (), (pictures["trade-offs"],)),
        Section(TIMING, TIMING_TITLE, (), (pictures[TIMING],)),
        _worst_section(material.cases, pictures["worst-cases"]),
    ]
    if any(name != NONE for name in results.mistakes):
        table = mistakes_table(results, material.effects)
        sections.append(Section("mistakes", "Mistakes", (), (table,)))
    sections.append(_exclusions_section(results))
    made = (compared_table(results), versions_table())
    sections.append(Section("made", "Methods", methods_paragraphs(results), made))
    return sections


def _worst_section(cases: Sequence[WorstCase], drawn: Picture) -> Section:
    if not cases:
        words = "Nobody left a lane outside a lane change or hit anything."
        return Section("worst", "The worst cases", (words,), ())
    words = (
        "Of each method, the drive with the most collisions, then the most lane "
        "departures, without and with a mistake. To replay one: costeer replay "
        f"{WORST}/NAME."
    )
    return Section("worst", "The worst cases", (words,), (drawn, worst_table(cases)))


def _exclusions_section(results: Results) -> Section:
    words = []
    if not results.failures and not results.left_out:
        words.append("No trial failed and no combination was left out.")
    if results.faults:
        named = ", ".join(f"{name} ({n})" for name, n in results.faults.items())
        words.append(f"Asked for a torque not finite or over the limit: {named}.")
    else:
        words.append("No method asked for a torque not finite or over the limit.")
    some = results.failures or results.left_out
    shown = (exclusions_table(results),) if some else ()
    return Section("exclusions", "Exclusions", tuple(words), shown)
