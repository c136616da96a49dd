"""The simulated wheel: what its signs, curve, delay, sensors and faults do."""

from __future__ import annotations

import itertools
import math
import pickle
from multiprocessing.shared_memory import SharedMemory

import pytest

from costeer.devices.wheels.interface import EFFECT_LIFE, Wheel, WheelLost
from costeer.devices.wheels.registry import emergency_stop, open_wheel
from costeer.devices.wheels.simulated import (
    SimulatedWheel,
    SimulatedWheelParameters,
    SpringHands,
    open_simulated,
    simulated_description,
    true_calibration,
)
from costeer.devices.wheels.torque_cell import TorqueCell

PLAIN = SimulatedWheelParameters(friction=0.0, damping=0.0, latency=0, resolution=0.0)
CURVE = ((0.0, 0.0), (0.5, 0.5), (1.0, 2.0))


def wheel_of(**options: object) -> SimulatedWheel:
    """A wheel that is calibrated as it is."""
    parameters = SimulatedWheelParameters(**{**PLAIN._asdict(), **options})
    return SimulatedWheel(parameters, true_calibration(parameters))


def pushed(wheel: SimulatedWheel, torque: float, steps: int) -> float:
    """Angle read after a torque was written in each of some steps."""
    for _ in range(steps):
        wheel.write(torque)
        angle = wheel.read().steering_wheel_angle
    return angle


def test_a_wheel_keeps_the_protocol() -> None:
    assert isinstance(wheel_of(), Wheel)


@pytest.mark.parametrize(
    ("angle_sign", "torque_sign"), [*itertools.product((1.0, -1.0), repeat=2)]
)
def test_a_calibrated_wheel_turns_where_it_is_pushed(
    angle_sign: float, torque_sign: float
) -> None:
    wheel = wheel_of(angle_sign=angle_sign, torque_sign=torque_sign)
    # Half a second at τ / J, then half the square of the time.
    assert pushed(wheel, 0.4, 480) == pytest.approx(0.4 / 0.04 * 0.5**2 / 2.0)
    assert wheel.angle > 0.0


def test_a_wrong_sign_in_the_calibration_is_seen_at_the_rim() -> None:
    parameters = PLAIN._replace(torque_sign=1.0)
    wrong = true_calibration(parameters)._replace(torque_sign=-1.0)
    assert pushed(SimulatedWheel(parameters, wrong), 0.4, 48) < 0.0


@pytest.mark.parametrize("torque", [0.25, -0.25, 1.25, -1.25, 2.0])
def test_the_torque_curve_is_honoured(torque: float) -> None:
    wheel = wheel_of(torque_curve=CURVE)
    pushed(wheel, torque, 1)
    assert wheel.motor_torque == pytest.approx(torque, rel=1e-12)


@pytest.mark.parametrize("torque", [math.nan, math.inf])
def test_what_is_no_torque_does_not_push(torque: float) -> None:
    wheel = wheel_of()
    assert pushed(wheel, torque, 48) == 0.0


def test_more_than_the_wheel_has_gives_all_it_has() -> None:
    wheel = wheel_of(torque_curve=CURVE)
    assert wheel.torque_limit == 2.0
    pushed(wheel, -9.0, 1)
    assert wheel.motor_torque == -2.0


@pytest.mark.parametrize("latency", [0, 1, 7])
def test_a_push_is_felt_after_the_latency(latency: int) -> None:
    wheel = wheel_of(latency=latency)
    wheel.read()
    wheel.write(1.0)
    felt = [wheel.read().steering_wheel_angle > 0.0 for _ in range(latency + 2)]
    assert felt == [False] * latency + [True, True]


def test_friction_holds_a_gentle_push() -> None:
    wheel = wheel_of(friction=0.2)
    assert pushed(wheel, 0.199, 960) == 0.0
    assert pushed(wheel, 0.21, 48) > 0.0


def test_a_torque_that_is_not_refreshed_dies() -> None:
    wheel = wheel_of()
    wheel.write(1.0)
    torques = []
    for _ in range(300):
        wheel.read()
        torques.append(wheel.motor_torque)
    alive = sum(torque > 0.0 for torque in torques)
    # In whole steps: it lives less than EFFECT_LIFE and one step more.
    assert EFFECT_LIFE * 960 <= alive <= EFFECT_LIFE * 960 + 1
    assert torques[-1] == 0.0


def test_the_angle_has_the_steps_of_the_sensor() -> None:
    step = math.radians(1.0)
    wheel = wheel_of(resolution=step)
    angles = {pushed(wheel, 0.3, 1) for _ in range(480)}
    assert len(angles) > 10
    # Rounding: the angle goes through the axis in [-1, 1] and back.
    assert all(abs(a / step - round(a / step)) < 1e-9 for a in angles)


