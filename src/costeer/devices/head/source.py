"""What a head tracker says, and what reads it."""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

STALE_AFTER = 0.2
"""Age from which a reading counts as lost [s]: six frames of a webcam."""

FULL_YAW = math.pi / 2.0
"""Head yaw that is written as 1 [rad]."""


class HeadReading(NamedTuple):
    """One answer of a head tracker.

    Attributes:
        time: Monotonic clock of this computer, when the head was seen [s].
        head_yaw: Positive to the left. A source gives it in [rad], as the tracker
            counts; after the calibration it is in [-1, 1], +-1 being +-90 deg [-].
            The last one seen while the head is lost.
        valid: Whether the head is seen.
    """

    time: float
    head_yaw: float
    valid: bool


class HeadDescription(NamedTuple):
    """Which tracker of heads; picklable.

    Attributes:
        kind: `webcam`, `lsl` or `opentrack`.
        address: Number of the camera or a video file; name of the stream; port of
            opentrack, or host and port as `0.0.0.0:4242`.
        channel: Label of the stream's channel with the yaw; empty to look for it.
        unit: `rad` or `deg`; empty to take what the stream says.
        validity: Label of a channel that is above 0.5 while the head is seen; empty if
            there is none.
        mirrored: Whether it counts right as positive, as in a mirrored picture.
    """

    kind: str
    address: str
    channel: str = ""
    unit: str = ""
    validity: str = ""
    mirrored: bool = False


class HeadSource(Protocol):
    """A tracker of heads, whatever its kind."""

    def read(self) -> HeadReading:
        """The newest reading [rad]; waits for a new one, but not longer than 50 ms.

        A webcam waits for its next picture.

        Raises:
            HeadLost: If the tracker itself is gone.
        """
        ...

    def close(self) -> None:
        """Release the device."""
        ...


class HeadSink(Protocol):
    """Takes readings to another process; it must be picklable, as a mailbox is."""

    def put(self, time: float, head_yaw: float, valid: bool) -> None:
        """Keep the newest calibrated reading.

        Args:
            time: Monotonic clock, when the head was seen [s].
            head_yaw: In [-1, 1], positive to the left [-].
            valid: Whether the head was seen.
        """
        ...


class HeadLost(OSError):
    """The camera, stream or port gives nothing any more."""


NOTHING_SEEN = HeadReading(time=-math.inf, head_yaw=0.0, valid=False)
"""What is known before the first reading."""


def held(last: HeadReading, reading: HeadReading) -> HeadReading:
    """The reading, with the last angle in place of one that is not valid."""
    if reading.valid:
        return reading
    return HeadReading(reading.time, last.head_yaw, False)


def aged(reading: HeadReading, now: float) -> HeadReading:
    """The reading as it counts at time `now` [s]: an old one is not valid."""
    fresh = now - reading.time <= STALE_AFTER
    return HeadReading(reading.time, reading.head_yaw, bool(reading.valid and fresh))
