"""A drive stepped by the test itself: no processes, a clock of its own, no waiting."""

from __future__ import annotations

import multiprocessing
import socket
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.interface import Wheel, WheelDescription
from costeer.devices.wheels.simulated import (
    SimulatedWheelParameters,
    SpringHands,
    open_simulated,
    simulated_description,
    true_calibration,
)
from costeer.loop.scenario import TrialSetup
from costeer.runtime.driving import Driving
from costeer.runtime.frame import FRAME_COLUMNS, PLACE
from costeer.runtime.links import Links
from costeer.runtime.markers import Marker
from costeer.runtime.setup import PLANT_DT, PLANT_STEPS, DriveSetup
from costeer.runtime.shared import Rows, Shared, close_shared, make_shared

FOR_EVER = 1e9


def drive_setup(condition: str = "strong-normal", **trial: object) -> DriveSetup:
    """A drive with virtual hands."""
    return DriveSetup(
        trial=TrialSetup(condition=condition)._replace(**trial),
        intention="off",
        needs_page=False,
    )


def wheel_setup(
    condition: str = "strong-normal",
    hands: SpringHands | None = None,
    torque_cell: str = "",
    **options: object,
) -> DriveSetup:
    """A drive with a simulated wheel that nobody holds unless `hands` do."""
    return drive_setup(condition)._replace(
        wheel=simulated_description(
            hands=hands,
            torque_cell=torque_cell,
            **options,
        ),
        calibration=true_calibration(SimulatedWheelParameters(**options)),  # type: ignore[arg-type]  # of the test's own making
    )


class Rig:
    """A drive and both ends of its links."""

    def __init__(self, setup: DriveSetup) -> None:
        self.shared: Shared = make_shared()
        self._near, far = multiprocessing.Pipe()
        self._wake, far_wake = socket.socketpair()
        self._wake.setblocking(False)
        links = Links(self.shared.memory.name, far, far_wake)
        self.now = 1000.0
        self.driving = Driving(setup, links, self.shared, self._clock, self._open)
        self.driving.warm_up()
        self.driving.open_wheel()
        self._ends = (self._near, far, self._wake, far_wake)
        self.alive(FOR_EVER)

    def _clock(self) -> float:
        return self.now

    def _open(self, which: WheelDescription, known: WheelCalibration) -> Wheel:
        return open_simulated(which, known, self._clock)

    def alive(self, time_ahead: float) -> None:
        """Let server and page be alive until so long from now [s]."""
        until = self.now + time_ahead
        self.shared.mailbox.put(server_time=until, page_time=until)

    def ask(self, *command: object) -> None:
        """Send a command."""
        self._near.send(command)

    def steps(self, number: int) -> NDArray[np.float64]:
        """So many control steps with their plant steps; returns their frames."""
        first = self.shared.frames.written
        for _ in range(number):
            self.driving.control_step(0.0)
            with suppress(OSError):
                self._wake.recv(4096)
            for _ in range(PLANT_STEPS):
                self.driving.plant_step(0.0)
                self.now += PLANT_DT
        return self.shared.frames.since(first)[1]

    def heard(self) -> list[Marker]:
        """Markers since the last time."""
        return [marker for marker, _ in self.told()]

    def told(self) -> list[tuple[Marker, Rows]]:
        """The same, each with the rows before which it happened."""
        found = []
        while self._near.poll():
            word, *values = self._near.recv()
            assert word == "marker"
            found.append(tuple(values))
        return found

    def kinds(self) -> list[str]:
        """Kinds of the markers since the last time."""
        return [marker.kind for marker in self.heard()]

    def close(self) -> None:
        """Let everything go."""
        self.driving.close()
        for end in self._ends:
            end.close()
        close_shared(self.shared, unlink=True)


def of(frames: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    """A column of frames."""
    assert name in FRAME_COLUMNS
    return frames[:, PLACE[name]]
