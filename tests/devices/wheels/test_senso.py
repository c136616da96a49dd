"""A SENSO-Wheel on a virtual CAN bus, played by a thread."""

from __future__ import annotations

import itertools
import math
import struct
import threading
import time
from collections.abc import Callable, Iterator

import can
import pytest

from costeer.devices.wheels import senso_frames as frames
from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.interface import Wheel, WheelLost
from costeer.devices.wheels.registry import emergency_stop, found_wheels, open_wheel
from costeer.devices.wheels.senso import SensoWheel, senso_description, stop_senso
from costeer.devices.wheels.senso_frames import SensoState
from tests.waiting import PATIENCE, wait_for

CALIBRATION = WheelCalibration(
    identity="senso-virtual-x",
    angle_sign=-1.0,
    full_range=math.radians(720.0),
    torque_sign=-1.0,
    torque_curve=((0.0, 0.0), (1.0, 8.0)),
)
CHANNELS = (f"costeer-{number}" for number in itertools.count())


class FakeSenso(threading.Thread):
    """Answers as the device does; keeps what it was asked."""

    def __init__(self, channel: str) -> None:
        super().__init__(daemon=True)
        self.bus = can.Bus(interface="virtual", channel=channel)
        self.state = int(SensoState.OFF)
        self.increments, self.rate = 10_000, 60
        self.accelerator, self.brake = 2330, 251
        self.torques: list[int] = []
        self.states: list[bytes] = []
        self.silent = self.ended = False
        self.stuck_in: int | None = None

    def run(self) -> None:
        """Answer until the end."""
        while not self.ended:
            message = self.bus.recv(0.02)
            if message is not None and not self.silent:
                self.take(message.arbitration_id, bytes(message.data))

    def take(self, identifier: int, content: bytes) -> None:
        """Answer one frame."""
        if identifier == 0x200:
            self.states.append(content)
            self.go_to(content[0])
            self.answer(0x210, bytes([self.state, *content[1:]]))
        elif identifier == 0x201:
            self.torques.append(struct.unpack("<4h", content)[0])
            moving = (self.increments, self.rate, self.torques[-1])
            self.answer(0x211, struct.pack("<ihh", *moving))
        elif identifier == 0x20C:
            pedals = (0, self.accelerator, self.brake)
            self.answer(0x21C, struct.pack("<HHH", *pedals))

    def go_to(self, mode: int) -> None:
        """Change the state as it is asked."""
        if self.stuck_in is not None:
            self.state = self.stuck_in
        elif mode == SensoState.CLEAR:
            self.state = int(SensoState.OFF)
        elif mode != SensoState.UNCHANGED and self.state != SensoState.ERROR:
            self.state = mode

    def answer(self, identifier: int, content: bytes) -> None:
        """Send a frame."""
        self.bus.send(
            can.Message(arbitration_id=identifier, data=content, is_extended_id=False)
        )


@pytest.fixture
def channel() -> str:
    """A bus of its own for each test."""
    return next(CHANNELS)


@pytest.fixture
def device(channel: str) -> Iterator[FakeSenso]:
    """The device, which answers."""
    thread = FakeSenso(channel)
    thread.start()
    yield thread
    thread.ended = True
    thread.join(PATIENCE)
    thread.bus.shutdown()


@pytest.fixture
def wheel(device: FakeSenso, channel: str) -> Iterator[SensoWheel]:
    """The wheel, switched on."""
    bus = can.Bus(interface="virtual", channel=channel)
    # On a loaded machine the device's thread may not answer for a while.
    opened = SensoWheel(bus, CALIBRATION, patience=PATIENCE, silence=PATIENCE)
    yield opened
    opened.close()


def loss(use: Callable[[], object]) -> str:
    """Do something until the wheel is lost; return what is said."""
    last = time.perf_counter() + PATIENCE
    while time.perf_counter() < last:
        try:
            use()
        except WheelLost as error:
            return str(error)
    return "not lost"


