"""The sender of a raw wheel forgets what was asked too long ago."""

from __future__ import annotations

import pytest

from costeer.devices.wheels import logitech, sender
from costeer.devices.wheels.sender import Sender
from tests.waiting import wait_for


class Wire:
    """Keeps what is sent."""

    def __init__(self) -> None:
        self.sent: list[bytes] = []

    def write(self, command: bytes) -> None:
        """Keep it."""
        self.sent.append(command)

    def read(self) -> bytes:
        """Nothing comes."""
        return b""

    def close(self) -> None:
        """Nothing is open."""


@pytest.mark.parametrize(("latest", "level"), [(1e9, 40), (-1.0, 0)])
def test_level_that_waited_while_the_process_was_halted_is_sent_as_zero(
    monkeypatch: pytest.MonkeyPatch, latest: float, level: int
) -> None:
    monkeypatch.setattr(sender, "LATEST", latest)
    wire = Wire()
    thread = Sender(wire)
    thread.put(40)
    wait_for(lambda: wire.sent)
    thread.end()
    assert wire.sent[0] == logitech.constant(0, level)
