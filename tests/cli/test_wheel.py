"""`costeer wheel` lists, calibrates and tests, with a user in simulated time."""

from __future__ import annotations

import io
import json
import math
from pathlib import Path

import pytest

from costeer.cli import wheel_session
from costeer.cli.errors import exit_code_of
from costeer.cli.group import load_command
from costeer.devices.wheels import excitation, registry, selftest
from costeer.devices.wheels.calibration import WheelCalibration, uncalibrated
from costeer.devices.wheels.interface import WheelDescription, WheelReading
from costeer.devices.wheels.pedals import NO_PEDAL, PedalAxis, pressed_axis
from costeer.devices.wheels.simulated import SimulatedWheel, SimulatedWheelParameters
from costeer.devices.wheels.store import load_calibration, save_calibration
from costeer.runtime import clock
from tests.devices.wheels.user import User

G29 = WheelDescription("sdl", "0", "Logitech G29", "046d-c24f")
OTHER = WheelDescription("sdl", "1", "Unheard-of wheel", "1234-5678")
DEVICE = SimulatedWheelParameters(friction=0.2)


def run(*words: str) -> int:
    """The exit code of `costeer wheel` with these words."""
    command = load_command("costeer.cli", "wheel")
    return exit_code_of(
        lambda: command.main(list(words), prog_name="wheel", standalone_mode=False)
    )


class PedalWheel(SimulatedWheel):
    """A simulated wheel with pedals, which its user presses when asked."""

    def __init__(self, calibration: WheelCalibration, user: User) -> None:
        super().__init__(DEVICE, calibration, user)
        self._user = user
        self._asked = 0
        self.is_awake = True

    def axes(self) -> tuple[float, ...]:
        """Steering, clutch, accelerator and brake; a pressed one falls to -1."""
        self._asked += 1
        pressed = -1.0 if self._asked % 5 else 1.0
        accelerator = pressed if "accelerator" in self._user.heard[-1] else 1.0
        brake = pressed if "brake" in self._user.heard[-1] else 1.0
        return (0.0, 1.0, accelerator, brake)


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("COSTEER_HOME", str(tmp_path))
    brief = excitation.ExcitationParameters(duration=6.0)
    monkeypatch.setattr(excitation, "DEFAULTS", brief)
    monkeypatch.setattr(selftest, "TEST_PUSHES", brief)
    return tmp_path


@pytest.fixture
def user(monkeypatch: pytest.MonkeyPatch) -> User:
    """Two wheels are plugged in; their user listens, and no clock ticks."""
    person = User(DEVICE, pull=0.7)
    shown = wheel_session.note

    def listen(text: str) -> None:
        person.listen(text)
        shown(text)

    class NoPacer:
        def __init__(self, period: float) -> None:
            assert period == pytest.approx(1.0 / 960.0)

        def wait(self) -> float:
            return 0.0

    def opened(known: WheelDescription, calibration: WheelCalibration) -> PedalWheel:
        return PedalWheel(calibration, person)

    monkeypatch.setattr(registry, "found_wheels", lambda can="": [G29, OTHER])
    monkeypatch.setattr(registry, "open_wheel", opened)
    monkeypatch.setattr(clock, "Pacer", NoPacer)
    monkeypatch.setattr(wheel_session, "note", listen)
    monkeypatch.setattr(wheel_session, "PEDAL_TIME", 0.1)
    monkeypatch.setattr("sys.stdin", io.StringIO("\n"))
    return person