def test_the_end_stop_holds() -> None:
    wheel = wheel_of(full_range=math.radians(180.0))
    assert pushed(wheel, 2.0, 960) == pytest.approx(math.radians(90.0), rel=1e-12)
    assert wheel.rate == 0.0
    assert pushed(wheel, -0.5, 96) < math.radians(90.0)


def test_sensors_tell_what_the_device_has() -> None:
    hands = SpringHands(stiffness=2.0, damping=0.0, amplitude=0.5, period=4.0)
    seeing = PLAIN._replace(measures_torque=True, measures_rate=True, brake=0.3)
    wheel = SimulatedWheel(seeing, true_calibration(seeing), hands)
    for _ in range(100):
        before, time = wheel.angle, wheel.time
        reading = wheel.read()
    assert reading.driver_torque == hands(time, before, 0.0)
    assert reading.steering_wheel_rate == wheel.rate > 0.0
    assert reading.brake == 0.3
    blind = wheel_of().read()
    assert math.isnan(blind.driver_torque + blind.steering_wheel_rate)
    assert math.isnan(blind.accelerator + blind.brake)


def test_held_by_a_spring_it_swings_at_its_own_frequency() -> None:
    hands = SpringHands(stiffness=4.0, damping=0.0)
    wheel = SimulatedWheel(PLAIN, true_calibration(PLAIN), hands)
    wheel.angle = 0.1
    angles = [wheel.read().steering_wheel_angle for _ in range(960)]
    crossings = sum(a * b < 0.0 for a, b in itertools.pairwise(angles))
    # Twice sqrt(k / J) / 2π = 1.59 Hz in a second.
    assert crossings == 3


def test_time_is_simulated_or_that_of_a_clock() -> None:
    assert wheel_of(dt=0.01).read().time == 0.01
    ticks = iter([7.0, 8.0])
    wheel = SimulatedWheel(PLAIN, true_calibration(PLAIN), clock=lambda: next(ticks))
    assert [wheel.read().time, wheel.read().time] == [7.0, 8.0]


def test_an_unplugged_wheel_is_lost() -> None:
    wheel = wheel_of(unplug_at=0.05, dt=0.01)
    for _ in range(5):
        wheel.read()
    with pytest.raises(WheelLost, match="was unplugged"):
        wheel.read()
    with pytest.raises(WheelLost, match="was unplugged"):
        wheel.write(0.0)
    with pytest.raises(WheelLost, match="was unplugged"):
        wheel.axes()


def test_a_frozen_wheel_repeats_its_last_reading() -> None:
    wheel = wheel_of(freeze_at=0.05, dt=0.01)
    readings = []
    for _ in range(8):
        wheel.write(1.0)
        readings.append(wheel.read())
    assert len(set(readings[:5])) == 5
    assert set(readings[4:]) == {readings[4]}


def test_a_closed_wheel_is_lost_and_closes_twice() -> None:
    wheel = wheel_of()
    wheel.close()
    wheel.close()
    with pytest.raises(WheelLost, match="is closed"):
        wheel.read()


def test_a_description_makes_the_same_wheel_elsewhere() -> None:
    description = simulated_description(
        hands=SpringHands(amplitude=0.2), torque_curve=CURVE, latency=2, brake=math.nan
    )
    sent = pickle.loads(pickle.dumps(description))
    parameters = SimulatedWheelParameters(torque_curve=CURVE, latency=2)
    here = SimulatedWheel(
        parameters, true_calibration(parameters), SpringHands(amplitude=0.2)
    )
    there = open_simulated(sent, true_calibration(parameters))
    for _ in range(100):
        here.write(0.3)
        there.write(0.3)
        assert here.read()[:3] == pytest.approx(there.read()[:3], nan_ok=True)


def test_another_process_can_take_the_torque_off() -> None:
    memory = SharedMemory(create=True, size=TorqueCell.size)
    try:
        description = simulated_description(torque_cell=memory.name)
        calibration = true_calibration(SimulatedWheelParameters())
        wheel = open_wheel(description, calibration)
        cell = TorqueCell(memory.name)
        wheel.write(-1.5)
        assert cell.read() == pytest.approx(-1.5, rel=1e-12)
        emergency_stop(description)
        assert cell.read() == 0.0
        wheel.write(1.0)
        wheel.close()
        assert cell.read() == 0.0
        cell.close()
        with pytest.raises(ValueError, match="cell is closed; open it again"):
            cell.read()
    finally:
        memory.close()
        memory.unlink()
    emergency_stop(description)  # what is gone pushes no more


def test_an_unknown_option_is_refused_with_those_there_are() -> None:
    with pytest.raises(ValueError, match="no 'mass'; it has inertia, damping"):
        simulated_description(mass=3.0)


@pytest.mark.parametrize("address", ["{", "[1]"])
def test_an_address_that_is_no_object_is_refused(address: str) -> None:
    description = simulated_description()._replace(address=address)
    with pytest.raises(ValueError, match="is no JSON object; make it with"):
        open_simulated(description, true_calibration(PLAIN))
