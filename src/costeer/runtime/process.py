"""The real-time process: fixed steps by the wall clock, and nothing else.

It is spawned and owns the wheel. Steps never change; a late one is followed by shorter
waits, so that simulated time keeps to the wall clock.
"""

from __future__ import annotations

import gc
import signal
import time
from contextlib import suppress

from costeer.runtime.clock import (
    SPIN,
    SPIN_PRIVILEGED,
    Pacer,
    Priority,
    own_core,
    raise_priority,
)
from costeer.runtime.driving import Driving
from costeer.runtime.links import Links
from costeer.runtime.setup import PLANT_DT, PLANT_STEPS, DriveSetup
from costeer.runtime.shared import Shared, close_shared, open_shared
from costeer.runtime.watchdog import ignore


def run_realtime(setup: DriveSetup, links: Links) -> None:
    """Drive until told to stop or left alone: the target of the spawned process."""
    ignore("SIGINT")  # the server says when to stop
    ignore("SIGTSTP")  # Ctrl-Z halts the server; that is noticed here
    shared = open_shared(links.memory)
    drive: Driving | None = None
    try:
        drive = Driving(setup, links, shared)
        end_at_signals(drive)
        drive.warm_up()
        priority, core = privileged() if setup.haste == 1.0 else (UNHURRIED, None)
        gc.collect()
        gc.freeze()
        gc.disable()
        drive.open_wheel()
        links.commands.send(("ready", told(priority, core)))
        pace(drive, shared, SPIN_PRIVILEGED if priority.realtime else SPIN, setup.haste)
    except (ValueError, OSError, ModuleNotFoundError) as error:
        with suppress(OSError):
            links.commands.send(("failed", str(error)))
    finally:
        if drive is not None:
            drive.close()
        links.commands.close()
        close_shared(shared, unlink=False)


UNHURRIED = Priority(False, "a rehearsal in haste asks for no priority")
"""What a process says that would take a core for itself."""


def end_at_signals(drive: Driving) -> None:
    """Fade out and end when the system or a closed terminal says so."""

    def end(*_: object) -> None:
        drive.is_told_to_end = True

    for name in ("SIGTERM", "SIGHUP", "SIGQUIT", "SIGBREAK"):
        if number := getattr(signal, name, None):
            signal.signal(number, end)


def privileged() -> tuple[Priority, int | None]:
    """Ask for priority, and with it for a core of one's own.

    Without priority a core of one's own would only be shared with fewer chances.
    """
    priority = raise_priority()
    return priority, own_core() if priority.realtime else None


def told(priority: Priority, core: int | None) -> str:
    """Priority and core in words."""
    return priority.detail + ("" if core is None else f", core {core}")


def pace(drive: Driving, shared: Shared, spin: float, haste: float = 1.0) -> None:
    """Call the steps at their times until the drive stops.

    Args:
        drive: That is stepped.
        shared: Memory of the drive.
        spin: How long before a step sleeping ends [s].
        haste: Seconds of the trial in a second of the clock.
    """
    pacer = Pacer(PLANT_DT, spin)
    shared.mailbox.put(heartbeat=time.perf_counter(), armed=1.0)
    lateness = 0.0
    while not drive.stopping:
        latest = 0.0
        pacer.hurry(PLANT_DT / haste if drive.is_running else PLANT_DT)
        for step in range(PLANT_STEPS):
            late = pacer.wait()
            latest = max(latest, late)
            if step == 0:
                drive.control_step(lateness)
            drive.plant_step(late)
        lateness = latest
