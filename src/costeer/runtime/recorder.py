"""The recorder: a thread of the server that keeps what the real-time process tells."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from costeer.base.packing import packed, unpack
from costeer.loop.step import LoopParameters
from costeer.loop.trial import shipped_network, trial_metadata
from costeer.records.metadata import PERSON
from costeer.runtime.frame import ENDED, PLACE, RUNNING
from costeer.runtime.setup import DriveSetup, drive_parameters
from costeer.runtime.shared import Shared
from costeer.runtime.stream import Marker, RecordStream
from costeer.runtime.tunables import place_of, tunable_named

INTERVAL = 0.25
"""Between two batches [s]: what a kill costs at most."""


def drive_metadata(
    setup: DriveSetup, tuned: Mapping[str, float] | None = None
) -> dict[str, object]:
    """Description of a drive for its record; what no person has is null.

    Args:
        setup: Of the drive, with condition and method as they are now.
        tuned: Values of tunables that were changed, by name.
    """
    network = shipped_network().hash if setup.intention == "network" else None
    parameters = tuned_parameters(drive_parameters(setup), tuned or {})
    described = trial_metadata(setup.trial, parameters, network)
    if setup.trial.strength_factor > 0.0:
        duration = parameters.controller.trajectory.change_duration
        described["change_duration"] = duration
    hands = "virtual hands" if setup.wheel is None else setup.wheel.name
    return {
        **described,
        "participant": setup.participant,
        "driver": f"person, {hands}",
        "driver_kind": PERSON,
        "driver_torque_source": torque_source(setup),
        "intention_source": setup.intention,
        "head_tracker": None if setup.head is None else setup.head.tracker.kind,
    }


def tuned_parameters(
    parameters: LoopParameters, tuned: Mapping[str, float]
) -> LoopParameters:
    """The parameters with tuned values in their places."""
    values = packed(parameters)
    for name, value in tuned.items():
        values[place_of(tunable_named(name))] = value
    return unpack(parameters, values)


def torque_source(setup: DriveSetup) -> str:
    """Which of the three the driver's torque is (spec 1.4)."""
    if setup.wheel is None:
        return "simulated"
    return "measured" if setup.wheel.kind == "senso" else "observed"


class Recorder:
    """Takes rows of the running trial from the rings to the streams.

    Args:
        shared: Memory of the drive.
        stream: Where the trial is kept.
        failed: Is called with a reason if nothing more can be kept.
        first: Numbers of the frame and the row of the trace to begin with.
    """

    def __init__(
        self,
        shared: Shared,
        stream: RecordStream,
        failed: Callable[[str], None],
        first: tuple[int, int] = (0, 0),
    ) -> None:
        self._shared = shared
        self.stream = stream
        self._failed = failed
        self._markers: list[Marker] = []
        self._next_frame, self._next_trace = first
        self._last_time = self._last_traced = -1.0
        self._stop = threading.Event()
        self._lock = threading.Lock()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def start(self) -> None:
        """Begin to record."""
        self._thread.start()

    def mark(self, marker: Marker) -> None:
        """Keep a marker with the next batch."""
        with self._lock:
            self._markers.append(marker)

    def stop(self) -> None:
        """Keep what is left, then close the streams."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()
        self.stream.close()

    def _run(self) -> None:
        try:
            while not self._stop.wait(INTERVAL):
                self._take()
            self._take()
        except (OSError, ValueError) as error:
            self._failed(f"the record cannot be written: {error}")

    def _take(self) -> None:
        """Move new rows of the running trial to the streams."""
        self._next_frame, frames = self._shared.frames.since(self._next_frame)
        rows = self._running(frames)
        with self._lock:
            markers, self._markers = self._markers, []
        if len(rows) or markers:
            assisted = rows[:, PLACE["strength_factor"]] > 0.0
            self.stream.write(rows, assisted, markers)
        self._next_trace, traced = self._shared.trace.since(self._next_trace)
        traced = self._of_this_trial(traced)
        if len(traced):
            self.stream.write_trace(traced)

    def _of_this_trial(self, traced: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rows of the trace up to where a new trial begins."""
        times = np.concatenate([[self._last_traced], traced[:, 0]])
        back = np.flatnonzero(np.diff(times) < 0.0)
        kept = traced[: back[0]] if len(back) else traced
        if len(back):
            self._last_traced = np.inf
        elif len(kept):
            self._last_traced = float(kept[-1, 0])
        return kept

    def _running(self, frames: NDArray[np.float64]) -> NDArray[np.float64]:
        """Frames of the running trial, each moment once, that of its end included."""
        time, state = frames[:, PLACE["time"]], frames[:, PLACE["run_state"]]
        goes_on = (state == RUNNING) | (state == ENDED)
        taken = frames[goes_on & (time > self._last_time)]
        times = taken[:, PLACE["time"]]
        running: NDArray[np.float64] = taken[np.diff(times, prepend=-1.0) > 0.0]
        if len(running):
            self._last_time = float(running[-1, PLACE["time"]])
        return running
