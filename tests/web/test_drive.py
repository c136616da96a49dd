"""What pages of a drive are told and may ask; the drive itself stands still here."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from costeer.methods.ibhs import TUNABLES
from costeer.runtime.frame import FRAME_COLUMNS, PLACE, WIDTH
from costeer.runtime.markers import Marker
from costeer.runtime.states import Fault, Loss, RunState
from costeer.web.drive import DriveOnPages, PageOptions
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
)
from tests.runtime.rig import drive_setup

STEPPED = """
lane target_lane consistent intention mode event driver_intention lead_lane
head_yaw_valid torque_fault contact driver_indicator crossing_side run_state fault
input_sequence wheel_time sent_time strength_factor condition indicator
"""


class Sent:
    """A drive that takes down what it is asked for."""

    def __init__(self, session: DriveOnPages) -> None:
        self.commands: list[tuple[object, ...]] = []
        self.inputs: list[tuple[object, ...]] = []
        drive = session.drive
        drive.send = lambda *command: self.commands.append(command)  # type: ignore[method-assign]  # instead of a process
        drive.press = lambda *keys: self.inputs.append(keys)  # type: ignore[method-assign]  # instead of a process


@pytest.fixture
def session() -> Iterator[DriveOnPages]:
    made = DriveOnPages(drive_setup(), None, PageOptions(show_signals=False))
    yield made
    made.stop()


@pytest.fixture
def sent(session: DriveOnPages) -> Sent:
    return Sent(session)


@pytest.mark.parametrize(
    ("message", "command"),
    [
        (Start(), ("start",)),
        (Resume(), ("resume",)),
        (Acknowledge(), ("acknowledge",)),
        (Restart(), ("restart",)),
        (Pause(), ("pause", "experimenter")),
        (Indicator(-1), ("indicator", -1)),
        (Set("preview_time", 2.0), ("set", "preview_time", 2.0)),
        (Set("condition", "weak-rapid"), ("set", "condition", "weak-rapid")),
        (Set("method", "manual"), ("set", "method", "manual")),
        (Stop(), ("pause", "stop")),
    ],
)
def test_message_becomes_a_command(
    session: DriveOnPages, sent: Sent, message: Message, command: tuple[object, ...]
) -> None:
    assert session.apply("experimenter", message) is None
    assert sent.commands == [command]


@pytest.mark.parametrize(
    ("message", "told"),
    [
        (Set("preview_time", 99.0), "from 0.5 to 3 s"),
        (Set("mass", 1.0), "cannot be tuned"),
        (Set("condition", "strongest"), "strongest"),
        (Set("method", "magic"), "magic"),
        (Set("preview_time", "long"), "'long'; give a number"),
    ],
)
def test_what_cannot_be_is_refused_before_it_reaches_the_loop(
    session: DriveOnPages, sent: Sent, message: Message, told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        session.apply("experimenter", message)
    assert sent.commands == []


def test_stop_ends_the_server(session: DriveOnPages, sent: Sent) -> None:
    ended: list[bool] = []
    session.on_stop = lambda: ended.append(True)
    session.apply("experimenter", Stop())
    assert ended == [True]


def test_experimenters_keys_steer_only_while_nobody_else_drives(
    session: DriveOnPages, sent: Sent
) -> None:
    keys = Input(sequence=1, steer=0.5, accelerator=0.0, brake=0.0)
    session.apply("experimenter", keys)
    session.client_joined("driver")
    session.apply("experimenter", keys)
    assert sent.inputs == [(1, 0.5, 0.0, 0.0)]
    session.apply("driver", keys)
    assert len(sent.inputs) == 2


def test_one_page_drives_and_a_second_is_told_why_not(session: DriveOnPages) -> None:
    session.drive.press(1, 0.0, 0.0, 0.0)
    session.client_joined("driver")
    session.client_joined("experimenter")
    with pytest.raises(ValueError, match="another page drives already"):
        session.client_joined("driver")
    session.client_left("driver")
    session.client_joined("driver")


def test_drive_pauses_as_its_drivers_page_closes_whoever_else_looks_on(
    session: DriveOnPages, sent: Sent
) -> None:
    session.client_joined("driver")
    session.client_joined("experimenter")
    session.client_left("experimenter")
    assert sent.commands == []
    session.client_left("driver")
    assert sent.commands == [("leave",)]


def test_page_that_fell_silent_is_replaced(session: DriveOnPages) -> None:
    session.client_joined("driver")
    long_ago = time.perf_counter() - 5.0
    session.drive.shared.mailbox.put(page_time=long_ago)
    session.client_joined("driver")


def test_hello_names_every_number_of_a_frame_and_hides_what_participants_may_not_see(
    session: DriveOnPages,
) -> None:
    driver, experimenter = session.hello("driver"), session.hello("experimenter")
    assert driver["columns"] == list(FRAME_COLUMNS)
    assert driver["stepped"] == STEPPED.split()
    assert driver["tunables"] == []
    assert driver["show_signals"] is False
    assert experimenter["show_signals"] is True
    tunables: Any = experimenter["tunables"]
    assert [each["name"] for each in tunables] == [each.name for each in TUNABLES]
    assert tunables[0]["value"] == 1.0
    assert driver["conditions"] == experimenter["conditions"]


def test_participant_cannot_take_a_fault_for_mended() -> None:
    options = PageOptions(driver_acknowledges=False)
    drive = DriveOnPages(drive_setup(), None, options)
    sent = Sent(drive)
    with pytest.raises(ValueError, match="experimenter looks after this"):
        drive.apply("driver", Acknowledge())
    assert sent.commands == []
    drive.apply("experimenter", Acknowledge())
    assert sent.commands == [("acknowledge",)]
    drive.stop()


def test_hello_tells_states_and_faults_by_their_numbers_in_a_frame(
    session: DriveOnPages,
) -> None:
    hello: Any = session.hello("driver")
    states = {each["code"]: each for each in hello["run_states"]}
    faults = {each["code"]: each for each in hello["faults"]}
    assert [states[code]["name"] for code in range(4)] == [
        *("waiting", "running", "paused", "ended")
    ]
    assert [states[code]["goes_on_by"] for code in range(4)] == [
        *("start", "", "resume", "")
    ]
    assert faults[0]["text"] == ""
    assert [faults[code]["name"] for code in range(1, 7)] == [
        *("wheel_lost", "page_lost", "sensor_stale"),
        *("not_finite", "stalled", "loop_gone"),
    ]
    final = [each["name"] for each in faults.values() if not each["can_resume"]]
    assert final == ["not_finite", "record_stopped", "unwatched", "loop_gone"]


def told_of(session: DriveOnPages) -> list[dict[str, Any]]:
    """Let the session send to a list."""
    told: list[dict[str, Any]] = []
    session.broadcast.send = told.append  # type: ignore[assignment,method-assign]  # instead of sockets
    return told


@pytest.mark.parametrize(
    ("marker", "name", "value"),
    [
        (Marker("parameter", "preview_time", 1.5, 2.25, "s"), "preview_time", 2.25),
        (Marker("parameter", "strength_factor", 1.0, 0.4), "strength_factor", 0.4),
        (Marker("condition", before="a", after="weak-gentle"), "preview_time", 1.5),
        (Marker("method", before="ibhs", after="manual"), "preview_time", 1.5),
    ],
)
def test_change_is_told_to_all_pages_with_the_values_that_hold_now(
    session: DriveOnPages, marker: Marker, name: str, value: float
) -> None:
    told = told_of(session)
    session._mark(marker._replace(time=1.0))
    assert told[0]["type"] == "marker"
    assert (told[0]["time"], told[0]["after"]) == (1.0, marker.after)
    assert " → " in told[0]["text"]
    values = {each["name"]: each["value"] for each in told[1]["tunables"]}
    assert values[name] == value
    tunables: Any = session.hello("experimenter")["tunables"]
    assert {each["name"]: each["value"] for each in tunables} == values


def test_condition_and_method_are_told_as_they_are_now(session: DriveOnPages) -> None:
    session._mark(Marker("condition", before="a", after="weak-gentle"))
    session._mark(Marker("method", before="ibhs", after="manual"))
    hello = session.hello("experimenter")
    assert (hello["condition"], hello["method"]) == ("weak-gentle", "manual")


def test_what_could_not_be_done_is_told_to_who_drives(session: DriveOnPages) -> None:
    told = told_of(session)
    session._mark(Marker("error", note="the wheel is turned"))
    assert told == [{"type": "error", "text": "the wheel is turned"}]


def test_marker_that_changes_nothing_is_told_alone(session: DriveOnPages) -> None:
    told = told_of(session)
    session._mark(Marker("paused", "driver", time=1.0))
    assert [each["type"] for each in told] == ["marker"]


def test_account_says_how_late_frames_and_pages_were(session: DriveOnPages) -> None:
    frame = np.zeros(len(FRAME_COLUMNS))
    for late in (0.0, 0.0, 0.0, 0.004):
        frame[PLACE["lateness"]] = late
        session._tell(frame)
    session.apply("driver", Latency((5.0, 6.0, 7.0)))
    steps, pages = session.account()
    assert steps.startswith("25.00 % of 4 control steps")
    assert "latest 4.0 ms" in steps
    # The page of a keyboard measures from a key to the frame that shows it.
    assert pages.startswith("key through the loop to page: median 6.0 ms")


def test_whoever_else_listens_is_told_the_same(session: DriveOnPages) -> None:
    frames: list[Any] = []
    markers: list[Any] = []
    session.also(frames.append, markers.append)
    session._tell(np.ones(len(FRAME_COLUMNS)))
    session._mark(Marker("started"))
    assert len(frames) == 1
    assert markers == [Marker("started")]


def test_pages_that_close_as_the_drive_ends_are_not_lost(
    session: DriveOnPages, sent: Sent
) -> None:
    session.client_joined("driver")
    session.end_soon()  # Ctrl-C
    session.client_left("driver")
    assert sent.commands == []
    ends: list[str] = []
    session.drive.end_trial = lambda: ends.append("told")  # type: ignore[method-assign]  # instead of a process
    session.say_goodbye()
    assert ends == ["told"]


def test_page_that_comes_later_is_told_where_the_trial_stands_and_what_is_lost(
    session: DriveOnPages,
) -> None:
    first = session.hello("driver")
    assert (first["run_state"], first["fault"], first["losses"]) == (0, 0, [])
    frame = np.zeros(WIDTH)
    frame[PLACE["run_state"]] = RunState.PAUSED
    frame[PLACE["fault"]] = Fault.LOOP_GONE
    session._tell(frame)
    session.drive._helpers.losses.append(Loss.NETWORK)
    then = session.hello("experimenter")
    assert (then["run_state"], then["fault"]) == (RunState.PAUSED, Fault.LOOP_GONE)
    assert then["losses"] == [Loss.NETWORK.text]
