"""A drive as the server holds it: its processes, its record, and who listens."""

from __future__ import annotations

import multiprocessing
import socket
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.context import BaseContext
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.devices.wheels.registry import emergency_stop
from costeer.runtime.clock import favour_thread
from costeer.runtime.frame import PLACE, WIDTH
from costeer.runtime.helpers import (
    START_PATIENCE,
    STOP_PATIENCE,
    Helpers,
    spawned,
    unstarted,
)
from costeer.runtime.keeper import Keeper
from costeer.runtime.links import Links
from costeer.runtime.markers import Kind, Marker
from costeer.runtime.process import run_realtime
from costeer.runtime.setup import DriveSetup, check_drive
from costeer.runtime.shared import Rows, close_shared, make_shared, next_rows
from costeer.runtime.states import Fault, Loss, RunState
from costeer.runtime.watchdog import Watch, Watched, stands_still

_LISTEN_INTERVAL = 0.05

_LOOP_PATIENCE = 0.3
"""A loop that has ended is told only after that [s]: a signal that ends all processes
reaches it before the server knows."""


class Listener(NamedTuple):
    """Who is told what happens; called from threads of the drive.

    Attributes:
        frame: Every frame, columns as `frame.frame_columns`.
        marker: What happened and when.
    """

    frame: Callable[[NDArray[np.float64]], None]
    marker: Callable[[Marker], None]


