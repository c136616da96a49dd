"""A drive with a wheel: what it gives, what it feels, and what stops it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from costeer.devices.wheels import hands
from costeer.devices.wheels.simulated import SimulatedWheel, SpringHands
from costeer.loop.realtime import arms_tick
from costeer.runtime.guard import GuardParameters
from costeer.runtime.setup import DriveSetup
from costeer.runtime.states import Fault, RunState
from tests.runtime.rig import Rig, drive_setup, of, wheel_setup

HANDS = SpringHands(stiffness=6.0, damping=0.6)
MakeRig = Callable[[DriveSetup], Rig]


def test_wheel_is_held_in_the_lane_by_the_guidance_and_torque_fades_in(
    rig: MakeRig,
) -> None:
    setup = wheel_setup()
    drive = rig(setup._replace(trial=setup.trial._replace(initial_offset=0.5)))
    drive.ask("start")
    frames = drive.steps(300)
    fade = of(frames, "fade")
    assert fade[1] < 0.05
    assert fade[70] == 1.0
    assert (np.diff(fade) >= 0.0).all()
    # Within 0.1 m after 2.7 s with the studies' column, one second more to fade in.
    assert np.abs(of(frames, "lateral_position")[230:]).max() < 0.15


def test_hands_that_turn_the_wheel_are_felt_within_their_torque(rig: MakeRig) -> None:
    hands = HANDS._replace(amplitude=0.15, period=3.0)
    drive = rig(wheel_setup("manual", hands=hands))
    drive.ask("start")
    frames = drive.steps(240)
    angle = of(frames, "steering_wheel_angle")[60:]
    told = of(frames, "driver_torque")[60:]
    when = of(frames, "time")[60:]
    assert np.ptp(angle) > 0.1
    # The observer knows neither the arms nor their phase: it sees what they do.
    rate = np.gradient(angle, 1 / 60)
    wanted = hands.amplitude * np.sin(2 * math.pi * (when + 0.03) / hands.period)
    true = hands.stiffness * (wanted - angle) - hands.damping * rate
    assert np.corrcoef(true, told)[0, 1] > 0.8


def test_hands_on_a_simulated_wheel_are_compiled_before_it_is_opened(
    rig: MakeRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the loop it would stand still for a second, and the watchdog end it."""
    moved: list[float] = []

    def tick(*given: float) -> float:
        moved.append(given[3])
        return arms_tick(*given)  # type: ignore[arg-type]  # arrays first

    monkeypatch.setattr(hands, "arms_tick", tick)
    drive = rig(wheel_setup())
    assert moved
    monkeypatch.undo()
    drive.ask("start")
    assert np.isfinite(of(drive.steps(3), "steering_wheel_angle")).all()


def test_stop_fades_out_and_leaves_no_torque(rig: MakeRig) -> None:
    hands = HANDS._replace(amplitude=0.3)
    drive = rig(wheel_setup(hands=hands))
    drive.ask("start")
    assert np.abs(of(drive.steps(120), "wheel_torque")).max() > 0.3
    drive.ask("pause", "by the driver")
    frames = drive.steps(30)
    torque = np.abs(of(frames, "wheel_torque"))
    limit = GuardParameters()
    assert np.abs(np.diff(torque)).max() <= limit.torque_rate_limit / 60 + 1e-9
    # Linear over 0.3 s: half of it is left after nine steps.
    assert of(frames, "fade")[8] == pytest.approx(0.5, abs=0.06)
    assert torque[8] / torque[0] == pytest.approx(0.5, abs=0.08)
    assert of(frames, "fade")[-1] == 0.0
    assert torque[-1] == 0.0


def test_end_of_the_process_fades_out_first_and_is_marked(rig: MakeRig) -> None:
    drive = rig(wheel_setup(hands=HANDS._replace(amplitude=0.3)))
    drive.ask("start")
    drive.steps(120)
    drive.ask("stop")
    torque, steps = [], 0
    while not drive.driving.stopping:
        torque += list(np.abs(of(drive.steps(1), "wheel_torque")))
        steps += 1
        assert steps < 30
    assert torque[0] > 0.2
    assert torque[-1] == 0.0
    assert drive.heard()[-1][:2] == ("ended", "server")


