"""Work in threads or on a cluster that can be stopped and loses nothing finished.

Threads suffice on one machine, because compiled trials release the interpreter's lock.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import TypeAlias, TypeVar

from costeer.scale.blocks import Engine, JobsStoppedError, run_blocks

__all__ = ["MOST_JOBS", "JobsStoppedError", "Pool", "default_jobs", "run_jobs"]

Task = TypeVar("Task")
Result = TypeVar("Result")

Pool: TypeAlias = int | Engine
"""Who works: so many threads of this process, or the workers of a cluster."""

MOST_JOBS = 256
_LOOK_EVERY = 0.2  # s; Windows delivers Ctrl-C only between waits


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
    pool: Pool,
    progress: Callable[[Result], None],
    keep: Callable[[Task, Result], Result] | None = None,
) -> list[Result]:
    """Do all tasks in threads or on a cluster; return the results in their order.

    When a task fails or the user interrupts, those that run are finished and no
    other is begun.

    Args:
        work: Does one task. To a cluster it is sent, with all that it closes over.
        tasks: All of them.
        pool: How many threads, or the cluster of `workers`.
        progress: Called in this thread with each result as it comes.
        keep: Called in this process with each task and its result, also of tasks that
            end after an interruption; what it returns takes the result's place.

    Raises:
        JobsStoppedError: From the error of a task, or from KeyboardInterrupt.
    """
    if not isinstance(pool, int):
        return run_blocks(work, tasks, pool, progress, keep)

    def done(task: Task) -> Result:
        result = work(task)
        return result if keep is None else keep(task, result)

    with ThreadPoolExecutor(max_workers=pool) as threads:
        futures = [threads.submit(done, task) for task in tasks]
        try:
            _watch(futures, progress)
        except BaseException as error:
            threads.shutdown(wait=True, cancel_futures=True)
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
