"""One attempt at a drive in a session: from starting its processes to its record."""

from __future__ import annotations

import multiprocessing
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from multiprocessing.context import BaseContext
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.runtime.frame import PLACE
from costeer.runtime.markers import Marker
from costeer.runtime.setup import DriveSetup
from costeer.runtime.states import Fault, Loss, RunState
from costeer.runtime.stream import record_paths
from costeer.web.drive import DriveOnPages, PageOptions

STARTING, READY, RUNNING, PAUSED, SAVING, OVER, FAILED = (
    "starting",
    "ready",
    "running",
    "paused",
    "saving",
    "ended",
    "failed",
)
"""Where an attempt stands."""

_STATES = {
    int(RunState.WAITING): READY,
    int(RunState.RUNNING): RUNNING,
    int(RunState.PAUSED): PAUSED,
    int(RunState.ENDED): SAVING,
}
_FAULTS = {int(each): each for each in Fault}


@cache
def warm_context() -> BaseContext:
    """What starts the processes of drives: quickly, where the system lets it.

    A small server that has imported everything forks them; without it each drive of a
    session would import all anew, which takes seconds.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(
        [
            "costeer.runtime.process",
            "costeer.runtime.verdicts",
            "costeer.runtime.watchdog",
        ]
    )
    return context


class Outcome(NamedTuple):
    """How an attempt ended.

    Attributes:
        record: That was kept; None if nothing was.
        reached_end: Whether the course was driven to its end, to a collision that ends
            it, or practice was enough.
        reason: Why not.
        facts: Of the way from device to page, in words.
        is_waived: Whether a practice counts whatever it was like.
    """

    record: Path | None
    reached_end: bool
    reason: str
    facts: tuple[str, ...]
    is_waived: bool = False


class StepDrive:
    """An attempt; starts and ends in threads of its own.

    Args:
        setup: Of the drive.
        record: File to write.
        options: What pages show.
        ended: Is told how it ended, once, in another thread.
    """

    def __init__(
        self,
        setup: DriveSetup,
        record: Path,
        options: PageOptions,
        ended: Callable[[Outcome], None],
    ) -> None:
        self.setup, self._record, self._options = setup, record, options
        self._ended = ended
        self._lock = threading.Lock()
        self._is_ending = self._has_broken = False
        self._frame: NDArray[np.float64] | None = None
        self.state = STARTING
        self.reason = ""
        self.markers: list[Marker] = []
        self._lost: list[str] = []
        self.pages: DriveOnPages | None = None
        self._opened: DriveOnPages | None = None
        self._thread = threading.Thread(target=self._start, daemon=True)

    def begin(self) -> None:
        """Start the processes; returns at once."""
        self._thread.start()

    def _start(self) -> None:
        try:
            pages = DriveOnPages(
                self.setup, self._record, self._options, warm_context()
            )
            self._opened = pages
            pages.also(self._take, self._hear)
            pages.drive.start()
        except (ValueError, OSError, ModuleNotFoundError) as error:
            self.state, self.reason = FAILED, str(error)
            self.end(False, str(error))
            return
        self.pages = pages
        self.state = READY

    def _take(self, frame: NDArray[np.float64]) -> None:
        """Follow the drive by its frames."""
        self._frame = frame
        if not self._is_ending and self.state != STARTING:
            self.state = _STATES[int(frame[PLACE["run_state"]])]

    def _hear(self, marker: Marker) -> None:
        """Follow the drive by what happens."""
        self.markers.append(marker)
        if marker.kind == "ended" and marker.name in ("course", "collision"):
            self.end(True, "")
        elif marker.kind == "fault" and marker.name == Fault.LOOP_GONE.word:
            self._break(Fault.LOOP_GONE)
        elif marker.kind == "lost" and marker.name == Loss.WATCHDOG.word:
            self._break(Fault.UNWATCHED)  # nobody drives on without it
        elif marker.kind == "lost":
            self._lost.append(marker.name)
        elif marker.name == Fault.ACKNOWLEDGED.word:
            self.reason = ""  # nothing is wrong any more
        elif marker.kind in ("fault", "error"):
            self.reason = _words(marker)
        elif marker.kind in ("resumed", "started"):
            self.reason = ""

    def _break(self, fault: Fault) -> None:
        """End the attempt: a process without which nobody drives is gone."""
        self._has_broken = not self._is_ending
        self.end(False, fault.text)

    @property
    def broke_unstarted(self) -> bool:
        """Whether its processes ended before anybody drove."""
        return self._has_broken and self.seconds == 0.0

    @property
    def is_ending(self) -> bool:
        """Whether it has been told to end."""
        return self._is_ending

    def ask(self, command: str, *values: object) -> None:
        """Ask the real-time process for something.

        Raises:
            ValueError: If there is none, or it is not there any more.
        """
        pages = self.pages
        if pages is None or self._is_ending:
            raise ValueError(f"the drive is {self.state}; wait until it is ready")
        pages.drive.send(command, *values)

    def end(self, reached_end: bool, reason: str, is_waived: bool = False) -> None:
        """End the attempt; returns at once, and does nothing a second time.

        Args:
            reached_end: Whether it is whole.
            reason: Why not, or who ended it.
            is_waived: Whether a practice counts whatever it was like.
        """
        with self._lock:
            if self._is_ending:
                return
            self._is_ending = True
        if self.state != FAILED:
            self.state = SAVING
        given = (reached_end, reason, is_waived)
        threading.Thread(target=self._close, args=given).start()

    def _close(self, reached_end: bool, reason: str, is_waived: bool) -> None:
        """Make the record whole and tell how it ended."""
        if self._thread is not threading.current_thread() and self._thread.ident:
            self._thread.join()
        pages, kept = self._opened, list[Path]()
        facts: tuple[str, ...] = ()
        if pages is not None:
            pages.broadcast.send({"type": "farewell"})
            pages.stop()
            kept, facts = pages.drive.kept, tuple(pages.account())
            lost = [f"{name} was lost on the way" for name in self._lost]
            parts = (reason, *lost, *pages.drive.unkept)
            reason = "; ".join([each for each in parts if each])
        record = kept[-1] if kept else None
        is_whole = reached_end and record is not None
        self._ended(Outcome(record, is_whole, reason, facts, is_waived))
        if self.state != FAILED:
            self.state = OVER

    @property
    def seconds(self) -> float:
        """Of the trial [s]; 0 before it."""
        return self._number("time")

    @property
    def metres(self) -> float:
        """Driven [m]; 0 before the start."""
        return self._number("longitudinal_position")

    @property
    def _is_broken(self) -> bool:
        """Whether a fault waits for the experimenter's word."""
        return _FAULTS[int(self._number("fault"))].must_be_acknowledged

    def _written(self) -> float | None:
        """How long ago the record was written last [s]; None before it is begun."""
        for file in (record_paths(self._record).stream, self._record):
            with suppress(OSError):
                return round(max(0.0, time.time() - file.stat().st_mtime), 2)
        return None

    def _number(self, name: str) -> float:
        frame = self._frame
        if frame is None:
            return 0.0
        return float(np.nan_to_num(frame[PLACE[name]]))

    def told(self) -> dict[str, Any]:  # Any: of JSON
        """Where the attempt stands, for pages."""
        pages = self.pages
        losses = [] if pages is None else [each.text for each in pages.drive.losses]
        return {
            "state": self.state,
            "reason": self.reason,
            "is_broken": self._is_broken,
            "seconds": round(self.seconds, 2),
            "metres": round(self.metres, 1),
            "length": float(self.setup.trial.length),
            "losses": losses,
            "has_page": pages is not None and pages.has_driver,
            "written": self._written(),
            "unkept": [] if pages is None else list(pages.drive.unkept),
        }


def _words(marker: Marker) -> str:
    """What is wrong, in words."""
    known = {fault.word: fault.text for fault in Fault}
    return marker.note or known.get(marker.name, marker.name)
