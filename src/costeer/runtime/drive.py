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

from costeer.runtime.clock import favour_thread
from costeer.runtime.frame import FAULTS, FRAME_COLUMNS, PAUSED, PLACE, STALLED
from costeer.runtime.head.process import run_head_process
from costeer.runtime.links import Links
from costeer.runtime.process import run_realtime
from costeer.runtime.recorder import Recorder, drive_metadata
from costeer.runtime.setup import DriveSetup, check_drive, drive_parameters
from costeer.runtime.shared import Shared, close_shared, make_shared, open_shared
from costeer.runtime.stream import (
    Marker,
    RecordStream,
    finish,
    next_free,
    record_paths,
)
from costeer.runtime.verdicts import run_network
from costeer.runtime.watchdog import Watched, run_watchdog

START_PATIENCE = 180.0
"""The first start compiles for a minute on a slow machine [s]."""

STOP_PATIENCE = 3.0
"""What a process gets to end by itself [s]."""

_LISTEN_INTERVAL = 0.05


class Listener(NamedTuple):
    """Who is told what happens; called from threads of the drive.

    Attributes:
        frame: Every frame, columns as `FRAME_COLUMNS`.
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
    """

    def __init__(
        self, setup: DriveSetup, record: Path | None, listener: Listener
    ) -> None:
        check_drive(setup)
        self.setup = setup
        self._record = record
        self._listener = listener
        self._context = multiprocessing.get_context("spawn")
        self.shared = make_shared()
        self._commands, self._far_commands = self._context.Pipe()
        self._wake, self._far_wake = socket.socketpair()
        self._wake.settimeout(_LISTEN_INTERVAL)
        self._processes: list[BaseProcess] = []
        self._threads: list[threading.Thread] = []
        self._recorder: Recorder | None = None
        self._closing = threading.Event()
        self._stopping = threading.Event()
        self._head_stop = self._context.Event()
        self._lock = threading.Lock()
        self._told_stalled = False
        self.priority = ""
        self.kept: list[Path] = []

    # From start to stop

    def start(self) -> None:
        """Start the processes and wait until the wheel's loop runs.

        Raises:
            ValueError: If the real-time process cannot begin; it says why.
        """
        self._live()
        links = Links(self.shared.memory.name, self._far_commands, self._far_wake)
        realtime = self._spawn(run_realtime, self.setup, links)
        watched = Watched(self.shared.memory.name, self.pid, self.setup.wheel)
        self._spawn(run_watchdog, watched)
        self._thread(self._listen)
        if self.setup.intention == "network":
            absent = ("head_yaw",) if self.setup.head is None else ()
            road = drive_parameters(self.setup).road
            self._spawn(run_network, self.shared.memory.name, road, absent)
        self.priority = self._await_ready(realtime)
        self._await_helper("watching", "watchdog")
        if self.setup.intention == "network":
            self._await_helper("reading", "intention network")
        if self.setup.head is not None:
            sink = MailboxSink(self.shared.memory.name)
            self._spawn(run_head_process, self.setup.head, sink, self._head_stop)
        self._begin_record()
        self._thread(self._hear, realtime)

    def _spawn(self, target: Callable[..., None], *given: object) -> BaseProcess:
        process = self._context.Process(target=target, args=given, daemon=True)
        process.start()
        self._processes.append(process)
        return process

    def _thread(self, target: Callable[..., None], *given: object) -> None:
        thread = threading.Thread(target=target, args=given, daemon=True)
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
                self.stop()
                raise ValueError(str(text))
            if not realtime.is_alive():
                break
        self.stop()
        raise ValueError(
            "the real-time process did not start; run `costeer doctor` to see what "
            "this computer lacks"
        )

    def _await_helper(self, flag: str, name: str) -> None:
        """No trial begins before watchdog and network are there."""
        deadline = time.perf_counter() + START_PATIENCE
        while self.shared.mailbox.get(flag) < 0.5:
            if time.perf_counter() > deadline:
                self.stop()
                raise ValueError(
                    f"the {name} did not start; run `costeer doctor` to see what this "
                    "computer lacks"
                )
            time.sleep(0.01)

    def stop(self) -> None:
        """End everything; the record is made whole. May be called twice."""
        if self._stopping.is_set():
            return
        self._stopping.set()
        with suppress(OSError):
            self._commands.send(("stop",))
        if self._processes:
            self._processes[0].join(STOP_PATIENCE)
        self._finish_record()
        self._closing.set()
        self._head_stop.set()
        for process in self._processes:
            process.terminate()
        for process in self._processes:
            process.join(STOP_PATIENCE)
        for thread in self._threads:
            thread.join(STOP_PATIENCE)
        for end in (self._commands, self._wake, self._far_wake):
            end.close()
        close_shared(self.shared, unlink=True)

    @property
    def pid(self) -> int:
        """Number of the real-time process."""
        return int(self._processes[0].pid or 0)

    # What comes in

    def send(self, *command: object) -> None:
        """Ask the real-time process for something.

        Raises:
            ValueError: If it is no longer there.
        """
        try:
            self._commands.send(command)
        except OSError as error:
            raise ValueError(f"{FAULTS[STALLED]}; start costeer drive again") from error

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
            try:
                self._wake.recv(4096)
            except TimeoutError:
                continue
            except OSError:
                return
            next_frame, frames = self.shared.frames.since(next_frame)
            for frame in frames:
                self._listener.frame(frame)

    def _hear(self, realtime: BaseProcess) -> None:
        """Pass on what the real-time process says; notice when it is gone."""
        while not self._closing.is_set():
            try:
                if self._commands.poll(_LISTEN_INTERVAL):
                    word, *values = self._commands.recv()
                    if word == "marker":
                        self._mark(*values)
            except (EOFError, OSError):
                return
            if not realtime.is_alive() and not self._stopping.is_set():
                self._tell_stalled()

    def _mark(self, when: float, kind: str, text: str) -> None:
        """Keep and pass on a marker; begin and end records with their trials."""
        marker: Marker = {"time": when, "kind": kind, "text": text}
        with self._lock:
            if self._recorder is not None and kind != "restarted":
                self._recorder.mark(marker)
        self._listener.marker(marker)
        if kind in ("ended", "restarted"):
            self._finish_record()
        if kind == "restarted":
            self._begin_record()

    def _tell_stalled(self) -> None:
        """Say once that the real-time process is gone; what was driven is kept."""
        if self._told_stalled:
            return
        self._told_stalled = True
        _, frames = self.shared.frames.since(self.shared.frames.written - 1)
        last = frames[-1] if len(frames) else np.full(len(FRAME_COLUMNS), np.nan)
        last[PLACE["run_state"]] = PAUSED
        last[PLACE["fault"]] = STALLED
        self._listener.frame(last)
        when = float(np.nan_to_num(last[PLACE["time"]]))
        self._mark(when, "fault", FAULTS[STALLED])
        self._finish_record()

    # The record

    def _begin_record(self) -> None:
        if self._record is None:
            return
        paths = record_paths(next_free(self._record))
        stream = RecordStream(paths, drive_metadata(self.setup))
        with self._lock:
            self._recorder = Recorder(self.shared, stream, self._tell_unkept)
            self._recorder.start()

    def _tell_unkept(self, reason: str) -> None:
        self._listener.marker({"time": 0.0, "kind": "error", "text": reason})

    def _finish_record(self) -> None:
        """Make the record whole; a trial that never began leaves none."""
        with self._lock:
            recorder, self._recorder = self._recorder, None
            if recorder is None:
                return
            recorder.stop()
            paths = recorder.stream.paths
            if finish(paths):
                self.kept.append(paths.record)
