"""The head process keeps going while its tracker comes and goes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import pytest

from costeer.devices.head import process
from costeer.devices.head.calibration import HeadCalibration
from costeer.devices.head.source import HeadDescription, HeadLost, HeadReading

ANYTHING = HeadCalibration("P01", HeadDescription("webcam", "0"))
FULL = math.pi / 2.0


class Script:
    """A tracker that reads what is written, a lost one where None stands."""

    def __init__(self, words: list[HeadReading | None]) -> None:
        self._words = iter(words)
        self.closed = 0

    def read(self) -> HeadReading:
        """The next word."""
        word = next(self._words)
        if word is None:
            raise HeadLost("gone")
        return word

    def close(self) -> None:
        """Count."""
        self.closed += 1


class Stopped:
    """Is set after so many looks; waits not at all."""

    def __init__(self, looks: int) -> None:
        self._looks = looks

    def is_set(self) -> bool:
        """Whether it was looked at often enough."""
        self._looks -= 1
        return self._looks < 0

    def wait(self, timeout: float) -> bool:
        """Do not wait."""
        assert timeout > 0.0
        return self._looks <= 0


class Told(NamedTuple):
    """Keeps what a process tells."""

    readings: list[HeadReading]

    def put(self, time: float, head_yaw: float, valid: bool) -> None:
        """Keep it."""
        self.readings.append(HeadReading(time, head_yaw, valid))


def run(
    monkeypatch: pytest.MonkeyPatch, opened: Iterator[Script | None], looks: int
) -> tuple[list[HeadReading], list[bool]]:
    """What the process tells while trackers open in turn; None does not open."""

    def open_next(_: HeadDescription) -> Script:
        script = next(opened)
        if script is None:
            raise HeadLost("not there")
        return script

    monkeypatch.setattr(process, "open_head", open_next)
    told = Told([])
    lost: list[bool] = []
    process.run_head_process(ANYTHING, told, Stopped(looks), lost.append)
    return told.readings, lost


def test_a_lost_tracker_is_told_closed_and_opened_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first = Script([HeadReading(1.0, FULL / 2.0, True), None])
    second = Script([HeadReading(2.0, 0.0, False), HeadReading(3.0, 0.0, True)])
    found, lost = run(monkeypatch, iter([first, None, second]), 8)
    assert lost == [False, True, False]
    assert [reading.valid for reading in found] == [True, False, False, False, True]
    # Held while it is gone, and until the new one has seen the head.
    assert [r.head_yaw for r in found] == pytest.approx([0.5, 0.5, 0.5, 0.5, 0.0])
    assert first.closed == second.closed == 1


def test_a_tracker_that_is_never_there_is_told_as_not_valid(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found, lost = run(monkeypatch, iter([None, None, None]), 3)
    assert lost == [True, True, True]
    assert len(found) == 3
    assert not any(reading.valid for reading in found)
    assert all(reading.head_yaw == 0.0 for reading in found)
