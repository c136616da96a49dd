"""Columns that contradict each other are named, with what mends them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from costeer.records.contradictions import (
    Lanes,
    contradictions,
    joined,
    lanes_of,
    unwrapped,
)
from tests.training.synthetic import columns as made


def drive(**changes: Any) -> dict[str, np.ndarray]:
    """A drive on two lanes with every column that can contradict another."""
    columns = made(1)
    time, yaw = columns["time"], columns["yaw_angle"]
    speed = columns["longitudinal_velocity"]
    rate = np.gradient(time)
    columns["lateral_position"] = np.cumsum(speed * yaw * rate)
    columns["longitudinal_position"] = np.cumsum(speed * rate)
    columns["yaw_rate"] = np.gradient(yaw, time)
    columns["steering_wheel_angle"] = 16.0 * 2.7 * columns["yaw_rate"] / speed
    columns["steering_wheel_rate"] = np.gradient(columns["steering_wheel_angle"], time)
    columns["lane"] = (columns["lateral_position"] > -1.75).astype(np.int8)
    return columns | {k: f(columns[k]) for k, f in changes.items()}


def test_a_drive_in_si_units_contradicts_nothing() -> None:
    assert contradictions(drive()) == []
    centimetres = drive(lateral_position=lambda y: np.round(y, 2))
    assert contradictions(centimetres) == []


def flipped(values: np.ndarray) -> np.ndarray:
    return -values


@pytest.mark.parametrize(
    ("name", "other"),
    [
        ("yaw_angle", "lateral_position"),
        ("steering_wheel_angle", "yaw_angle"),
        ("steering_wheel_rate", "steering_wheel_angle"),
        ("yaw_rate", "yaw_angle"),
    ],
)
def test_another_sign_is_noticed(name: str, other: str) -> None:
    found = contradictions(drive(**{name: flipped}))
    assert any(f"{name} and {other} contradict each other in sign" in n for n in found)
    assert f"--scale {name}=-1 or --scale {other}=-1" in found[0] + found[-1]


@pytest.mark.parametrize(
    "name", ["yaw_angle", "steering_wheel_angle", "steering_wheel_rate", "yaw_rate"]
)
def test_degrees_are_noticed_however_small(name: str) -> None:
    told = contradictions(drive(**{name: np.degrees}))
    from costeer.records.plausible import suspicions

    told += [each.words for each in suspicions(drive(**{name: np.degrees}))]
    assert any(f"{name} looks like degrees" in note for note in told)


@pytest.mark.parametrize(
    ("unit", "factor"), [("km/h", 3.6), ("mph", 1.0 / 0.44704), ("one of them", 1.7)]
)
def test_a_speed_that_the_positions_contradict_is_noticed(
    unit: str, factor: float
) -> None:
    slow = drive(longitudinal_position=lambda x: x / factor)
    assert any(unit in note for note in contradictions(slow))


def test_a_position_from_the_lane_driven_in_is_noticed_and_joined() -> None:
    columns = drive()
    whole = columns["lateral_position"]
    own = np.where(whole < -1.75, whole + 3.5, whole)
    (note,) = contradictions(columns | {"lateral_position": own})
    assert "lateral_position jumps by 3.4" in note
    assert "--join-lanes" in note
    again = joined(columns | {"lateral_position": own})["lateral_position"]
    np.testing.assert_allclose(again, whole, atol=1e-9)


def test_a_lane_that_the_position_contradicts_is_noticed() -> None:
    found = contradictions(drive(lane=lambda lane: 1 - lane))
    assert any("lane and lateral_position contradict" in note for note in found)


THREE = Lanes(width=3.0, number=3)


def on_three_lanes() -> dict[str, np.ndarray]:
    """The drive scaled to lanes of 3 m: from the middle lane to the right and back."""
    columns = drive(lateral_position=lambda y: y * 3.0 / 3.5 - 3.0)
    columns["yaw_angle"] = columns["yaw_angle"] * 3.0 / 3.5
    for name in ("yaw_rate", "steering_wheel_angle", "steering_wheel_rate"):
        columns[name] = columns[name] * 3.0 / 3.5
    columns["lane"] = (columns["lateral_position"] > -4.5).astype(np.int8)
    return columns


def test_lanes_of_another_road_contradict_nothing() -> None:
    columns = on_three_lanes()
    assert set(columns["lane"]) == {0, 1}
    assert contradictions(columns, THREE) == []
    assert contradictions(columns)  # on the paper's road they would
    (note,) = contradictions(columns | {"lane": columns["lane"] + 1}, THREE)
    assert "0 right, 2 left" in note


def test_a_position_is_joined_over_the_lanes_of_its_road() -> None:
    columns = on_three_lanes()
    whole = columns["lateral_position"]
    own = whole + np.where(whole > -4.5, 3.0, 6.0)
    (note,) = contradictions(columns | {"lateral_position": own}, THREE)
    assert "jumps by 2.9" in note
    again = joined(columns | {"lateral_position": own}, THREE)["lateral_position"]
    np.testing.assert_allclose(again, whole, atol=1e-9)


@pytest.mark.parametrize(
    ("about", "lanes"),
    [
        ({}, Lanes()),
        ({"scenario": {"road": {"lanes": 4, "lane_width": 3.2}}}, Lanes(3.2, 4)),
        ({"configuration": {"road": {"num_lanes": 3.0}}}, Lanes(3.5, 3)),
        (
            {
                "scenario": {"road": {"lanes": 4, "lane_width": 3.2}},
                "configuration": {"road": {"num_lanes": 4.0, "lane_width": 3.0}},
            },
            Lanes(3.0, 4),
        ),
        ({"scenario": {"road": {"lanes": "many", "lane_width": -1}}}, Lanes()),
        ({"scenario": 7, "configuration": [1]}, Lanes()),
    ],
)
def test_a_record_says_its_lanes(about: dict[str, Any], lanes: Lanes) -> None:
    assert lanes_of(about) == lanes


def test_a_yaw_from_0_to_2_pi_is_unwrapped() -> None:
    columns = drive()
    round_about = {"yaw_angle": columns["yaw_angle"] % (2.0 * np.pi)}
    found, notes = unwrapped(columns | round_about)
    np.testing.assert_allclose(found["yaw_angle"], columns["yaw_angle"], atol=1e-12)
    assert notes == ["yaw_angle runs from 0 to 2 pi: taken as -pi to pi"]
    assert unwrapped(columns)[1] == []


@pytest.mark.parametrize("num_rows", [0, 1, 2, 3, 5])
def test_few_rows_contradict_nothing(num_rows: int) -> None:
    assert contradictions({k: v[:num_rows] for k, v in drive().items()}) == []
