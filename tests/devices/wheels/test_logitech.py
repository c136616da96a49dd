"""Bytes of Logitech's classic protocol, as SDL's own encoder writes them."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.devices.wheels import logitech
from costeer.devices.wheels.interface import LEFT_INDICATOR, RIGHT_INDICATOR

G29, G27 = logitech.MODELS[0xC24F].layout, logitech.MODELS[0xC29B].layout
DFGT, DFP = logitech.MODELS[0xC29A].layout, logitech.MODELS[0xC298].layout

# As lg4ff_update_slot of SDL gives them; commands as hid-lg4ff of Linux sends them.
GOLDEN = {
    "1c 00 ff 00 00 00 00": logitech.constant(0, 32767),
    "1c 00 80 00 00 00 00": logitech.constant(0, 0),
    "1c 00 00 00 00 00 00": logitech.constant(0, -32768),
    "1c 00 9f 00 00 00 00": logitech.constant(0, 8000),
    "1c 00 60 00 00 00 00": logitech.constant(0, -8000),
    "11 00 80 00 00 00 00": logitech.constant(0, 0, logitech.PLAY),
    "2c 00 00 ff 00 00 00": logitech.constant(1, 32767),
    "8c 00 00 00 00 ff 00": logitech.constant(3, 40000),
    "f8 81 84 03 00 00 00": logitech.steering_range(math.radians(900.0)),
    "f8 81 0e 01 00 00 00": logitech.steering_range(math.radians(270.0)),
    "f5 00 00 00 00 00 00": logitech.autocenter_off(),
    "0d 00 00 00 00 00 00": logitech.fixed_loop_off(),
    "13 00 00 00 00 00 00": logitech.stop(0),
    "83 00 00 00 00 00 00": logitech.stop(3),
}


@pytest.mark.parametrize("expected", GOLDEN)
def test_bytes_are_those_of_the_protocol(expected: str) -> None:
    assert GOLDEN[expected].hex(" ") == expected


@given(st.integers(-32768, 32767))
def test_constant_force_keeps_eight_bits_and_grows(level: int) -> None:
    sent = logitech.constant(0, level)[2]
    # 256 levels lie in a byte; the device takes 128 as no force.
    assert 0 <= (level + 32768) / 256 - sent < 1
    assert logitech.constant(0, min(level + 256, 32767))[2] >= sent


@pytest.mark.parametrize(("asked", "sent"), [(10.0, 40), (2000.0, 900), (540.4, 540)])
def test_the_range_is_one_that_the_device_takes(asked: float, sent: int) -> None:
    command = logitech.steering_range(math.radians(asked))
    assert int.from_bytes(command[2:4], "little") == sent


def test_a_driving_force_pro_knows_two_ranges() -> None:
    wide = logitech.pro_steering_range(math.radians(900.0))
    narrow = logitech.pro_steering_range(math.radians(200.0))
    assert [c.hex() for c in wide] == ["f8030000000000", "810b0000000000"]
    assert narrow[0].hex() == "f8020000000000"


def test_all_stop_ends_every_slot_and_the_spring() -> None:
    assert [c.hex()[:2] for c in logitech.all_stop()] == ["13", "23", "43", "83", "f5"]
    assert {len(c) for c in logitech.all_stop()} == {logitech.LENGTH}


def test_a_slot_that_is_not_there_is_refused() -> None:
    with pytest.raises(ValueError, match="slot is 4, it must be one of 0 to 3"):
        logitech.stop(4)


def g29_report(angle: int, pedals: tuple[int, int, int], paddles: int = 0) -> bytes:
    """A report as a G29 sends it: accelerator, brake and clutch in this order."""
    head = bytes([8, paddles, 0, 0]) + angle.to_bytes(2, "little")
    return head + bytes(pedals) + bytes([128, 128, 0])


def test_a_g29_tells_where_its_rim_and_pedals_are() -> None:
    report = logitech.decoded(G29, g29_report(0x8000, (255, 0, 255)))
    assert report.axes == (0.0, 1.0, 1.0, -1.0)
    assert report.buttons == 0


@given(st.integers(0, 65535))
def test_the_rim_of_a_g29_has_sixteen_bits(angle: int) -> None:
    axis = logitech.decoded(G29, g29_report(angle, (255, 255, 255))).axes[0]
    assert round(axis * 32768) + 32768 == angle
    assert -1.0 <= axis < 1.0


@pytest.mark.parametrize(
    ("paddles", "buttons"),
    [(1, RIGHT_INDICATOR), (2, LEFT_INDICATOR), (3, 3), (0xFC, 0)],
)
def test_paddles_are_indicators(paddles: int, buttons: int) -> None:
    report = g29_report(0x8000, (255, 255, 255), paddles)
    assert logitech.decoded(G29, report).buttons == buttons


@given(st.integers(0, 16383), st.integers(0, 3))
def test_the_rim_of_a_g27_lies_above_two_buttons(angle: int, buttons: int) -> None:
    word = (angle << 2 | buttons).to_bytes(2, "little")
    report = bytes([8, 0, 0]) + word + bytes([255, 0, 255, 128, 128, 0])
    axes = logitech.decoded(G27, report).axes
    assert round(axes[0] * 8192) + 8192 == angle
    assert axes[1:] == (1.0, 1.0, -1.0)


@given(st.integers(0, 16383), st.integers(0, 3))
def test_older_wheels_have_fourteen_bits_and_no_clutch(angle: int, rest: int) -> None:
    word = (angle | rest << 14).to_bytes(2, "little")
    newer = bytes([8, 0, 0, 0]) + word + bytes([0, 255])
    older = word + bytes([0x08, 0x80, 127, 0, 255, 0])
    for layout, report in ((DFGT, newer), (DFP, older)):
        steering, clutch, accelerator, brake = logitech.decoded(layout, report).axes
        assert round(steering * 8192) + 8192 == angle
        assert math.isnan(clutch)
        assert (accelerator, brake) == (-1.0, 1.0)
    assert logitech.decoded(DFP, older).buttons == LEFT_INDICATOR


def test_a_report_of_another_mode_is_refused_with_the_way_out() -> None:
    with pytest.raises(ValueError, match=r"8 bytes is too short.*PS3 or PC mode"):
        logitech.decoded(G29, bytes(8))
