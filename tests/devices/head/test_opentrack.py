"""Packets of opentrack are believed if they can be, and nothing else is."""

from __future__ import annotations

import math
import socket
import struct
from collections.abc import Iterator

import numpy as np
import pytest

from costeer.devices.head.opentrack import Opentrack, packet_yaw, parse_address
from costeer.devices.head.registry import open_head
from costeer.devices.head.source import HeadDescription, HeadLost


def packet(yaw_deg: float, x: float = 1.0) -> bytes:
    return struct.pack("<6d", x, 2.0, 60.0, yaw_deg, -3.0, 1.0)


class Clock:
    """A clock that stands until it is set."""

    now = 100.0

    def __call__(self) -> float:
        """Its time [s]."""
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def source(clock: Clock) -> Iterator[Opentrack]:
    opened = Opentrack("0", clock)
    yield opened
    opened.close()


def send(source: Opentrack, *packets: bytes) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for each in packets:
            sender.sendto(each, ("127.0.0.1", source.port))


def test_the_newest_packet_counts(source: Opentrack) -> None:
    send(source, packet(5.0), packet(-12.0))
    reading = source.read()
    assert reading.valid
    assert math.degrees(reading.head_yaw) == pytest.approx(-12.0)


def test_nothing_is_seen_before_the_first_packet(source: Opentrack) -> None:
    assert not source.read().valid


def test_a_silent_tracker_is_lost_after_a_fifth_of_a_second(
    source: Opentrack, clock: Clock
) -> None:
    send(source, packet(20.0))
    assert source.read().valid
    clock.now += 0.25
    late = source.read()
    assert not late.valid
    assert math.degrees(late.head_yaw) == pytest.approx(20.0)


@pytest.mark.parametrize(
    "bad",
    [
        b"",
        b"x",
        packet(1.0)[:-1],
        packet(1.0) + b"x",
        b"\0" * 1400,
        packet(math.nan),
        packet(math.inf),
        packet(10.0, x=math.nan),
        packet(181.0),
        packet(-1e300),
    ],
)
def test_a_packet_that_cannot_be_is_refused(source: Opentrack, bad: bytes) -> None:
    send(source, packet(7.0))
    before = source.read()
    send(source, bad)
    assert source.read() == before
    assert source.refused == 1
    assert packet_yaw(bad) is None


NUMBERS = (1.7, -3.2, 61.4, 12.3, -4.5, 0.9)


@pytest.mark.parametrize(
    "bad", [struct.pack(">6d", *NUMBERS), struct.pack("<12f", *NUMBERS, *NUMBERS)]
)
def test_bytes_in_another_order_or_size_of_number_are_refused(bad: bytes) -> None:
    assert packet_yaw(bad) is None


def test_packets_of_true_numbers_are_believed() -> None:
    draw = np.random.default_rng(1)
    sent = draw.normal(scale=(5.0, 5.0, 60.0, 20.0, 10.0, 5.0), size=(20_000, 6))
    yaws = [packet_yaw(struct.pack("<6d", *each)) for each in sent.tolist()]
    assert yaws.count(None) <= 4  # of 20,000; each half looks single one time in eleven
    assert packet_yaw(struct.pack("<6d", *[0.0] * 6)) == 0.0
    assert packet_yaw(struct.pack("<6d", 1, 2, 60, 15, -3, 0)) == math.radians(15)


def test_it_listens_on_this_computer_only(source: Opentrack) -> None:
    assert source._socket.getsockname()[0] == "127.0.0.1"
    assert parse_address("4242") == ("127.0.0.1", 4242)
    assert parse_address("0.0.0.0:4242") == ("0.0.0.0", 4242)


@pytest.mark.parametrize("address", ["", "port", "70000", "-1", "1.5", "host:", "²"])
def test_an_address_that_is_none_is_refused(address: str) -> None:
    with pytest.raises(ValueError, match="is no port"):
        parse_address(address)


def test_a_taken_port_is_told(source: Opentrack) -> None:
    with pytest.raises(HeadLost, match="does not open"):
        Opentrack(str(source.port))


def test_a_tracker_that_counts_right_as_positive_is_turned_round() -> None:
    description = HeadDescription("opentrack", "0", mirrored=True)
    opened = open_head(description)
    try:
        send(opened._source, packet(30.0))  # type: ignore[attr-defined]  # the wrapper
        assert math.degrees(opened.read().head_yaw) == pytest.approx(-30.0)
    finally:
        opened.close()


def test_an_unknown_kind_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="webcam, lsl, opentrack"):
        open_head(HeadDescription("crystal", "0"))
