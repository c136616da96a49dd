"""Cars, drivers and parameters of files: what is written is what drives."""

from __future__ import annotations

from pathlib import Path

import pytest

from costeer.drivers.population import participant_driver
from costeer.loop.inputs import (
    ABOUT,
    car_of,
    parse_assignments,
    read_car,
    read_driver,
    read_values,
    write_driver,
)
from costeer.plant.parameters import LARGE_CAR, CarParameters


def test_a_driver_is_read_as_it_was_written(tmp_path: Path) -> None:
    driver = participant_driver(5, 3, 20.0)
    write_driver(tmp_path / "d.yaml", driver, {"fitted_to": "trial.parquet"})
    assert read_driver(tmp_path / "d.yaml") == driver
    assert "fitted_to: trial.parquet" in (tmp_path / "d.yaml").read_text("utf-8")


def test_a_car_is_the_default_one_but_for_what_its_file_names(tmp_path: Path) -> None:
    (tmp_path / "c.yaml").write_text("about: [a, b]\nmass: 1900\n", "utf-8")
    assert read_car(tmp_path / "c.yaml") == CarParameters(mass=1900.0)
    assert car_of(str(tmp_path / "c.yaml")) == CarParameters(mass=1900.0)
    assert car_of("large") == "large"
    assert LARGE_CAR.mass == 1835.0


def test_names_may_be_nested_or_dotted(tmp_path: Path) -> None:
    (tmp_path / "v.yaml").write_text("a:\n  b: {c: 1}\nd.e: 2.5\n", "utf-8")
    assert read_values(tmp_path / "v.yaml") == {"a.b.c": 1.0, "d.e": 2.5}
    assert parse_assignments(["a.b = 3", "c=1e-3"]) == {"a.b": 3.0, "c": 0.001}


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("mass: 1e3", {"mass": 1000.0}),
        ("a.b: 1.5e0\nc: -2", {"a.b": 1.5, "c": -2.0}),
        ("flag: true", {"flag": True}),
    ],
)
def test_numbers_are_read_as_people_write_them(
    tmp_path: Path, text: str, values: dict[str, float]
) -> None:
    (tmp_path / "values.yaml").write_text(text)
    assert read_values(tmp_path / "values.yaml") == values


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("mass: 1\nmass: 2", "mass stands twice"),
        ("a.b: 1\na:\n  b: 2", "a.b is set twice"),
        ("mass: 1:02", "mass is '1:02'; give a number"),
        ("mass: 2020-13-45", "mass is '2020-13-45'; give a number"),
        ("mass: [1]", "mass is .*; give a number"),
        ("mass:", "mass is ''; give a number"),
    ],
)
def test_what_is_no_number_is_named(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "values.yaml").write_text(text)
    with pytest.raises(ValueError, match=rf"values\.yaml.*{message}"):
        read_values(tmp_path / "values.yaml")


@pytest.mark.parametrize("digits", [400, 5000])
def test_a_number_of_many_digits_is_out_of_range(tmp_path: Path, digits: int) -> None:
    (tmp_path / "car.yaml").write_text(f"mass: {'9' * digits}")
    with pytest.raises(ValueError, match="mass is inf; give a number from"):
        read_car(tmp_path / "car.yaml")


def test_a_large_file_is_not_parsed(tmp_path: Path) -> None:
    (tmp_path / "v.yaml").write_text("a: 1\n" * 300_000, "utf-8")
    with pytest.raises(ValueError, match=r"has 1\.5 MB, at most 1 MB are read"):
        read_values(tmp_path / "v.yaml")


@pytest.mark.parametrize(("about", "band"), [("{population: '2'}", 0.0), ("{}", 0.006)])
def test_a_fit_from_before_stays_the_driver_that_it_was(
    tmp_path: Path, about: str, band: float
) -> None:
    file = tmp_path / "driver.yaml"
    file.write_text(f"{ABOUT}: {about}\narm.stiffness: 14\n")
    driver = read_driver(file)
    assert driver.arm.stiffness == 14.0
    assert driver.tolerance.band == band
    assert (driver.learning.share == 0.0) is (band == 0.0)