def test_sample_that_is_no_number_is_left_out(rig: MakeRig) -> None:
    drive = rig(wheel_setup(hands=HANDS))
    drive.ask("start")
    drive.steps(10)
    wheel = drive.driving._cabin.wheel
    assert wheel is not None
    whole = wheel.read
    wheel.read = lambda: whole()._replace(steering_wheel_angle=math.nan)  # type: ignore[method-assign]  # a fault, injected
    short = drive.steps(2)
    wheel.read = whole  # type: ignore[method-assign]  # the fault is over
    assert (of(short, "run_state") == RunState.RUNNING).all()
    assert np.isfinite(of(drive.steps(5), "lateral_position")).all()
    wheel.read = lambda: whole()._replace(steering_wheel_angle=math.nan)  # type: ignore[method-assign]  # and comes back to stay
    frames = drive.steps(10)
    assert of(frames, "fault")[-1] == Fault.SENSOR_STALE
    assert of(frames, "run_state")[-1] == RunState.PAUSED


def test_paddles_set_the_indicator_and_take_it_back(rig: MakeRig) -> None:
    drive = rig(wheel_setup(hands=HANDS))
    wheel = drive.driving._cabin.wheel
    assert wheel is not None
    whole, pulled = wheel.read, [0]
    wheel.read = lambda: whole()._replace(buttons=pulled[0])  # type: ignore[method-assign]  # paddles, pulled
    sides = []
    for pulled[0] in (0, 1, 1, 0, 2, 0, 2, 0):
        sides += [float(of(drive.steps(2), "indicator")[-1])]
    assert sides == [0.0, 1.0, 1.0, 1.0, -1.0, -1.0, 0.0, 0.0]


def test_unplugged_wheel_pauses_the_trial_and_says_so(rig: MakeRig) -> None:
    drive = rig(wheel_setup(unplug_at=0.5))
    drive.ask("start")
    frames = drive.steps(60)
    assert of(frames, "run_state")[-1] == RunState.PAUSED
    assert of(frames, "fault")[-1] == Fault.WHEEL_LOST
    assert of(frames, "time")[-1] == pytest.approx(0.5, abs=0.05)
    assert drive.heard()[-1][:2] == ("fault", "wheel_lost")
    # A new one (the same, seen from its own start) is found, and the trial goes on:
    # not by the key with which drives begin alone.
    drive.ask("resume")
    again = drive.steps(5)
    assert of(again, "run_state")[-1] == RunState.PAUSED
    assert "say that it is mended" in drive.heard()[-1].note
    drive.ask("acknowledge")
    assert of(drive.steps(2), "run_state")[-1] == RunState.PAUSED
    assert drive.heard()[-1][:2] == ("fault", "acknowledged")
    drive.ask("resume")
    again = drive.steps(5)
    assert of(again, "run_state")[-1] == RunState.RUNNING
    assert of(again, "fault")[-1] == Fault.NONE


def test_silent_wheel_pauses_the_trial_without_torque_within_100_ms(
    rig: MakeRig,
) -> None:
    drive = rig(wheel_setup(hands=HANDS._replace(amplitude=0.2), freeze_at=1.5))
    drive.ask("start")
    frames = drive.steps(120)
    assert np.abs(of(frames, "wheel_torque")[80:88]).min() > 0.1
    assert of(frames, "fault")[-1] == Fault.SENSOR_STALE
    assert of(frames, "run_state")[-1] == RunState.PAUSED
    # It stood still at 1.5 s, step 90; six steps are 100 ms.
    assert (of(frames, "wheel_torque")[96:] == 0.0).all()


def test_lost_page_pauses_the_trial(rig: MakeRig) -> None:
    drive = rig(drive_setup()._replace(needs_page=True))
    drive.ask("start")
    drive.steps(10)
    drive.shared.mailbox.put(page_time=drive.now - 1.1)
    frames = drive.steps(3)
    assert of(frames, "run_state")[-1] == RunState.PAUSED
    assert of(frames, "fault")[-1] == Fault.PAGE_LOST
    drive.alive(60.0)
    drive.ask("resume")
    assert of(drive.steps(2), "run_state")[-1] == RunState.RUNNING


def test_closed_page_pauses_the_trial_at_once(rig: MakeRig) -> None:
    drive = rig(drive_setup()._replace(needs_page=True))
    drive.ask("leave")
    assert of(drive.steps(1), "fault")[-1] == Fault.NONE  # nothing ran
    drive.ask("start")
    drive.steps(5)
    drive.ask("leave")
    assert of(drive.steps(2), "fault")[-1] == Fault.PAGE_LOST


def test_input_is_told_as_applied_in_the_step_that_applied_it(rig: MakeRig) -> None:
    drive = rig(drive_setup())
    drive.ask("start")
    drive.steps(1)
    drive.shared.mailbox.put(steer=0.5, steering=1.0, input_sequence=3.0)
    frames = drive.steps(1)
    assert of(frames, "input_sequence")[0] == 3.0
    assert of(frames, "intended_angle")[0] > 0.0
    drive.ask("pause", "")
    drive.steps(1)
    drive.shared.mailbox.put(input_sequence=4.0)
    assert of(drive.steps(1), "input_sequence")[0] == 3.0  # nobody applied it


