"""The watchdog: a second process that takes the torque off when the first stands still.

It looks at the heartbeat of the real-time process every few milliseconds. If that
stands still for too long, it ends the process, so that the system takes back the
device, and tells the wheel itself to let go, because not every device does so when its
owner dies.
"""

from __future__ import annotations

import os
import signal
import time
from contextlib import suppress
from typing import NamedTuple

from costeer.runtime.clock import raise_priority
from costeer.runtime.shared import Mailbox, close_shared, open_shared
from costeer.runtime.wheels.interface import WheelDescription
from costeer.runtime.wheels.registry import emergency_stop, prepare_stop

PATIENCE = 0.08
"""A heartbeat older than this is none [s]: acting takes the rest of 100 ms."""

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


def stands_still(mailbox: Mailbox, now: float) -> bool:
    """Whether the real-time process should be alive and is not."""
    armed = mailbox.get("armed") > 0.5
    return armed and now - mailbox.get("heartbeat") > PATIENCE


def run_watchdog(watched: Watched) -> None:
    """Look until there is nothing left to look after: target of a spawned process."""
    stay_until_needed_no_more()
    if watched.wheel is not None:
        prepare_stop(watched.wheel)
    raise_priority(level=70)
    shared = open_shared(watched.memory)
    mailbox = shared.mailbox
    mailbox.put(watching=1.0)
    try:
        while not (
            orphaned(mailbox, time.perf_counter()) or mailbox.get("dismissed") > 0.5
        ):
            if stands_still(mailbox, time.perf_counter()):
                act(watched)
                mailbox.put(stalled=1.0, armed=0.0)
                return
            time.sleep(INTERVAL)
    finally:
        close_shared(shared, unlink=False)


def stay_until_needed_no_more() -> None:
    """Outlive whatever ends the process that is watched: Ctrl-C, a closed terminal."""
    for name in ("SIGINT", "SIGHUP", "SIGQUIT", "SIGBREAK", "SIGTERM"):
        if number := getattr(signal, name, None):
            signal.signal(number, signal.SIG_IGN)


def orphaned(mailbox: Mailbox, now: float) -> bool:
    """Whether the server is gone for long, and no torque can be on."""
    alone = now - mailbox.get("server_time") > ORPHAN_PATIENCE
    return alone and mailbox.get("armed") < 0.5


def act(watched: Watched) -> None:
    """End the process that stands still and take the torque off the wheel."""
    if watched.wheel is not None:
        # First of all, without waiting for the system to take the process down.
        with suppress(OSError, ValueError, ModuleNotFoundError):
            emergency_stop(watched.wheel)
    kill = getattr(signal, "SIGKILL", signal.SIGTERM)
    with suppress(OSError):
        os.kill(watched.process, kill)
    if watched.wheel is not None:
        with suppress(OSError, ValueError, ModuleNotFoundError):
            emergency_stop(watched.wheel)
