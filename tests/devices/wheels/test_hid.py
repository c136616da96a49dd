"""A raw Logitech wheel: the bytes it gets, in order, and what it sends."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable

import pytest

from costeer.devices.wheels import hid, logitech
from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.hid import HidWheel, hid_model, hid_wheels, stop_hid
from costeer.devices.wheels.interface import Wheel, WheelDescription, WheelLost
from tests.waiting import PATIENCE, wait_for

DESCRIPTION = WheelDescription("hid", "path", "Logitech G29", "046d-c24f-hid")
MODEL = logitech.MODELS[0xC24F]
CALIBRATION = WheelCalibration(
    identity=DESCRIPTION.identity,
    angle_sign=-1.0,
    full_range=math.radians(900.0),
    torque_curve=((0.0, 0.0), (1.0, 2.0)),
    accelerator_axis=2,
    accelerator_sign=-1.0,
    brake_axis=3,
    brake_sign=-1.0,
)
OPENING = ["0d", "f5", "f88184", "11"]
ALL_STOP = ["13", "23", "43", "83", "f5"]


class RecordingTransport:
    """Keeps what is written; tells what it is told to."""

    def __init__(self, *reports: bytes) -> None:
        self.reports = list(reports)
        self.written: list[bytes] = []
        self.gone = False
        self.closed = 0
        self.entered = threading.Event()
        self.held = threading.Event()
        self.held.set()

    def write(self, command: bytes) -> None:
        """Take a command, once nobody holds the line."""
        self.entered.set()
        self.held.wait(PATIENCE)
        if self.gone:
            raise OSError("write error")
        self.written.append(command)

    def read(self) -> bytes:
        """The next report."""
        if self.gone:
            raise OSError("read error")
        return self.reports.pop(0) if self.reports else b""

    def close(self) -> None:
        """Count how often it is closed."""
        self.closed += 1


def report(angle: int = 0x8000, accelerator: int = 255, paddles: int = 0) -> bytes:
    """What a G29 sends."""
    rim = angle.to_bytes(2, "little")
    return bytes([8, paddles, 0, 0]) + rim + bytes([accelerator, 255, 255, 128, 128, 0])


def opened(transport: RecordingTransport) -> HidWheel:
    """A G29 on a transport."""
    return HidWheel(transport, MODEL, CALIBRATION)


def loss(use: Callable[[], object]) -> str:
    """Do something until the wheel is lost; return what is said."""
    last = time.perf_counter() + PATIENCE
    while time.perf_counter() < last:
        try:
            use()
        except WheelLost as error:
            return str(error)
        time.sleep(0.001)
    return "not lost"


def starts(commands: list[bytes], wanted: list[str]) -> list[str]:
    """First bytes of commands, as many as are wanted of each."""
    pairs = zip(commands, wanted, strict=True)
    return [command.hex()[: len(text)] for command, text in pairs]


def test_a_wheel_starts_without_spring_in_its_range_with_a_zero_force() -> None:
    transport = RecordingTransport(report())
    wheel = opened(transport)
    assert isinstance(wheel, Wheel)
    assert starts(transport.written, OPENING) == OPENING
    assert transport.written[-1] == logitech.constant(0, 0, logitech.PLAY)
    wheel.close()


def test_a_driving_force_pro_gets_its_own_range() -> None:
    transport = RecordingTransport(bytes([0, 0x20, 0, 0x80, 127, 255, 255, 0]))
    wheel = HidWheel(transport, logitech.MODELS[0xC298], CALIBRATION)
    assert [c.hex()[:4] for c in transport.written[2:4]] == ["f803", "810b"]
    assert wheel.read().steering_wheel_angle == 0.0
    wheel.close()


@pytest.mark.parametrize(
    ("torque", "byte"),
    [(2.0, 0xFF), (-2.0, 0x00), (0.0, 0x80), (9.0, 0xFF), (1.0, 0xC0), (-1.0, 0x40)],
)
def test_a_torque_is_a_refreshed_constant_force(torque: float, byte: int) -> None:
    transport = RecordingTransport(report())
    wheel = opened(transport)
    wheel.write(torque)
    wait_for(lambda: len(transport.written) > len(OPENING))
    assert transport.written[len(OPENING)] == bytes([0x1C, 0, byte, 0, 0, 0, 0])
    wheel.close()


@pytest.mark.parametrize("torque", [math.nan, math.inf, -math.inf])
def test_what_is_no_finite_torque_is_sent_as_none(torque: float) -> None:
    transport = RecordingTransport(report())
    wheel = opened(transport)
    wheel.write(torque)
    wait_for(lambda: len(transport.written) > len(OPENING))
    assert transport.written[len(OPENING)] == logitech.constant(0, 0)
    wheel.close()


def test_a_force_that_is_not_refreshed_is_taken_off_once() -> None:
    transport = RecordingTransport(report())
    wheel = opened(transport)
    start = time.perf_counter()
    wheel.write(1.0)
    wait_for(lambda: len(transport.written) > len(OPENING) + 1)
    assert time.perf_counter() - start >= 0.2
    time.sleep(0.25)
    forces = transport.written[len(OPENING) :]
    assert [force[2] for force in forces] == [0xC0, 0x80]
    wheel.close()


def test_a_slow_transfer_neither_holds_the_loop_nor_queues_old_torques() -> None:
    transport = RecordingTransport(report())
    wheel = opened(transport)
    transport.held.clear()
    transport.entered.clear()
    wheel.write(2.0)
    assert transport.entered.wait(PATIENCE)  # the thread stands in the transfer
    start = time.perf_counter()
    for _ in range(100):
        wheel.write(-1.0)
    wheel.write(1.0)
    assert time.perf_counter() - start < PATIENCE / 10.0
    transport.held.set()
    wait_for(lambda: len(transport.written) >= len(OPENING) + 2)
    # On a busy machine the zero of a stale force may have followed already.
    assert [c[2] for c in transport.written[len(OPENING) :][:2]] == [0xFF, 0xC0]
    wheel.close()


def test_the_newest_report_counts() -> None:
    transport = RecordingTransport(report(0), report(1), report(0xC000, 0, 3))
    wheel = opened(transport)
    reading = wheel.read()
    # To the right of the middle by half of the way, by the device; left is positive.
    assert reading.steering_wheel_angle == -math.radians(225.0)
    assert (reading.accelerator, reading.brake, reading.buttons) == (1.0, 0.0, 3)
    assert math.isnan(reading.steering_wheel_rate + reading.driver_torque)
    assert wheel.read()[1:6:3] == reading[1:6:3]
    assert wheel.axes() == (0.5, 1.0, -1.0, 1.0)
    transport.reports.append(report(0x8000))
    assert wheel.read().steering_wheel_angle == 0.0
    wheel.close()


def test_closing_stops_every_force_once() -> None:
    transport = RecordingTransport(report())
    wheel = opened(transport)
    wheel.write(1.0)
    wheel.close()
    wheel.close()
    assert starts(transport.written[-5:], ALL_STOP) == ALL_STOP
    assert transport.closed == 1
    for use in (wheel.read, lambda: wheel.write(1.0)):
        with pytest.raises(WheelLost, match="is closed"):
            use()


def test_an_unplugged_wheel_is_lost_for_the_reader() -> None:
    transport = RecordingTransport(report())
    wheel = opened(transport)
    transport.gone = True
    with pytest.raises(WheelLost, match="was unplugged: read error"):
        wheel.read()
    wheel.close()
    assert transport.closed == 1


def test_an_unplugged_wheel_is_lost_for_the_writer() -> None:
    transport = RecordingTransport(report())
    wheel = opened(transport)
    transport.gone = True
    reason = loss(lambda: wheel.write(1.0))
    assert "was unplugged: write error" in reason
    wheel.close()


def test_a_wheel_that_says_nothing_is_let_go() -> None:
    transport = RecordingTransport()
    with pytest.raises(WheelLost, match="it is silent; turn it a little"):
        HidWheel(transport, MODEL, CALIBRATION, patience=0.02)
    assert starts(transport.written[-5:], ALL_STOP) == ALL_STOP
    assert transport.closed == 1


def test_a_report_of_another_mode_is_told() -> None:
    with pytest.raises(WheelLost, match="8 bytes is too short"):
        opened(RecordingTransport(bytes(8)))


def test_another_process_takes_every_force_off() -> None:
    transport = RecordingTransport()
    stop_hid(DESCRIPTION, transport)
    assert starts(transport.written, ALL_STOP) == ALL_STOP
    assert transport.closed == 1


def test_the_model_is_in_the_identity() -> None:
    assert hid_model(DESCRIPTION) is MODEL
    with pytest.raises(ValueError, match="c262-hid\\) does not speak the classic"):
        hid_model(DESCRIPTION._replace(identity="046d-c262-hid"))


class FakeDevice:
    """A device of hidapi, as far as it is used."""

    def __init__(self) -> None:
        self.sent: list[bytes] = []
        self.answers = [list(report())]

    def open_path(self, path: bytes) -> None:
        """Open it, if the path is known."""
        if path != b"here":
            raise OSError("open failed")

    def set_nonblocking(self, on: int) -> None:
        """Do not wait for reports."""
        assert on == 1

    def write(self, content: bytes) -> int:
        """Take a command; the second one fails."""
        self.sent.append(content)
        return len(content) if len(self.sent) < 2 else -1

    def read(self, most: int) -> list[int]:
        """The next report."""
        assert most >= 12
        return self.answers.pop(0) if self.answers else []

    def error(self) -> str:
        """Why it failed."""
        return "no such device"

    def close(self) -> None:
        """Note that it is closed."""
        self.sent.append(b"closed")


def test_a_device_of_hidapi_gets_a_zero_in_front(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    device = FakeDevice()
    monkeypatch.setattr(hid.hid_library(), "device", lambda: device)
    with pytest.raises(WheelLost, match="there does not open: open failed; close"):
        hid.DeviceTransport("there")
    transport = hid.DeviceTransport("here")
    transport.write(logitech.stop(0))
    assert device.sent == [bytes([0, 0x13, 0, 0, 0, 0, 0, 0])]
    assert transport.read() == report()
    assert transport.read() == b""
    with pytest.raises(OSError, match="no such device"):
        transport.write(logitech.stop(0))
    transport.close()
    assert device.sent[-1] == b"closed"


def test_wheels_of_the_classic_protocol_are_listed_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def listed(vendor: int, product: int) -> list[dict[str, object]]:
        assert (vendor, product) == (0x046D, 0)
        wheel = {"product_id": 0xC29B, "path": b"a", "interface_number": 0}
        newer = {"product_id": 0xC262, "path": b"b", "interface_number": 0}
        mouse = {"product_id": 0xC077, "path": b"c", "interface_number": -1}
        return [wheel, {**wheel, "usage": 4}, newer, mouse]

    monkeypatch.setattr(hid.hid_library(), "enumerate", listed)
    (found,) = hid_wheels()
    assert found == WheelDescription("hid", "a", "Logitech G27", "046d-c29b-hid")
