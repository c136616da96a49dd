"""The watchdog sees a heart that stands still, and only then."""

from __future__ import annotations

import os

import numpy as np
import pytest

from costeer.devices.wheels.interface import WheelDescription
from costeer.runtime import watchdog
from costeer.runtime.shared import MAILBOX, Mailbox
from costeer.runtime.watchdog import PATIENCE, Watch, Watched, orphaned, silence


def mailbox(**values: float) -> Mailbox:
    box = Mailbox(np.zeros(len(MAILBOX)))
    box.put(**values)
    return box


@pytest.mark.parametrize(("armed", "expected"), [(1.0, 0.7), (0.0, 0.0)])
def test_heart_is_missed_only_while_it_should_beat(
    armed: float, expected: float
) -> None:
    box = mailbox(armed=armed, heartbeat=100.0)
    assert silence(box, 100.7) == pytest.approx(expected)


def test_patience_leaves_room_to_act_within_100_ms() -> None:
    assert PATIENCE + 2 * watchdog.INTERVAL <= 0.1


def test_watchdog_stays_while_a_torque_may_be_on_although_the_server_is_gone() -> None:
    assert not orphaned(mailbox(armed=1.0, server_time=0.0), 100.0)
    assert orphaned(mailbox(armed=0.0, server_time=0.0), 100.0)
    assert not orphaned(mailbox(armed=0.0, server_time=99.0), 100.0)


class Acts:
    """What the watchdog does instead of touching wheels and processes."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.done: list[object] = []
        monkeypatch.setattr(
            watchdog, "emergency_stop", lambda wheel: self.done.append("let go")
        )
        monkeypatch.setattr(os, "kill", lambda process, _: self.done.append(process))


@pytest.fixture
def acts(monkeypatch: pytest.MonkeyPatch) -> Acts:
    return Acts(monkeypatch)


WHEEL = WheelDescription("hid", "", "", "")


def test_wheel_is_let_go_once_and_the_process_ended_only_if_it_stays_still(
    acts: Acts,
) -> None:
    box = mailbox(armed=1.0, heartbeat=100.0)
    watch = Watch(Watched("", 4711, WHEEL), box)
    assert not watch.look(100.05)
    assert acts.done == []
    assert not watch.look(100.09)
    assert not watch.look(100.5)
    assert acts.done == ["let go"]
    assert box.get("stalled") == 1.0
    assert watch.look(101.1)
    assert acts.done == ["let go", 4711, "let go"]
    assert box.get("armed") == 0.0


def test_process_that_goes_on_is_watched_on(acts: Acts) -> None:
    box = mailbox(armed=1.0, heartbeat=100.0)
    watch = Watch(Watched("", 4711, WHEEL), box)
    watch.look(100.09)
    box.put(heartbeat=100.2)
    watch.look(100.21)
    watch.look(100.3)
    assert acts.done == ["let go", "let go"]


def test_without_a_wheel_a_busy_computer_is_no_fault(acts: Acts) -> None:
    box = mailbox(armed=1.0, heartbeat=100.0)
    watch = Watch(Watched("", 4711, None), box)
    assert not watch.look(102.0)
    assert (acts.done, box.get("stalled")) == ([], 0.0)
    assert watch.look(106.0)
    assert acts.done == [4711]


def test_wheel_that_cannot_be_reached_does_not_keep_the_process_alive(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail(_: object) -> None:
        raise OSError("unplugged")

    ended: list[int] = []
    monkeypatch.setattr(watchdog, "emergency_stop", fail)
    monkeypatch.setattr(os, "kill", lambda process, _: ended.append(process))
    watch = Watch(Watched("", 4711, WHEEL), mailbox(armed=1.0, heartbeat=100.0))
    assert not watch.look(100.5)
    assert watch.look(101.5)
    assert ended == [4711]
