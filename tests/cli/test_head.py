"""`costeer head` calibrates a participant's tracker, and shows what it sees."""

from __future__ import annotations

import io
import math
import time
from pathlib import Path

import pytest

from costeer.cli.errors import exit_code_of
from costeer.cli.group import load_command
from costeer.devices.head import looks, registry
from costeer.devices.head.calibration import (
    HeadCalibration,
    load_calibration,
    save_calibration,
)
from costeer.devices.head.source import HeadDescription, HeadLost, HeadReading
from tests.devices.head.films import film
from tests.devices.head.rendering import View, render

WEBCAM = HeadDescription("webcam", "0")


def run(*words: str) -> int:
    """The exit code of `costeer head` with these words."""
    command = load_command("costeer.cli", "head")
    return exit_code_of(
        lambda: command.main(list(words), prog_name="head", standalone_mode=False)
    )


class Keyboard(io.StringIO):
    """Somebody who presses Enter when asked, and turns the head."""

    presses = 0

    def readline(self, size: int | None = -1, /) -> str:
        """Press Enter."""
        self.presses += 1
        return "\n"


class Participant:
    """A tracker that sees somebody who does as asked, 4 deg off and 20 % short."""

    def __init__(self, keyboard: Keyboard, gain: float = 0.8) -> None:
        self._keyboard = keyboard
        self._gain = gain
        self.closed = False

    def read(self) -> HeadReading:
        """Ahead, left and right in turn."""
        time.sleep(0.002)
        asked_deg = (0.0, 0.0, 30.0, -30.0)[self._keyboard.presses]
        tracked = math.radians(self._gain * asked_deg + 4.0)
        return HeadReading(time.perf_counter(), tracked, True)

    def close(self) -> None:
        """Remember it."""
        self.closed = True


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's folder for this test, and looks that take no time."""
    monkeypatch.setenv("COSTEER_HOME", str(tmp_path))
    # Its own tests are in tests/devices/head/test_looks.py.
    monkeypatch.setattr(looks, "steady_yaw", quick_look)
    return tmp_path


def quick_look(source: Participant) -> float:
    """A look without waiting for a person."""
    return source.read().head_yaw


def sit_down(monkeypatch: pytest.MonkeyPatch, gain: float = 0.8) -> Participant:
    """Put a participant before every tracker and at the keyboard."""
    keyboard = Keyboard()
    somebody = Participant(keyboard, gain)
    monkeypatch.setattr("sys.stdin", keyboard)
    monkeypatch.setattr(registry, "open_head", lambda _: somebody)
    return somebody


def test_three_looks_become_the_participants_calibration(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], home: Path
) -> None:
    somebody = sit_down(monkeypatch)
    words = ["--lsl", "Eyes", "--unit", "rad", "--channel", "Yaw"]
    assert run("calibrate", "--participant", "P01", *words) == 0
    found = load_calibration("P01")
    assert found.tracker == HeadDescription("lsl", "Eyes", "Yaw", "rad")
    assert found.gain == pytest.approx(1.25)
    assert math.degrees(found.offset) == pytest.approx(-5.0)
    shown = capsys.readouterr()
    assert shown.out.splitlines() == [
        "P01: gain 1.25, offset -5.0 deg, largest misfit 0.0 deg",
        str(home / "heads" / "P01.json"),
    ]
    assert shown.err.count("press Enter") == 3
    assert somebody.closed


def test_the_angles_of_the_mirrors_can_be_said(monkeypatch: pytest.MonkeyPatch) -> None:
    sit_down(monkeypatch)
    words = ["--camera", "1", "--left", "36", "--right", "36"]
    assert run("calibrate", "--participant", "P01", *words) == 0
    assert load_calibration("P01").gain == pytest.approx(1.25 * 36 / 30)
    assert load_calibration("P01").tracker == HeadDescription("webcam", "1")


def test_a_refused_calibration_leaves_no_file(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], home: Path
) -> None:
    somebody = sit_down(monkeypatch, gain=-0.8)
    assert run("calibrate", "--participant", "P01") == 2
    assert "--mirrored" in capsys.readouterr().err
    assert list(home.iterdir()) == []
    assert somebody.closed


def test_without_a_keyboard_there_is_no_calibration(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    sit_down(monkeypatch)
    monkeypatch.setattr("sys.stdin", io.StringIO())
    assert run("calibrate", "--participant", "P01") == 2
    assert "nobody pressed Enter" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["dance"], "'dance' is no action; give calibrate or test"),
        (["calibrate"], "give --participant P"),
        (["calibrate", "--participant", "Jane Doe"], "is no pseudonym"),
        (["calibrate", "--participant", "P1", "--seconds", "3"], "--seconds"),
        (["test", "--left", "30"], "test does not use --left"),
        (["test", "--camera", "0", "--lsl", "Eyes"], "one of --camera"),
        (["test", "--channel", "Yaw"], "--channel need --lsl"),
        (["test", "--lsl", "Eyes", "--unit", "px"], "'px'; give rad or deg"),
        (["test", "--participant", "P09"], "head of participant P09 is not"),
        (["test", "--opentrack", "70000"], "is no port"),
        (["test", "--camera", "none.avi"], "no video file none.avi"),
        (["calibrate", "--participant", "P1", "--left", "5"], "from 10 to 60"),
    ],
)
def test_bad_words_are_refused_in_one_line(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*words) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1


def test_a_film_of_a_face_is_shown_with_rate_and_validity(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    face = film(tmp_path / "face.avi", [render(View(yaw_deg=20.0))] * 24)
    calibrated = HeadCalibration("P01", HeadDescription("webcam", str(face)), gain=1.1)
    save_calibration(calibrated)
    assert run("test", "--participant", "P01") == 0
    shown = capsys.readouterr()
    lines = shown.out.splitlines()
    yaw_deg = float(lines[0].split()[2])
    assert yaw_deg == pytest.approx(22.0, abs=4.0)
    assert "deg (left), " in lines[0]
    assert "readings per second" in lines[-1]
    assert "gives no picture" in shown.err  # the film is over before five seconds


def test_a_tracker_that_is_silent_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("test", "--opentrack", "0", "--seconds", "0.2") == 2
    assert "gave no two readings within 0.2 s" in capsys.readouterr().err


def test_another_kind_of_tracker_needs_another_calibration(
    capsys: pytest.CaptureFixture[str],
) -> None:
    save_calibration(HeadCalibration("P01", WEBCAM))
    assert run("test", "--participant", "P01", "--opentrack", "4242") == 2
    assert "was calibrated with webcam" in capsys.readouterr().err


def test_a_tracker_that_is_gone_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def absent(_: HeadDescription) -> Participant:
        raise HeadLost("camera 0 does not open; plug it in")

    monkeypatch.setattr(registry, "open_head", absent)
    assert run("test") == 2
    assert capsys.readouterr().err == "costeer: camera 0 does not open; plug it in\n"
