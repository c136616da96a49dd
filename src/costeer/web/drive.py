"""A drive as its pages see it: what they are told, and what they may ask."""

from __future__ import annotations

import statistics
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.context import BaseContext
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.loop.trial import scenario_metadata
from costeer.methods.conditions import CONDITION_NAMES
from costeer.plant.parameters import wheelbase
from costeer.runtime.choices import (
    checked_choice,
    chosen_setup,
    first_choice,
    followed,
    tuned_values,
)
from costeer.runtime.drive import Drive, Listener
from costeer.runtime.frame import PLACE, frame_columns
from costeer.runtime.markers import Marker
from costeer.runtime.patience import PAGE_PATIENCE
from costeer.runtime.setup import (
    PLANT_DT,
    DriveSetup,
    drive_columns,
    drive_method,
    drive_parameters,
    offered_methods,
)
from costeer.runtime.states import Fault, RunState, page_tables
from costeer.scenarios.reading import scenario_named
from costeer.web.messages import (
    Acknowledge,
    Indicator,
    Input,
    Latency,
    Message,
    Pause,
    Restart,
    Resume,
    Set,
    Start,
    Stop,
    marker_shown,
    told_of,
)
from costeer.web.scenery import cars_of, scenery_of
from costeer.web.session import Broadcast, Role

FRAME_RATE = 60
"""Frames a second."""

MOST_DRIVERS = 1
"""Pages that may drive at once."""

KEPT_LATENCIES = 36_000
"""Latencies kept for the account at the end: ten minutes of frames."""


class PageOptions(NamedTuple):
    """What pages show.

    Attributes:
        input: "keyboard", "gamepad" or "wheel".
        show_signals: Whether a driver's page may show the live signals.
        driver_starts: Whether a driver's page may start the drive.
        driver_acknowledges: Whether a driver's page may say that a fault is mended.
    """

    input: str = "keyboard"
    show_signals: bool = True
    driver_starts: bool = True
    driver_acknowledges: bool = True


