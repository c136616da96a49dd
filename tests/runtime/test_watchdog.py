"""The watchdog sees a heart that stands still, and only then."""

from __future__ import annotations

import inspect
import os
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from costeer.devices.wheels.interface import WheelDescription
from costeer.runtime import watchdog
from costeer.runtime.clock import raise_priority
from costeer.runtime.shared import (
    MAILBOX,
    Mailbox,
    Shared,
    close_shared,
    make_shared,
    open_shared,
)
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


class Night:
    """A watchdog that runs in this process; what it does before its first look."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, shared: Shared) -> None:
        self.shared, self.naps = shared, 0
        self.begun: list[str] = []
        self.levels: list[int] = []
        for name in ("stay_until_needed_no_more", "prepare_stop", "raise_priority"):
            monkeypatch.setattr(watchdog, name, self._noting(name))
        monkeypatch.setattr(watchdog.time, "sleep", self._nap)
        self.wakes: Callable[[Mailbox], object] = lambda box: box.put(dismissed=1.0)

    def _noting(self, name: str) -> Callable[..., None]:
        def note(*_: object, level: int = 0) -> None:
            self.begun.append(name)
            if level:
                self.levels.append(level)

        return note

    def _nap(self, duration: float) -> None:
        assert duration == watchdog.INTERVAL
        self.naps += 1
        assert self.naps < 5, "it goes on for ever"
        if self.naps == 3:
            self.wakes(self.shared.mailbox)

    def pass_by(self, wheel: WheelDescription | None) -> None:
        """Watch until there is nothing left to look after."""
        name = self.shared.memory.name
        watchdog.run_watchdog(Watched(name, 4711, wheel))
        close_shared(open_shared(name), unlink=False)  # it is still there for others


@pytest.fixture
def night(monkeypatch: pytest.MonkeyPatch) -> Iterator[Night]:
    shared = make_shared()
    shared.mailbox.put(server_time=time.perf_counter() + 1000.0)
    with monkeypatch.context() as patched:
        yield Night(patched, shared)
    close_shared(shared, unlink=True)


def test_watchdog_looks_until_it_is_dismissed_and_leaves_the_memory_to_others(
    night: Night,
) -> None:
    before = time.perf_counter()
    night.pass_by(WHEEL)
    assert night.naps == 3
    assert night.begun == [
        "stay_until_needed_no_more",
        "prepare_stop",
        "raise_priority",
    ]
    assert night.shared.mailbox.get("watching") == 1.0
    assert night.shared.mailbox.get("watched_at") > before


def test_watchdog_stands_above_the_loop_that_it_watches(night: Night) -> None:
    night.pass_by(None)
    loop = inspect.signature(raise_priority).parameters["level"].default
    assert loop < night.levels[0] < 99 - 10  # and leaves room for the system's own
    assert "prepare_stop" not in night.begun


def test_watchdog_that_nobody_needs_any_more_ends_by_itself(night: Night) -> None:
    night.wakes = lambda box: box.put(server_time=0.0, armed=0.0)
    night.pass_by(WHEEL)
    assert night.naps == 3


def test_watchdog_ends_with_the_process_that_it_had_to_end(
    night: Night, acts: Acts
) -> None:
    long_ago = time.perf_counter() - 1000.0
    night.wakes = lambda box: box.put(armed=1.0, heartbeat=long_ago)
    night.pass_by(WHEEL)
    assert night.naps == 3
    assert acts.done == [4711, "let go"]
    assert night.shared.mailbox.get("stalled") == 1.0
