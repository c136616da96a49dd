"""The watchdog: a second process that takes the torque off when the first stands still.

It looks at the heartbeat of the real-time process every few milliseconds. If that
stands still, it tells the wheel itself to let go, because not every device does so
when its owner dies; a process that goes on afterwards finds its trial paused. One that
stands still for longer is ended, so that the system takes back the device.

The real-time process looks at the watchdog in turn, and the server looks on where the
watchdog stands still.
"""

from __future__ import annotations

import os
import signal
import time
from contextlib import suppress
from typing import NamedTuple

from costeer.devices.wheels.interface import WheelDescription
from costeer.devices.wheels.registry import emergency_stop, prepare_stop
from costeer.runtime.clock import raise_priority
from costeer.runtime.patience import WATCHDOG_PATIENCE
from costeer.runtime.shared import Mailbox, close_shared, open_shared

PATIENCE = 0.08
"""A heartbeat older than this is none [s]: acting takes the rest of 100 ms."""

END_PATIENCE = 1.0
"""A process that stands still for so long with a wheel is ended [s]."""

END_PATIENCE_WITHOUT = 5.0
"""The same without a wheel: nobody is pushed, and a busy computer is no fault [s]."""

INTERVAL = 0.005
"""Between two looks [s]."""

ORPHAN_PATIENCE = 5.0
"""The watchdog ends when neither server nor heartbeat has moved for so long [s]."""


class Watched(NamedTuple):
    """What the watchdog looks after.

    Attributes:
        memory: Name of the shared memory.
        process: Number of the real-time process.
        wheel: That may be under torque; None for virtual hands.
    """

    memory: str
    process: int
    wheel: WheelDescription | None


def silence(mailbox: Mailbox, now: float) -> float:
    """How long the process has stood still although it should be alive [s]."""
    if mailbox.get("armed") < 0.5:
        return 0.0
    return now - mailbox.get("heartbeat")


def stands_still(mailbox: Mailbox, now: float) -> bool:
    """Whether a watchdog that had begun to look does so no more."""
    if mailbox.get("watching") < 0.5:
        return False
    return now - mailbox.get("watched_at") > WATCHDOG_PATIENCE


def run_watchdog(watched: Watched) -> None:
    """Look until there is nothing left to look after: target of a spawned process."""
    stay_until_needed_no_more()
    if watched.wheel is not None:
        prepare_stop(watched.wheel)
    raise_priority(level=70)
    shared = open_shared(watched.memory)
    mailbox = shared.mailbox
    mailbox.put(watched_at=time.perf_counter(), watching=1.0)
    watch = Watch(watched, mailbox)
    try:
        while not (
            orphaned(mailbox, time.perf_counter()) or mailbox.get("dismissed") > 0.5
        ):
            mailbox.put(watched_at=time.perf_counter())
            if watch.look(time.perf_counter()):
                return
            time.sleep(INTERVAL)
    finally:
        close_shared(shared, unlink=False)


class Watch:
    """What one look after the other sees and does.

    Args:
        watched: What is looked after.
        mailbox: With the heartbeat.
    """

    def __init__(self, watched: Watched, mailbox: Mailbox) -> None:
        self._watched = watched
        self._mailbox = mailbox
        self._has_acted = False
        there = watched.wheel is not None
        self._end_patience = END_PATIENCE if there else END_PATIENCE_WITHOUT

    def look(self, now: float) -> bool:
        """Act on what is seen at this time [s]; return whether all is over."""
        still = silence(self._mailbox, now)
        if still > self._end_patience:
            end_process(self._watched)
            self._mailbox.put(stalled=1.0, armed=0.0)
            return True
        if still <= PATIENCE:
            self._has_acted = False
        elif not self._has_acted and self._watched.wheel is not None:
            self._mailbox.put(stalled=1.0)  # first, for a process that wakes up now
            let_go(self._watched.wheel)
            self._has_acted = True
        return False


def stay_until_needed_no_more() -> None:
    """Outlive whatever ends or halts the others: Ctrl-C and Ctrl-Z, a closed window."""
    for name in ("SIGINT", "SIGHUP", "SIGQUIT", "SIGBREAK", "SIGTERM", "SIGTSTP"):
        ignore(name)


def ignore(name: str) -> None:
    """Let a signal pass, where the system has it."""
    if number := getattr(signal, name, None):
        signal.signal(number, signal.SIG_IGN)


def orphaned(mailbox: Mailbox, now: float) -> bool:
    """Whether the server is gone for long, and no torque can be on."""
    alone = now - mailbox.get("server_time") > ORPHAN_PATIENCE
    return alone and mailbox.get("armed") < 0.5


def let_go(wheel: WheelDescription) -> None:
    """Take the torque off a wheel, as far as it can be reached."""
    with suppress(OSError, ValueError, ModuleNotFoundError):
        emergency_stop(wheel)


def end_process(watched: Watched) -> None:
    """End the process that stands still and take the torque off the wheel."""
    kill = getattr(signal, "SIGKILL", signal.SIGTERM)
    with suppress(OSError):
        os.kill(watched.process, kill)
    if watched.wheel is not None:
        let_go(watched.wheel)
