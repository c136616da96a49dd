"""The watchdog sees a heart that stands still, and only then."""

from __future__ import annotations

import os

import numpy as np
import pytest

from costeer.runtime import watchdog
from costeer.runtime.shared import MAILBOX, Mailbox
from costeer.runtime.watchdog import PATIENCE, Watched, orphaned, stands_still
from costeer.runtime.wheels.interface import WheelDescription


def mailbox(**values: float) -> Mailbox:
    box = Mailbox(np.zeros(len(MAILBOX)))
    box.put(**values)
    return box


@pytest.mark.parametrize(
    ("armed", "age", "still"),
    [(1.0, 0.0, False), (1.0, PATIENCE * 1.1, True), (0.0, 10.0, False)],
)
def test_heart_that_should_beat_and_does_not(
    armed: float, age: float, still: bool
) -> None:
    box = mailbox(armed=armed, heartbeat=100.0)
    assert stands_still(box, 100.0 + age) is still


def test_patience_leaves_room_to_act_within_100_ms() -> None:
    assert PATIENCE + 2 * watchdog.INTERVAL <= 0.1


def test_watchdog_stays_while_a_torque_may_be_on_although_the_server_is_gone() -> None:
    assert not orphaned(mailbox(armed=1.0, server_time=0.0), 100.0)
    assert orphaned(mailbox(armed=0.0, server_time=0.0), 100.0)
    assert not orphaned(mailbox(armed=0.0, server_time=99.0), 100.0)


def test_wheel_is_let_go_before_and_after_the_process_is_ended(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    done: list[object] = []
    monkeypatch.setattr(watchdog, "emergency_stop", lambda wheel: done.append("stop"))
    monkeypatch.setattr(os, "kill", lambda process, _: done.append(process))
    wheel = WheelDescription("hid", "", "", "")
    watchdog.act(Watched("", 4711, wheel))
    watchdog.act(Watched("", 4712, None))
    assert done == ["stop", 4711, "stop", 4712]


def test_wheel_that_cannot_be_reached_does_not_keep_the_process_alive(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail(_: object) -> None:
        raise OSError("unplugged")

    ended: list[int] = []
    monkeypatch.setattr(watchdog, "emergency_stop", fail)
    monkeypatch.setattr(os, "kill", lambda process, _: ended.append(process))
    watchdog.act(Watched("", 4711, WheelDescription("hid", "", "", "")))
    assert ended == [4711]