def test_gone_server_ends_the_process(rig: MakeRig) -> None:
    drive = rig(drive_setup())
    drive.steps(1)
    assert not drive.driving.stopping
    drive.shared.mailbox.put(server_time=drive.now - 6.0)
    drive.steps(1)
    assert drive.driving.stopping


def test_loop_that_was_stuck_finds_its_trial_paused_and_can_resume(
    rig: MakeRig,
) -> None:
    drive = rig(wheel_setup(hands=HANDS._replace(amplitude=0.2)))
    drive.ask("start")
    drive.steps(80)
    drive.shared.mailbox.put(stalled=1.0)  # as the watchdog does
    frames = drive.steps(10)
    assert of(frames, "fault")[-1] == Fault.STALLED
    assert of(frames, "run_state")[-1] == RunState.PAUSED
    assert (of(frames, "wheel_torque")[4:] == 0.0).all()
    drive.ask("acknowledge")
    drive.ask("resume")
    frames = drive.steps(70)
    assert (of(frames, "run_state")[1:] == RunState.RUNNING).all()
    assert of(frames, "fade")[2] < 0.1  # anew, from nothing


def test_wheel_opened_anew_after_a_stall_may_first_have_to_be_turned(
    rig: MakeRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    # SDL2 tells no angle of a wheel that was just opened until it has moved.
    drive = rig(wheel_setup())
    drive.ask("start")
    drive.steps(5)
    drive.shared.mailbox.put(stalled=1.0)
    drive.steps(2)
    monkeypatch.setattr(SimulatedWheel, "is_awake", False, raising=False)
    drive.ask("acknowledge")
    assert of(drive.steps(1), "run_state")[-1] == RunState.PAUSED
    assert "turn the wheel by 10 degrees" in drive.heard()[-1].note
    drive.driving._cabin.wheel.is_awake = True  # type: ignore[union-attr]
    drive.ask("acknowledge")
    drive.ask("resume")
    assert of(drive.steps(1), "run_state")[-1] == RunState.RUNNING


@pytest.mark.parametrize("where", ["waiting", "paused"])
def test_trial_whose_wheel_was_lost_can_be_restarted(rig: MakeRig, where: str) -> None:
    drive = rig(wheel_setup(unplug_at=0.2))
    if where == "paused":
        drive.ask("start")
    assert of(drive.steps(20), "fault")[-1] == Fault.WHEEL_LOST
    drive.ask("restart")
    drive.ask("start")
    frames = drive.steps(5)
    assert of(frames, "run_state")[-1] == RunState.RUNNING
    assert of(frames, "fault")[-1] == Fault.NONE


def test_number_that_is_not_finite_pauses_the_trial_without_torque(
    rig: MakeRig,
) -> None:
    drive = rig(wheel_setup(hands=HANDS._replace(amplitude=0.2)))
    drive.ask("start")
    drive.steps(70)
    drive.driving._cabin.memory.motion[:] = np.nan
    frames = drive.steps(10)
    assert of(frames, "run_state")[-1] == RunState.PAUSED
    assert of(frames, "fault")[-1] == Fault.NOT_FINITE
    assert (of(frames, "wheel_torque")[4:] == 0.0).all()
    drive.ask("resume")
    drive.steps(1)
    assert "restart" in drive.heard()[-1].note
    drive.ask("restart")
    drive.ask("start")
    assert np.isfinite(of(drive.steps(5), "lateral_position")).all()


def test_trial_does_not_begin_before_the_wheel_tells_its_angle(rig: MakeRig) -> None:
    drive = rig(wheel_setup())
    wheel = drive.driving._cabin.wheel
    wheel.is_awake = False  # type: ignore[union-attr]  # as SDL2 has it after opening
    drive.ask("start")
    assert of(drive.steps(1), "run_state")[-1] == RunState.WAITING
    assert "turn the wheel by 10 degrees" in drive.heard()[-1].note
    wheel.is_awake = True  # type: ignore[union-attr]  # it was turned
    drive.ask("start")
    assert of(drive.steps(1), "run_state")[-1] == RunState.RUNNING


def test_trial_does_not_begin_with_a_turned_wheel(rig: MakeRig) -> None:
    hands = HANDS._replace(amplitude=1.5, period=2.0)
    drive = rig(wheel_setup(hands=hands))
    drive.steps(30)
    drive.ask("start")
    frames = drive.steps(2)
    assert of(frames, "run_state")[-1] == RunState.WAITING
    assert "straight" in drive.heard()[-1].note