def test_frames_are_those_of_the_device() -> None:
    state = frames.state_frame(SensoState.ON, math.radians(720.0))
    assert state.hex(" ") == "14 00 68 01 00 00 64 64"
    assert frames.torque_frame(1.5).hex(" ") == "dc 05 00 00 00 00 00 00"
    assert frames.torque_frame(-1.5).hex(" ") == "24 fa 00 00 00 00 00 00"
    moving = frames.motion(bytes.fromhex("f0 d8 ff ff 3c 00 e8 03"))
    # -10,000 steps of 0.009 deg, one turn a second, 1 N·m.
    assert moving == pytest.approx((math.radians(-90.0), 2.0 * math.pi, 1.0))
    assert frames.pedals(struct.pack("<HHH", 0, 1100, 501)) == (0.0, 1.0)
    assert frames.pedals(struct.pack("<HHH", 0, 9999, 0)) == (1.0, 0.0)


def test_a_torque_frame_never_asks_for_more_than_the_limit() -> None:
    for torque, sent in ((30.0, 8000), (-30.0, -8000), (math.nan, 0), (math.inf, 0)):
        assert struct.unpack("<4h", frames.torque_frame(torque))[0] == sent


def test_it_is_switched_on_step_by_step_with_its_limits(
    wheel: SensoWheel, device: FakeSenso
) -> None:
    assert isinstance(wheel, Wheel)
    assert wheel.measures_torque
    assert wheel.torque_limit == frames.FULL_TORQUE
    assert device.state == SensoState.ON
    modes = [mode for mode, _ in itertools.groupby(s[0] for s in device.states)]
    assert modes == [0x11, 0x10, 0x12, 0x14]
    limits = {struct.unpack("<BBhhBB", s)[2:] for s in device.states}
    assert limits == {(360, 0, 100, 100)}
    assert set(device.torques) == {0}


def test_a_torque_is_asked_for_in_the_devices_sign(
    wheel: SensoWheel, device: FakeSenso
) -> None:
    for torque, sent in ((1.25, -1250), (-2.0, 2000), (50.0, -8000), (math.nan, 0)):
        wheel.write(torque)
        wait_for(lambda sent=sent: device.torques[-1] == sent)


def test_motion_and_pedals_come_back_in_our_signs(
    wheel: SensoWheel, device: FakeSenso
) -> None:
    before = time.perf_counter()
    wheel.write(1.0)
    wait_for(lambda: wheel.read().driver_torque == pytest.approx(1.0))
    wait_for(lambda: wheel.read().brake > 0.0)
    reading = wheel.read()
    assert reading.steering_wheel_angle == pytest.approx(-math.radians(90.0))
    assert reading.steering_wheel_rate == pytest.approx(-2.0 * math.pi)
    assert reading.driver_torque == pytest.approx(1.0)
    assert (reading.accelerator, reading.brake) == (0.5, 0.5)
    assert wheel.axes()[0] == pytest.approx(0.25)
    assert before < reading.time <= time.perf_counter()


def test_every_answer_is_read_and_the_newest_counts(
    wheel: SensoWheel, device: FakeSenso
) -> None:
    for step in range(50):
        device.increments = 100 * step
        wheel.write(0.01 * step)
        wait_for(lambda step=step: device.torques[-1] == -10 * step)
    newest = pytest.approx(-math.radians(4900 * 0.009))
    time.sleep(0.02)  # so that most answers wait
    wait_for(lambda: wheel.read().steering_wheel_angle == newest)
    assert wheel.read().steering_wheel_angle == newest


def test_a_torque_dies_when_only_readings_go_on(
    wheel: SensoWheel, device: FakeSenso
) -> None:
    wheel.write(2.0)
    wait_for(lambda: device.torques[-1] == -2000)
    start = time.perf_counter()

    def is_off() -> bool:
        wheel.read()
        return device.torques[-1] == 0

    wait_for(is_off)
    assert time.perf_counter() - start > 0.1


def test_a_silent_wheel_is_lost(device: FakeSenso, channel: str) -> None:
    bus = can.Bus(interface="virtual", channel=channel)
    wheel = SensoWheel(bus, CALIBRATION, patience=PATIENCE, silence=0.05)
    device.silent = True
    assert "does not answer; see its power" in loss(wheel.read)
    wheel.close()


