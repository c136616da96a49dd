"""A head tracker that streams what it is told, as a professional one does."""

from __future__ import annotations

from collections.abc import Sequence
from uuid import uuid4

import pylsl

from tests.waiting import PATIENCE


class FakeOutlet:
    """An outlet of the lab streaming layer with labels and units."""

    def __init__(self, channels: Sequence[tuple[str, str]], name: str = "") -> None:
        """Open it under a name of its own; `channels` are pairs of label and unit."""
        self.name = name or f"tracker-{uuid4().hex}"
        info = pylsl.StreamInfo(
            self.name, "Gaze", len(channels), 60.0, pylsl.cf_double64, uuid4().hex
        )
        parent = info.desc().append_child("channels")
        for label, unit in channels:
            channel = parent.append_child("channel")
            channel.append_child_value("label", label)
            channel.append_child_value("unit", unit)
        self._outlet = pylsl.StreamOutlet(info)

    def send(self, *sample: float, age: float = 0.0) -> None:
        """Send a sample that was measured `age` ago [s], once somebody listens.

        Who has begun to read is heard of later on a busy machine; a sample that is sent
        before goes to nobody.
        """
        assert self._outlet.wait_for_consumers(PATIENCE)
        self._outlet.push_sample(list(sample), pylsl.local_clock() - age)
