"""Somebody who sits at a simulated wheel and does what the texts ask for."""

from __future__ import annotations

import math

from costeer.devices.wheels.references import BACK, LEFT, RIGHT
from costeer.devices.wheels.simulated import SimulatedWheelParameters
from costeer.devices.wheels.weighing import HANG, TAKE_OFF, WAIT

TAKES = 3.0
"""After which the weight is off, once it is asked for [s]."""


class User:
    """Does what the texts ask for, as a wheel's hands."""

    def __init__(self, device: SimulatedWheelParameters, pull: float = 0.0) -> None:
        end = device.full_range / 2.0
        self._wanted = {LEFT: end, RIGHT: -end, BACK: 0.0, HANG: 0.0}
        self._pull = pull
        self._since = math.nan
        self.heard = [""]

    def listen(self, text: str) -> None:
        """Hear what is asked."""
        self.heard.append(text)
        self._since = math.nan

    def __call__(self, time: float, angle: float, rate: float) -> float:
        """Torque of the hands and of a weight, if it hangs [N·m]."""
        if math.isnan(self._since):
            self._since = time
        text = self.heard[-1]
        torque = self._weight(text, time - self._since)
        if text in self._wanted:
            grip = 6.0 * (self._wanted[text] - angle) - 1.5 * rate
            torque += self._hold(text, time - self._since) * grip
        return torque

    def _weight(self, text: str, elapsed: float) -> float:
        """Torque of the weight [N·m]."""
        hangs = text in (HANG, WAIT) or (text == TAKE_OFF and elapsed < TAKES)
        return self._pull if hangs else 0.0

    def _hold(self, text: str, elapsed: float) -> float:
        """How much of the grip is left: a weight is let go between 1 and 4 s [-]."""
        return min(max((4.0 - elapsed) / 3.0, 0.0), 1.0) if text == HANG else 1.0
