"""A drive does what it is told, and stops what must not go on."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from costeer.devices.wheels.simulated import SpringHands
from costeer.runtime.setup import DriveSetup
from costeer.runtime.states import RunState
from tests.runtime.rig import Rig, drive_setup, of, wheel_setup

HANDS = SpringHands(stiffness=6.0, damping=0.6)
MakeRig = Callable[[DriveSetup], Rig]


def test_drive_waits_runs_pauses_and_goes_on_where_it_was(rig: MakeRig) -> None:
    drive = rig(drive_setup())
    assert (of(drive.steps(3), "run_state") == RunState.WAITING).all()
    drive.ask("start")
    ran = drive.steps(30)
    drive.ask("pause", "driver")
    rested = drive.steps(10)
    drive.ask("resume")
    went_on = drive.steps(5)
    assert (of(ran, "run_state") == RunState.RUNNING).all()
    np.testing.assert_allclose(of(ran, "time"), np.arange(30) / 60.0, atol=1e-12)
    assert (of(rested, "time") == of(ran, "time")[-1]).all()
    assert (of(rested, "run_state") == RunState.PAUSED).all()
    np.testing.assert_allclose(of(went_on, "time"), np.arange(30, 35) / 60.0)
    assert drive.kinds() == ["started", "paused", "resumed"]


def test_trace_of_the_wheel_has_every_plant_step_at_its_time(rig: MakeRig) -> None:
    drive = rig(wheel_setup(hands=HANDS))
    drive.ask("start")
    drive.steps(3)
    drive.ask("pause", "")
    drive.steps(2)
    drive.ask("resume")
    drive.steps(1)
    rows = drive.shared.trace.since(0)[1]
    moments = np.unique(rows[:, 0])  # the row of the pause without torque repeats one
    np.testing.assert_allclose(moments, np.arange(4 * 16) / 960.0, atol=1e-9)
    drive.ask("restart")
    drive.ask("start")
    drive.steps(1)
    again = drive.shared.trace.since(65)[1]
    np.testing.assert_allclose(again[:, 0], np.arange(16) / 960.0, atol=1e-9)


def test_held_key_changes_the_lane_and_the_car_keeps_its_speed(rig: MakeRig) -> None:
    drive = rig(drive_setup("manual"))
    drive.ask("start")
    drive.shared.mailbox.put(steer=-0.8, steering=1.0)
    drive.steps(90)
    drive.shared.mailbox.put(steer=0.8)
    drive.steps(97)
    drive.shared.mailbox.put(steer=0.0, steering=0.0)
    frames = drive.steps(90)
    assert of(frames, "lane")[-1] == 0.0
    assert of(frames, "lateral_position")[-1] < -1.75
    assert of(frames, "longitudinal_velocity")[-1] == pytest.approx(70 / 3.6, abs=0.3)


def test_end_of_the_course_ends_the_trial_and_a_restart_begins_anew(
    rig: MakeRig,
) -> None:
    drive = rig(drive_setup(length=100.0))
    drive.ask("start")
    frames = drive.steps(330)
    assert of(frames, "run_state")[-1] == RunState.ENDED
    assert of(frames, "longitudinal_position")[-1] == pytest.approx(100.0, abs=0.4)
    drive.ask("restart")
    drive.ask("start")
    again = drive.steps(3)
    assert of(again, "longitudinal_position")[0] == 0.0
    assert drive.kinds() == ["started", "ended", "restarted", "started"]


def test_condition_method_and_gain_change_while_driving_and_are_told(
    rig: MakeRig,
) -> None:
    drive = rig(drive_setup())
    drive.ask("start")
    drive.steps(2)
    drive.ask("set", "condition", "weak-gentle")
    assert of(drive.steps(1), "strength_factor")[-1] == 0.4
    drive.ask("set", "lateral_error_gain", 2.0)
    drive.ask("set", "method", "manual")
    assert of(drive.steps(1), "strength_factor")[-1] == 0.0
    markers = drive.heard()[1:]
    assert [marker[:5] for marker in markers] == [
        ("condition", "", "strong-normal", "weak-gentle", ""),
        ("parameter", "strength_factor", 1.0, 0.4, "-"),
        ("parameter", "change_duration", 6.0, 8.0, "s"),
        ("parameter", "lateral_error_gain", 1.5, 2.0, "N·m/m"),
        ("method", "", "ibhs", "manual", ""),
        ("parameter", "strength_factor", 0.4, 0.0, "-"),
    ]
    assert markers[0].time == pytest.approx(1 / 60)


def test_drive_that_begins_in_manual_assists_as_soon_as_its_condition_does(
    rig: MakeRig,
) -> None:
    drive = rig(drive_setup("manual"))
    drive.ask("start")
    assert of(drive.steps(1), "strength_factor")[-1] == 0.0
    drive.ask("set", "condition", "strong-rapid")
    assert of(drive.steps(1), "strength_factor")[-1] == 1.0


def test_tuned_gain_acts_and_outlives_a_restart(rig: MakeRig) -> None:
    setup = drive_setup(initial_offset=0.5)
    usual, tuned = rig(setup), rig(setup)
    tuned.ask("set", "lateral_error_gain", 3.0)
    tuned.ask("restart")
    for drive in (usual, tuned):
        drive.ask("start")
    here, there = usual.steps(10), tuned.steps(10)
    ratio = of(there, "instructed_torque")[0] / of(here, "instructed_torque")[0]
    # tau' = K_y e_y + ... with e_y alone at the start; friction compensation besides.
    assert 1.5 < ratio < 2.1


@pytest.mark.parametrize(
    ("command", "told"),
    [
        (("set", "lateral_error_gain", 99.0), "from 0 to 3"),
        (("set", "mass", 1.0), "cannot be tuned"),
        (("set", "lateral_error_gain", "high"), "'high'; give a number"),
        (("set", "condition", "strongest"), "strongest"),
        (("set", "method", 1.0), "method '1.0' is not known"),
    ],
)
def test_bad_command_is_refused_in_words_and_the_drive_goes_on(
    rig: MakeRig, command: tuple[object, ...], told: str
) -> None:
    drive = rig(drive_setup())
    drive.ask("start")
    drive.ask(*command)
    assert (of(drive.steps(3), "run_state") == RunState.RUNNING).all()
    assert [m for m in drive.heard() if m.kind == "error" and told in m.note]


def test_indicator_asks_for_a_lane_change_to_the_lane_that_is_there(
    rig: MakeRig,
) -> None:
    drive = rig(drive_setup()._replace(intention="indicator"))
    drive.ask("start")
    drive.ask("indicator", 1)  # there is no lane on the left
    drive.steps(30)
    assert (of(drive.steps(30), "mode") == 1.0).all()
    drive.ask("indicator", -1)
    frames = drive.steps(30)
    assert (of(frames, "mode")[2:] == 2.0).all()
    assert of(frames, "target_lane")[-1] == 0.0
    assert of(frames, "indicator")[-1] == -1.0


def test_indicator_asks_for_either_lane_where_there_are_lanes_on_both_sides(
    rig: MakeRig,
) -> None:
    setup = drive_setup(parameters=(("road.num_lanes", 3.0),))
    drive = rig(setup._replace(intention="indicator"))
    drive.ask("start")
    drive.ask("indicator", -1)
    frames = drive.steps(900)
    assert of(frames, "lane")[-1] == of(frames, "target_lane")[-1] == 1.0
    drive.ask("indicator", 1)  # back, although one could overtake on
    frames = drive.steps(30)
    assert of(frames, "target_lane")[-1] == 2.0
    assert of(frames, "crossing_side")[2] == 1.0


def test_indicator_of_one_trial_asks_for_nothing_in_the_next(rig: MakeRig) -> None:
    drive = rig(drive_setup()._replace(intention="indicator"))
    drive.ask("start")
    drive.steps(60)
    drive.ask("indicator", -1)
    drive.steps(1)
    drive.ask("restart")
    drive.ask("start")
    frames = drive.steps(30)
    assert (of(frames, "mode") == 1.0).all()
    assert (of(frames, "indicator") == 0.0).all()


def test_head_counts_only_while_it_was_seen_lately(rig: MakeRig) -> None:
    drive = rig(drive_setup())
    drive.ask("start")
    now = drive.now
    drive.shared.mailbox.put(head_yaw=-0.4, head_valid=1.0, head_time=now + 60.0)
    seen = drive.steps(1)
    drive.shared.mailbox.put(head_time=now - 0.3)
    stale = drive.steps(1)
    assert of(seen, "head_yaw_valid")[0] == 1.0
    assert of(stale, "head_yaw_valid")[0] == 0.0
    assert of(stale, "head_yaw")[0] == of(seen, "head_yaw")[0] == -0.4


def test_verdict_counts_only_while_it_is_fresh(rig: MakeRig) -> None:
    drive = rig(drive_setup()._replace(intention="network"))
    drive.ask("start")
    drive.steps(1)
    written = float(drive.shared.frames.written)
    drive.shared.mailbox.put(crossing_probability=0.9, verdict_row=written)
    frames = drive.steps(10)
    probability = of(frames, "crossing_probability")
    assert (probability[:6] == 0.9).all()
    assert np.isnan(probability[8:]).all()


def test_signal_to_end_ends_the_trial_with_a_marker_once(rig: MakeRig) -> None:
    drive = rig(drive_setup())
    drive.ask("start")
    drive.steps(5)
    drive.driving.is_told_to_end = True  # by its handler, a plain flag
    drive.steps(2)
    assert drive.driving.stopping
    assert drive.kinds() == ["started", "ended"]
