"""Tables of a study with people: answers, exclusions, agreement, when they disagree."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from costeer.methods.conditions import MANUAL
from costeer.pages.numerals import NOTHING, count, interval, number, p_value, signed
from costeer.pages.tables import Table
from costeer.study.agreement import AgreementRow, agreement
from costeer.study.disputes import Dispute, disputes
from costeer.study.material import StudyMaterial, conditions_driven, mark_of, pair
from costeer.study.outcome import FRIEDMAN, WILCOXON, WITHIN, StudyTests
from costeer.study.people import People
from costeer.study.quantities import QUANTITIES, WORKLOAD_ITEMS


def answers_table(tests: StudyTests) -> Table:
    """Return the six items of the NASA-TLX by condition with both kinds of tests."""
    means = {
        (row.measure, row.level): row
        for row in tests.summaries
        if row.analysis == WITHIN
    }
    names = list(dict.fromkeys(level for _, level in means))
    rows = []
    for item in WORKLOAD_ITEMS:
        cells = []
        for name in names:
            row = means.get((item.name, name))
            if row is None or not math.isfinite(row.mean):
                cells.append(NOTHING)
                continue
            marks = "" if name == MANUAL else f"\n{_marks(tests, item.name, name)}"
            ends = interval(row.low, row.high, 0)
            cells.append(f"{number(row.mean, 1)}\n{ends}{marks}".rstrip())
        rows.append((item.title, *cells, *_effects(tests, item.name)))
    return Table(
        name="workload-items",
        title="The six items of the NASA-TLX [0–100]",
        note="Means over participants, below them the 95 % interval and the marks "
        "against manual: Wilcoxon's signed ranks | paired t test, each corrected over "
        "the pairs of the item. W: Kendall's. Everything stands in answers_tests.csv, "
        "answers_pairs.csv and answers_summaries.csv.",
        header=("Item", *names, "Friedman χ² (df)", "p", "W", "F (df)", "p"),
        rows=tuple(rows),
    )


def _marks(tests: StudyTests, item: str, name: str) -> str:
    """Marks of a condition against manual, by ranks and by means."""
    found = []
    for analysis in (WILCOXON, WITHIN):
        wanted = (item, analysis, name, MANUAL)
        row = next((each for each in tests.pairs if each[:4] == wanted), None)
        found.append(mark_of(row))
    return " | ".join(found)


def _effects(tests: StudyTests, item: str) -> tuple[str, ...]:
    """Friedman's test and the analysis of variance of an item."""
    cells: list[str] = []
    for analysis in (FRIEDMAN, WITHIN):
        row = next(
            (r for r in tests.tests if r.measure == item and r.analysis == analysis),
            None,
        )
        is_rank = analysis == FRIEDMAN
        if row is None or not math.isfinite(row.statistic):
            cells += [NOTHING] * (3 if is_rank else 2)
            continue
        df1, df2 = row.df1 * row.epsilon, row.df2 * row.epsilon
        df = count(row.df1) if is_rank else f"{number(df1, 1)}, {number(df2, 1)}"
        cells.append(f"{number(row.statistic, 2)} ({df})")
        cells.append(f"{p_value(row.p_corrected)} {row.mark}".rstrip())
        cells += [number(row.effect_size, 2)] if is_rank else []
    return tuple(cells)


def timing_table(material: StudyMaterial) -> Table | None:
    """Return when inconsistencies begin, by condition; None if there are none."""
    found = disputes(material)
    names = [name for name in conditions_driven(material) if name != MANUAL]
    if not found:
        return None
    groups = [
        (name, [each for each in found if each.condition == name]) for name in names
    ]
    return Table(
        name="timing",
        title="When inconsistencies come",
        note="Of the first inconsistent verdict. In a lane change: from its start to "
        "its end by yaw. Time and share: median, below it the quartiles.",
        header=(
            "Condition",
            "Number",
            "In a lane change",
            "before the crossing",
            "after it",
            "Outside of one",
            "Time from crossing [s]",
            "Share of the lane change [%]",
        ),
        rows=tuple(_timing_row(name, own) for name, own in (*groups, ("all", found))),
    )


def _timing_row(name: str, own: Sequence[Dispute]) -> tuple[str, ...]:
    inside = [each for each in own if math.isfinite(each.share)]
    before = sum(each.from_crossing < 0.0 for each in inside)
    return (
        name,
        count(len(own)),
        count(len(inside)),
        count(before),
        count(len(inside) - before),
        count(len(own) - len(inside)),
        _quartiles([each.from_crossing for each in own], 1.0, 2),
        _quartiles([each.share for each in inside], 100.0, 0),
    )


