"""The recorder: a thread of the server that keeps what the real-time process tells."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from costeer.base.described import described
from costeer.loop.network import EXACT
from costeer.loop.parameters import DT, LoopParameters
from costeer.loop.scenario import is_assisted
from costeer.loop.trial import trial_metadata, trial_predictor
from costeer.records.columns import COLUMNS
from costeer.records.metadata import PERSON, VIRTUAL
from costeer.runtime.frame import FRAME, PLACE
from costeer.runtime.markers import Marker
from costeer.runtime.patience import STOP_PATIENCE
from costeer.runtime.setup import DriveSetup, drive_parameters, is_virtual
from costeer.runtime.shared import Rows, Shared
from costeer.runtime.states import RunState
from costeer.runtime.stream import RecordStream

INTERVAL = 0.25
"""Between two batches [s]: what a kill costs at most."""


def drive_metadata(
    setup: DriveSetup, parameters: LoopParameters[Any] | None = None
) -> dict[str, object]:
    """Description of a drive for its record; what no person has is null.

    Args:
        setup: Of the drive, with condition and method as they are now.
        parameters: As they are now; those of the setup if None.
    """
    network = setup.trial._replace(intention="network")
    asks = setup.intention == "network"
    used = drive_parameters(setup) if parameters is None else parameters
    known = {each.name: each.value for each in described(used)}
    about = trial_metadata(
        setup.trial, used, trial_predictor(network) if asks else None
    )
    if is_assisted(setup.trial):
        for name, place in TUNED_BY_HAND.items():
            about[name] = known.get(place, about[name])
    hands = "virtual hands" if setup.wheel is None else setup.wheel.name
    virtual = is_virtual(setup)
    return {
        **_told_in_json(about),
        "network_form": None if about["network_form"] is None else EXACT,
        "participant": setup.participant,
        "driver": f"{'virtual hands' if virtual else 'person'}, {hands}",
        "driver_kind": VIRTUAL if virtual else PERSON,
        "driver_torque_source": torque_source(setup),
        "intention_source": setup.intention,
        "head_tracker": None if setup.head is None else setup.head.tracker.kind,
    }


def _told_in_json(value: Any) -> Any:  # Any: a tree of what a description holds
    """The same with null for infinities, which JSON has not: a straight's radius."""
    if isinstance(value, dict):
        return {name: _told_in_json(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_told_in_json(each) for each in value]
    return None if isinstance(value, float) and math.isinf(value) else value


TUNED_BY_HAND = {
    "strength_factor": "controller.actuation.strength_factor",
    "change_duration": "controller.trajectory.change_duration",
}
"""What an experimenter may have changed of the condition, by its place."""


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
        told: Is called with the reason when nothing can be written, and with "" once
            it can again.
        first: Rows to begin with.
    """

    def __init__(
        self,
        shared: Shared,
        stream: RecordStream,
        told: Callable[[str], None],
        first: Rows = Rows(),  # noqa: B008  # it cannot be changed
    ) -> None:
        self._shared = shared
        self.stream = stream
        self._told = told
        self._trouble = ""
        self._markers: list[Marker] = []
        self._next_frame, self._next_trace = first
        self._until: Rows | None = None
        self._last_time = -1.0
        self._seen_until = self._traced_until = -1.0
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

    def stop(self, until: Rows | None = None) -> None:
        """Keep what is left, then close the streams.

        Args:
            until: Where the next trial begins, which may have been long ago; if none
                does, the torque fades out first.

        Raises:
            OSError: If the rest cannot be written.
        """
        self._until = until
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()
        if self._trouble:
            self._told("")  # the next trial finds out by itself
        self.stream.close()

    def _run(self) -> None:
        while not self._stop.wait(INTERVAL):
            self._try()
        if self._until is None:
            self._await_rest()
        self._try()

    def _await_rest(self) -> None:
        """Let the wheel's torque fade out, which belongs to the trace."""
        deadline = time.monotonic() + 2.0 * STOP_PATIENCE
        while self._is_pushed() and time.monotonic() < deadline:
            time.sleep(0.02)

    def _is_pushed(self) -> bool:
        """Whether the newest frame tells of a torque at the wheel."""
        ring = self._shared.frames
        newest = ring.since(ring.written - 1)[1]
        return bool((newest[:, PLACE["wheel_torque"]] != 0.0).any())

    def _try(self) -> None:
        """Write what is new; say when that fails, and when it succeeds again."""
        try:
            self._take()
            trouble = ""
        except (OSError, ValueError) as error:
            trouble = f"the record cannot be written: {error}"
        before, self._trouble = self._trouble, trouble
        if bool(before) != bool(trouble):
            self._told(trouble)

    def _take(self) -> None:
        """Move new rows of the running trial to the streams."""
        ends = self._until or (None, None)
        rings = self._shared
        self._next_frame, frames = rings.frames.since(self._next_frame, ends[0])
        frames, self._seen_until = of_one_trial(frames, PLACE["time"], self._seen_until)
        before = max(self._last_time, 0.0)
        rows = self._running(frames)
        if len(rows) and (gap := rows[0, PLACE["time"]] - before) > 1.5 * DT:
            self.mark(Marker("gap", after=round(gap, 3), unit="s", time=before))
        with self._lock:
            markers, self._markers = self._markers, []
        if len(rows) or markers:
            assisted = rows[:, PLACE["strength_factor"]] > 0.0
            own = rows[:, len(FRAME) :]
            self.stream.add(
                np.hstack([rows[:, : len(COLUMNS)], own]), assisted, markers
            )
        self._next_trace, traced = rings.trace.since(self._next_trace, ends[1])
        traced, self._traced_until = of_one_trial(traced, 0, self._traced_until)
        if len(traced):
            self.stream.add_trace(traced)
        self.stream.flush()

    def _running(self, frames: NDArray[np.float64]) -> NDArray[np.float64]:
        """Frames of the running trial, each moment once, that of its end included."""
        time, state = frames[:, PLACE["time"]], frames[:, PLACE["run_state"]]
        goes_on = (state == RunState.RUNNING) | (state == RunState.ENDED)
        taken = frames[goes_on & (time > self._last_time)]
        times = taken[:, PLACE["time"]]
        running: NDArray[np.float64] = taken[np.diff(times, prepend=-1.0) > 0.0]
        if len(running):
            self._last_time = float(running[-1, PLACE["time"]])
        return running


def of_one_trial(
    rows: NDArray[np.float64], time: int, reached: float
) -> tuple[NDArray[np.float64], float]:
    """Rows up to where time goes back, as it does where the next trial begins.

    The server may not have heard yet that it has begun.

    Args:
        rows: Of a ring, shape `(row, column)`.
        time: Column of the trial's time [s].
        reached: Time of the rows before them [s]; infinite after the trial.

    Returns:
        The rows and the time that they reach [s].
    """
    times = rows[:, time]
    back = np.flatnonzero(np.diff(times, prepend=reached) < 0.0)
    if len(back):
        return rows[: back[0]], math.inf
    return rows, float(times[-1]) if len(rows) else reached
