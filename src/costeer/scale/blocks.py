"""Blocks of tasks for workers elsewhere: sent, gathered, stopped.

A block is what a worker gets at a time. Who gets which is the engine's affair (Dask,
Ray); joblib speaks to both.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Sequence
from queue import Empty, Queue
from threading import Event, Thread
from typing import Any, NamedTuple, Protocol, TypeVar

from costeer.scale.worker import Facts, refuse_other

Task = TypeVar("Task")
Result = TypeVar("Result")

LARGEST_BLOCK = 8
"""Tasks a worker gets at a time; it finishes them after Ctrl-C."""

BLOCKS_PER_WORKER = 8
"""At least, so that nobody waits long for the last one."""

_LOOK_EVERY = 0.2
"""How often Ctrl-C and the engine are looked at [s]."""


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


class Raised(NamedTuple):
    """What a task raised on a worker.

    Attributes:
        error: The error.
    """

    error: BaseException


class Block(NamedTuple):
    """Tasks for one worker.

    Attributes:
        start: Place of the first among all tasks.
        facts: What the worker's costeer must be.
        work: What to do with each, pickled.
        tasks: The tasks.
    """

    start: int
    facts: Facts
    work: bytes
    tasks: tuple[Any, ...]  # whatever the work takes


Answer = tuple[int, list[Any]]
"""Place of a block's first task, and its results or what a task raised."""


Failure = tuple[BaseException, int | None]
"""What stopped the work, and the place of the task that raised it."""


class Engine(Protocol):
    """Workers of a cluster."""

    @property
    def num_workers(self) -> int:
        """How many there are."""

    @property
    def facts(self) -> Facts:
        """What costeer is here."""

    def answers(
        self, work: Callable[[Block], Answer], blocks: Iterator[Block]
    ) -> Iterator[Answer]:
        """What comes of the blocks, in any order; it takes few in advance.

        Raises:
            OSError: If the workers are lost.
        """

    def lost(self) -> str:
        """Why no answer will come any more; empty while one may."""


def work_block(block: Block) -> Answer:
    """Do the tasks of a block on a worker; stop at the first that fails."""
    results: list[Any] = []
    try:
        refuse_other(block.facts)
        work = pickle.loads(block.work)
        for task in block.tasks:
            results.append(work(task))  # noqa: PERF401  those before a failure count
    except Exception as error:
        results.append(Raised(_sendable(error)))
    return block.start, results


def _sendable(error: Exception) -> Exception:
    """The error, or its words if it cannot be sent."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # whatever somebody else's class raises
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def block_size(num_tasks: int, num_workers: int) -> int:
    """How many tasks a worker gets at a time."""
    fair = num_tasks // (max(num_workers, 1) * BLOCKS_PER_WORKER)
    return max(1, min(LARGEST_BLOCK, fair))


class _Run:
    """One run on an engine: what was sent, what came back, whether it was stopped."""

    def __init__(self, engine: Engine, work: bytes, tasks: Sequence[Any]) -> None:
        self._engine, self._work, self._tasks = engine, work, tasks
        self._queue: Queue[Answer | Raised | None] = Queue()
        self.stopping = Event()

    def start(self) -> None:
        """Begin to send blocks, in a thread of its own."""
        Thread(target=self._feed, daemon=True).start()

    def _feed(self) -> None:
        try:
            for answer in self._engine.answers(work_block, self._blocks()):
                if any(isinstance(each, Raised) for each in answer[1]):
                    self.stopping.set()  # at once: nothing else is sent
                self._queue.put(answer)
        except BaseException as error:
            self._queue.put(Raised(error))
        self._queue.put(None)

    def _blocks(self) -> Iterator[Block]:
        size = block_size(len(self._tasks), self._engine.num_workers)
        for start in range(0, len(self._tasks), size):
            if self.stopping.is_set():
                return
            part = tuple(self._tasks[start : start + size])
            yield Block(start, self._engine.facts, self._work, part)

    def next(self) -> Answer | None:
        """The next answer; None at the end.

        Raises:
            OSError: If the engine is lost.
            BaseException: What its thread raised.
        """
        while True:
            try:
                answer = self._queue.get(timeout=_LOOK_EVERY)
            except Empty:
                if why := self._engine.lost():
                    raise ConnectionError(why) from None
                continue
            if isinstance(answer, Raised):
                raise answer.error
            return answer


def run_blocks(
    work: Callable[[Task], Result],
    tasks: Sequence[Task],
    engine: Engine,
    progress: Callable[[Result], None],
    keep: Callable[[Task, Result], Result] | None = None,
) -> list[Result]:
    """Do all tasks on a cluster, as `run_jobs` does.

    Ctrl-C lets the blocks that were sent come back; pressed again, it leaves them.

    Raises:
        JobsStoppedError: From the error of a task, a lost engine or KeyboardInterrupt.
    """
    if not tasks:
        return []
    import cloudpickle

    run = _Run(engine, cloudpickle.dumps(work), tasks)
    run.start()
    found: dict[int, Result] = {}
    stop: Failure | None = None
    while True:
        try:
            answer = run.next()
            if answer is None:
                break
            failed: Failure | None = _gather(answer, tasks, found, progress, keep)
        except BaseException as error:
            if stop is not None or not isinstance(error, KeyboardInterrupt):
                raise JobsStoppedError(len(found), None) from error
            failed = error, None
        if failed is not None:
            stop = stop or failed
            run.stopping.set()
    if stop is not None:
        raise JobsStoppedError(len(found), stop[1]) from stop[0]
    return [found[place] for place in range(len(tasks))]


def _gather(
    answer: Answer,
    tasks: Sequence[Task],
    found: dict[int, Result],
    progress: Callable[[Result], None],
    keep: Callable[[Task, Result], Result] | None,
) -> Failure | None:
    """Keep the results of a block; return what a task raised, and its place."""
    start, results = answer
    for place, result in enumerate(results, start):
        if isinstance(result, Raised):
            return result.error, place
        found[place] = result if keep is None else keep(tasks[place], result)
    for place in range(start, start + len(results)):
        progress(found[place])
    return None
