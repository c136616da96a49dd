"""Columns are declared once, and a declaration says what the world does."""

from __future__ import annotations

import pytest

from costeer.records.columns import COLUMNS, Column, with_method_columns

INTEGRAL = Column(
    "method_integral", "m·s", "float64", "of the error", "method.integral"
)


def names(**wanted: object) -> set[str]:
    return {
        column.name
        for column in COLUMNS
        if all(getattr(column, field) == value for field, value in wanted.items())
    }


def test_columns_are_those_of_the_public_format_in_its_order() -> None:
    # As the format was published, before columns were declared once; what came later
    # stands at the end.
    published = """
    time longitudinal_position lateral_position lane target_lane yaw_angle yaw_rate
    longitudinal_velocity longitudinal_acceleration lateral_velocity
    lateral_acceleration steering_wheel_angle steering_wheel_rate driver_torque
    estimated_driver_torque instructed_torque applied_torque haptic_gain head_yaw
    distance_to_adjacent_lane lateral_error heading_error_rate guidance_pseudo_work
    driver_pseudo_work torque_agreement consistent crossing_probability intention mode
    event driver_intention lead_distance lead_velocity lead_lane
    target_lateral_position head_yaw_valid accelerator brake torque_fault road_curvature
    contact driver_indicator crossing_side
    """
    assert [column.name for column in COLUMNS] == published.split()


def test_flags_numbers_of_lanes_and_modes_are_drawn_as_steps() -> None:
    stepped = """
    lane target_lane consistent intention mode event driver_intention lead_lane
    head_yaw_valid torque_fault contact driver_indicator crossing_side
    """
    assert names(stepped=True) == set(stepped.split())


def test_every_column_comes_from_a_place_of_its_own() -> None:
    sources = [column.source for column in COLUMNS]
    assert len(set(sources)) == len(sources)


def test_columns_of_a_method_follow_those_of_every_record() -> None:
    assert with_method_columns([INTEGRAL]) == (*COLUMNS, INTEGRAL)
    assert with_method_columns([]) == COLUMNS


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": "integral"}, "'integral' of the method must be named 'method_'"),
        ({"name": "method_a b"}, "must be named 'method_' and then letters"),
        ({"name": "method_first"}, "'method_first' of the method is declared twice"),
        ({"kind": "float32"}, "kind 'float32'; choose from float64, int8, bool, str"),
        (
            {"mirrored": "odd"},
            "mirrored 'odd'; choose from same, flipped, swapped, reflected",
        ),
        ({"kind": "string"}, "needs labels if it is a string"),
        ({"labels": ("off", "on")}, "has none if it is not"),
    ],
)
def test_a_column_that_no_method_can_have_is_refused(
    changes: dict[str, str], message: str
) -> None:
    first = INTEGRAL._replace(name="method_first")
    with pytest.raises(ValueError, match=message):
        with_method_columns([first, INTEGRAL._replace(**changes)])  # type: ignore[arg-type]  # wrong on purpose
