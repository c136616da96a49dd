"""Missing samples are bridged or left out, and named."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.records.columns import TrialRecord
from costeer.study.analysis import Analysis, analyse

TIME = np.arange(3600) / 60.0
WHOLE = {
    "time": TIME,
    "lateral_position": 0.2 * np.sin(TIME),
    "yaw_angle": 0.01 * np.cos(TIME),
    "steering_wheel_angle": 0.1 * np.sin(1.3 * TIME),
    "driver_torque": np.sin(TIME),
}


def measured(missing: dict[str, list[int]]) -> Analysis:
    columns = {name: values.copy() for name, values in WHOLE.items()}
    for name, rows in missing.items():
        columns[name][rows] = np.nan
    (found,) = analyse(TrialRecord({}, columns))
    return found


@pytest.mark.parametrize("length", [1, 10, 600])
@pytest.mark.parametrize("name", [n for n in WHOLE if n != "time"])
def test_measures_come_from_the_rest_and_the_gap_is_named(
    name: str, length: int
) -> None:
    whole, found = measured({}), measured({name: list(range(1000, 1000 + length))})
    for measure in ("sdlp", "swrr", "driver_torque_rms"):
        assert not found.measures[measure].reason
        expected = whole.measures[measure].value
        assert found.measures[measure].value == pytest.approx(expected, rel=0.12)
    (note,) = [note for note in found.notes if "samples are missing" in note]
    assert f"{name}: {length} of 3600 samples are missing, first in row 1000" in note
    left_out = 0 if length < 15 else length
    assert f"{left_out} samples in longer ones left out" in note


def test_a_column_without_a_value_is_named_as_before() -> None:
    found = measured({"steering_wheel_angle": list(range(3600))})
    assert "undefined throughout" in found.measures["swrr"].reason
