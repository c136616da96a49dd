"""Simulations side by side, as the validation runs them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from costeer.scale.jobs import JobsStoppedError, run_jobs

Task = TypeVar("Task")
Result = TypeVar("Result")


def in_threads(
    work: Callable[[Task], Result],
    tasks: Sequence[Task],
    jobs: int,
    progress: Callable[[int], None] | None = None,
) -> list[Result]:
    """Do all tasks in threads; return the results in the order of the tasks.

    Args:
        work: Does one task.
        tasks: All of them.
        jobs: How many threads.
        progress: Called with the number of tasks just done.

    Raises:
        BaseException: What stopped a task, as the task raised it.
    """

    def told(_: Result) -> None:
        if progress is not None:
            progress(1)

    try:
        return run_jobs(work, tasks, jobs, told)
    except JobsStoppedError as stopped:
        raise (stopped.__cause__ or stopped) from None
