"""Blocks on workers: results in order, failures told, workers of another kind refused.

The engine here works in the same process; that of Dask has tests of its own.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from costeer.scale.blocks import Answer, Block, JobsStoppedError, block_size
from costeer.scale.cluster import check_cluster, workers
from costeer.scale.jobs import run_jobs
from costeer.scale.worker import Facts, OtherWorkerError, facts, sources_of

pytest.importorskip("cloudpickle")


class Backwards:
    """An engine whose answers come in the wrong order, a few at a time."""

    num_workers = 2

    def __init__(self, expected: Facts | None = None, ends: int | None = None) -> None:
        self.facts = expected or facts()
        self._ends = ends

    def answers(
        self, work: Callable[[Block], Answer], blocks: Iterator[Block]
    ) -> Iterator[Answer]:
        """Three at a time, the last first."""
        waiting: list[Block] = []
        for number, block in enumerate(blocks):
            if self._ends is not None and number >= self._ends:
                raise ConnectionError("the scheduler is lost")
            waiting.append(block)
            if len(waiting) == 3:
                yield from (work(each) for each in reversed(waiting))
                waiting = []
        yield from (work(each) for each in reversed(waiting))

    def lost(self) -> str:
        """Never."""
        return ""


def ignore(_: object) -> None:
    """Show no progress."""


def test_results_come_in_the_order_of_the_tasks() -> None:
    seen: list[int] = []
    found = run_jobs(lambda x: x * x, range(100), Backwards(), seen.append)
    assert found == [x * x for x in range(100)]
    assert seen != found
    assert sorted(seen) == found


def test_there_may_be_nothing_to_do() -> None:
    assert run_jobs(lambda task: task, [], Backwards(), ignore) == []


def test_what_is_kept_takes_the_place_of_the_result() -> None:
    kept = run_jobs(abs, [-1, -2], Backwards(), ignore, lambda t, r: (t, r))
    assert kept == [(-1, 1), (-2, 2)]


def test_what_a_task_raises_stops_the_rest_and_names_it() -> None:
    kept: list[int] = []

    def work(task: int) -> int:
        if task == 40:
            raise OSError(28, "No space left on device", "there")
        return task

    def keep(task: int, result: int) -> int:
        kept.append(task)
        return result

    with pytest.raises(JobsStoppedError) as stopped:
        run_jobs(work, range(1000), Backwards(), ignore, keep)
    cause = stopped.value.__cause__
    assert isinstance(cause, OSError)
    assert (cause.errno, cause.filename) == (28, "there")
    assert stopped.value.failed == 40
    assert stopped.value.num_done == len(kept) < 100
    assert 39 in kept


class Unsendable(Exception):
    """An error that cannot be pickled."""

    def __init__(self, one: int, two: int) -> None:
        super().__init__(f"{one} and {two}")

    def __reduce__(self) -> tuple[Any, ...]:
        # Libraries of clusters teach pickle to send exceptions; this one stays here.
        raise TypeError


def test_an_error_that_cannot_be_sent_is_told_in_words() -> None:
    def work(_: int) -> int:
        raise Unsendable(1, 2)

    with pytest.raises(JobsStoppedError) as stopped:
        run_jobs(work, range(3), Backwards(), ignore)
    assert str(stopped.value.__cause__) == "Unsendable: 1 and 2"


def test_a_lost_engine_is_told_with_what_was_done() -> None:
    with pytest.raises(JobsStoppedError) as stopped:
        run_jobs(abs, range(1000), Backwards(ends=6), ignore)
    assert isinstance(stopped.value.__cause__, ConnectionError)
    assert stopped.value.num_done == 6 * block_size(1000, 2)


def test_ctrl_c_lets_the_blocks_that_were_sent_come_back() -> None:
    kept: list[int] = []
    pressed = False

    def press(_: int) -> None:
        nonlocal pressed
        if not pressed:
            pressed = True
            raise KeyboardInterrupt

    def keep(task: int, result: int) -> int:
        kept.append(task)
        return result

    with pytest.raises(JobsStoppedError) as stopped:
        run_jobs(abs, range(10_000), Backwards(), press, keep)
    assert isinstance(stopped.value.__cause__, KeyboardInterrupt)
    assert stopped.value.num_done == len(kept)


@pytest.mark.parametrize("name", Facts._fields)
def test_a_worker_of_another_costeer_does_not_work(name: str) -> None:
    other: dict[str, Any] = {name: "0.0.0"}
    done: list[int] = []
    with pytest.raises(JobsStoppedError) as stopped:
        run_jobs(done.append, range(3), Backwards(facts()._replace(**other)), ignore)
    cause = stopped.value.__cause__
    assert isinstance(cause, OtherWorkerError)
    assert re.search(
        rf"the worker process \d+ on \S+ has another .*: {name} .* and 0.0.0 here; ins",
        str(cause),
    )
    assert done == []


def test_the_hash_of_sources_changes_with_any_of_them(tmp_path: Any) -> None:
    for name in ("a.py", "data/b.npz", "web/page.js"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("1")
    before = sources_of(tmp_path)
    (tmp_path / "web" / "page.js").write_text("2")
    assert sources_of(tmp_path) == before
    (tmp_path / "data" / "b.npz").write_text("2")
    assert sources_of(tmp_path) != before


@pytest.mark.parametrize(
    ("tasks", "num_workers", "size"), [(1, 4, 1), (84, 2, 5), (7000, 4, 8), (7, 0, 1)]
)
def test_blocks_are_many_and_small(tasks: int, num_workers: int, size: int) -> None:
    assert block_size(tasks, num_workers) == size


@pytest.mark.parametrize(
    "cluster",
    ["", "local:2", "tcp://node7:8786", "node7:8786", "ray:2", "ray://head:10001"],
)
def test_a_cluster_may_be_named_so(cluster: str) -> None:
    assert check_cluster(cluster) == cluster


@pytest.mark.parametrize(
    ("cluster", "message"),
    [
        ("local:0", "cluster local:0 has 0 workers; give 1 to 256"),
        ("local:1000", "has 1000 workers; give 1 to 256"),
        ("local", "cluster 'local' is not known; give local:N"),
        ("mars", "cluster 'mars' is not known"),
        ("http://node:80", "is not known"),
    ],
)
def test_what_is_no_cluster_is_refused(cluster: str, message: str) -> None:
    with pytest.raises(ValueError, match=message), workers(None, cluster):
        pass


def test_jobs_are_of_this_computer_only() -> None:
    with (
        pytest.raises(ValueError, match="all workers of a cluster work; leave jobs"),
        workers(2, "local:2"),
    ):
        pass


class OneByOne(Backwards):
    """An engine that counts the blocks it takes."""

    taken = 0

    def answers(
        self, work: Callable[[Block], Answer], blocks: Iterator[Block]
    ) -> Iterator[Answer]:
        """In order, the next only when the last was given."""
        for block in blocks:
            self.taken += 1
            yield work(block)


def test_no_block_is_sent_after_one_that_failed() -> None:
    def work(task: int) -> int:
        raise ValueError(task)

    engine = OneByOne()
    with pytest.raises(JobsStoppedError):
        run_jobs(work, range(10_000), engine, ignore)
    assert engine.taken == 1
