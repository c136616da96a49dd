"""Head yaw from a professional tracker that sends a stream of the lab streaming layer.

Any outlet will do: the channel is found by its label, its unit by what the stream says.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from costeer.devices.head.source import (
    NOTHING_SEEN,
    HeadDescription,
    HeadLost,
    HeadReading,
    aged,
)

FIND_WITHIN = 5.0
"""How long a stream is looked for [s]."""

WAIT = 0.05
"""Longest wait for a sample [s]."""

VALID_ABOVE = 0.5
"""Value of the validity channel from which the head is seen [-]."""

YAW_LABELS = frozenset(
    {"headyaw", "yaw", "headheading", "heading", "headrotationyaw", "headposeyaw"}
)
"""Labels by which the channel is found: small letters, without other signs."""

_UNITS = {
    "rad": 1.0,
    "radian": 1.0,
    "radians": 1.0,
    "deg": math.pi / 180.0,
    "degree": math.pi / 180.0,
    "degrees": math.pi / 180.0,
    "°": math.pi / 180.0,
}
"""Size of each unit [rad]."""


class Channel(NamedTuple):
    """What a stream says of one of its channels.

    Attributes:
        label: Its name.
        unit: As the stream writes it.
    """

    label: str
    unit: str


class Layout(NamedTuple):
    """How a sample of the stream is read.

    Attributes:
        yaw: Index of the channel.
        unit: Its unit's size [rad].
        validity: Index of the validity channel, or None.
    """

    yaw: int
    unit: float
    validity: int | None


def layout(description: HeadDescription, channels: Sequence[Channel]) -> Layout:
    """Choose the channels of a stream.

    Raises:
        ValueError: If a channel is not there, is not plain, or has no known unit.
    """
    labels = [channel.label for channel in channels]
    yaw = _index(labels, description.channel) if description.channel else _find(labels)
    word = (description.unit or channels[yaw].unit).strip().lower()
    if word not in _UNITS:
        raise ValueError(
            f"channel {labels[yaw]!r} has the unit {word!r}; say what it is with "
            "--unit rad or --unit deg"
        )
    validity = description.validity
    return Layout(yaw, _UNITS[word], _index(labels, validity) if validity else None)


def _index(labels: list[str], label: str) -> int:
    """Place of a channel."""
    if labels.count(label) != 1:
        raise ValueError(
            f"the stream has {labels.count(label)} channels {label!r}; it has "
            f"{_shown(labels)}"
        )
    return labels.index(label)


def _find(labels: list[str]) -> int:
    """Place of the one channel whose label says that it is the yaw."""
    plain = ["".join(filter(str.isalnum, label)).lower() for label in labels]
    found = [index for index, label in enumerate(plain) if label in YAW_LABELS]
    if len(found) != 1:
        raise ValueError(
            f"{len(found)} of the stream's channels look like the head's yaw; name it "
            f"with --channel, one of {_shown(labels)}"
        )
    return found[0]


def _shown(labels: list[str]) -> str:
    """Labels for a message; a stream may have hundreds, or none."""
    if not any(labels):
        return "no labels"
    return ", ".join(labels[:20]) + (", ..." if len(labels) > 20 else "")


def sample_yaw(chosen: Layout, sample: Sequence[float]) -> float | None:
    """Yaw in a sample [rad]; None if it says that the head is not seen."""
    yaw = sample[chosen.yaw] * chosen.unit
    if not math.isfinite(yaw) or abs(yaw) > math.pi:
        return None
    seen = chosen.validity is None or sample[chosen.validity] > VALID_ABOVE
    return yaw if seen else None


MOST_APART = 60.0
"""A sample from farther away in time was stamped by no clock of LSL [s]."""

FIND_OTHERS = 1.0
"""How long is looked for a second stream of the name [s]."""


class LslTracker:
    """Reads the newest sample of a stream; its clock is brought to this computer's."""

    def __init__(
        self,
        description: HeadDescription,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """Find the stream.

        Args:
            description: Name of the stream, and channels where they are not plain.
            clock: Monotonic [s].

        Raises:
            HeadLost: If there is no such stream.
            ValueError: If its channels do not say what is what.
            ModuleNotFoundError: If the extra `lsl` is not installed.
        """
        import pylsl

        self._clock = clock
        self._last = NOTHING_SEEN
        self._inlet = _inlet(description.address)
        try:
            channels = _channels(self._inlet.info(FIND_WITHIN))
            self._layout = layout(description, channels)
            # It asks the sender once and answers from then on at once.
            self._inlet.time_correction(FIND_WITHIN)
        except pylsl.util.TimeoutError as error:
            self.close()
            raise _absent(description.address) from error
        except ValueError:
            self.close()
            raise
        self._epoch = clock() - pylsl.local_clock()

    def read(self) -> HeadReading:
        """Yaw of the newest sample, as the tracker counts it [rad].

        Raises:
            HeadLost: If the stream is gone for good.
        """
        import pylsl

        try:
            sample, stamp = self._inlet.pull_sample(timeout=WAIT)
            later, stamps = self._inlet.pull_chunk(timeout=0.0)
        except pylsl.util.LostError as error:
            raise HeadLost("the stream of the head tracker has ended") from error
        if stamps:
            sample, stamp = later[-1], stamps[-1]
        if sample is not None and stamp is not None:
            self._take(sample, float(stamp))
        return aged(self._last, self._clock())

    def _take(self, sample: Sequence[float], stamp: float) -> None:
        """Keep a sample that was stamped by the sender's clock [s].

        Raises:
            HeadLost: If that is no clock of LSL.
        """
        seen = self._epoch + stamp + self._inlet.time_correction()
        apart = seen - self._clock()
        if abs(apart) > MOST_APART:
            raise HeadLost(
                f"the stream stamps its samples with another clock, {apart:.3g} s from "
                "this one; let its outlet stamp them (push_sample without a time), or "
                "with pylsl.local_clock()"
            )
        yaw = sample_yaw(self._layout, sample)
        self._last = HeadReading(
            time=min(seen, self._clock()),
            head_yaw=self._last.head_yaw if yaw is None else yaw,
            valid=yaw is not None,
        )

    def close(self) -> None:
        """Leave the stream."""
        self._inlet.close_stream()


def _inlet(name: str) -> Any:  # Any: pylsl ships no types
    """Open the one stream of a name."""
    import pylsl

    found = pylsl.resolve_byprop("name", name, 1, FIND_WITHIN)
    if not found:
        raise _absent(name)
    every = pylsl.resolve_byprop("name", name, 2, FIND_OTHERS)
    if len(every) > 1:
        hosts = ", ".join(sorted(each.hostname() for each in every))
        raise ValueError(
            f"{len(every)} LSL streams are called {name!r}, on {hosts}; give each a "
            "name of its own, or stop those that are not meant"
        )
    if found[0].channel_format() == pylsl.cf_string:
        raise ValueError(
            f"stream {name!r} sends text, not angles; choose another --lsl"
        )
    return pylsl.StreamInlet(found[0], max_buflen=1, recover=True)


def _absent(name: str) -> HeadLost:
    """The error of a stream that is not there."""
    return HeadLost(
        f"no LSL stream {name!r} within {FIND_WITHIN:g} s; start the tracker's outlet "
        "in the same network, or choose another --lsl"
    )


def _channels(info: Any) -> list[Channel]:  # Any: pylsl ships no types
    """Labels and units that a stream tells; empty where it tells none."""
    told = []
    node = info.desc().child("channels").child("channel")
    for _ in range(info.channel_count()):
        told.append(Channel(node.child_value("label"), node.child_value("unit")))
        node = node.next_sibling("channel")
    return told
