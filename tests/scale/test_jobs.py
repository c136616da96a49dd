"""Work in threads stops cleanly and reports in order."""

from __future__ import annotations

import os
import threading
import time

import pytest

from costeer.scale.jobs import JobsStoppedError, default_jobs, run_jobs
from tests.waiting import PATIENCE


def ignore(_: int) -> None:
    """Show nothing."""


def test_results_come_in_the_order_of_the_tasks() -> None:
    ended = [threading.Event() for _ in range(6)]
    ended[5].set()

    def work(task: int) -> int:
        assert ended[task + 1].wait(PATIENCE)  # the last task ends first
        ended[task].set()
        return task * task

    assert run_jobs(work, range(5), 5, ignore) == [0, 1, 4, 9, 16]


def test_jobs_run_side_by_side() -> None:
    # Each waits for the other; alone, the first would wait for ever.
    barrier = threading.Barrier(2, timeout=PATIENCE)
    run_jobs(lambda _: barrier.wait(), range(2), 2, ignore)


def test_progress_is_told_from_the_calling_thread() -> None:
    told: list[int] = []
    run_jobs(lambda _: 1, range(3), 2, lambda _: told.append(threading.get_ident()))
    assert set(told) == {threading.get_ident()}
    assert len(told) == 3


def test_after_a_failure_no_task_is_begun() -> None:
    begun: list[int] = []

    def work(task: int) -> int:
        begun.append(task)
        if task == 1:
            raise ZeroDivisionError
        time.sleep(0.05)
        return task

    with pytest.raises(JobsStoppedError) as caught:
        run_jobs(work, range(100), 1, ignore)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    assert caught.value.failed == 1
    # A few more begin until the failure is noticed, 50 ms each; all would take 5 s.
    assert len(begun) < 50
    assert caught.value.num_done == len(begun) - 1


def test_tasks_that_run_at_an_interruption_are_finished() -> None:
    finished: list[int] = []

    def work(task: int) -> int:
        time.sleep(0.1)
        finished.append(task)
        return task

    def interrupt(_: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(JobsStoppedError) as caught:
        run_jobs(work, range(50), 2, interrupt)
    assert isinstance(caught.value.__cause__, KeyboardInterrupt)
    assert caught.value.failed is None
    assert caught.value.num_done == len(finished) < 50


def test_no_task_is_no_work() -> None:
    assert run_jobs(lambda task: task, [], 2, ignore) == []


def test_jobs_are_at_most_the_processors(monkeypatch: pytest.MonkeyPatch) -> None:
    assert 1 <= default_jobs() <= (os.cpu_count() or 1)
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert default_jobs() == 1
