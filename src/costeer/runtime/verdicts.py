"""The network process: a verdict for every frame, off the real-time process's path.

It reads each frame of the running trial in order, since a window needs all of its 180
samples, and puts the newest verdict into the mailbox. The verdict on a sample reaches
the controller one control step later than in a simulated trial.
"""

from __future__ import annotations

import math
import signal
import time

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import IntentionSample, facing
from costeer.intention.wavefront import (
    WavefrontState,
    WavefrontWeights,
    advance,
    initial_state,
    wavefront_weights,
)
from costeer.loop.parameters import DT
from costeer.loop.trial import shipped_network
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import adjacent_side
from costeer.runtime.frame import PLACE
from costeer.runtime.patience import SERVER_PATIENCE
from costeer.runtime.shared import close_shared, open_shared
from costeer.runtime.states import RunState

INTERVAL = 0.002
"""Between two looks at the ring [s]."""

_SIGNALS = tuple(PLACE[name] for name in IntentionSample._fields)
_VALID = PLACE["head_yaw_valid"]
_HEAD = IntentionSample._fields.index("head_yaw")


def sample_of(frame: NDArray[np.float64], road: RoadParameters) -> IntentionSample:
    """The network's sample of a frame, mirrored to the adjacent lane; lost head NaN.

    Args:
        frame: Columns as `FRAME_COLUMNS`.
        road: Tells on which side the adjacent lane is.
    """
    values = [float(frame[place]) for place in _SIGNALS]
    if frame[_VALID] < 0.5:
        values[_HEAD] = math.nan
    side = adjacent_side(road, float(frame[PLACE["lane"]]))
    return facing(IntentionSample(*values), side)


class Reader:
    """The network over the frames of one drive.

    Args:
        road: Of the drive.
        absent: Signals that this drive does not have, as `head_yaw`.
    """

    def __init__(self, road: RoadParameters, absent: tuple[str, ...]) -> None:
        self._road = road
        self._absent = absent
        self._weights: WavefrontWeights = wavefront_weights(shipped_network().weights)
        self._memory = self._new_memory()
        self._time = -1.0

    def _new_memory(self) -> WavefrontState:
        return initial_state(self._weights, self._absent)

    def warm_up(self) -> None:
        """Compile, or load what was compiled, before the first frame."""
        advance(
            self._weights,
            self._new_memory(),
            IntentionSample(*([math.nan] * len(_SIGNALS))),
        )

    def read(self, frame: NDArray[np.float64]) -> float:
        """Verdict after one more frame; NaN before the window is full [-].

        A frame whose time does not follow the last one begins a new window.
        """
        now = float(frame[PLACE["time"]])
        if not 0.0 < now - self._time < 1.5 * DT:
            self._memory = self._new_memory()
        self._time = now
        return advance(self._weights, self._memory, sample_of(frame, self._road))


def run_network(memory: str, road: RoadParameters, absent: tuple[str, ...]) -> None:
    """Give verdicts until the server is gone: target of a spawned process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    shared = open_shared(memory)
    reader = Reader(road, absent)
    reader.warm_up()
    next_frame = shared.frames.written
    shared.mailbox.put(reading=1.0)
    try:
        while time.perf_counter() - shared.mailbox.get("server_time") < SERVER_PATIENCE:
            next_frame, frames = shared.frames.since(next_frame)
            for frame in frames:
                if frame[PLACE["run_state"]] == RunState.RUNNING:
                    probability = reader.read(frame)
                    shared.mailbox.put(
                        crossing_probability=probability, verdict_row=next_frame
                    )
            if not len(frames):
                time.sleep(INTERVAL)
    finally:
        close_shared(shared, unlink=False)
