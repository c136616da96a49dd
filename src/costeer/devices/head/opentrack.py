"""Head yaw from opentrack's output "UDP over network"."""

from __future__ import annotations

import math
import socket
import struct
import time
from collections.abc import Callable

from costeer.devices.head.source import NOTHING_SEEN, HeadLost, HeadReading, aged

LOOPBACK = "127.0.0.1"
WAIT = 0.05
"""Longest wait for a packet [s]."""

_PACKET = struct.Struct("<6d")
"""x, y, z [cm], yaw, pitch, roll [deg]."""

_HALVES = struct.Struct("<12f")
"""The same bytes as numbers of single precision."""

_SMALLEST, _LARGEST = 1e-12, 1e4
_SINGLE_SMALLEST = 1e-3
_MOST_SINGLES = 5
"""So many halves of six true numbers do not look like numbers by chance: each of them
does in one of twelve."""

_MOST_PACKETS = 1000
"""Packets read at a time: a flood does not hold up the reader."""


class Opentrack:
    """Listens for packets of opentrack; everything else is refused.

    Attributes:
        refused: Number of packets of a wrong size or with impossible numbers.
        port: Where it listens.
    """

    def __init__(
        self, address: str, clock: Callable[[], float] = time.perf_counter
    ) -> None:
        """Open the port.

        Args:
            address: Port on this computer, or host and port as `0.0.0.0:4242` to
                take packets of other computers.
            clock: Monotonic [s].

        Raises:
            ValueError: If the address is none.
            HeadLost: If the port cannot be opened.
        """
        host, port = parse_address(address)
        self.refused = 0
        self._clock = clock
        self._last = NOTHING_SEEN
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((host, port))
        except OSError as error:
            self._socket.close()
            raise HeadLost(
                f"port {address} does not open ({error.strerror}); choose another "
                "--opentrack, and the same in opentrack"
            ) from error
        self.port = int(self._socket.getsockname()[1])

    def read(self) -> HeadReading:
        """Yaw of the newest packet, as opentrack counts it [rad]."""
        packet = self._packet(WAIT)
        for _ in range(_MOST_PACKETS):
            if packet is None:
                break
            self._take(packet)
            packet = self._packet(0.0)
        return aged(self._last, self._clock())

    def _packet(self, wait: float) -> bytes | None:
        """The next packet, or None if none comes within `wait` [s]."""
        self._socket.settimeout(wait)
        try:
            return self._socket.recv(_PACKET.size + 1)
        except (TimeoutError, BlockingIOError):
            return None
        except OSError:  # Windows: a packet was too long for the buffer
            return b""

    def _take(self, packet: bytes) -> None:
        """Believe a packet or count it as refused."""
        yaw = packet_yaw(packet)
        if yaw is None:
            self.refused += 1
        else:
            self._last = HeadReading(self._clock(), yaw, True)

    def close(self) -> None:
        """Close the port."""
        self._socket.close()


def packet_yaw(packet: bytes) -> float | None:
    """Yaw that a packet tells [rad]; None if it is no packet of opentrack."""
    if len(packet) != _PACKET.size:
        return None
    numbers = _PACKET.unpack(packet)
    yaw_deg = numbers[3]
    if abs(yaw_deg) > 180.0 or not all(map(_is_measured, numbers)):
        return None
    if sum(map(_is_single, _HALVES.unpack(packet)[::2])) >= _MOST_SINGLES:
        return None
    return math.radians(yaw_deg)


def _is_measured(number: float) -> bool:
    """Whether a tracker can have measured it; bytes in another order give no such."""
    return number == 0.0 or _SMALLEST < abs(number) < _LARGEST


def _is_single(number: float) -> bool:
    """Whether half of a number looks like one of single precision, by itself."""
    return _SINGLE_SMALLEST < abs(number) < _LARGEST


def parse_address(address: str) -> tuple[str, int]:
    """Host and port of `4242` or `0.0.0.0:4242`.

    Raises:
        ValueError: If it is neither.
    """
    host, _, port = address.rpartition(":")
    if not (port.isdecimal() and port.isascii() and int(port) <= 65535):
        raise ValueError(
            f"{address!r} is no port; give one from 1 to 65535, as 4242, or host and "
            "port, as 0.0.0.0:4242"
        )
    return host or LOOPBACK, int(port)
