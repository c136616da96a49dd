"""Faults of a drive: each told once, none lost for another, and what clears which."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from costeer.devices.wheels.interface import EFFECT_LIFE
from costeer.records.columns import Column
from costeer.records.row import ROW_COLUMNS
from costeer.runtime.frame import FRAME, FrameRow
from costeer.runtime.setup import DriveSetup, leader_draws
from costeer.runtime.states import Fault, RunState
from tests.runtime.rig import Rig, drive_setup, of, wheel_setup
from tests.runtime.test_driving_wheel import HANDS

MakeRig = Callable[[DriveSetup], Rig]


def begun(rig: MakeRig, setup: DriveSetup) -> Rig:
    """A drive that runs, its start heard."""
    drive = rig(setup)
    drive.ask("start")
    drive.steps(5)
    drive.heard()
    return drive


def faults(drive: Rig) -> list[str]:
    """Names of the faults that were told since the last time."""
    return [marker.name for marker in drive.heard() if marker.kind == "fault"]


def test_fault_that_lasts_is_told_once(rig: MakeRig) -> None:
    drive = begun(rig, drive_setup()._replace(needs_page=True))
    for _ in range(4):
        drive.ask("leave")
        drive.driving._break_off(Fault.PAGE_LOST)
        drive.steps(1)
    assert faults(drive) == ["page_lost"]


def test_fault_that_ends_a_trial_for_good_is_not_covered_by_another(
    rig: MakeRig,
) -> None:
    drive = begun(rig, wheel_setup(hands=HANDS))
    drive.driving._break_off(Fault.NOT_FINITE)
    drive.shared.mailbox.put(stalled=1.0)
    frames = drive.steps(3)
    assert (of(frames, "fault") == Fault.NOT_FINITE).all()
    assert faults(drive) == ["not_finite"]
    # The watchdog has let go of the wheel meanwhile: a restart takes it up anew.
    drive.ask("restart")
    drive.ask("start")
    frames = drive.steps(90)
    assert of(frames, "run_state")[-1] == RunState.RUNNING
    assert drive.shared.mailbox.get("stalled") == 0.0
    assert of(frames, "fade")[-1] == 1.0


@pytest.mark.parametrize("fault", [Fault.PAGE_LOST, Fault.RECORD_STOPPED])
def test_only_a_record_that_had_stopped_is_mended(rig: MakeRig, fault: Fault) -> None:
    drive = begun(rig, drive_setup())
    drive.driving._break_off(fault)
    drive.ask("unrecorded", False)
    told = of(drive.steps(1), "fault")[-1]
    stopped = fault == Fault.RECORD_STOPPED
    assert told == (Fault.RECORD_MENDED if stopped else fault)


def test_record_that_is_mended_before_the_start_is_no_fault_any_more(
    rig: MakeRig,
) -> None:
    drive = rig(drive_setup())
    drive.ask("unrecorded", True)
    assert of(drive.steps(1), "fault")[-1] == Fault.RECORD_STOPPED
    drive.ask("restart")  # makes no room on the disk
    assert of(drive.steps(1), "fault")[-1] == Fault.RECORD_STOPPED
    drive.ask("unrecorded", False)
    assert of(drive.steps(1), "fault")[-1] == Fault.NONE


def test_without_a_wheel_a_loop_that_slept_goes_on(rig: MakeRig) -> None:
    drive = begun(rig, drive_setup())
    drive.now += 2.0 * EFFECT_LIFE
    frames = drive.steps(2)
    assert (of(frames, "run_state") == RunState.RUNNING).all()
    assert (of(frames, "fault") == Fault.NONE).all()


def test_wheel_is_opened_anew_after_the_loop_slept_and_not_without_need(
    rig: MakeRig,
) -> None:
    drive = rig(wheel_setup(hands=HANDS))
    drive.steps(1)
    first = drive.driving._cabin.wheel
    drive.ask("start")
    drive.steps(2)
    assert drive.driving._cabin.wheel is first
    drive.now += 2.0 * EFFECT_LIFE
    assert of(drive.steps(2), "fault")[-1] == Fault.STALLED
    drive.ask("acknowledge")
    drive.ask("resume")
    assert of(drive.steps(1), "run_state")[-1] == RunState.RUNNING
    assert drive.driving._cabin.wheel is not first


@pytest.mark.parametrize("fault", Fault)
@pytest.mark.parametrize("where", ["start", "resume"])
def test_no_fault_but_a_closed_page_is_left_without_a_word(
    rig: MakeRig, fault: Fault, where: str
) -> None:
    drive = rig(drive_setup())
    if where == "resume":
        drive.ask("start")
        drive.steps(1)
        drive.ask("pause", "driver")
        drive.steps(1)
    drive.driving._break_off(fault)
    drive.ask(where)
    free = fault in (Fault.NONE, Fault.PAGE_LOST, Fault.ACKNOWLEDGED)
    assert (of(drive.steps(1), "run_state")[-1] == RunState.RUNNING) == free
    if free:
        return
    drive.ask("acknowledge")
    drive.ask(where)
    mended = of(drive.steps(1), "run_state")[-1] == RunState.RUNNING
    assert mended == fault.can_resume


def test_fault_after_the_word_needs_another(rig: MakeRig) -> None:
    drive = rig(wheel_setup(hands=HANDS))
    drive.steps(1)
    drive.ask("start")
    drive.steps(2)
    for _ in range(2):
        drive.shared.mailbox.put(stalled=1.0)
        drive.steps(2)
        drive.ask("acknowledge")
        assert of(drive.steps(1), "fault")[-1] == Fault.ACKNOWLEDGED
    drive.shared.mailbox.put(stalled=1.0)  # in the very moment of going on
    drive.ask("resume")
    frames = drive.steps(2)
    assert of(frames, "run_state")[-1] == RunState.PAUSED
    assert of(frames, "fault")[-1] == Fault.STALLED


def test_loop_whose_server_has_hung_up_ends(rig: MakeRig) -> None:
    drive = begun(rig, drive_setup())
    drive._near.close()
    drive.driving.control_step(0.0)
    assert drive.driving.stopping


def test_loop_never_waits_for_a_server_that_reads_no_frames(rig: MakeRig) -> None:
    drive = rig(drive_setup())
    drive.steps(1)
    assert not drive.driving._links.wake.getblocking()


def test_frame_says_what_acted_when_and_how_long_it_took(rig: MakeRig) -> None:
    drive = rig(wheel_setup(hands=HANDS))
    drive.steps(1)
    drive.shared.mailbox.put(input_sequence=7.0)
    frames = drive.steps(2)  # nobody drives yet: no input acts
    assert of(frames, "input_sequence").tolist() == [0.0, 0.0]
    # The clock of the rig stands still within a step.
    assert of(frames, "compute_time").tolist() == [0.0, 0.0]
    before = of(frames, "sent_time") - of(frames, "wheel_time")
    assert before == pytest.approx([1.0 / 960.0] * 2)
    drive.ask("start")
    drive.steps(1)
    drive.ask("pause", "driver")
    drive.steps(3)
    trace = drive.shared.trace.since(0)[1]
    assert len(trace) > 16
    assert (trace[:, -1] == 0.0).all()


def test_each_leader_has_a_speed_of_its_own_and_a_new_trial_begins_with_the_first(
    rig: MakeRig,
) -> None:
    setup = drive_setup()
    drive = begun(rig, setup)
    draws = leader_draws(setup)

    def drawn(*events: float) -> list[float]:
        row, found = np.zeros(len(ROW_COLUMNS)), []
        for row[ROW_COLUMNS.index("event")] in events:
            drive.driving._after(row)
            found.append(drive.driving._controls(drive.now).leader_uniform)
        return found

    assert drive.driving._controls(drive.now).leader_uniform == draws[0]
    assert drawn(1.0, 1.0, 0.0, 2.0, 0.0) == list(draws[[1, 1, 1, 2, 2]])
    drive.ask("restart")
    drive.steps(1)
    assert drive.driving._controls(drive.now).leader_uniform == draws[0]
    assert drawn(1.0, 0.0) == list(draws[[1, 1]])


def test_frame_ends_with_what_the_method_adds_or_with_nothing_of_it(
    rig: MakeRig,
) -> None:
    drive = rig(drive_setup())
    own = [Column(f"method_{name}", "-", "float64", name) for name in "ab"]
    drive.driving._frame = FrameRow(own)
    row = np.zeros(len(ROW_COLUMNS) + 2)
    row[-2:] = 1.5, 2.5
    # Without the last two another method runs.
    for given, added in ((row, [1.5, 2.5]), (row[:-2], [np.nan, np.nan])):
        drive.driving._tell(given, 0.0)
        frame = drive.shared.frames.since(drive.shared.frames.written - 1)[1][0]
        np.testing.assert_array_equal(frame[len(FRAME) : len(FRAME) + 2], added)


def test_marker_of_going_on_says_how_long_the_trial_stood(rig: MakeRig) -> None:
    drive = begun(rig, drive_setup())
    drive.ask("pause", "driver")
    drive.steps(30)
    drive.ask("resume")
    drive.steps(1)
    last = drive.heard()[-1]
    assert (last.kind, last.unit) == ("resumed", "s")
    assert last.after == pytest.approx(0.5, abs=1e-3)
