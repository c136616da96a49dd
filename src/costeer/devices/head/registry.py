"""Open the tracker that a description names."""

from __future__ import annotations

from costeer.devices.head.source import HeadDescription, HeadReading, HeadSource

KINDS = ("webcam", "lsl", "opentrack")
"""Kinds of trackers."""


def open_head(description: HeadDescription) -> HeadSource:
    """Open a tracker of heads.

    Raises:
        ValueError: If the kind is unknown, or the description does not fit it.
        HeadLost: If it is not there.
        ModuleNotFoundError: If the extra that it needs is not installed.
    """
    source = _opened(description)
    return Mirrored(source) if description.mirrored else source


def _opened(description: HeadDescription) -> HeadSource:
    """The tracker, counting as it does."""
    if description.kind == "webcam":
        from costeer.devices.head.camera import Webcam

        return Webcam(description.address)
    if description.kind == "lsl":
        from costeer.devices.head.lsl import LslTracker

        return LslTracker(description)
    if description.kind == "opentrack":
        from costeer.devices.head.opentrack import Opentrack

        return Opentrack(description.address)
    raise ValueError(
        f"head tracker {description.kind!r} is unknown; choose from {', '.join(KINDS)}"
    )


class Mirrored:
    """A tracker that counts right as positive, turned round."""

    def __init__(self, source: HeadSource) -> None:
        """Turn round what a source reads."""
        self._source = source

    def read(self) -> HeadReading:
        """The newest reading with left positive [rad].

        Raises:
            HeadLost: If the tracker itself is gone.
        """
        reading = self._source.read()
        return HeadReading(reading.time, -reading.head_yaw, reading.valid)

    def close(self) -> None:
        """Release the device."""
        self._source.close()
