"""The processes that help a drive: watchdog, intention network and head tracker.

They are told to end by a number in shared memory. An event of `multiprocessing` has a
lock, and whoever dies while waiting for it lets everyone else wait for ever.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.context import BaseContext
from multiprocessing.process import BaseProcess

from costeer.devices.head.process import run_head_process
from costeer.runtime.setup import DriveSetup, drive_parameters
from costeer.runtime.shared import Shared, open_shared
from costeer.runtime.states import Loss
from costeer.runtime.verdicts import run_network
from costeer.runtime.watchdog import Watched, run_watchdog

START_PATIENCE = 180.0
"""The first start compiles for a minute on a slow machine [s]."""

HEAD_PATIENCE = 20.0
"""A camera that has shown nothing for so long is not waited for [s]."""

STOP_PATIENCE = 3.0
"""What a process gets to end by itself [s]."""

_NAMES = {
    Loss.WATCHDOG: "watchdog",
    Loss.NETWORK: "intention network",
    Loss.HEAD: "head tracker",
}


class MailboxLink:
    """What the head's process has of a drive; it can be sent there.

    It takes readings of the head to the mailbox, and tells when to stop.

    Args:
        memory: Name of the shared memory.
    """

    def __init__(self, memory: str) -> None:
        self._memory = memory
        self._shared: Shared | None = None

    def _opened(self) -> Shared:
        if self._shared is None:
            self._shared = open_shared(self._memory)
        return self._shared

    def put(self, time: float, head_yaw: float, valid: bool) -> None:
        """Keep the newest reading; `HeadSink` says what it is."""
        self._opened().mailbox.put(
            head_yaw=head_yaw, head_valid=float(valid), head_time=time
        )

    def lose(self, is_lost: bool) -> None:
        """Note whether the tracker itself is there."""
        self._opened().mailbox.put(head_lost=float(is_lost))

    def is_set(self) -> bool:
        """Whether to stop."""
        return self._opened().mailbox.get("dismissed") > 0.5

    def wait(self, timeout: float) -> bool:
        """Wait until it is time to stop, or `timeout` [s]; return whether to stop."""
        deadline = time.perf_counter() + timeout
        while not self.is_set() and time.perf_counter() < deadline:
            time.sleep(0.02)
        return self.is_set()


class Helpers:
    """The helpers of one drive.

    Args:
        context: That starts processes.
        setup: Of the drive.
        shared: Memory of the drive.
    """

    def __init__(self, context: BaseContext, setup: DriveSetup, shared: Shared) -> None:
        self._context = context
        self._setup = setup
        self._shared = shared
        self.processes: dict[Loss, BaseProcess] = {}
        self.losses: list[Loss] = []

    def start(self, watched: Watched) -> None:
        """Start those that the drive needs."""
        memory, trial = self._shared.memory.name, self._setup.trial
        self._add(Loss.WATCHDOG, run_watchdog, watched)
        if self._setup.intention == "network":
            absent = ("head_yaw",) if self._setup.head is None else ()
            world = drive_parameters(self._setup)
            asked = (absent, trial.predictor, trial.weights)
            given = (memory, world.car, world.road, *asked)
            self._add(Loss.NETWORK, run_network, *given)
        if self._setup.head is not None:
            link = MailboxLink(memory)
            head = (self._setup.head, link, link, link.lose)
            self._add(Loss.HEAD, run_head_process, *head)

    def _add(self, which: Loss, target: Callable[..., None], *given: object) -> None:
        self.processes[which] = spawned(self._context, target, *given)

    def wait(self) -> None:
        """Wait until they work; no trial begins before watchdog and network are there.

        Raises:
            ValueError: If one of these two ends or does not come.
        """
        self._await("watching", Loss.WATCHDOG)
        if Loss.NETWORK in self.processes:
            self._await("reading", Loss.NETWORK)
        if head := self.processes.get(Loss.HEAD):
            self._await_head(head)

    def _await(self, flag: str, which: Loss) -> None:
        deadline = time.perf_counter() + START_PATIENCE
        while self._shared.mailbox.get(flag) < 0.5:
            alive = self.processes[which].is_alive()
            if not alive or time.perf_counter() > deadline:
                raise ValueError(unstarted(_NAMES[which]))
            time.sleep(0.01)

    def _await_head(self, head: BaseProcess) -> None:
        """Wait for the first word of the tracker, good or bad."""
        box, deadline = self._shared.mailbox, time.perf_counter() + HEAD_PATIENCE
        while head.is_alive() and time.perf_counter() < deadline:
            if box.get("head_time") > 0.0 or box.get("head_lost") > 0.5:
                return
            time.sleep(0.01)

    def changes(self) -> Iterator[tuple[Loss, bool]]:
        """What is lost since the last look, or there again."""
        for which, process in list(self.processes.items()):
            if not process.is_alive():
                del self.processes[which]
                yield from self._note(which, True)
        missing = self._shared.mailbox.get("head_lost") > 0.5
        follows = Loss.HEAD in self.processes
        yield from self._note(Loss.CAMERA, missing and follows)

    def _note(self, which: Loss, is_lost: bool) -> Iterator[tuple[Loss, bool]]:
        if is_lost == (which in self.losses):
            return
        if is_lost:
            self.losses.append(which)
        else:
            self.losses.remove(which)
        yield which, is_lost

    def end(self) -> None:
        """Tell them to end, and end those that do not."""
        self._shared.mailbox.put(dismissed=1.0)
        for process in self.processes.values():
            _end(process)


def spawned(
    context: BaseContext, target: Callable[..., None], *given: object
) -> BaseProcess:
    """A process that was started, and that no Ctrl-C reaches."""
    # mypy knows the class of each context's processes, not that all have one.
    process: BaseProcess = getattr(context, "Process")(  # noqa: B009
        target=target, args=given, daemon=True
    )
    with _without_interrupt():
        process.start()
    return process


@contextmanager
def _without_interrupt() -> Iterator[None]:
    """Hold Ctrl-C back: a process that is started meanwhile never gets it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def unstarted(name: str) -> str:
    """That a process did not start, in words."""
    return (
        f"the {name} did not start; run `costeer doctor` to see what this computer "
        "lacks"
    )


def _end(process: BaseProcess) -> None:
    """Let a process end by itself, then end it."""
    process.join(0.5)
    if process.is_alive():
        process.kill()
        process.join(STOP_PATIENCE)
