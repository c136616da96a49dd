"""The wheel of a drive as it comes and goes: opened, lost, let go, found again."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.interface import Wheel, WheelDescription
from costeer.runtime.cabin import Cabin
from costeer.runtime.setup import DriveSetup
from costeer.runtime.shared import Mailbox

Opener = Callable[[WheelDescription, WheelCalibration], Wheel]
"""Opens a wheel."""


class Bay:
    """Opens and closes the wheel; what takes long is not watched meanwhile.

    Args:
        setup: Of the drive.
        cabin: That the wheel is brought to.
        mailbox: With the heartbeat.
        clock: Time that all processes share [s].
        opener: Opens the wheel.
    """

    def __init__(
        self,
        setup: DriveSetup,
        cabin: Cabin,
        mailbox: Mailbox,
        clock: Callable[[], float],
        opener: Opener,
    ) -> None:
        self._setup = setup
        self._cabin = cabin
        self._mailbox = mailbox
        self._clock = clock
        self._opener = opener

    @property
    def is_empty(self) -> bool:
        """Whether the drive has a wheel that is not there."""
        return self._setup.wheel is not None and self._cabin.wheel is None

    def open(self) -> None:
        """Open the wheel of the setup, if there is one.

        Raises:
            OSError: If it is not there.
        """
        self._cabin.change_wheel(self._opened())

    def _opened(self) -> Wheel | None:
        wheel, calibration = self._setup.wheel, self._setup.calibration
        if wheel is None or calibration is None:
            return None
        return self._opener(wheel, calibration)

    def close(self) -> None:
        """Take the torque off the wheel and let it go; watched until it is done."""
        self._mailbox.put(heartbeat=self._clock())
        self._let_go()
        self._mailbox.put(armed=0.0)

    def _let_go(self) -> None:
        """Close the wheel, also one that does not answer."""
        if self._cabin.wheel is not None:
            with suppress(OSError):
                self._cabin.wheel.close()

    def lose(self) -> None:
        """Let go of a wheel that is gone; that may take longer than is watched."""
        self._mailbox.put(armed=0.0)
        self._let_go()
        self._cabin.change_wheel(None)
        self._mailbox.put(heartbeat=self._clock(), armed=1.0)

    def find(self) -> None:
        """Open the wheel again; it may take longer than the watchdog waits.

        Raises:
            OSError: If it is not there.
        """
        self._mailbox.put(armed=0.0)
        try:
            self.open()
            self._cabin.advance(False, True)
        finally:
            self._mailbox.put(heartbeat=self._clock(), armed=1.0)
