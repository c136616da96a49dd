"""Other readings of the paper: how they are set, compared and printed."""

from __future__ import annotations

import pytest

from benchmarks.readings import (
    CONDITIONS,
    HEADINGS,
    MEASURES,
    READINGS,
    by_condition,
    cell,
    change,
    row,
    settings_of,
)
from costeer.methods.conditions import MANUAL
from costeer.study.configuration import check_settings
from costeer.study.definitions import MeasureParameters

WEAK = CONDITIONS[1]


def means(value: float) -> dict[str, float]:
    return dict.fromkeys(MEASURES, value)


@pytest.mark.parametrize("reading", READINGS, ids=lambda each: each.name)
def test_each_reading_can_be_set_and_is_not_ours(reading) -> None:  # noqa: ANN001
    if reading.measures:
        assert MeasureParameters(**reading.measures) != MeasureParameters()
        return
    other = check_settings(settings_of(reading, 1))
    assert other.parameters or other.car != "default" or other.intention == "scripted"
    assert (MANUAL in other.conditions) is reading.changes_manual


def test_names_are_folders_of_their_own() -> None:
    assert len({each.name for each in READINGS}) == len(READINGS)
    assert len(HEADINGS) == len(MEASURES) - 1


def test_a_change_is_a_share_of_ours_and_of_disputes_a_difference() -> None:
    assert change(means(2.0), means(3.0), "sdlp") == pytest.approx(50.0)
    assert change(means(20.0), means(30.0), "disputed") == pytest.approx(10.0)


def test_a_lane_change_without_a_number_is_left_out() -> None:
    trial = {"condition": WEAK, "sdlp": 0.2, "swrr": 3.0, "driver_torque_rms": 0.3}
    change_row = {"condition": WEAK, "peak_steering_angle": 0.1, "duration": 4.0}
    changes = [
        {**change_row, "overshoot": "", "num_inconsistencies": 0},
        {**change_row, "overshoot": 0.3, "num_inconsistencies": 2},
    ]
    found = by_condition([trial], changes)[WEAK]
    assert found["overshoot"] == pytest.approx(0.3)
    assert found["disputed"] == pytest.approx(50.0)


def test_bold_is_what_all_seeds_agree_on() -> None:
    assert cell([6.0, 7.0, 8.0]) == "**+7 (+6 to +8)**"
    assert cell([-1.0, 7.0, 8.0]) == "+7 (-1 to +8)"
    assert cell([3.0, 4.0, 4.5]) == "+4 (+3 to +4)"
    assert cell([0.1, -0.2, 0.3]) == "0"
    assert cell([-0.4, -0.2, 3.0]) == "0 (0 to +3)"


def test_a_difference_from_manual_of_another_sign_is_named() -> None:
    base = [{MANUAL: means(2.0), WEAK: means(1.0)}]
    same = [{WEAK: means(1.5)}]
    other = [{WEAK: means(1.5) | {"swrr": 2.5}}]
    assert row(READINGS[0], base, same, WEAK).endswith("|  |")
    assert row(READINGS[0], base, other, WEAK).endswith("| reversals |")
