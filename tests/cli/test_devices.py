"""Words of an option become a wheel, a head tracker, a number; or a clear refusal."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.cli import devices
from costeer.cli.devices import chosen_head, chosen_wheel, pseudonym_number
from costeer.devices.head.calibration import HeadCalibration, save_calibration
from costeer.devices.head.source import HeadDescription
from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.interface import WheelDescription
from costeer.devices.wheels.store import save_calibration as save_wheel

WHEEL = WheelDescription("sdl", "0", "Good wheel", "046d-c24f")


@pytest.fixture(autouse=True)
def _home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COSTEER_HOME", str(tmp_path))


def plug_in(monkeypatch: pytest.MonkeyPatch, *wheels: WheelDescription) -> None:
    found = list(wheels)
    monkeypatch.setattr(
        "costeer.devices.wheels.registry.found_wheels", lambda can="": found
    )


def calibrate() -> WheelCalibration:
    calibration = WheelCalibration(
        identity=WHEEL.identity, torque_curve=((0.0, 0.0), (1.0, 2.0)), inertia=0.03
    )
    save_wheel(calibration)
    return calibration


def test_calibrated_wheel_is_taken_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    plug_in(monkeypatch, WHEEL)
    calibration = calibrate()
    assert chosen_wheel("auto") == devices.ChosenWheel("wheel", WHEEL, calibration)
    assert chosen_wheel("1").description == WHEEL


def test_wheel_that_is_not_calibrated_is_left_to_lie_and_that_is_said(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plug_in(monkeypatch, WHEEL)
    assert chosen_wheel("auto") == devices.ChosenWheel("keyboard")
    assert "costeer wheel calibrate" in capsys.readouterr().err
    with pytest.raises(ValueError, match="not calibrated"):
        chosen_wheel("1")


@pytest.mark.parametrize(
    ("word", "told"),
    [("2", "0 wheels are plugged in"), ("joystick", "give auto, keyboard")],
)
def test_wheel_that_is_not_there_is_refused(
    monkeypatch: pytest.MonkeyPatch, word: str, told: str
) -> None:
    plug_in(monkeypatch)
    with pytest.raises(ValueError, match=told):
        chosen_wheel(word)


def test_simulated_wheel_needs_no_calibration() -> None:
    chosen = chosen_wheel("simulated")
    assert chosen.input == "wheel"
    assert chosen.calibration is not None


def test_participants_calibration_is_taken_with_its_tracker() -> None:
    tracker = HeadDescription("opentrack", "4242")
    known = HeadCalibration("P01", tracker, gain=1.2)
    save_calibration(known)
    assert chosen_head("calibrated", "P01") == known
    assert chosen_head("opentrack", "P01") == known
    assert chosen_head("none", "P01") is None


def test_what_was_told_of_the_tracker_at_its_calibration_still_holds() -> None:
    mirrored = HeadDescription("webcam", "0", mirrored=True)
    known = HeadCalibration("P01", mirrored, gain=1.2)
    save_calibration(known)
    assert chosen_head("webcam", "P01") == known


def test_tracker_without_a_calibration_is_taken_as_it_is(
    capsys: pytest.CaptureFixture[str],
) -> None:
    chosen = chosen_head("webcam:2", "P02")
    assert chosen == HeadCalibration("", HeadDescription("webcam", "2"))
    assert "costeer head calibrate" in capsys.readouterr().err


def test_calibration_of_another_tracker_is_not_taken(
    capsys: pytest.CaptureFixture[str],
) -> None:
    save_calibration(HeadCalibration("P01", HeadDescription("webcam", "0"), gain=1.2))
    assert chosen_head("lsl:SmartEye", "P01") == HeadCalibration(
        "", HeadDescription("lsl", "SmartEye")
    )
    assert "another head tracker" in capsys.readouterr().err


@pytest.mark.parametrize("word", ["camera", "lsl", "lsl:", ""])
def test_unknown_tracker_is_refused_with_the_known_ones(word: str) -> None:
    with pytest.raises(ValueError, match="give none, calibrated, webcam"):
        chosen_head(word, "P01")


def test_pseudonym_gives_its_number_or_always_the_same_one() -> None:
    assert pseudonym_number("P07") == 7
    assert pseudonym_number("12") == 12
    assert (
        pseudonym_number("blue") == pseudonym_number("blue") != pseudonym_number("red")
    )
    with pytest.raises(ValueError, match="pseudonym"):
        pseudonym_number("../etc")