def test_a_simulated_wheel_is_calibrated_and_passes_its_test(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("calibrate", "--simulated") == 0
    told = capsys.readouterr()
    assert "0.0400" in told.out  # its inertia
    assert "explains 100.0%" in told.out
    assert "Take your hands off" in told.err
    stored = json.loads((home / "wheels" / "simulated.json").read_text("utf-8"))
    assert stored["torque_sign"] == -1.0
    assert run("test", "--simulated") == 0
    assert "differs" not in capsys.readouterr().out


def test_a_user_calibrates_a_wheel_with_pedals(
    user: User, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("calibrate") == 0
    found = load_calibration(G29)
    assert (found.angle_sign, found.torque_sign) == (-1.0, -1.0)
    assert found.torque_curve[-1][1] == 2.2  # of the table
    assert found.inertia == pytest.approx(DEVICE.inertia, rel=0.03)
    assert (found.accelerator_axis, found.accelerator_sign) == (2, -1.0)
    assert (found.brake_axis, found.brake_sign) == (3, -1.0)
    assert "2, 3" in capsys.readouterr().out
    asked = " ".join(user.heard)
    order = ["turn by itself", "accelerator", "brake", "to the left", "to the right"]
    places = [asked.index(words) for words in order]
    assert places == sorted(places)


class SleepingWheel(PedalWheel):
    """A wheel that is awake once its user has been asked to turn it."""

    def __init__(self, calibration: WheelCalibration, user: User) -> None:
        super().__init__(calibration, user)
        self.is_awake = False

    def read(self) -> WheelReading:
        """A reading, which wakes the wheel if it was turned."""
        self.is_awake = self.is_awake or "by 10 degrees" in self._user.heard[-1]
        return super().read()


@pytest.mark.slow
def test_a_wheel_that_is_asleep_is_turned_first(
    user: User, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(registry, "open_wheel", lambda _, raw: SleepingWheel(raw, user))
    assert run("calibrate", "--no-pedals") == 0
    asked = [text for text in user.heard if "Turn the wheel" in text]
    assert asked[0] == "Turn the wheel by 10 degrees and back."
    assert "to the left" in asked[1]
    user.heard = [""]
    monkeypatch.setattr("sys.stdin", io.StringIO("\n"))
    assert run("test") == 0
    assert user.heard[-2:] == [asked[0], "Take your hands off the wheel."]


@pytest.mark.parametrize("action", ["calibrate", "test"])
def test_a_wheel_that_nobody_wakes_is_not_pushed(
    action: str,
    user: User,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def opened(known: WheelDescription, calibration: WheelCalibration) -> PedalWheel:
        wheel = PedalWheel(calibration, user)
        wheel.is_awake = False
        return wheel

    save_calibration(uncalibrated(G29.identity))
    monkeypatch.setattr(registry, "open_wheel", opened)
    monkeypatch.setattr(wheel_session, "WAKE_TIME", 0.05)
    assert run(action) == 2
    assert "nobody turned the wheel within" in capsys.readouterr().err
    assert not any("hands" in text for text in user.heard)


def test_without_turns_a_wheel_is_not_mirrored(user: User) -> None:
    # Its axis grows to the right and a positive command pushes to the right.
    assert (DEVICE.angle_sign, DEVICE.torque_sign) == (-1.0, -1.0)
    assert run("calibrate", "--no-turns", "--no-pedals") == 0
    found = load_calibration(G29)
    assert (found.angle_sign, found.torque_sign) == (-1.0, -1.0)


@pytest.mark.slow
def test_a_weight_on_a_wheel_that_is_not_in_the_table(user: User) -> None:
    mass = 0.7 / 9.81 / 0.14  # what the user's weight of 0.7 N·m is
    words = ("--weight", f"{mass:.6f}", "--radius", "0.14", "--no-pedals")
    assert run("calibrate", "--device", "2", *words) == 0
    found = load_calibration(OTHER)
    # As tests/devices/wheels/test_selftest.py has it.
    assert found.torque_curve[-1][1] == pytest.approx(2.2, rel=0.03)
    assert found.accelerator_axis == found.brake_axis == -1


def test_a_wheel_that_changed_fails_its_test(
    user: User, capsys: pytest.CaptureFixture[str]
) -> None:
    # In the axis's own frame it pushes to the left.
    save_calibration(uncalibrated("046d-c24f")._replace(torque_sign=-1.0))
    assert run("test") == 2
    told = capsys.readouterr()
    assert "differs" in told.out
    assert "direction, " in told.err
    assert "costeer wheel calibrate" in told.err


def test_the_list_tells_what_is_calibrated(
    user: User, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save_calibration(uncalibrated(G29.identity))
    save_calibration(uncalibrated("at-home"))
    (home / "wheels" / "bad.json").write_text("{", "utf-8")
    assert run("list") == 0
    told = capsys.readouterr()
    assert "046d-c24f" in told.out
    assert "yes" in next(line for line in told.out.splitlines() if "G29" in line)
    assert "no" in next(line for line in told.out.splitlines() if "Unheard" in line)
    assert "not plugged in: at-home" in told.out
    assert "bad.json" in told.err


def test_without_wheels_the_list_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(registry, "found_wheels", lambda can="": [])
    assert run("list") == 0
    assert "No steering wheel" in capsys.readouterr().out
    assert run("test") == 2
    assert "--simulated" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("tune",), "'tune' is no action; give list, calibrate or test"),
        (("list", "--device", "1"), "list does not use --device"),
        (("test", "--no-turns"), "test does not use --no-turns"),
        (("calibrate", "--weight", "1"), "give --weight and --radius"),
        (("calibrate", "--radius", "0.1"), "give --weight and --radius"),
        (
            ("calibrate", "--weight=1", "--radius=0.1", "--peak-torque=2"),
            "not both",
        ),
        (("calibrate", "--range", "900", "--no-turns"), "leave --no-turns out"),
        (("test", "--simulated", "--device", "1"), "one of --device and --simulated"),
        (("calibrate", "--peak-torque", "nan"), "nan is not allowed"),
        (("calibrate", "--peak-torque", "1e9"), "from 0.1 to 50"),
        (("calibrate", "--device", "0"), "at least 1"),
        (("calibrate", "--device", "3"), "--device is 3, but there are 2"),
        (("calibrate", "--device", "2"), "peak torque of Unheard-of wheel"),
        (("calibrate", "--simulated", "--range", "900"), "nobody turns a simulated"),
        (("test",), "Logitech G29 is not calibrated; run: costeer wheel calibrate"),
    ],
)
def test_what_cannot_be_done_is_told_in_one_line(
    user: User, words: tuple[str, ...], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert told in line


def test_without_enter_the_wheel_does_not_move(
    user: User, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    assert run("calibrate") == 2
    assert "nobody pressed Enter" in capsys.readouterr().err


def test_a_pedal_is_the_axis_that_moved_most() -> None:
    released, pressed = (0.0, 1.0, 1.0, -1.0), (0.9, 0.6, -1.0, 0.2)
    rows = [released, pressed, released]
    assert pressed_axis(rows) == PedalAxis(2, -1.0)
    assert pressed_axis(rows, frozenset({2})) == PedalAxis(3, 1.0)
    assert pressed_axis(rows, frozenset({2, 3})) == NO_PEDAL  # the rest is too little
    assert pressed_axis([]) == NO_PEDAL
    assert math.copysign(1.0, NO_PEDAL.sign) == 1.0
