"""How far a study is: trials done, driver-seconds per second, time left, report."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple

from costeer.cli.console import note, progress

if TYPE_CHECKING:
    from costeer.study.trials import TrialDone


class Display(NamedTuple):
    """What to call as the study goes on, from one thread.

    Attributes:
        trial: With each trial that is done.
        step: With a few words before each step of the report.
    """

    trial: Callable[[TrialDone], None]
    step: Callable[[str], None]


@contextmanager
def study_progress(total: int) -> Iterator[Display]:
    """Show on stderr how far a study is: a bar, or lines in a log.

    Args:
        total: Number of trials.

    Yields:
        What to call as it goes on.
    """
    if sys.stderr.isatty():
        with _bar(total) as display:
            yield display
    else:
        with progress("trials", total) as advance:
            yield Display(lambda _: advance(1), lambda words: note(f"report: {words}"))


@contextmanager
def _bar(total: int) -> Iterator[Display]:
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
        TextColumn("trials"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.description}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    rate = speedometer()
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("", total=total)
        yield Display(
            trial=lambda done: bar.update(task, advance=1, description=rate(done)),
            step=lambda words: bar.update(task, description=f"report: {words}"),
        )


def speedometer(
    clock: Callable[[], float] = time.monotonic,
) -> Callable[[TrialDone], str]:
    """Return a function that tells the driver-seconds simulated per second so far.

    Args:
        clock: Seconds that pass.
    """
    start = clock()
    simulated = 0.0

    def rate(done: TrialDone) -> str:
        nonlocal simulated
        simulated += 0.0 if done.resumed else done.driver_seconds
        elapsed = clock() - start
        if simulated == 0.0 or elapsed <= 0.0:
            return ""
        return f"{simulated / elapsed:,.0f} driver-s/s"

    return rate
