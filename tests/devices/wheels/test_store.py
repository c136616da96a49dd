"""A calibration lies on disk whole or not at all; trouble is told with a way out."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

from costeer.devices.wheels.calibration import WheelCalibration
from costeer.devices.wheels.interface import WheelDescription
from costeer.devices.wheels.store import (
    calibration_path,
    load_calibration,
    save_calibration,
    stored_calibrations,
)

G29 = WheelDescription(kind="hid", address="x", name="G29", identity="046d-c24f")
FOUND = WheelCalibration(
    identity="046d-c24f",
    angle_sign=-1.0,
    torque_curve=((0.0, 0.0), (0.05, 0.01), (1.0, 2.2)),
    inertia=0.031,
    latency=0.0123,
    accelerator_axis=2,
)


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("COSTEER_HOME", str(tmp_path / "home"))
    return tmp_path / "home"


def spoiled(**changes: Any) -> None:  # Any: whatever a file may hold
    path = save_calibration(FOUND)
    content = json.loads(path.read_text("utf-8")) | changes
    path.write_text(json.dumps(content), "utf-8")


def test_what_was_saved_is_loaded(home: Path) -> None:
    path = save_calibration(FOUND)
    assert path == home / "wheels" / "046d-c24f.json"
    assert load_calibration(G29) == FOUND
    assert list(path.parent.iterdir()) == [path]  # nothing half-written stays


def test_a_wheel_without_a_calibration_is_told_what_to_run() -> None:
    with pytest.raises(ValueError, match="G29 is not calibrated; run: costeer wheel"):
        load_calibration(G29)
    assert stored_calibrations() == ([], [])


def test_a_later_calibration_replaces_the_former() -> None:
    save_calibration(FOUND)
    save_calibration(FOUND._replace(inertia=0.05))
    assert load_calibration(G29).inertia == 0.05


def test_a_write_that_fails_leaves_the_former(monkeypatch: pytest.MonkeyPatch) -> None:
    path = save_calibration(FOUND)

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        save_calibration(FOUND._replace(inertia=0.05))
    assert load_calibration(G29) == FOUND
    assert list(path.parent.iterdir()) == [path]


def test_an_impossible_calibration_is_not_kept() -> None:
    with pytest.raises(ValueError, match="inertia"):
        save_calibration(FOUND._replace(inertia=-1.0))
    assert not calibration_path(FOUND.identity).exists()


@pytest.mark.parametrize(
    "text",
    [
        *("", "{", "[]", "null", '"x"', '{"format": 2}', '{"format": 1}'),
        *("[" * 50_000, "\0", "1e999", " " * 200_000),
    ],
    ids=lambda text: text[:14].strip() or "blank",
)
def test_a_damaged_file_is_told_what_to_run(text: str) -> None:
    path = save_calibration(FOUND)
    path.write_text(text, "utf-8")
    with pytest.raises(ValueError, match=r"damaged \(.+\); run: costeer wheel cal"):
        load_calibration(G29)


def test_bytes_that_are_no_text_are_damage() -> None:
    save_calibration(FOUND).write_bytes(b"\xff\xfe\x80")
    with pytest.raises(ValueError, match="it is not JSON"):
        load_calibration(G29)


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("inertia", "0.1", "inertia is not a number"),
        ("friction", True, "friction is not a number"),
        ("latency", float("nan"), "latency is nan"),
        ("latency", -1.0, "latency of wheel"),
        ("torque_curve", [[0, 0], [1]], "list of pairs"),
        ("torque_curve", 7, "list of pairs"),
        ("torque_curve", [[0, 0], [1, None]], "torque_curve is not a number"),
        ("torque_curve", [[0, 0], [1, -1]], "torque_curve of wheel"),
        ("brake_axis", 1e300, "brake_axis of wheel"),
        ("angle_sign", 10**400, "too large"),
    ],
)
def test_a_value_of_the_wrong_kind_is_named(name: str, value: Any, told: str) -> None:
    spoiled(**{name: value})
    with pytest.raises(ValueError, match=told) as refused:
        load_calibration(G29)
    assert str(refused.value).count("costeer wheel calibrate") == 1


def test_a_calibration_of_another_wheel_is_refused() -> None:
    spoiled(identity="046d-c299")
    with pytest.raises(ValueError, match="is of wheel 046d-c299, not of G29"):
        load_calibration(G29)


@pytest.mark.parametrize("identity", ["../../etc/passwd", "A", "a b", "x" * 300, "ä"])
def test_any_identity_makes_a_file_inside_the_folder(home: Path, identity: str) -> None:
    path = save_calibration(FOUND._replace(identity=identity))
    assert path.parent == home / "wheels"
    assert load_calibration(G29._replace(identity=identity)).identity == identity


def test_names_that_differ_only_where_replaced_are_kept_apart() -> None:
    assert calibration_path("a b") != calibration_path("a_b") != calibration_path("a.b")


def test_the_list_tells_the_good_and_the_damaged() -> None:
    save_calibration(FOUND)
    save_calibration(FOUND._replace(identity="046d-c299"))
    calibration_path("broken").write_text("{", "utf-8")
    listed = stored_calibrations()
    identities = [each.identity for each in listed.calibrations]
    assert identities == ["046d-c24f", "046d-c299"]
    assert len(listed.damaged) == 1
    assert "broken.json" in listed.damaged[0]
