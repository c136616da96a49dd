"""Thread that sends the newest force to a raw HID wheel, and takes a stale one off.

A transfer takes up to 2 ms, in which the loop of 960 Hz shall not stand. A raw wheel
keeps its last force for ever; here it gets zero when nothing came for `EFFECT_LIFE`.
"""

from __future__ import annotations

import threading
import time
from typing import Protocol

from costeer.devices.wheels import logitech
from costeer.devices.wheels.interface import EFFECT_LIFE

LATEST = 0.05
"""A level that was asked for longer ago is not sent any more [s]: who asked for it may
have been halted since, and the wheel told to let go."""


class HidTransport(Protocol):
    """Carries reports to a device and back."""

    def write(self, command: bytes) -> None:
        """Send a command; raise OSError if the device is gone."""
        ...

    def read(self) -> bytes:
        """Return the next input report, empty if none waits; OSError if gone."""
        ...

    def close(self) -> None:
        """Let the device go."""
        ...


class Sender:
    """Thread that sends the newest level, and zero when none comes.

    Attributes:
        error: Why a command could not be sent; None while all is well.
    """

    def __init__(self, transport: HidTransport) -> None:
        """Start the thread.

        Args:
            transport: To the device.
        """
        self.error: OSError | None = None
        self._transport = transport
        self._changed = threading.Condition()
        self._level: int | None = None
        self._put_at = 0.0
        self._ended = False
        self._thread = threading.Thread(target=self._run, name="wheel", daemon=True)
        self._thread.start()

    def put(self, level: int) -> None:
        """Have a level sent; one that was not sent yet is forgotten."""
        with self._changed:
            self._level, self._put_at = level, time.perf_counter()
            self._changed.notify()

    def end(self) -> None:
        """Stop sending."""
        with self._changed:
            self._ended = True
            self._changed.notify()
        self._thread.join(timeout=1.0)

    def _run(self) -> None:
        pushing = False
        while True:
            level = self._next(EFFECT_LIFE if pushing else None)
            if level is None:
                return
            try:
                self._transport.write(logitech.constant(0, level))
            except OSError as error:
                self.error = error
                return
            pushing = level != 0

    def _next(self, patience: float | None) -> int | None:
        """Wait for a level: zero if none comes in time, None at the end."""
        with self._changed:
            self._changed.wait_for(self._is_due, patience)
            if self._ended:
                return None
            late = time.perf_counter() - self._put_at > LATEST
            level = 0 if self._level is None or late else self._level
            self._level = None
            return level

    def _is_due(self) -> bool:
        return self._ended or self._level is not None
