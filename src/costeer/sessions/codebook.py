"""`codebook.csv`: every column of every table and record, and every question asked."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from costeer.records.columns import COLUMNS, Column
from costeer.sessions.fields import FIELDS, QUESTIONNAIRES_FILE, SCORES_FILE, STORE
from costeer.sessions.questionnaires.definition import Item
from costeer.sessions.questionnaires.instrument import Instrument, load_instrument
from costeer.sessions.session import Session
from costeer.study.dictionary import tables
from costeer.study.people import EXCLUSIONS_FILE
from costeer.study.trial_tables import write_csv

CODEBOOK_FILE = "codebook.csv"
HEAD = ("file", "column", "meaning", "unit", "range", "source")

Row = tuple[str, str, str, str, str, str]

_RANGES = {"int8": "whole number", "bool": "true or false", "float64": "number"}


def write_codebook(out: Path, session: Session) -> None:
    """Write what every column is.

    Args:
        out: Folder to write in.
        session: Whose instruments and language the questions are in.

    Raises:
        ValueError: If an instrument of the plan cannot be read.
        OSError: If a file cannot be read or written.
    """
    rows = [dict(zip(HEAD, row, strict=True)) for row in codebook(session)]
    write_csv(out / CODEBOOK_FILE, rows, HEAD)


def codebook(session: Session) -> Iterator[Row]:
    """Rows of `codebook.csv`."""
    for file, fields in FIELDS.items():
        for field in fields:
            yield (file, *field)
    for instrument in asked(session):
        yield from _questions(instrument)
    for file, entries in tables().items():
        source = "statistics of costeer report"
        if file in ("trials.csv", "lane_changes.csv", "triggers.csv"):
            source = "measured from the records"
        source = STORE if file == EXCLUSIONS_FILE else source
        for entry in entries:
            yield (file, *entry, source)
    for column in COLUMNS:
        yield _of_record(column)


def asked(session: Session) -> list[Instrument]:
    """Instruments of the plan, and of every answer that there is, in its language."""
    plans = [
        session.plan,
        *(session.plan_of(r["participant"]) for r in session.people()),
    ]
    steps = [
        step for plan in plans for each in plan.steps for step in (each, *each.after)
    ]
    names = {step.instrument for step in steps if step.instrument}
    given = session.store.rows("SELECT DISTINCT instrument FROM answers")
    names |= {row["instrument"] for row in given}
    found = []
    for name in sorted(names):
        try:
            found.append(load_instrument(name, session.plan.language, session.folder))
        except ValueError:
            if name not in {row["instrument"] for row in given}:
                raise
    return found


def _questions(instrument: Instrument) -> Iterator[Row]:
    """A row for each item and each score of an instrument."""
    source = f"{instrument.name} version {instrument.version}: {instrument.source}"
    for item in instrument.items:
        text = instrument.texts[item.name]
        said = ": ".join(part for part in (text.title, text.text) if part)
        if item.kind == "pairs":
            said = f"which weighs more: {' or '.join(text.labels.values())}"
        ends = f" ({text.low} ... {text.high})" if text.low and text.high else ""
        name = f"value of {instrument.name}.{item.name}"
        yield QUESTIONNAIRES_FILE, name, f"{said}{ends}", "-", _range(item), source
    for score in instrument.scores:
        turned = [
            e.name for e in instrument.items if e.reversed and e.name in score.items
        ]
        said = f"{score.how} of {', '.join(score.items)}"
        said += f", times {score.factor:g}" if score.factor != 1.0 else ""
        said += f"; reversed: {', '.join(turned)}" if turned else ""
        name = f"value of {instrument.name}.{score.name}"
        yield SCORES_FILE, name, said, "-", "number", source


def _range(item: Item) -> str:
    if item.kind in ("scale", "number"):
        return f"{item.low:g} to {item.high:g} in steps of {item.step:g}"
    if item.options:
        return ", ".join(item.options)
    return f"text, up to {item.longest} characters"


def _of_record(column: Column) -> Row:
    values = ", ".join(column.labels) or _RANGES[column.kind]
    empty = [
        "null where undefined" if column.nullable else "",
        "undefined in manual" if column.assisted_only and not column.labels else "",
    ]
    told = "; ".join([values, *(each for each in empty if each)])
    return (
        "records/*.parquet",
        column.name,
        column.description,
        column.unit,
        told,
        "60 samples per second",
    )