def test_a_wheel_in_error_is_lost(wheel: SensoWheel, device: FakeSenso) -> None:
    device.stuck_in = int(SensoState.ERROR)

    def used() -> None:
        wheel.write(0.0)
        wheel.read()

    assert "went to state 0x18" in loss(used)


def test_an_error_from_before_is_cleared(device: FakeSenso, channel: str) -> None:
    device.state = int(SensoState.ERROR)
    wheel = SensoWheel(can.Bus(interface="virtual", channel=channel), CALIBRATION)
    assert device.state == SensoState.ON
    wheel.close()


def test_closing_sets_zero_and_switches_off(
    wheel: SensoWheel, device: FakeSenso
) -> None:
    wheel.write(2.0)
    wheel.close()
    wheel.close()
    wait_for(lambda: device.state == SensoState.OFF)
    assert device.torques[-1] == 0
    for use in (wheel.read, lambda: wheel.write(1.0)):
        with pytest.raises(WheelLost, match="is closed"):
            use()


def test_another_process_switches_it_off(
    wheel: SensoWheel, device: FakeSenso, channel: str
) -> None:
    wheel.write(2.0)
    other = can.Bus(interface="virtual", channel=channel)
    stop_senso(senso_description(f"virtual:{channel}"), other)
    wait_for(lambda: device.state == SensoState.OFF)
    assert device.torques[-1] == 0


def test_a_bus_without_a_wheel_is_told(channel: str) -> None:
    bus = can.Bus(interface="virtual", channel=channel)
    with pytest.raises(WheelLost, match="see its power, its cable"):
        SensoWheel(bus, CALIBRATION, patience=0.05)


def test_the_registry_opens_and_stops_it_by_its_address(
    device: FakeSenso, channel: str
) -> None:
    (description,) = found_wheels(can=f"virtual:{channel}")
    assert description.kind == "senso"
    mine = CALIBRATION._replace(identity=description.identity)
    wheel = open_wheel(description, mine)
    wheel.write(1.0)
    wait_for(lambda: device.torques[-1] == -1000)
    emergency_stop(description)
    wait_for(lambda: device.state == SensoState.OFF)
    wheel.close()


@pytest.mark.parametrize("address", ["", "can0", "pcan:", ":x"])
def test_an_address_without_interface_and_channel_is_refused(address: str) -> None:
    with pytest.raises(ValueError, match="as pcan:PCAN_USBBUS1 or socketcan:can0"):
        senso_description(address)


def test_an_interface_that_is_not_there_is_told() -> None:
    description = senso_description("nothing:here")
    mine = CALIBRATION._replace(identity=description.identity)
    with pytest.raises(WheelLost, match=r"has no bus.*see that the adapter"):
        open_wheel(description, mine)


class BrokenBus:
    """A bus whose adapter was pulled."""

    def __init__(self) -> None:
        self.ended = False

    def send(self, message: can.Message, timeout: float) -> None:
        """Fail, as the interfaces do."""
        raise can.CanOperationError("adapter pulled")

    def recv(self, timeout: float) -> None:
        """Fail, as the interfaces do."""
        raise can.CanOperationError("adapter pulled")

    def shutdown(self) -> None:
        """End."""
        self.ended = True


def test_a_pulled_adapter_is_told_and_let_go(wheel: SensoWheel) -> None:
    broken = BrokenBus()
    with pytest.raises(WheelLost, match="takes no frame: adapter pulled"):
        SensoWheel(broken, CALIBRATION)
    assert broken.ended
    wheel._bus.shutdown()
    wheel._bus = BrokenBus()
    assert "the CAN bus is gone: adapter pulled" in loss(wheel._drain)
    assert "takes no frame" in loss(lambda: wheel.write(1.0))


def test_a_cut_frame_is_told(wheel: SensoWheel, device: FakeSenso) -> None:
    device.answer(0x211, b"\x00\x01")
    assert "sent a cut frame" in loss(wheel.read)
