"""A record shows itself: a line, HTML, a data frame, a figure."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import costeer
from costeer.records.columns import COLUMNS, MANUAL, Column
from tests.study.synthetic import synthetic_record


@pytest.fixture(scope="module")
def record() -> costeer.Record:
    return synthetic_record(length=1500.0)


def test_the_repr_is_one_short_line(record: costeer.Record) -> None:
    assert "\n" not in repr(record)
    assert len(repr(record)) < 120
    assert record.metadata["condition"] in repr(record)  # type: ignore[operator]  # a text
    assert f"{len(record.columns['time'])} rows" in repr(record)


def test_a_table_without_metadata_has_a_repr_too() -> None:
    table = costeer.Record({}, {"time": np.array([0.0, 0.5])})
    assert repr(table) == "<costeer record: participant -, -, -, -, 2 rows, 0.5 s>"
    assert "0 rows" in repr(costeer.Record({}, {}))


def test_html_escapes_what_a_file_says() -> None:
    nasty = costeer.Record({"method": "<script>"}, {"time": np.zeros(1)})
    assert "<script>" not in nasty._repr_html_()
    assert "&lt;script&gt;" in nasty._repr_html_()


def test_a_frame_has_every_column_and_its_unit(record: costeer.Record) -> None:
    frame = record.to_frame()
    assert list(frame) == list(record.columns)
    assert frame.attrs["units"]["yaw_angle"] == "rad"
    assert set(frame.attrs["units"]) == {c.name for c in COLUMNS} & set(frame)


def test_a_frame_says_missing_where_a_column_is_masked() -> None:
    lane = np.ma.MaskedArray(np.array([0, 1], np.int8), mask=[False, True])
    frame = costeer.Record({}, {"time": np.arange(2.0), "lead_lane": lane}).to_frame()
    assert frame["lead_lane"].isna().tolist() == [False, True]
    assert frame["lead_lane"][0] == 0


def test_a_column_of_a_method_has_its_unit_in_the_frame() -> None:
    added = Column("method_effort", "N·m·s", "float64", "effort")
    columns = {"time": np.arange(2.0), "method_effort": np.ones(2)}
    frame = costeer.Record({}, columns, (added,)).to_frame()
    assert frame.attrs["units"]["method_effort"] == "N·m·s"


def test_a_figure_has_a_panel_with_unit_for_each_signal(
    record: costeer.Record, tmp_path: Path
) -> None:
    figure = record.plot(["lateral_position", "steering_wheel_angle", "lane"])
    labels = [axes.get_ylabel().replace("\n", " ") for axes in figure.axes]
    assert labels == ["Lateral position [m]", "Steering wheel angle [deg]", "Lane [–]"]
    assert figure.axes[-1].get_xlabel() == "Time [s]"
    figure.savefig(tmp_path / "figure.pdf")
    assert figure._repr_png_().startswith(b"\x89PNG")  # as a notebook asks for it


def test_a_figure_shows_angles_in_degrees(record: costeer.Record) -> None:
    (axes,) = record.plot(["yaw_angle"]).axes
    drawn = np.asarray(axes.lines[-1].get_ydata())
    np.testing.assert_allclose(drawn, np.degrees(record.columns["yaw_angle"]))


def test_the_usual_figure_leaves_out_what_the_record_does_not_know() -> None:
    time = np.arange(3.0)
    known = {"time": time, "driver_torque": time, "haptic_gain": np.full(3, np.nan)}
    assert len(costeer.Record({"condition": MANUAL}, known).plot().axes) == 1


def test_panels_share_the_time_also_of_a_signal_that_begins_undefined() -> None:
    late = np.array([np.nan, np.nan, 1.0, 2.0])
    columns = {"time": np.arange(4.0), "lead_distance": late, "yaw_angle": late}
    figure = costeer.Record({}, columns).plot(["lead_distance", "yaw_angle", "time"])
    assert {axes.get_xlim() for axes in figure.axes} == {(0.0, 3.0)}


def test_a_signal_that_is_not_there_is_an_error_with_a_suggestion(
    record: costeer.Record,
) -> None:
    with pytest.raises(ValueError, match="did you mean driver_torque"):
        record.plot(["driver_torqe"])
    with pytest.raises(ValueError, match="choose from"):
        record.plot(["mode"])
    with pytest.raises(ValueError, match="nothing to draw"):
        costeer.Record({}, {"time": np.arange(3.0)}).plot()


def test_a_record_is_read_as_it_was_written(
    record: costeer.Record, tmp_path: Path
) -> None:
    from costeer.records.record import write_record

    write_record(tmp_path / "a.parquet", record)
    again = costeer.load_record(tmp_path / "a.parquet")
    np.testing.assert_array_equal(
        again.columns["yaw_angle"], record.columns["yaw_angle"]
    )


def test_a_signal_of_words_is_there_but_cannot_be_drawn(record: costeer.Record) -> None:
    with pytest.raises(ValueError, match="signal 'mode' holds words and cannot be dr"):
        record.plot(["mode"])
