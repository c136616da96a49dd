"""A drive as the server holds it: its processes, its record, and who listens."""

from __future__ import annotations

import multiprocessing
import socket
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.devices.head.process import run_head_process
from costeer.devices.wheels.registry import emergency_stop
from costeer.runtime.clock import favour_thread
from costeer.runtime.frame import PLACE, WIDTH
from costeer.runtime.keeper import Keeper
from costeer.runtime.links import Links
from costeer.runtime.markers import Marker
from costeer.runtime.process import run_realtime
from costeer.runtime.setup import DriveSetup, check_drive, drive_parameters
from costeer.runtime.shared import Shared, close_shared, make_shared, open_shared
from costeer.runtime.states import Fault, RunState
from costeer.runtime.verdicts import run_network
from costeer.runtime.watchdog import Watch, Watched, run_watchdog, stands_still

START_PATIENCE = 180.0
"""The first start compiles for a minute on a slow machine [s]."""

STOP_PATIENCE = 3.0
"""What a process gets to end by itself [s]."""

_LISTEN_INTERVAL = 0.05

_LOST_HELPERS = {
    "watchdog": "nobody watches the wheel any more; start costeer drive again",
    "intention network": "the intention network has ended: no lane change is read "
    "any more; start costeer drive again",
    "head tracker": "the head tracker has ended: the head is not seen any more; start "
    "costeer drive again",
}


class Listener(NamedTuple):
    """Who is told what happens; called from threads of the drive.

    Attributes:
        frame: Every frame, columns as `frame.frame_columns`.
        marker: What happened and when.
    """

    frame: Callable[[NDArray[np.float64]], None]
    marker: Callable[[Marker], None]


class MailboxSink:
    """Takes readings of the head to the mailbox; it can be sent to a process.

    Args:
        memory: Name of the shared memory.
    """

    def __init__(self, memory: str) -> None:
        self._memory = memory
        self._shared: Shared | None = None

    def put(self, time: float, head_yaw: float, valid: bool) -> None:
        """Keep the newest reading; `HeadSink` says what it is."""
        if self._shared is None:
            self._shared = open_shared(self._memory)
        self._shared.mailbox.put(
            head_yaw=head_yaw, head_valid=float(valid), head_time=time
        )


class Drive:
    """Real-time process, watchdog and network, and the record they leave.

    Args:
        setup: Of the drive.
        record: File to write, or None.
        listener: Who is told.

    Raises:
        ValueError: If the drive cannot begin.
        OSError: If the record could not be written.
    """

    def __init__(
        self, setup: DriveSetup, record: Path | None, listener: Listener
    ) -> None:
        check_drive(setup)
        self.setup = setup
        self._listener = listener
        self._keeper = Keeper(setup, record, self._tell_error, self._halt)
        self._context = multiprocessing.get_context("spawn")
        self.shared = make_shared()
        self._commands, self._far_commands = self._context.Pipe()
        self._wake, self._far_wake = socket.socketpair()
        self._wake.settimeout(_LISTEN_INTERVAL)
        self._realtime: BaseProcess | None = None
        self._helpers: dict[str, BaseProcess] = {}
        self._threads: list[threading.Thread] = []
        self._closing = threading.Event()
        self._stopping = threading.Event()
        self._head_stop = self._context.Event()
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
        self._realtime = self._spawned(run_realtime, self.setup, links)
        watched = Watched(memory, self.pid, self.setup.wheel)
        self._helpers["watchdog"] = self._spawned(run_watchdog, watched)
        self._watch = Watch(watched, self.shared.mailbox)
        if self.setup.intention == "network":
            absent = ("head_yaw",) if self.setup.head is None else ()
            road = drive_parameters(self.setup).road
            trial = self.setup.trial
            network = self._spawned(
                run_network, memory, road, absent, trial.predictor, trial.weights
            )
            self._helpers["intention network"] = network
        if self.setup.head is not None:
            sink = MailboxSink(memory)
            head = self._spawned(
                run_head_process, self.setup.head, sink, self._head_stop
            )
            self._helpers["head tracker"] = head
        self._thread(self._listen)
        self.priority = self._await_ready(self._realtime)
        self._far_commands.close()  # so that its end is noticed
        self._await_helper("watching", "watchdog")
        if self.setup.intention == "network":
            self._await_helper("reading", "intention network")
        self._thread(self._hear)

    def _spawned(self, target: Callable[..., None], *given: object) -> BaseProcess:
        process = self._context.Process(target=target, args=given, daemon=True)
        process.start()
        return process

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
        raise ValueError(_unstarted("real-time process"))

    def _await_helper(self, flag: str, name: str) -> None:
        """No trial begins before watchdog and network are there."""
        deadline = time.perf_counter() + START_PATIENCE
        while self.shared.mailbox.get(flag) < 0.5:
            alive = self._helpers[name].is_alive()
            if not alive or time.perf_counter() > deadline:
                raise ValueError(_unstarted(name))
            time.sleep(0.01)

    def stop(self) -> None:
        """End everything; the record is made whole. May be called twice."""
        if self._stopping.is_set():
            return
        self._stopping.set()
        try:
            self._end_loop()
        finally:
            self._closing.set()
            self._head_stop.set()
            self.shared.mailbox.put(dismissed=1.0)
            for process in self._helpers.values():
                _end(process)
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
        with suppress(OSError):
            self._commands.send(("stop",))
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
        try:
            self._commands.send(command)
        except OSError as error:
            raise ValueError(Fault.LOOP_GONE.text) from error

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
        while not self._closing.is_set():
            try:
                if self._commands.poll(_LISTEN_INTERVAL):
                    word, *values = self._commands.recv()
                    if word == "marker":
                        self._mark(*values)
            except (EOFError, OSError):
                break
            self._keeper.retry(self.shared)
            self._look_after_helpers()
        if not self._stopping.is_set():
            self._tell_stalled()

    def _mark(self, marker: Marker) -> None:
        """Keep and pass on a marker."""
        self._keeper.mark(marker, self.shared)
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
        """Say once that a helper is gone; without a watchdog nobody drives on."""
        if self._stopping.is_set():
            return
        for name, process in list(self._helpers.items()):
            if process.is_alive():
                continue
            del self._helpers[name]
            if self._realtime is None or not self._realtime.is_alive():
                return  # the watchdog goes with the loop that it ended
            if name == "watchdog":
                self.send("pause", name)
                self._out_of_order = _LOST_HELPERS[name]
            self._tell_error(_LOST_HELPERS[name])

    def _tell_stalled(self) -> None:
        """Say that the real-time process is gone; what was driven is kept."""
        self._out_of_order = Fault.LOOP_GONE.text
        _, frames = self.shared.frames.since(self.shared.frames.written - 1)
        last = frames[-1] if len(frames) else np.full(WIDTH, np.nan)
        last[PLACE["run_state"]] = RunState.PAUSED
        last[PLACE["fault"]] = Fault.LOOP_GONE
        self._listener.frame(last)
        when = float(np.nan_to_num(last[PLACE["time"]]))
        self._mark(Marker("fault", Fault.LOOP_GONE.word, time=when))
        self._keeper.finish()


def _unstarted(name: str) -> str:
    return (
        f"the {name} did not start; run `costeer doctor` to see what this computer "
        "lacks"
    )


def _end(process: BaseProcess) -> None:
    """Let a process end by itself, then end it."""
    process.join(0.2)
    if process.is_alive():
        process.terminate()
        process.join(STOP_PATIENCE)
    if process.is_alive():
        process.kill()
        process.join(STOP_PATIENCE)
