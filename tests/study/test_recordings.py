"""Foreign tables: names, units, stretches and sampling."""

from __future__ import annotations

import re
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


@pytest.mark.parametrize(
    ("columns", "note"),
    [
        (
            {"lane": TIME},
            "lane is not used: .*'lane' is 0.05 in row 1; expected a whole",
        ),
        ({"intention": TIME * 20}, "intention is not used: .*is 2 in row 2; expected"),
        (
            {"brake": np.full(100, "off")},
            "brake is not used: .*'brake' is 'off' in row",
        ),
        ({"lane": np.where(TIME < 1, np.nan, 1.0)}, "'lane' has undefined samples"),
        ({"event": np.full(100, "none")}, "event is not used"),
    ],
)
def test_a_column_that_is_not_needed_refuses_nothing(
    columns: dict[str, np.ndarray], note: str
) -> None:
    (stretch,) = stretches(table(yaw_angle=TIME, **columns))
    assert set(stretch.columns) == {"time", "yaw_angle"}
    (told,) = stretch.notes
    assert re.search(note, told)


def test_rows_without_a_name_are_one_stretch_that_is_named() -> None:
    for keys in (np.repeat([1.0, np.nan], 50), np.repeat(["1.0", ""], 50)):
        first, second = stretches(table(sequence=keys))
        assert (first.name, second.name) == ("1.0", "empty")
        assert "sequence is empty in 50 rows, first in row 50" in second.notes[0]


def test_participants_are_told_apart_like_stretches() -> None:
    names = np.repeat(["2021-03-01", "2021-03-02"], 50)
    found = stretches(table(participant=names))
    assert [each.name for each in found] == ["2021-03-01", "2021-03-02"]
    (one,) = stretches(table(participant=np.full(100, "a")))
    assert one.columns["time"].size == 100


def test_a_repeated_time_is_left_out_if_wanted() -> None:
    time = np.insert(TIME, 40, TIME[40])
    (stretch,) = stretches({"time": time}, Adaptation(drop_repeated=True))
    np.testing.assert_array_equal(stretch.columns["time"], TIME)
    assert "1 rows repeat the time of the row before, first row 41" in stretch.notes[0]
    with pytest.raises(ValueError, match=r"delete row 41, .*--drop-repeated"):
        sampling(time)


def test_moments_are_renamed_to_time() -> None:
    stamps = np.datetime64("2024-05-01T10:00") + (TIME * 1e9).astype("m8[ns]")
    texts = np.array([str(stamp).replace("T", " ") for stamp in stamps])
    for values in (stamps, texts):
        columns = {"clock": values}
        with pytest.raises(ValueError, match=r"it may be clock; .*--rename clock=time"):
            stretches(columns)
        (stretch,) = stretches(columns, Adaptation(renames={"clock": "time"}))
        np.testing.assert_allclose(stretch.columns["time"], TIME, atol=1e-9)
        assert "seconds since the first row" in stretch.notes[0]
