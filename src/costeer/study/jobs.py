"""Work in threads that can be stopped and never loses what is finished.

Threads suffice, because compiled trials release the interpreter's lock.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import TypeVar

Task = TypeVar("Task")
Result = TypeVar("Result")

MOST_JOBS = 256
_LOOK_EVERY = 0.2  # s; Windows delivers Ctrl-C only between waits


class JobsStoppedError(Exception):
    """Work that came to no end; its cause is what stopped it.

    Attributes:
        num_done: Tasks that were finished.
        failed: Place of the task that failed; None if something else went wrong.
    """

    def __init__(self, num_done: int, failed: int | None) -> None:
        super().__init__(f"stopped after {num_done} tasks")
        self.num_done = num_done
        self.failed = failed


def usable_cores() -> int:
    """Return how many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def default_jobs() -> int:
    """Return how many threads are worth while."""
    return min(usable_cores(), MOST_JOBS)


def run_jobs(
    work: Callable[[Task], Result],
    tasks: Sequence[Task],
    jobs: int,
    progress: Callable[[Result], None],
) -> list[Result]:
    """Do all tasks in threads; return the results in the order of the tasks.

    When a task fails or the user interrupts, those that run are finished and no
    other is begun.

    Args:
        work: Does one task.
        tasks: All of them.
        jobs: How many threads.
        progress: Called in this thread with each result as it comes.

    Raises:
        JobsStoppedError: From the error of a task, or from KeyboardInterrupt.
    """
    with ThreadPoolExecutor(max_workers=jobs) as pool:
        futures = [pool.submit(work, task) for task in tasks]
        try:
            _watch(futures, progress)
        except BaseException as error:
            pool.shutdown(wait=True, cancel_futures=True)
            raise _stopped(futures) from error
    return [future.result() for future in futures]


def _watch(
    futures: Sequence[Future[Result]], progress: Callable[[Result], None]
) -> None:
    pending = set(futures)
    while pending:
        done, pending = wait(pending, _LOOK_EVERY, return_when=FIRST_COMPLETED)
        for future in done:
            progress(future.result())


def _stopped(futures: Sequence[Future[Result]]) -> JobsStoppedError:
    ended = [place for place, future in enumerate(futures) if not future.cancelled()]
    failed = [place for place in ended if futures[place].exception() is not None]
    return JobsStoppedError(len(ended) - len(failed), failed[0] if failed else None)
