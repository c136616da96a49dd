"""The self-test finds the wheel that it was given, and stops where it should."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest

from costeer.devices.wheels.calibration import (
    WheelCalibration,
    device_command,
    uncalibrated,
)
from costeer.devices.wheels.excitation import (
    HANDS_OFF,
    ExcitationParameters,
    SelfTestStopped,
)
from costeer.devices.wheels.interface import WheelLost
from costeer.devices.wheels.references import (
    BACK,
    LEFT,
    RIGHT,
    Weight,
    known_angle_sign,
)
from costeer.devices.wheels.selftest import (
    Reference,
    SelfTestResult,
    agrees,
    calibrate,
    compare,
    opened_for_test,
    reading_rate,
    run_procedure,
)
from costeer.devices.wheels.simulated import (
    SimulatedWheel,
    SimulatedWheelParameters,
    no_hands,
    true_calibration,
)
from costeer.devices.wheels.weighing import HANG
from tests.devices.wheels.user import User

DT = 1.0 / 960.0
BRIEF = ExcitationParameters(duration=6.0)
LEVELS = tuple(0.05 * n for n in range(21))


class Case(NamedTuple):
    """A device, and what the user says of it."""

    device: SimulatedWheelParameters
    peak: float


def curve(peak: float, power: float, dead: float) -> tuple[tuple[float, float], ...]:
    """A torque curve that bends, with a dead zone at its start."""
    shares = [max((c - dead) / (1.0 - dead), 0.0) ** power for c in LEVELS]
    return tuple(
        (c, peak * max(s, 1e-6 * c)) for c, s in zip(LEVELS, shares, strict=True)
    )


def drawn(seed: int) -> Case:
    """One of many devices, from weak and light to strong and stiff."""
    random = np.random.default_rng(seed)
    peak = float(random.uniform(1.5, 6.0))
    dead = float(random.choice([0.0, 0.03]))
    return Case(
        SimulatedWheelParameters(
            inertia=0.02 * 5.0 ** float(random.random()),
            damping=float(random.uniform(0.01, 0.4)),
            friction=float(random.uniform(0.05, 0.5)) * min(1.0, peak / 3.0),
            torque_curve=curve(peak, float(random.uniform(0.7, 1.4)), dead),
            angle_sign=float(random.choice([-1.0, 1.0])),
            torque_sign=float(random.choice([-1.0, 1.0])),
            latency=int(random.integers(2, 30)),
        ),
        peak,
    )


def calibrated(
    device: SimulatedWheelParameters,
    reference: Reference,
    opened: WheelCalibration | None = None,
    hands: User | None = None,
    parameters: ExcitationParameters = BRIEF,
) -> SelfTestResult:
    """Calibrate a device, in simulated time."""
    raw = opened or uncalibrated("w", device.full_range, device.angle_sign)
    wheel = SimulatedWheel(device, raw, hands or no_hands)
    dt = 1.0 / reading_rate(wheel)
    return run_procedure(
        wheel,
        calibrate(raw, reference, dt, parameters),
        wait=lambda: None,
        tell=hands.listen if hands else lambda text: None,
    )


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_device_is_found_whatever_it_is(seed: int) -> None:
    device, peak = drawn(seed)
    found = calibrated(device, Reference(peak_torque=peak, turns=False)).calibration
    truth = true_calibration(device)
    # Of 40 such devices, pushed for 6 s, the worst were off by: inertia 0.7 %, damping
    # 0.004, friction 0.02 N·m, latency 0.15 ms, torque 3 % of the largest.
    assert found.torque_sign == truth.torque_sign
    assert found.inertia == pytest.approx(truth.inertia, rel=0.015)
    assert found.damping == pytest.approx(truth.damping, abs=0.006)
    assert found.friction == pytest.approx(truth.friction, abs=0.03)
    assert found.latency == pytest.approx(truth.latency, abs=0.0003)
    for torque in np.linspace(0.1, 1.0, 10) * found.torque_curve[-1][1]:
        asked = device_command(found, float(torque))
        given = math.copysign(
            np.interp(abs(asked), *zip(*truth.torque_curve, strict=True)),
            asked * truth.torque_sign,
        )
        assert given == pytest.approx(torque, abs=0.04 * peak)


@pytest.mark.parametrize("angle_sign", [-1.0, 1.0])
def test_the_turns_give_the_side_and_the_range(angle_sign: float) -> None:
    device = SimulatedWheelParameters(
        full_range=math.radians(540.0), angle_sign=angle_sign, torque_sign=-angle_sign
    )
    user = User(device)
    # It was opened as if it turned over 900 deg, with the other side for one sign.
    found = calibrated(
        device,
        Reference(peak_torque=2.2, lock_to_lock=math.radians(540.0)),
        opened=uncalibrated("w", math.radians(900.0)),
        hands=user,
    ).calibration
    assert user.heard[1:5] == [LEFT, RIGHT, BACK, HANDS_OFF]
    assert found.angle_sign == angle_sign
    assert found.torque_sign == -angle_sign
    # A turn counts as ended within 1.5 deg of its end, twice.
    assert found.full_range == pytest.approx(device.full_range, rel=0.006)
    assert found.inertia == pytest.approx(device.inertia, rel=0.03)
    assert found.damping == pytest.approx(device.damping, abs=0.02)


def test_only_a_senso_wheels_axis_grows_to_the_left() -> None:
    sides = [known_angle_sign(kind) for kind in ("sdl", "hid", "simulated", "senso")]
    assert sides == [-1.0, -1.0, -1.0, 1.0]


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_weight_gives_the_scale(side: float) -> None:
    device = SimulatedWheelParameters(friction=0.2)
    weight = Weight(mass=0.5, radius=0.14)
    user = User(device, pull=side * 0.5 * 9.81 * 0.14)
    found = calibrated(device, Reference(weight=weight, turns=False), hands=user)
    # Friction cancels over whole swings but for the swing's ends, where it sticks.
    assert found.calibration.torque_curve[-1][1] == pytest.approx(2.2, rel=0.03)
    assert found.calibration.friction == pytest.approx(0.2, rel=0.06)


def test_a_wheel_is_brought_to_its_middle_before_the_weight() -> None:
    # So light and free that the pushes leave it far away.
    device = SimulatedWheelParameters(friction=0.03, damping=0.01)
    user = User(device, pull=0.5 * 9.81 * 0.14)
    reference = Reference(weight=Weight(mass=0.5, radius=0.14), turns=False)
    found = calibrated(device, reference, hands=user).calibration
    before = user.heard[1 : user.heard.index(HANG)]
    assert before[:2] == [HANDS_OFF, BACK]
    assert before[-1] == HANDS_OFF
    assert found.torque_curve[-1][1] == pytest.approx(2.2, rel=0.03)


@pytest.mark.parametrize(
    ("pull", "told"), [(1.9, "turns the wheel|too heavy"), (0.0, "too li")]
)
def test_a_weight_that_cannot_be_weighed_is_refused(pull: float, told: str) -> None:
    device = SimulatedWheelParameters(torque_curve=((0.0, 0.0), (1.0, 1.5)))
    weight = Weight(mass=1.0, radius=0.14)
    with pytest.raises(SelfTestStopped, match=told):
        calibrated(
            device, Reference(weight=weight, turns=False), hands=User(device, pull)
        )


class Stuck(User):
    """Hands that hold the wheel, from some time on."""

    def __init__(self, device: SimulatedWheelParameters, since: float) -> None:
        super().__init__(device)
        self._from = since

    def __call__(self, time: float, angle: float, rate: float) -> float:
        """Torque of the hands [N·m]."""
        return -40.0 * angle - 4.0 * rate if time > self._from else 0.0


@pytest.mark.parametrize(
    ("since", "told"), [(0.0, "does not move at 60% of its command"), (6.0, "is held")]
)
def test_hands_on_the_wheel_stop_the_test(since: float, told: str) -> None:
    device = SimulatedWheelParameters(torque_curve=((0.0, 0.0), (1.0, 0.4)))
    hands = Stuck(device, since)
    with pytest.raises(SelfTestStopped, match=told):
        calibrated(device, Reference(peak_torque=0.4, turns=False), hands=hands)


class Held(User):
    """Hands that hold the wheel and feel how strongly it pushes."""

    def __init__(self, device: SimulatedWheelParameters) -> None:
        super().__init__(device)
        self.felt = 0.0

    def __call__(self, time: float, angle: float, rate: float) -> float:
        """Torque of the hands [N·m]."""
        held = -400.0 * angle - 8.0 * rate
        self.felt = max(self.felt, abs(held))
        return held


STRONG = SimulatedWheelParameters(torque_curve=((0.0, 0.0), (1.0, 25.0)), damping=0.5)


def test_a_strong_wheel_that_is_held_gets_two_newton_metres() -> None:
    hands = Held(STRONG)
    with pytest.raises(SelfTestStopped, match="at 8% of its command: let it go"):
        calibrated(STRONG, Reference(peak_torque=25.0, turns=False), hands=hands)
    # Less its friction of 0.1 N·m.
    assert hands.felt == pytest.approx(1.9, abs=0.1)


def test_a_strong_wheel_that_is_held_gets_no_more_in_its_test() -> None:
    hands, stored = Held(STRONG), true_calibration(STRONG)
    wheel = SimulatedWheel(STRONG, opened_for_test(stored), hands)
    with pytest.raises(SelfTestStopped, match="at 8% of its command"):
        run_procedure(wheel, compare(stored, DT), lambda: None, lambda text: None)
    assert hands.felt == pytest.approx(1.9, abs=0.1)


def test_a_wheel_of_the_table_is_pushed_as_gently_with_a_weight() -> None:
    senso = STRONG._replace(torque_curve=((0.0, 0.0), (1.0, 8.0)))
    opened = uncalibrated("senso-7", senso.full_range, senso.angle_sign)
    reference = Reference(weight=Weight(1.0, 0.14), turns=False)
    with pytest.raises(SelfTestStopped, match="at 25% of its command"):
        calibrated(senso, reference, opened, Held(senso))


class Shaking(User):
    """Somebody who moves the wheel although nobody should."""

    def __call__(self, time: float, angle: float, rate: float) -> float:
        """Torque of the hands [N·m]."""
        return 1.5 * math.sin(9.0 * time) - 2.0 * angle if time > 4.0 else 0.0


def test_somebody_who_moves_the_wheel_spoils_the_test() -> None:
    device = SimulatedWheelParameters()
    with pytest.raises(SelfTestStopped, match=r"explain|does not come to rest"):
        calibrated(
            device, Reference(peak_torque=2.2, turns=False), hands=Shaking(device)
        )


class Falling(User):
    """A wheel that is pulled to one side."""

    def __call__(self, time: float, angle: float, rate: float) -> float:
        """Torque of the hands [N·m]."""
        return 3.0 if time > 5.0 else 0.0


def test_a_wheel_that_goes_too_far_is_let_go() -> None:
    device = SimulatedWheelParameters()
    raw = uncalibrated("w", device.full_range)
    wheel = SimulatedWheel(device, raw, Falling(device))
    with pytest.raises(SelfTestStopped, match=r"too far|too fast"):
        run_procedure(
            wheel,
            calibrate(raw, Reference(peak_torque=2.2, turns=False), DT, BRIEF),
            wait=lambda: None,
            tell=lambda text: None,
        )
    for _ in range(device.latency + 1):
        wheel.read()
    assert wheel.motor_torque == 0.0


def test_a_harsh_device_is_never_pushed_with_all_it_has() -> None:
    strong = SimulatedWheelParameters(torque_curve=((0.0, 0.0), (1.0, 25.0)))
    found = calibrated(strong, Reference(peak_torque=25.0, turns=False))
    highest = found.calibration.torque_curve[-1]
    assert highest[0] <= 0.6  # 25 N·m on 0.04 kg·m² reach 250 rad/s² at 0.4
    # Its curve is straight, so the share of the peak is right.
    assert highest[1] == pytest.approx(25.0 * highest[0], rel=0.01)
    assert "never sent" in found.notes[0]


def test_a_wheel_that_saturates_has_its_peak_where_it_saturates() -> None:
    full_from_half = ((0.0, 0.0), (0.5, 2.2), (1.0, 2.2))
    device = SimulatedWheelParameters(torque_curve=full_from_half)
    found = calibrated(device, Reference(peak_torque=2.2, turns=False))
    highest = found.calibration.torque_curve[-1]
    assert highest[0] < 1.0
    assert highest[1] == pytest.approx(2.2, rel=0.01)
    # As a device with a straight curve.
    assert found.calibration.inertia == pytest.approx(device.inertia, rel=0.015)
    assert f"above {highest[0]:g} add nothing" in found.notes[0]
    assert not any("share of the peak" in words for words in found.notes)


def test_a_wheel_that_is_lost_is_told_as_lost() -> None:
    device = SimulatedWheelParameters(unplug_at=2.0)
    with pytest.raises(WheelLost):
        calibrated(device, Reference(peak_torque=2.2, turns=False))


def test_a_wheel_that_says_the_same_for_ever_stops_the_test() -> None:
    device = SimulatedWheelParameters(freeze_at=2.0)
    with pytest.raises(SelfTestStopped, match="nothing new"):
        calibrated(device, Reference(peak_torque=2.2, turns=False))


def test_a_wheel_without_an_angle_stops_the_test() -> None:
    device = SimulatedWheelParameters(angle_sign=math.nan)
    opened = uncalibrated("w", device.full_range)
    with pytest.raises(SelfTestStopped, match="does not tell its angle"):
        calibrated(device, Reference(peak_torque=2.2, turns=False), opened)


@pytest.mark.parametrize(
    ("reference", "told"),
    [
        (Reference(), "one reference"),
        (Reference(peak_torque=2.0, weight=Weight(1.0, 0.1)), "one reference"),
        (Reference(peak_torque=math.nan), "cannot be"),
        (Reference(peak_torque=-1.0), "cannot be"),
        (Reference(weight=Weight(0.0, 0.1)), "mass"),
        (Reference(weight=Weight(1.0, math.inf)), "radius"),
        (Reference(peak_torque=2.0, lock_to_lock=9.0, turns=False), "--no-turns"),
    ],
)
def test_a_reference_that_gives_no_scale_is_refused(
    reference: Reference, told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        calibrated(SimulatedWheelParameters(), reference)


def disagreeing(
    device: SimulatedWheelParameters, stored: WheelCalibration
) -> list[str]:
    """What a test finds wrong with a calibration."""
    wheel = SimulatedWheel(device, opened_for_test(stored))
    found = run_procedure(
        wheel, compare(stored, DT, BRIEF), lambda: None, lambda text: None
    )
    return [each.name for each in found if not agrees(each)]


def test_a_true_calibration_passes_its_test() -> None:
    device = drawn(3).device
    assert disagreeing(device, true_calibration(device)) == []


def test_a_wrong_calibration_is_found_out() -> None:
    device = SimulatedWheelParameters()
    stored = true_calibration(device)._replace(
        torque_sign=1.0,
        inertia=0.06,
        friction=0.3,
        latency=0.02,
        torque_curve=((0.0, 0.0), (0.5, 1.6), (1.0, 2.2)),
    )
    wrong = disagreeing(device, stored)
    assert wrong == ["direction", "inertia", "friction", "latency", "torque curve"]