class Drive:
    """Real-time process, watchdog and network, and the record they leave.

    Args:
        setup: Of the drive.
        record: File to write, or None.
        listener: Who is told.
        context: That starts processes; one that spawns them if None.

    Raises:
        ValueError: If the drive cannot begin.
        OSError: If the record could not be written.
    """

    def __init__(
        self,
        setup: DriveSetup,
        record: Path | None,
        listener: Listener,
        context: BaseContext | None = None,
    ) -> None:
        check_drive(setup)
        self.setup = setup
        self._listener = listener
        self._keeper = Keeper(setup, record, self._tell_error, self._halt)
        self._context = context or multiprocessing.get_context("spawn")
        self.shared = make_shared()
        self._commands, self._far_commands = self._context.Pipe()
        self._wake, self._far_wake = socket.socketpair()
        self._wake.settimeout(_LISTEN_INTERVAL)
        self._realtime: BaseProcess | None = None
        self._helpers = Helpers(self._context, setup, self.shared)
        self._threads: list[threading.Thread] = []
        self._closing = threading.Event()
        self._stopping = threading.Event()
        self.is_ending = self._is_told_to_stop = False
        self._out_of_order = ""
        self._watch: Watch | None = None
        self.priority = ""

    # From start to stop

    def start(self) -> None:
        """Start the processes and wait until the wheel's loop runs.

        Raises:
            ValueError: If the real-time process cannot begin; it says why.
        """
        self._live()
        memory = self.shared.memory.name
        links = Links(memory, self._far_commands, self._far_wake)
        self._realtime = spawned(self._context, run_realtime, self.setup, links)
        watched = Watched(memory, self.pid, self.setup.wheel)
        self._watch = Watch(watched, self.shared.mailbox)
        self._helpers.start(watched)
        self._thread(self._listen)
        self.priority = self._await_ready(self._realtime)
        self._far_commands.close()  # so that its end is noticed
        self._helpers.wait()
        self._look_after_helpers()
        self._thread(self._hear)

    def _thread(self, target: Callable[[], None]) -> None:
        thread = threading.Thread(target=target, daemon=True)
        thread.start()
        self._threads.append(thread)

    def _await_ready(self, realtime: BaseProcess) -> str:
        """Wait for the first word of the real-time process: its priority."""
        deadline = time.perf_counter() + START_PATIENCE
        while time.perf_counter() < deadline:
            if self._commands.poll(0.1):
                word, text = self._commands.recv()
                if word == "ready":
                    return str(text)
                raise ValueError(str(text))
            if not realtime.is_alive():
                break
        raise ValueError(unstarted("real-time process"))

    def stop(self) -> None:
        """End everything; the record is made whole. May be called twice."""
        if self._stopping.is_set():
            return
        self._stopping.set()
        self.is_ending = True
        try:
            self._end_loop()
        finally:
            self._closing.set()
            self._helpers.end()
            for thread in self._threads:
                thread.join(STOP_PATIENCE)
            self._keeper.close()
            for end in (self._commands, self._wake, self._far_wake):
                end.close()
            close_shared(self.shared, unlink=True)

    def _end_loop(self) -> None:
        """Ask the wheel's loop to end, and end it if it does not."""
        if self._realtime is None:
            return
        with suppress(ValueError):  # it is gone
            self.end_trial()
        self._realtime.join(STOP_PATIENCE)
        if self._realtime.is_alive():
            self._realtime.kill()
            self._realtime.join(STOP_PATIENCE)
            if self.setup.wheel is not None:
                with suppress(OSError, ValueError, ModuleNotFoundError):
                    emergency_stop(self.setup.wheel)

    @property
    def pid(self) -> int:
        """Number of the real-time process; 0 before the start."""
        return 0 if self._realtime is None else int(self._realtime.pid or 0)

    @property
    def pids(self) -> dict[str, int]:
        """Numbers of the processes that run, by what they are."""
        running = {"loop": self._realtime} | {
            which.word: process for which, process in self._helpers.processes.items()
        }
        return {name: int(p.pid or 0) for name, p in running.items() if p is not None}

    @property
    def losses(self) -> list[Loss]:
        """What the drive goes on without."""
        return list(self._helpers.losses)

    @property
    def kept(self) -> list[Path]:
        """Records that are whole."""
        return self._keeper.kept

    @property
    def unkept(self) -> list[str]:
        """What could not be kept, and the way to save what is left of it."""
        return self._keeper.unkept

    # What comes in

    def send(self, *command: object) -> None:
        """Ask the real-time process for something.

        Raises:
            ValueError: If it is no longer there, or nobody watches it.
        """
        if self._out_of_order:
            raise ValueError(self._out_of_order)
        self._put(*command)

    def _put(self, *command: object) -> None:
        try:
            self._commands.send(command)
        except OSError as error:
            raise ValueError(Fault.LOOP_GONE.text) from error

    def end_trial(self) -> None:
        """Ask the loop to end the trial and itself, once.

        Raises:
            ValueError: As `send`.
        """
        if not self._is_told_to_stop:
            self._is_told_to_stop = True
            self.is_ending = True
            self._put("stop")

    def press(
        self, sequence: int, steer: float, accelerator: float, brake: float
    ) -> None:
        """Take what keys or stick of a driver's page say."""
        self.shared.mailbox.put(
            steer=steer,
            steering=float(steer != 0.0),
            accelerator=accelerator,
            brake=brake,
            page_time=time.perf_counter(),
            input_sequence=float(sequence),
        )

    # What goes out, each in a thread of its own

    def _live(self) -> None:
        self.shared.mailbox.put(server_time=time.perf_counter())

    def _listen(self) -> None:
        """Show life, and pass every frame on as soon as it is there."""
        favour_thread()
        next_frame = 0
        while not self._closing.is_set():
            self._live()
            self._stand_in()
            try:
                self._wake.recv(4096)
            except TimeoutError:
                continue
            except OSError:
                return
            next_frame, frames = self.shared.frames.since(next_frame)
            for frame in frames:
                self._listener.frame(frame)

    def _stand_in(self) -> None:
        """Look after the loop in place of a watchdog that stands still."""
        now = time.perf_counter()
        if self._watch and stands_still(self.shared.mailbox, now):
            self._watch.look(now)

    def _hear(self) -> None:
        """Pass on what the real-time process says; notice who is gone."""
        while True:
            try:
                is_more = self._commands.poll(_LISTEN_INTERVAL)
                if self._closing.is_set() and not is_more:
                    break  # the last word has been heard
                if is_more:
                    word, *values = self._commands.recv()
                    if word == "marker":
                        self._mark(*values)
            except ConnectionResetError:
                continue  # its other end has closed unread; what it said is still there
            except (EOFError, OSError):
                break
            self._keeper.retry(self.shared)
            self._look_after_helpers()
        self._closing.wait(_LOOP_PATIENCE)
        if not self.is_ending:
            self._tell_stalled()

    def _mark(self, marker: Marker, rows: Rows | None = None) -> None:
        """Keep and pass on a marker; one of the loop says before which rows it was."""
        self._keeper.mark(marker, self.shared, rows or next_rows(self.shared))
        self._listener.marker(marker)

    def _tell_error(self, text: str) -> None:
        self._listener.marker(Marker("error", note=text))

    def _halt(self, reason: str) -> None:
        """Let nobody drive unrecorded: pause for a reason, "" once that is over."""
        if reason:
            self._tell_error(reason)
        with suppress(ValueError):  # there is no loop that would drive
            self.send("unrecorded", bool(reason))

    def _look_after_helpers(self) -> None:
        """Say what is lost, as long as it is; without a watchdog nobody drives on."""
        if self.is_ending or self._realtime is None or not self._realtime.is_alive():
            return  # the watchdog goes with the loop that it ended
        for which, is_lost in self._helpers.changes():
            if which == Loss.WATCHDOG:
                with suppress(ValueError):  # the loop is gone as well
                    self.send("unwatched")
                self._out_of_order = Fault.UNWATCHED.text
            when = float(np.nan_to_num(self._last_frame()[PLACE["time"]]))
            note = "" if is_lost else "is there again"
            kind: Kind = "lost" if is_lost else "note"
            self._mark(Marker(kind, which.word, time=when, note=note))

    def _last_frame(self) -> NDArray[np.float64]:
        """The newest frame; of numbers that are none before the first."""
        _, frames = self.shared.frames.since(self.shared.frames.written - 1)
        return frames[-1] if len(frames) else np.full(WIDTH, np.nan)

    def _tell_stalled(self) -> None:
        """Say that the real-time process is gone; what was driven is kept."""
        self._out_of_order = Fault.LOOP_GONE.text
        last = self._last_frame()
        last[PLACE["run_state"]] = RunState.PAUSED
        last[PLACE["fault"]] = Fault.LOOP_GONE
        self._listener.frame(last)
        when = float(np.nan_to_num(last[PLACE["time"]]))
        self._mark(Marker("fault", Fault.LOOP_GONE.word, time=when))
        self._keeper.finish()
