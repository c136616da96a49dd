"""A loop or a watchdog that was halted: what the wheel is given when it goes on."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.devices.wheels.simulated import SpringHands
from costeer.runtime.drive import Drive, Listener
from costeer.runtime.frame import PLACE
from costeer.runtime.patience import WATCHDOG_PATIENCE
from costeer.runtime.setup import DriveSetup
from costeer.runtime.states import Fault, Loss, RunState
from costeer.runtime.watchdog import stands_still
from tests.runtime.rig import Rig, of, wheel_setup
from tests.waiting import wait_for

MakeRig = Callable[[DriveSetup], Rig]
HELD = SpringHands(stiffness=6.0, damping=0.6, amplitude=0.3)
LARGEST_STEP = 200.0 / 960 + 1e-9
"""Of the torque from one write to the next [N·m]: the guard's 200 N·m/s."""


def pushing(rig: MakeRig) -> tuple[Rig, list[float]]:
    """A drive whose wheel pushes, and what is written to the wheel from now on."""
    drive = rig(wheel_setup(hands=HELD))
    drive.ask("start")
    drive.steps(80)
    wheel, written = drive.driving._cabin.wheel, []
    assert wheel is not None
    whole = wheel.write

    def write(torque: float) -> None:
        written.append(torque)
        whole(torque)

    wheel.write = write  # type: ignore[method-assign]  # to see what is written
    drive.steps(1)
    assert abs(written[-1]) > 0.3
    written.clear()
    return drive, written


def test_loop_that_wakes_after_the_watchdog_acted_writes_nothing_but_zero(
    rig: MakeRig,
) -> None:
    drive, written = pushing(rig)
    drive.shared.mailbox.put(stalled=1.0)
    frames = drive.steps(3)
    assert written
    assert set(written) == {0.0}
    assert of(frames, "fault")[-1] == Fault.STALLED


def test_loop_halted_between_reading_and_writing_does_not_push_when_it_wakes(
    rig: MakeRig,
) -> None:
    drive, written = pushing(rig)
    wheel = drive.driving._cabin.wheel
    assert wheel is not None
    whole = wheel.read

    def halted() -> object:
        drive.shared.mailbox.put(stalled=1.0)
        return whole()

    wheel.read = halted  # type: ignore[method-assign,assignment]  # halted here
    drive.driving.plant_step(0.0)
    assert set(written) == {0.0}


def test_loop_that_slept_longer_than_a_torque_lives_starts_from_nothing(
    rig: MakeRig,
) -> None:
    drive, written = pushing(rig)
    drive.now += 0.25  # no watchdog has noticed it
    drive.driving.plant_step(0.0)
    assert abs(written[0]) <= LARGEST_STEP
    assert of(drive.steps(2), "fault")[-1] == Fault.STALLED


def test_trial_is_paused_without_torque_while_the_watchdog_stands_still(
    rig: MakeRig,
) -> None:
    drive, written = pushing(rig)
    drive.shared.mailbox.put(watched_at=drive.now, watching=1.0)
    assert of(drive.steps(2), "fault")[-1] == Fault.NONE
    drive.shared.mailbox.put(watched_at=drive.now - WATCHDOG_PATIENCE - 0.01)
    frames = drive.steps(6)
    assert of(frames, "fault")[-1] == Fault.WATCHDOG_STILL
    assert of(frames, "run_state")[-1] == RunState.PAUSED
    assert written[-1] == 0.0
    drive.heard()
    drive.ask("acknowledge")
    assert of(drive.steps(1), "run_state")[-1] == RunState.PAUSED
    assert "watchdog" in drive.heard()[-1].note
    drive.shared.mailbox.put(watched_at=drive.now + 9.0)
    drive.ask("acknowledge")
    drive.ask("resume")
    assert of(drive.steps(1), "run_state")[-1] == RunState.RUNNING


@pytest.fixture
def drives() -> Iterator[list[Drive]]:
    made: list[Drive] = []
    yield made
    for drive in made:
        for process in (drive._realtime, *drive._helpers.processes.values()):
            if process is not None and process.is_alive():
                os.kill(int(process.pid or 0), signal.SIGCONT)
        drive.stop()


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="there are no such signals")
@pytest.mark.usefixtures("compiled_drive")
@pytest.mark.parametrize("watchdog_too", [False, True])
def test_halted_process_does_not_push_when_it_goes_on(
    drives: list[Drive],
    torque_cell: tuple[str, NDArray[np.float64]],
    watchdog_too: bool,
) -> None:
    name, cell = torque_cell
    frames: list[NDArray[np.float64]] = []
    drive = Drive(
        wheel_setup(hands=HELD, torque_cell=name),
        None,
        Listener(lambda frame: frames.append(frame.copy()), lambda marker: None),
    )
    drives.append(drive)
    drive.start()
    drive.send("start")

    def pushes() -> bool:
        if frames and frames[-1][PLACE["run_state"]] == RunState.PAUSED:
            drive.send("acknowledge")
            drive.send("resume")  # a busy machine has paused it
        return abs(cell[0]) > 0.3

    wait_for(pushes)
    watchdog = int(drive._helpers.processes[Loss.WATCHDOG].pid or 0)
    if watchdog_too:
        os.kill(watchdog, signal.SIGSTOP)
    os.kill(drive.pid, signal.SIGSTOP)
    wait_for(lambda: cell[0] == 0.0)  # who is left takes the torque off
    if watchdog_too:
        assert stands_still(drive.shared.mailbox, 1e9)
        os.kill(watchdog, signal.SIGCONT)
    seen, number = [0.0], len(frames)
    os.kill(drive.pid, signal.SIGCONT)

    def goes_on() -> bool:
        seen.append(float(cell[0]))
        return len(frames) > number + 5 or not drive._realtime.is_alive()  # type: ignore[union-attr]  # it was started

    wait_for(goes_on)
    assert np.abs(seen).max() == 0.0
