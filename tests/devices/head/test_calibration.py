"""Three looks become a line, the line becomes the head yaw that the network knows."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.devices.head.calibration import (
    FitParameters,
    HeadCalibration,
    Look,
    LookParameters,
    calibrated,
    calibration_file,
    fit_calibration,
    load_calibration,
    save_calibration,
)
from costeer.devices.head.source import (
    NOTHING_SEEN,
    HeadDescription,
    HeadReading,
    aged,
    held,
)

WEBCAM = HeadDescription("webcam", "0")


def fit(*pairs_deg: tuple[float, float]) -> HeadCalibration:
    """Calibration from pairs of true and tracked yaw [deg]."""
    looks = [Look(*map(math.radians, pair)) for pair in pairs_deg]
    return fit_calibration(FitParameters(), "P01", WEBCAM, looks)


@given(gain=st.floats(0.6, 1.8), offset_deg=st.floats(-20.0, 20.0))
def test_a_straight_tracker_is_found_exactly(gain: float, offset_deg: float) -> None:
    usual = LookParameters()
    angles = [0.0, math.degrees(usual.left_yaw), math.degrees(usual.right_yaw)]
    found = fit(*[(angle, (angle - offset_deg) / gain) for angle in angles])
    assert found.gain == pytest.approx(gain, rel=1e-9)
    assert math.degrees(found.offset) == pytest.approx(offset_deg, abs=1e-9)
    assert found.misfit == pytest.approx(0.0, abs=1e-9)
    for angle in (-40.0, 0.0, 25.0):
        tracked = math.radians((angle - offset_deg) / gain)
        yaw = calibrated(found, HeadReading(1.0, tracked, True)).head_yaw
        assert yaw == pytest.approx(angle / 90.0, abs=1e-9)


def test_the_default_looks_are_one_left_and_one_right() -> None:
    assert LookParameters().left_yaw > 0.0 > LookParameters().right_yaw


def test_a_tracker_that_counts_the_other_way_is_refused_with_the_way_out() -> None:
    with pytest.raises(ValueError, match="--mirrored"):
        fit((0.0, 0.0), (30.0, -28.0), (-30.0, 27.0))


@pytest.mark.parametrize(
    ("looks", "told"),
    [
        (((0.0, 0.0), (30.0, 1.0), (-30.0, -1.0)), "less than 5 deg"),
        (((0.0, 0.0), (30.0, math.nan), (-30.0, -1.0)), "less than 5 deg"),
        (((0.0, 0.0), (30.0, 10.0), (-30.0, -10.0)), "3.00 times"),
        (((0.0, 0.0), (10.0, 30.0), (-10.0, -30.0)), "0.33 times"),
        (((0.0, 25.0), (30.0, 26.0), (-30.0, -25.0)), "off the line"),
    ],
)
def test_looks_that_cannot_be_are_refused(
    looks: tuple[tuple[float, float], ...], told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        fit(*looks)


@given(st.floats(allow_nan=True, allow_infinity=True), st.booleans())
def test_head_yaw_stays_in_its_range(tracked: float, valid: bool) -> None:
    calibration = HeadCalibration("P01", WEBCAM, offset=0.1, gain=1.3)
    reading = calibrated(calibration, HeadReading(0.0, tracked, valid))
    assert -1.0 <= reading.head_yaw <= 1.0
    assert reading.valid == (valid and math.isfinite(1.3 * tracked))


def test_a_calibration_comes_back_from_its_file(tmp_path: Path) -> None:
    stream = HeadDescription("lsl", "Eyes", "HeadYaw", "rad", "Quality", mirrored=True)
    written = HeadCalibration("P-07_b", stream, offset=-0.12, gain=1.17, misfit=0.01)
    path = save_calibration(written, tmp_path)
    assert path == tmp_path / "heads" / "P-07_b.json"
    assert load_calibration("P-07_b", tmp_path) == written
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


def test_only_numbers_and_the_trackers_name_are_stored(tmp_path: Path) -> None:
    path = save_calibration(HeadCalibration("P01", WEBCAM), tmp_path)
    stored = json.loads(path.read_text("utf-8"))
    assert set(stored) == {
        "version",
        "participant",
        "tracker",
        "offset",
        "gain",
        "misfit",
    }


def test_the_users_folder_is_where_it_lies(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COSTEER_HOME", str(tmp_path / "home"))
    assert calibration_file("P01") == tmp_path / "home" / "heads" / "P01.json"


@pytest.mark.parametrize("name", ["", "../P01", "a/b", "Jane Doe", "P" * 41, "-P", "ä"])
def test_a_pseudonym_is_plain(name: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="pseudonym"):
        load_calibration(name, tmp_path)
    with pytest.raises(ValueError, match="pseudonym"):
        save_calibration(HeadCalibration(name, WEBCAM), tmp_path)


def test_a_missing_calibration_says_how_to_make_it(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="costeer head calibrate --participant P09"):
        load_calibration("P09", tmp_path)


@pytest.mark.parametrize(
    "change",
    [
        {"version": 2},
        {"gain": None},
        {"gain": math.nan},
        {"gain": 0.0},
        {"gain": 9e18},
        {"gain": -1.0},
        {"offset": 3.0},
        {"tracker": {"camera": 1}},
        {"tracker": 3},
        {"height": 1.8},
    ],
)
def test_a_damaged_file_is_refused(tmp_path: Path, change: dict[str, object]) -> None:
    path = save_calibration(HeadCalibration("P01", WEBCAM), tmp_path)
    stored = json.loads(path.read_text("utf-8"))
    path.write_text(json.dumps(stored | change), encoding="utf-8")
    with pytest.raises(ValueError, match="not a calibration of this costeer"):
        load_calibration("P01", tmp_path)


def test_a_file_of_another_participant_is_refused(tmp_path: Path) -> None:
    path = save_calibration(HeadCalibration("P02", WEBCAM), tmp_path)
    path.rename(path.with_name("P01.json"))
    with pytest.raises(ValueError, match="is of participant P02, not of P01; run"):
        load_calibration("P01", tmp_path)


@pytest.mark.parametrize("text", ["", "[]", "{}", "{"])
def test_a_file_that_is_something_else_is_refused(tmp_path: Path, text: str) -> None:
    path = save_calibration(HeadCalibration("P01", WEBCAM), tmp_path)
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match="not a calibration of this costeer"):
        load_calibration("P01", tmp_path)


def test_an_old_reading_is_not_valid_and_keeps_its_angle() -> None:
    reading = HeadReading(time=10.0, head_yaw=0.3, valid=True)
    assert aged(reading, 10.19) == reading
    assert aged(reading, 10.21) == HeadReading(10.0, 0.3, False)
    assert not aged(NOTHING_SEEN, 0.0).valid


def test_a_lost_head_holds_the_last_angle_not_zero() -> None:
    last = HeadReading(time=1.0, head_yaw=0.4, valid=True)
    lost = held(last, HeadReading(2.0, 0.0, False))
    assert lost == HeadReading(2.0, 0.4, False)
    seen = HeadReading(3.0, -0.1, True)
    assert held(lost, seen) == seen
