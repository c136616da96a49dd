"""Numbers that docs/drive.md promises, each where it would be seen to change."""

from __future__ import annotations

import math
import signal
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.simulated import SimulatedWheel, SimulatedWheelParameters
from costeer.records.row import ROW_COLUMNS
from costeer.runtime import recorder
from costeer.runtime.cabin import guard_parameters
from costeer.runtime.guard import GuardParameters, GuardState, step
from costeer.runtime.setup import PLANT_DT, DriveSetup
from costeer.runtime.states import Fault, RunState
from costeer.runtime.watchdog import stay_until_needed_no_more
from tests.runtime.rig import Rig, of, wheel_setup
from tests.runtime.test_driving_wheel import HANDS

MakeRig = Callable[[DriveSetup], Rig]


def most(limits: GuardParameters) -> float:
    """The largest torque that ever passes a guard [N·m]."""
    state, largest = GuardState(), 0.0
    for _ in range(2000):
        state, torque = step(limits, state, 1000.0, True, False, PLANT_DT)
        largest = max(largest, float(torque))
    return largest


def test_no_wheel_ever_gets_more_than_8_newton_metres() -> None:
    assert most(GuardParameters()) == 8.0


@pytest.mark.parametrize(("device", "passes"), [(2.2, 2.2), (20.0, 8.0)])
def test_the_smaller_of_both_limits_holds(device: float, passes: float) -> None:
    curve = ((0.0, 0.0), (1.0, device))
    known = WheelCalibration("", -1.0, 5.0 * math.pi, -1.0, curve, 0.04, 0.05, 0.1, 0.0)
    wheel = SimulatedWheel(SimulatedWheelParameters(torque_curve=curve), known)
    assert most(guard_parameters(wheel)) == pytest.approx(passes)


def test_reading_is_stale_after_50_ms(rig: MakeRig) -> None:
    drive = rig(wheel_setup(hands=HANDS))
    drive.ask("start")
    drive.steps(5)
    wheel = drive.driving._cabin.wheel
    assert wheel is not None
    last = wheel.read()
    wheel.read = lambda: last  # type: ignore[method-assign]  # it stands still
    ages = []
    while drive.driving._fault == Fault.NONE:
        ages.append(drive.now - last.time)
        assert ages[-1] < 0.1
        drive.driving.plant_step(0.0)
        drive.now += PLANT_DT
    assert ages[-1] == pytest.approx(0.050, abs=1.5 * PLANT_DT)


@pytest.mark.parametrize("name", ["longitudinal_position", "steering_wheel_angle"])
def test_each_number_of_the_motion_alone_breaks_the_trial_off_for_good(
    rig: MakeRig, name: str
) -> None:
    drive = rig(wheel_setup(hands=HANDS))
    drive.ask("start")
    drive.steps(5)
    row = np.zeros(len(ROW_COLUMNS))
    row[ROW_COLUMNS.index(name)] = math.nan
    drive.driving._after(row)
    assert of(drive.steps(1), "fault")[-1] == Fault.NOT_FINITE
    drive.ask("resume")
    frames = drive.steps(2)
    assert of(frames, "run_state")[-1] == RunState.PAUSED
    assert of(frames, "fault")[-1] == Fault.NOT_FINITE
    assert not Fault.NOT_FINITE.can_resume


SIGNALS = [
    getattr(signal, name)
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGTSTP")
    if hasattr(signal, name)
]


@pytest.fixture
def _handlers() -> Iterator[None]:
    before = {number: signal.getsignal(number) for number in SIGNALS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures("_handlers")
def test_watchdog_outlives_every_signal_that_it_can() -> None:
    stay_until_needed_no_more()
    assert {signal.getsignal(number) for number in SIGNALS} == {signal.SIG_IGN}


def test_a_killed_drive_loses_no_more_than_a_quarter_of_a_second() -> None:
    assert recorder.INTERVAL == 0.25
