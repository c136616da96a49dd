"""How far a study is: trials done, driver-seconds per second, time left."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from costeer.cli.console import progress

if TYPE_CHECKING:
    from costeer.study.trials import TrialDone

ShowTrial = Callable[["TrialDone"], None]


@contextmanager
def trial_progress(total: int) -> Iterator[ShowTrial]:
    """Show on stderr how far the trials are: a bar, or a line for each tenth.

    Args:
        total: Number of trials.

    Yields:
        A function to call with each trial that is done, from one thread.
    """
    if sys.stderr.isatty():
        with _bar(total) as show:
            yield show
    else:
        with progress("trials", total) as advance:
            yield lambda _: advance(1)


@contextmanager
def _bar(total: int) -> Iterator[ShowTrial]:
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
    with Progress(*columns, console=Console(stderr=True)) as display:
        task = display.add_task("", total=total)
        yield lambda done: display.update(task, advance=1, description=rate(done))


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
