"""The indicator: set by a page or the wheel's paddles, off after the lane change."""

from __future__ import annotations

from collections.abc import Callable

from costeer.devices.wheels.interface import (
    LEFT_INDICATOR,
    RIGHT_INDICATOR,
    WheelReading,
)
from costeer.loop.tick import REQUEST_DURATION
from costeer.plant.parameters import RoadParameters
from costeer.plant.road import lane_exists
from costeer.runtime.markers import Marker

_WORDS = {-1.0: "right", 0.0: "off", 1.0: "left"}

ARRIVED, STRAIGHT = 0.5, 0.015
"""A lane change is over nearer to the lane's centre than this [m] and at less yaw
against the road [rad]. Source: assumed; a lever springs back while the wheel is turned
back, in the last part of the lane change."""


class Indicator:
    """Side of the indicator and what it asks for.

    Args:
        mark: Takes a marker; its time is filled in there.
    """

    def __init__(self, mark: Callable[[Marker], None]) -> None:
        self.side = 0.0
        self._mark = mark
        self._asked_until = -1.0
        self._pulled = 0
        self._from: float | None = None

    def put(self, side: float, now: float) -> None:
        """Set it: -1 right, 0 off, +1 left, at a time of the trial [s]."""
        before, self.side = self.side, side
        self._asked_until = now + REQUEST_DURATION if side else -1.0
        self._from = None
        self._mark(Marker("indicator", before=_WORDS[before], after=_WORDS[side]))

    def look(self, reading: WheelReading | None, now: float) -> None:
        """A paddle that is pulled sets it, or takes it back."""
        pulled = 0 if reading is None else reading.buttons
        for bit, side in ((LEFT_INDICATOR, 1.0), (RIGHT_INDICATOR, -1.0)):
            if pulled & bit and not self._pulled & bit:
                self.put(0.0 if self.side == side else side, now)
        self._pulled = pulled

    def follow(self, lane: float, offset: float, yaw: float, now: float) -> None:
        """Switch off once the car has changed to a lane on this side.

        Args:
            lane: That the car is in, counted from the right [-].
            offset: From that lane's centre [m].
            yaw: Against the road [rad].
            now: Time of the trial [s].
        """
        if not self.side:
            return
        if self._from is None:
            self._from = lane
        changed = (lane - self._from) * self.side > 0.0
        if changed and abs(offset) < ARRIVED and abs(yaw) < STRAIGHT:
            self.put(0.0, now)

    def asks(self, now: float, road: RoadParameters, lane: float) -> bool:
        """Whether it asks, at this time [s], for a lane on its side that is there."""
        there = self.side != 0.0 and lane_exists(road, lane + self.side)
        return there and now <= self._asked_until

    def forget(self) -> None:
        """Off, as a new trial begins."""
        self.side, self._asked_until, self._from = 0.0, -1.0, None