class DriveOnPages:
    """The session of a drive; satisfies `DriveSession`.

    Args:
        setup: Of the drive.
        record: File to write, or None.
        options: What pages show.
        context: That starts processes; one that spawns them if None.

    Raises:
        ValueError: If the drive cannot begin.
    """

    def __init__(
        self,
        setup: DriveSetup,
        record: Path | None,
        options: PageOptions,
        context: BaseContext | None = None,
    ) -> None:
        self.broadcast = Broadcast()
        self.latencies: deque[float] = deque(maxlen=KEPT_LATENCIES)
        self.on_stop: Callable[[], None] = lambda: None
        self._others: list[Listener] = []
        self._late = Lateness()
        self._options = options
        self._num_drivers = 0
        self._every = round(setup.haste)
        self._chosen = first_choice(setup)
        self.columns = frame_columns(drive_columns(setup))
        listener = Listener(self._tell, self._mark)
        self.drive = Drive(setup, record, listener, context)
        self._stands = (RunState.WAITING.value, Fault.NONE.value)

    def also(
        self,
        frame: Callable[[NDArray[np.float64]], None],
        marker: Callable[[Marker], None],
    ) -> None:
        """Tell frames and markers to someone else, too."""
        self._others.append(Listener(frame, marker))

    def end_soon(self) -> None:
        """Take what ends from now on as meant; a handler of a signal may call it."""
        self.drive.is_ending = True

    def say_goodbye(self) -> None:
        """End the trial while its pages are still there, and tell them so."""
        with suppress(ValueError):  # the loop has ended
            self.drive.end_trial()
        self.broadcast.send({"type": "farewell"})

    def stop(self) -> None:
        """End the drive; its record is made whole."""
        self.drive.stop()

    def _tell(self, frame: NDArray[np.float64]) -> None:
        """Pass a frame on to all pages."""
        self._late.take(frame)
        self._stands = (int(frame[PLACE["run_state"]]), int(frame[PLACE["fault"]]))
        for other in self._others:
            other.frame(frame)
        if self._late.num_frames % self._every:
            return  # in haste pages would drown in frames
        shown = frame[: len(self.columns)]
        self.broadcast.send_frame(shown.astype("<f8", copy=False).tobytes())

    def _mark(self, marker: Marker) -> None:
        """Pass a marker on, and what it changed."""
        for other in self._others:
            other.marker(marker)
        if marker.kind == "error":  # it could not be done, and who drives must know
            self.broadcast.send({"type": "error", "text": marker.note})
            return
        self.broadcast.send({"type": "marker", **marker_shown(marker)})
        if marker.kind in ("lost", "note"):
            self.broadcast.send({"type": "losses", "texts": self._losses()})
        chosen = followed(self._chosen, marker)
        if chosen is not self._chosen:
            self._chosen = chosen
            self.broadcast.send(self._state())

    def _losses(self) -> list[str]:
        """What the drive goes on without, for the pages."""
        return [loss.text for loss in self.drive.losses]

    def _state(self) -> dict[str, object]:
        """What an experimenter has chosen."""
        return {
            "type": "state",
            "condition": self._chosen.condition,
            "method": self._chosen.method,
            "tunables": self._tunables(),
        }

    def _tunables(self) -> list[dict[str, object]]:
        """Tunables of the method that runs, and what they are."""
        setup = self.drive.setup
        values = tuned_values(setup, self._chosen)
        method = drive_method(chosen_setup(setup, self._chosen))
        return [
            {
                "name": each.name,
                "unit": each.unit,
                "low": each.low,
                "high": each.high,
                "value": values[each.name],
                "label": each.label,
            }
            for each in method.tunables
        ]

    def hello(self, role: Role) -> dict[str, object]:
        """The first message to a page: what the numbers of a frame are, and choices."""
        parameters = drive_parameters(self.drive.setup)
        road, car, trial = parameters.road, parameters.car, self.drive.setup.trial
        return {
            "mode": "drive",
            **told_of(self.columns),
            "rate": FRAME_RATE,
            "road": road._asdict(),
            "scenario": scenery_of(scenario_metadata(trial)),
            "other_cars": cars_of(scenario_named(trial.scenario), parameters.fleet),
            "car": {
                "width": car.width,
                "wheelbase": wheelbase(car),
                "steering_ratio": car.steering_ratio,
            },
            "conditions": list(CONDITION_NAMES),
            "condition": self._chosen.condition,
            "methods": list(offered_methods(self.drive.setup)),
            "method": self._chosen.method,
            **page_tables(),
            "run_state": self._stands[0],
            "fault": self._stands[1],
            "losses": self._losses(),
            "tunables": self._tunables() if role == "experimenter" else [],
            "input": self._options.input,
            "show_signals": self._options.show_signals or role == "experimenter",
            "torque_limit": parameters.column.torque_limit,
        }

    def apply(self, role: Role, message: Message) -> dict[str, object] | None:
        """Do what a page asks.

        Raises:
            ValueError: If it cannot be done.
        """
        if isinstance(message, Input):
            if role == "driver" or self._num_drivers == 0:
                self.drive.press(*message)
        elif isinstance(message, Latency):
            self.latencies.extend(message.values)
        elif isinstance(message, Start | Resume | Restart | Acknowledge):
            if role == "driver":
                self._check_driver(message)
            self.drive.send(type(message).__name__.lower())
        elif isinstance(message, Pause):
            self.drive.send("pause", role)
        elif isinstance(message, Indicator):
            self.drive.send("indicator", message.side)
        else:
            self._choose(message)
        return None

    def _check_driver(self, message: Message) -> None:
        """Refuse what in this drive is the experimenter's to say.

        Raises:
            ValueError: If it is.
        """
        if isinstance(message, Start) and not self._options.driver_starts:
            raise ValueError("the experimenter starts this drive; please wait")
        if isinstance(message, Acknowledge) and not self._options.driver_acknowledges:
            raise ValueError("the experimenter looks after this; please wait")

    def _choose(self, message: Message) -> None:
        """What only the experimenter may ask.

        Raises:
            ValueError: If name or value cannot be.
        """
        if isinstance(message, Set):
            value = checked_choice(
                self.drive.setup, self._chosen, message.name, message.value
            )
            self.drive.send("set", message.name, value)
        elif isinstance(message, Stop):
            self.drive.send("pause", "stop")
            self.on_stop()

    def client_joined(self, role: Role) -> None:
        """Count the pages that drive; a new one replaces one that has fallen silent.

        Raises:
            ValueError: If another page drives already.
        """
        if role != "driver":
            return
        silence = time.perf_counter() - self.drive.shared.mailbox.get("page_time")
        if self._num_drivers >= MOST_DRIVERS and silence < PAGE_PATIENCE:
            raise ValueError(
                "another page drives already; close it, or open the experimenter's "
                "address to look on"
            )
        self._num_drivers += 1

    @property
    def has_driver(self) -> bool:
        """Whether a page that drives is open."""
        return self._num_drivers > 0

    def client_left(self, role: Role) -> None:
        """Forget a page; without one that drives the trial pauses."""
        if role != "driver":
            return
        self._num_drivers -= 1
        if self._num_drivers == 0 and not self.drive.is_ending:
            with suppress(ValueError):  # the drive has ended
                self.drive.send("leave")

    def account(self) -> list[str]:
        """How late everything was, in words."""
        told = [self._late.told()] if self._late.num_frames else []
        if len(self.latencies) > 1:
            late = statistics.quantiles(self.latencies, n=20)
            way = "wheel" if self._options.input == "wheel" else "key through the loop"
            told.append(
                f"{way} to page: median {statistics.median(self.latencies):.1f} ms, "
                f"95th percentile {late[-1]:.1f} ms of {len(self.latencies)} frames"
            )
        return told


class Lateness:
    """How late the control steps of a drive were, kept as frames pass by."""

    def __init__(self) -> None:
        self.num_frames = 0
        self._num_late = 0
        self._longest = 0.0

    def take(self, frame: NDArray[np.float64]) -> None:
        """Count one frame."""
        late = float(frame[PLACE["lateness"]])
        self.num_frames += 1
        self._num_late += late > PLANT_DT
        self._longest = max(self._longest, late)

    def told(self) -> str:
        """In words."""
        share = 100.0 * self._num_late / self.num_frames
        return (
            f"{share:.2f} % of {self.num_frames} control steps held a plant step that "
            f"began more than {1e3 * PLANT_DT:.2f} ms late; the latest "
            f"{1e3 * self._longest:.1f} ms"
        )
