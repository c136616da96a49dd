"""The network process: a verdict for every frame, off the real-time process's path.

It reads each frame of the running trial in order, since a window needs all of its 180
samples, and puts the newest verdict into the mailbox. The verdict on a sample reaches
the controller one control step later than in a simulated trial.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import NUM_FEATURES, IntentionSample
from costeer.intention.predictors.chosen import ChosenPredictor, chosen_predictor
from costeer.intention.wavefront import advance, initial_state, wavefront_weights
from costeer.loop.outside import Ask, Outlook, Verdicts
from costeer.loop.parameters import DT
from costeer.loop.tick import Verdict
from costeer.plant.parameters import CarParameters, RoadParameters
from costeer.runtime.frame import PLACE
from costeer.runtime.patience import SERVER_PATIENCE
from costeer.runtime.shared import Mailbox, close_shared, open_shared
from costeer.runtime.states import RunState
from costeer.runtime.watchdog import ignore

INTERVAL = 0.002
"""Between two looks at the ring [s]."""


class Reader:
    """The predictor over the frames of one drive.

    Args:
        car: Of the drive.
        road: Of the drive.
        absent: Signals that this drive does not have, as `head_yaw`.
        predictor: Network, or function of windows.
    """

    def __init__(
        self,
        car: CarParameters,
        road: RoadParameters,
        absent: tuple[str, ...],
        predictor: ChosenPredictor,
    ) -> None:
        self._make = _asked(predictor, absent)
        self._outlook = Outlook(self._make, car, road)
        self._time = -1.0

    def warm_up(self) -> None:
        """Compile, or load what was compiled, before the first frame."""
        self._make()(IntentionSample(*([math.nan] * NUM_FEATURES)))

    def read(self, frame: NDArray[np.float64]) -> Verdict:
        """Verdict after one more frame; its number is NaN before the window is full.

        A frame whose time does not follow the last one begins a new window.
        """
        now = float(frame[PLACE["time"]])
        if not 0.0 < now - self._time < 1.5 * DT:
            self._outlook.forget()
        self._time = now
        return self._outlook.after(frame)


def _asked(predictor: ChosenPredictor, absent: tuple[str, ...]) -> Callable[[], Ask]:
    """Makes what is asked sample by sample, its window empty."""
    judge, numbers = predictor.judge, predictor.weights
    if numbers is None:
        if judge is None:
            raise ValueError(f"predictor {predictor.name} predicts nothing")
        return lambda: Verdicts(judge, predictor.name).after
    weights = wavefront_weights(numbers)
    return lambda: partial(advance, weights, initial_state(weights, absent))


def _is_needed(mailbox: Mailbox) -> bool:
    """Whether the server is there and has not said that it is over."""
    silence = time.perf_counter() - mailbox.get("server_time")
    return silence < SERVER_PATIENCE and mailbox.get("dismissed") < 0.5


def run_network(
    memory: str,
    car: CarParameters,
    road: RoadParameters,
    absent: tuple[str, ...],
    predictor: str,
    weights: str | None,
) -> None:
    """Give verdicts until the server is gone: target of a spawned process."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # the server says when to stop
        ignore(name)
    shared = open_shared(memory)
    reader = Reader(car, road, absent, chosen_predictor(predictor, weights))
    reader.warm_up()
    next_frame = shared.frames.written
    shared.mailbox.put(reading=1.0)
    try:
        while _is_needed(shared.mailbox):
            next_frame, frames = shared.frames.since(next_frame)
            for frame in frames:
                if frame[PLACE["run_state"]] == RunState.RUNNING:
                    said = reader.read(frame)
                    shared.mailbox.put(
                        crossing_probability=said.probability,
                        crossing_side=said.side,
                        verdict_row=next_frame,
                    )
            if not len(frames):
                time.sleep(INTERVAL)
    finally:
        close_shared(shared, unlink=False)
