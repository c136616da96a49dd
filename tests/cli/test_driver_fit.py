"""`costeer drivers --fit` prints and draws a fit."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from costeer.cli.driver_fit import show_fit
from costeer.identification.fit import DriverFit, fit_driver
from costeer.records.columns import TrialRecord
from costeer.records.record import write_record
from tests.identification.driving import cut, recorded, recorded_with, with_columns


@pytest.fixture(scope="module", autouse=True)
def _fitted_once() -> Iterator[None]:
    """A recording that several tests show is fitted for the first of them alone."""
    known: dict[bytes, DriverFit] = {}

    def fitted(record: TrialRecord, car: str | None = None) -> DriverFit:
        key = b"".join(np.asarray(column) for column in record.columns.values())
        if key not in known:
            known[key] = fit_driver(record, car)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("costeer.identification.fit.fit_driver", fitted)
        yield


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("fit") / "trial.parquet"
    write_record(path, cut(recorded(1), slice(0, 12_000)))
    return path


@pytest.mark.slow
def test_tables_name_estimates_and_what_is_not_identified(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    show_fit(file, False, 2, None, None)
    printed = capsys.readouterr().out
    for word in ("arm.stiffness", "reliance.*", "sdlp", "lane_change_duration"):
        assert word in printed


@pytest.mark.slow
def test_json_has_the_same_and_the_figure_is_written(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plot = tmp_path / "new" / "fit.svg"
    show_fit(file, True, 2, plot, None)
    answer = json.loads(capsys.readouterr().out)
    names = {each["name"] for each in answer["estimates"]}
    assert {"vision.lead_time", "decision.change_duration"} <= names
    assert len(answer["checks"]) == 4
    assert answer["notes"] == []
    assert plot.read_text("utf-8").startswith("<?xml")


def csv(path: Path, columns: dict[str, np.ndarray]) -> Path:
    names = ["time", "lateral_position", "yaw_angle", "longitudinal_velocity"]
    names += ["steering_wheel_angle", "steering_wheel_rate", "driver_torque"]
    table = np.stack([columns[name] for name in names], axis=1)
    np.savetxt(path, table, delimiter=",", header=",".join(names), comments="")
    return path


@pytest.mark.slow
def test_a_csv_with_the_needed_columns_is_enough(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = csv(tmp_path / "drive.csv", recorded_with(friction=100.0).columns)
    show_fit(path, False, 2, None, None)
    captured = capsys.readouterr()
    assert "the wheel never moves" in captured.out
    assert "not compared: lane_change_duration" in captured.out


def test_a_recording_that_cannot_be_fitted_is_named(tmp_path: Path) -> None:
    path = csv(tmp_path / "short.csv", cut(recorded(1), slice(0, 600)).columns)
    with pytest.raises(ValueError, match=r"short\.csv: .* needs 60\.0 s"):
        show_fit(path, False, 1, None, None)


def test_a_plot_that_is_no_svg_is_refused_before_the_fit(file: Path) -> None:
    with pytest.raises(ValueError, match=r"fit\.png is no SVG"):
        show_fit(file, False, 1, Path("fit.png"), None)


@pytest.mark.slow
def test_a_driver_whom_the_model_does_not_describe_is_noted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = recorded(1)
    shaken = record.columns["driver_torque"].copy()
    shaken += 0.05 * np.sin(2.0 * np.pi * 3.0 * record.columns["time"])
    path = tmp_path / "shaken.parquet"
    write_record(path, with_columns(record, driver_torque=shaken))
    show_fit(path, False, 2, None, None)
    assert "does not describe this driver well" in capsys.readouterr().err


@pytest.mark.slow
def test_a_drive_too_slow_for_the_simulator_is_fitted_and_not_checked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = recorded_with(friction=100.0)
    slow = np.full(len(record.columns["time"]), 9.0)
    path = csv(tmp_path / "slow.csv", {**record.columns, "longitudinal_velocity": slow})
    show_fit(path, False, 2, None, None)
    assert (
        "not checked: the recording's mean speed is 32.4 km/h"
        in capsys.readouterr().err
    )