def _quartiles(values: Sequence[float], factor: float, digits: int) -> str:
    known = [factor * value for value in values if math.isfinite(value)]
    if not known:
        return NOTHING
    low, middle, high = (float(q) for q in np.percentile(known, (25, 50, 75)))
    return f"{number(middle, digits)}\n{interval(low, high, digits)}"


def agreement_table(material: StudyMaterial, virtual: StudyMaterial) -> Table:
    """Return people beside virtual drivers, with the same tests of both."""
    rows = agreement(material, virtual)
    cells: list[tuple[str, ...]] = []
    for quantity in QUANTITIES:
        own = [each for each in rows if each.measure == quantity.name]
        for place, row in enumerate(own):
            title = f"{quantity.title}\n[{quantity.unit}]" if place == 0 else ""
            r = number(row.correlation, 2) if place == 0 else ""
            numbers = _agreement_cells(row, quantity.factor, quantity.digits)
            marks = [_mark(each, row) for each in (material, virtual)]
            cells.append((title, row.condition, *numbers, *marks, r))
    return Table(
        name="agreement",
        title="People beside virtual drivers",
        note="Means over participants' own means with 95 % intervals; difference: "
        "people less virtual drivers (Welch). Within: whether the mean of people lies "
        "in the 95 % prediction interval of the virtual drivers for the mean of as "
        "many others. Marks: against manual, within subjects, of each group by itself. "
        "r: correlation of both means over the conditions. Also in agreement.csv.",
        header=(
            "Measure",
            "Condition",
            "People",
            "Virtual drivers",
            "Difference",
            "Prediction",
            "Within",
            "Mark, people",
            "Mark, virtual",
            "r",
        ),
        rows=tuple(cells),
        num_labels=2,
    )


def _agreement_cells(row: AgreementRow, factor: float, digits: int) -> list[str]:
    def told(mean: float, low: float, high: float) -> str:
        ends = interval(low * factor, high * factor, digits)
        return f"{number(mean * factor, digits)}\n{ends}".rstrip()

    ends = interval(row.prediction_low * factor, row.prediction_high * factor, digits)
    apart = interval(row.difference_low * factor, row.difference_high * factor, digits)
    return [
        told(row.mean_people, row.low_people, row.high_people),
        told(row.mean_virtual, row.low_virtual, row.high_virtual),
        f"{signed(row.difference * factor, digits)}\n{apart}".rstrip(),
        ends or NOTHING,
        {True: "yes", False: "no", None: NOTHING}[row.inside],
    ]


def _mark(material: StudyMaterial, row: AgreementRow) -> str:
    """Mark of a condition against manual; for lane keeping too by condition."""
    if row.condition == MANUAL:
        return ""
    return mark_of(pair(material, row.measure, WITHIN, row.condition, MANUAL))


def agreement_sentence(material: StudyMaterial, virtual: StudyMaterial) -> str:
    """Say how often the mean of people lies in the prediction."""
    rows = agreement(material, virtual)
    judged = [each for each in rows if each.inside is not None]
    if not judged:
        return "Nothing can be compared: no mean of two virtual drivers or more."
    inside = sum(bool(each.inside) for each in judged)
    missed = [
        title
        for title, name in ((each.title, each.name) for each in QUANTITIES)
        if any(each.measure == name and not each.inside for each in judged)
    ]
    where = f" Outside at least once: {', '.join(missed)}." if missed else ""
    return (
        f"{inside} of {len(judged)} means of people lie in the 95 % prediction "
        f"interval of the virtual drivers; of a correct prediction, 95 % would.{where}"
    )


def exclusions_table(people: People) -> Table | None:
    """Return the log of exclusions; None if there are none."""
    rows = tuple(
        (
            each.participant or NOTHING,
            each.condition or NOTHING,
            each.attempt or NOTHING,
            each.state,
            each.reason or NOTHING,
            each.utc[:19].replace("T", " ") or NOTHING,
        )
        for each in people.exclusions
    )
    if not rows:
        return None
    return Table(
        name="exclusions",
        title="Exclusion log",
        note="Drives that are not in the tables, and trials that were planned and are "
        "not there. Also in exclusions.csv.",
        header=(
            "Participant",
            "Condition",
            "Attempt",
            "State",
            "Reason",
            "Begun (UTC)",
        ),
        rows=rows,
        num_labels=6,
        prose=True,
    )
