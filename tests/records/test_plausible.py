"""Values that do not look like SI units are noticed, with what would mend them."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest

from costeer.records.plausible import suspicions


@pytest.mark.parametrize(
    ("name", "value", "other", "factor"),
    [
        ("steering_wheel_angle", 90.0, "degrees", radians(1.0)),
        ("yaw_angle", 10.0, "degrees", radians(1.0)),
        ("longitudinal_velocity", 110.0, "km/h", 1.0 / 3.6),
        ("head_yaw", 45.0, "degrees instead of [-1, 1]", 1.0 / 90.0),
    ],
)
def test_values_that_are_not_si_are_noticed(
    name: str, value: float, other: str, factor: float
) -> None:
    (found,) = suspicions({name: np.array([0.0, np.nan, -value])})
    assert (found.column, found.factor) == (name, factor)
    assert f"{name} looks like {other}, expected " in found.words


@pytest.mark.parametrize("values", [[0.0, 0.9], [np.nan], []])
def test_plausible_values_are_not_suspected(values: list[float]) -> None:
    assert suspicions({"yaw_angle": np.array(values)}) == []


def test_small_angles_are_noticed_by_the_grip_they_would_need() -> None:
    # 5 degrees at 30 m/s are a bend; 5 radians would take 10 g.
    speed = np.full(3, 30.0)
    angle = np.array([0.0, 5.0, 0.0])
    degrees = {"steering_wheel_angle": angle, "longitudinal_velocity": speed}
    assert [each.column for each in suspicions(degrees)] == ["steering_wheel_angle"]
    assert suspicions(degrees | {"steering_wheel_angle": np.radians(angle)}) == []


def test_a_second_wrong_unit_is_noticed_beside_the_first() -> None:
    degrees = {
        "yaw_angle": np.array([0.0, 4.0, 0.0]),
        "steering_wheel_angle": np.array([0.0, 12.0, 0.0]),
        "longitudinal_velocity": np.full(3, 20.0),
    }
    found = {each.column for each in suspicions(degrees)}
    assert found == {"yaw_angle", "steering_wheel_angle"}
