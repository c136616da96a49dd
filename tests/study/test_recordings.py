"""Foreign tables: names, units, stretches and sampling."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from costeer.study.recordings import Adaptation, stretches
from costeer.study.sampling import evened, sampling

TIME = np.arange(100) / 20.0


def table(**columns: Any) -> dict[str, np.ndarray]:
    return {"time": TIME, **columns}


def test_columns_are_renamed_then_scaled() -> None:
    columns = {"t": TIME * 1000, "deg": np.arange(100), "other": TIME}
    adaptation = Adaptation(
        renames={"t": "time", "deg": "steering_wheel_angle"},
        scales={"time": 0.001, "steering_wheel_angle": 0.5},
    )
    (stretch,) = stretches(columns, adaptation)
    np.testing.assert_allclose(stretch.columns["time"], TIME)
    np.testing.assert_array_equal(
        stretch.columns["steering_wheel_angle"], np.arange(100) / 2
    )
    assert stretch.ignored == ("other",)
    assert stretch.name == ""


def test_a_renamed_column_replaces_one_of_that_name() -> None:
    columns = table(yaw_angle=TIME, true_yaw=TIME + 1)
    (stretch,) = stretches(columns, Adaptation(renames={"true_yaw": "yaw_angle"}))
    np.testing.assert_array_equal(stretch.columns["yaw_angle"], TIME + 1)


def test_stretches_come_in_the_order_in_which_they_begin() -> None:
    part = np.where(np.arange(100) < 40, "b", "a")
    first, second = stretches(table(part=part), Adaptation(sequence="part"))
    assert (first.name, second.name) == ("b", "a")
    assert first.columns["time"].size == 40
    assert first.ignored == ()


def test_a_column_named_sequence_splits_by_itself() -> None:
    found = stretches(table(sequence=np.repeat([3, 1], 50)))
    assert [stretch.name for stretch in found] == ["3", "1"]


def test_whole_numbers_do_for_flags_and_lanes() -> None:
    lane = np.ones(100)
    gaps = np.where(np.arange(100) < 5, np.nan, 1.0)
    (stretch,) = stretches(
        table(lane=lane, intention=np.arange(100) % 2, consistent=gaps)
    )
    assert stretch.columns["lane"].dtype == np.int8
    assert stretch.columns["intention"].dtype == bool
    assert stretch.columns["consistent"].mask.sum() == 5


@pytest.mark.parametrize(
    ("columns", "adaptation", "message"),
    [
        ({"t": TIME}, Adaptation(), "no column 'time'.*--rename t=time.; there are t"),
        (table(), Adaptation(renames={"t": "time"}), "--rename t: there is no such"),
        (table(a=TIME), Adaptation(renames={"a": "wheel"}), "'wheel' is no column of"),
        (table(), Adaptation(scales={"yaw_angle": 2.0}), "--scale yaw_angle: there is"),
        (table(), Adaptation(scales={"time": np.inf}), "must be finite and not 0"),
        (table(), Adaptation(scales={"time": 0.0}), "must be finite and not 0"),
        (
            table(mode=np.full(100, "manual")),
            Adaptation(scales={"mode": 2.0}),
            "holds no numbers",
        ),
        (table(), Adaptation(sequence="part"), "--sequence part: there is no such"),
        (
            table(yaw_angle=np.full(100, "left")),
            Adaptation(),
            "'yaw_angle' is 'left' in row 0, expected a number",
        ),
        (table(lane=TIME), Adaptation(), "'lane' is 0.05 in row 1; expected a whole"),
        (table(intention=TIME * 20), Adaptation(), "'intention' is 2 in row 2; expe"),
    ],
)
def test_what_cannot_be_meant_is_refused(
    columns: dict[str, np.ndarray], adaptation: Adaptation, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        stretches(columns, adaptation)


def test_even_samples_are_left_as_they_are() -> None:
    found = sampling(TIME)
    assert found.rate == pytest.approx(20.0)
    assert found.unevenness < 1e-9
    columns = table()
    assert evened(columns, found) is columns


def test_uneven_samples_are_interpolated() -> None:
    rng = np.random.default_rng(1)
    time = np.cumsum(rng.uniform(0.01, 0.03, 500))
    columns = {
        "time": time,
        "yaw_angle": 2.0 * time,
        "mode": np.where(time < 5, "manual", "lane_keeping"),
        "consistent": np.ma.MaskedArray(time < 3, mask=time > 4),
    }
    found = sampling(time)
    even = evened(columns, found)
    steps = np.diff(even["time"])
    np.testing.assert_allclose(steps, 1.0 / found.rate, rtol=1e-9)
    np.testing.assert_allclose(even["yaw_angle"], 2.0 * even["time"])
    assert set(even["mode"][even["time"] < 4.9]) == {"manual"}
    assert even["consistent"].mask[even["time"] > 4.1].all()


@pytest.mark.parametrize(
    ("time", "message"),
    [
        (np.array([0.0, 0.1, 0.5]), "0.4 s pass between rows 1 and 2"),
        (TIME * 1000, "--scale time=0.001"),
        (np.array([0.0, 0.1, 0.1]), "does not increase in row 2"),
        (np.array([0.0, np.nan, 0.1]), "time is nan in row 1"),
        (np.zeros(1), "1 samples are no recording"),
    ],
)
def test_too_irregular_samples_are_refused(time: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sampling(time)


def test_an_infinite_sample_is_an_undefined_one() -> None:
    values = np.where(TIME == 2.0, np.inf, 0.1)
    (stretch,) = stretches(table(yaw_angle=values))
    held = stretch.columns["yaw_angle"]
    assert np.isnan(held[TIME == 2.0]).all()
    assert np.isfinite(held[TIME != 2.0]).all()


def test_what_a_record_leaves_empty_stays_empty() -> None:
    # Of a person nobody knows the intention; a zero would say that there was none.
    nobody_knows = np.ma.MaskedArray(np.zeros(100, np.int8), mask=True)
    some = np.ma.MaskedArray(np.ones(100, np.int8), mask=TIME > 2.0)
    columns = table(driver_intention=nobody_knows, target_lane=some)
    (stretch,) = stretches(columns, Adaptation())
    assert np.ma.getmaskarray(stretch.columns["driver_intention"]).all()
    np.testing.assert_array_equal(
        np.ma.getmaskarray(stretch.columns["target_lane"]), TIME > 2.0
    )
