"""What the car touches: felt, marked, and the end of a trial or a new one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from costeer.devices.wheels.simulated import SpringHands
from costeer.runtime.guard import GuardParameters
from costeer.runtime.indicator import Indicator
from costeer.runtime.markers import Marker, told
from costeer.runtime.setup import DriveSetup, drive_columns, drive_parameters
from costeer.runtime.states import RunState
from costeer.scenarios.definition import Actor, Road, Scenario
from tests.runtime.rig import Rig, drive_setup, of, wheel_setup

MakeRig = Callable[[DriveSetup], Rig]

BLOCKED = Scenario(
    "blocked",
    road=Road(length=900.0),
    actors=(
        Actor("box", kind="obstacle", lane=1, at=40.0),
        Actor("ahead", lane=0, at=80.0, speed="10 m/s"),
    ),
)


def on(scenario: Scenario, condition: str = "manual") -> DriveSetup:
    return drive_setup(condition, scenario=scenario, speed=20.0)


def test_other_cars_are_in_the_frames_behind_the_methods_columns(rig: MakeRig) -> None:
    setup = on(BLOCKED)
    drive = rig(setup)
    drive.ask("start")
    last = drive.steps(31)[-1]
    names = [each.name for each in drive_columns(setup)]
    assert names[-6:] == [
        *("car_01_position", "car_01_lateral", "car_01_velocity"),
        *("car_02_position", "car_02_lateral", "car_02_velocity"),
    ]
    first = len(last) - 16 - 3 * 40 + len(names) - 6
    box, ahead = last[first : first + 3], last[first + 3 : first + 6]
    np.testing.assert_allclose(box, [40.0, 0.0, 0.0], atol=1e-9)
    # Half a second at 10 m/s, in the lane to the right of the reference line.
    np.testing.assert_allclose(ahead, [85.0, -3.5, 10.0], atol=0.2)


def test_hitting_an_obstacle_is_marked_and_ends_the_trial(rig: MakeRig) -> None:
    drive = rig(on(BLOCKED))
    drive.ask("start")
    frames = drive.steps(150)
    ended = frames[of(frames, "run_state") == RunState.ENDED]
    # Middle to middle: half of 1 m and half of a car of 4 to 5 m before the box.
    assert 36.5 < of(ended, "longitudinal_position")[0] < 38.0
    assert of(ended, "contact")[0] == 3.0
    markers = drive.heard()
    assert [(each.kind, each.name) for each in markers] == [
        *(("started", ""), ("contact", "car"), ("ended", "collision")),
    ]
    assert told(markers[1]) == "contact: The car has hit another car or an obstacle."
    later = drive.steps(400)
    assert (of(later, "run_state") == RunState.ENDED).all()


def test_scenario_that_restarts_waits_at_the_start_with_a_new_record(
    rig: MakeRig,
) -> None:
    drive = rig(on(BLOCKED._replace(after_collision="restart")))
    drive.ask("start")
    frames = drive.steps(400)
    states = of(frames, "run_state")
    ended = np.flatnonzero(states == RunState.ENDED)
    assert 2.9 * 60 < len(ended) < 3.1 * 60  # its end is on show for 3 s
    assert states[-1] == RunState.WAITING
    assert of(frames, "longitudinal_position")[-1] == 0.0
    assert drive.kinds() == ["started", "contact", "ended", "restarted"]
    drive.ask("start")
    again = drive.steps(150)
    assert of(again, "contact").max() == 3.0
    assert drive.kinds() == ["started", "contact", "ended"]


def test_leaving_the_road_meets_the_strip_and_then_the_barrier(rig: MakeRig) -> None:
    drive = rig(on(BLOCKED._replace(actors=())))
    drive.ask("start")
    drive.shared.mailbox.put(steer=0.3, steering=1.0)
    frames = drive.steps(300)
    names = [each.name for each in drive.heard() if each.kind == "contact"]
    assert names == ["rumble_strip", "barrier"]
    last = frames[of(frames, "run_state") == RunState.RUNNING][-1:]
    # Half a lane and the shoulder, less half a car of 1.7 to 1.9 m.
    assert of(last, "lateral_position")[0] == pytest.approx(1.75 + 2.5 - 0.9, abs=0.1)


def test_rumble_strip_is_felt_at_a_real_wheel_and_is_no_fault(rig: MakeRig) -> None:
    setup = wheel_setup("manual", hands=SpringHands(stiffness=6.0, damping=0.6))
    trial = setup.trial._replace(initial_offset=1.2, speed=30.0)
    drive = rig(setup._replace(trial=trial))
    drive.ask("start")
    frames = drive.steps(100)
    trace = drive.shared.trace.since(0)[1]
    on_strip = of(frames, "contact") == 1.0
    assert on_strip[5:].all()
    assert (of(frames, "fault") == 0.0).all()
    assert (of(frames, "torque_fault") == 0.0).all()
    torque = trace[-480:, 4]
    assert np.abs(torque).max() < GuardParameters().torque_limit
    # 30 m/s over grooves 0.6 m apart: 50 Hz, seen in half a second.
    power = np.abs(np.fft.rfft(torque - torque.mean()))
    assert np.argmax(power) == pytest.approx(25, abs=1)
    assert np.ptp(torque) > 0.8  # of 1.2 N·m


@pytest.mark.parametrize("length", [300.0, 8000.0])
def test_drive_ends_at_the_length_of_its_trial(length: float) -> None:
    # 8000 m is the usual length, and yet it is a number as any other.
    asked = on(BLOCKED)._replace(trial=on(BLOCKED).trial._replace(length=length))
    assert drive_parameters(asked).road.length == length


def test_indicator_goes_out_after_the_lane_change_and_not_before() -> None:
    heard: list[Marker] = []
    indicator = Indicator(heard.append)
    indicator.put(-1.0, 1.0)
    indicator.follow(1.0, 0.0, 0.0, 1.1)
    indicator.follow(1.0, -1.7, -0.05, 3.0)  # on the line, turned to the right
    indicator.follow(0.0, 1.2, -0.03, 4.0)  # across
    indicator.follow(0.0, 0.3, -0.02, 5.0)  # near the middle, still turned
    assert indicator.side == -1.0
    indicator.follow(0.0, 0.1, -0.005, 5.5)
    assert indicator.side == 0.0
    assert [(each.before, each.after) for each in heard] == [
        *(("off", "right"), ("right", "off")),
    ]
    indicator.put(1.0, 6.0)
    indicator.follow(0.0, 0.0, 0.0, 6.1)
    assert indicator.side == 1.0
