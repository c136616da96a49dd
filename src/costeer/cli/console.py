"""What commands print besides results: progress on stderr, tables on stdout."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Literal

Advance = Callable[[int], None]
"""Tells the progress display that so many more pieces are done."""


@contextmanager
def progress(description: str, total: int, done: int = 0) -> Iterator[Advance]:
    """Show on stderr how far a long command is: a bar, or a line for each tenth.

    Args:
        description: What is being done.
        total: Number of pieces.
        done: Pieces that an earlier run finished.

    Yields:
        A function to call with the number of pieces just finished, from one thread.
    """
    show = _bar if sys.stderr.isatty() else _lines
    with show(description, total, done) as advance:

        def begun(pieces: int) -> None:
            release_notes()
            advance(pieces)

        yield begun


@contextmanager
def _bar(description: str, total: int, done: int) -> Iterator[Advance]:
    """A bar with the time passed and the time left, for a terminal."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True)) as display:
        task = display.add_task(description, total=total, completed=done)
        yield lambda pieces: display.advance(task, pieces)


@contextmanager
def _lines(description: str, total: int, done: int) -> Iterator[Advance]:
    """A line for each tenth that is done, for a log file."""
    start = time.monotonic()
    finished, printed = done, _tenths(done, total)

    def advance(pieces: int) -> None:
        nonlocal finished, printed
        finished += pieces
        if _tenths(finished, total) > printed:
            printed = _tenths(finished, total)
            elapsed = time.monotonic() - start
            note(f"{description}: {finished} of {total}, {elapsed:.0f} s")

    yield advance


def _tenths(finished: int, total: int) -> int:
    """Whole tenths that are done."""
    return 10 * finished // total if total > 0 else 10


_held: list[str] | None = None
"""Notes that wait until work begins; None if they are told at once."""


def hold_notes() -> None:
    """Keep notes back until work begins: who is refused reads the refusal alone."""
    global _held
    _held = []


def release_notes(told: bool = True) -> None:
    """Tell the notes that were kept back, or forget them, and keep none from now on."""
    global _held
    waiting, _held = _held or [], None
    for each in waiting if told else ():
        note(each)


def note(message: str, at_once: bool = False) -> None:
    """Tell the user something on stderr, away from results.

    Args:
        message: What to tell.
        at_once: Whether it is told even while others are kept back.
    """
    if _held is not None and not at_once:
        _held.append(message)
        return
    print(message, file=sys.stderr, flush=True)


def note_all(file: Path, lines: Iterable[str]) -> None:
    """Tell what a reader should know of a file."""
    for line in lines:
        note(f"note on {file}: {line}")


def print_table(
    headings: Sequence[str], rows: Sequence[Sequence[str]], title: str = ""
) -> None:
    """Print a table on stdout; a column whose cells are all numbers leans right.

    A terminal folds it to its width, but for the first column, which people copy; in a
    file or a pipe it is as wide as it needs.
    """
    from rich.console import Console
    from rich.measure import Measurement
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(title) if title else None, title_justify="left")
    for index, heading in enumerate(headings):
        cells = [row[index] for row in rows]
        numeric = all(map(_is_number, cells))
        side: Literal["left", "right"] = "right" if numeric else "left"
        table.add_column(
            Text(heading), justify=side, overflow="fold", no_wrap=index == 0
        )
    for row in rows:
        table.add_row(*map(Text, row))
    console = Console()
    if not console.is_terminal:
        wide = Console(width=1000)
        console.width = Measurement.get(wide, wide.options, table).maximum
    console.print(table)


def _is_number(cell: str) -> bool:
    """Whether a cell holds a number, a dash or nothing."""
    if cell in {"", "-", "–"}:
        return True
    try:
        float(cell)
    except ValueError:
        return False
    return True
