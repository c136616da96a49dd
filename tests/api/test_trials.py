"""`simulate`, `study` and `parameters` do what the rooms do, with checked arguments."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import costeer
from costeer.api.trials import study
from costeer.drivers.population import participant_driver
from costeer.loop.inputs import read_driver, write_driver
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.methods.ibhs import IBHS
from costeer.plant.parameters import CARS
from costeer.records.record import write_record
from costeer.study.configuration import StudySettings
from costeer.study.run import run_study

SHORT: dict[str, Any] = {"length": 200, "intention": "off"}


def arguments(function: Any) -> dict[str, Any]:  # Any: whatever is a default
    """Names and defaults of a function's arguments."""
    given = inspect.signature(function).parameters
    return {name: each.default for name, each in given.items()}


def test_everything_that_a_trial_setup_knows_can_be_given() -> None:
    given = arguments(costeer.simulate)
    assert set(given) == {*TrialSetup._fields, "engine"}
    # An assisted condition, a mapping, and what the scenario says.
    differ = {"condition", "parameters", "length", "speed"}
    for name, usual in TrialSetup._field_defaults.items():
        if name not in differ:
            np.testing.assert_equal(given[name], usual, err_msg=name)


WORK = {"jobs", "cluster", "records", "shard"}
"""How a study is worked off, which changes nothing in it."""


def test_everything_that_a_study_is_set_to_can_be_given() -> None:
    given = arguments(study)
    assert set(given) == {*StudySettings._fields, "driver", "out", "report", *WORK}
    for name, usual in StudySettings._field_defaults.items():
        if name not in {"parameters", "weights", "length", "speed"}:
            assert given[name] == usual, name


def test_a_trial_has_the_bytes_of_the_deep_call(tmp_path: Path) -> None:
    gain = {"guidance.lateral_error_gain": 2.5}
    shallow = costeer.simulate(
        "weak-rapid", seed=3, participant=2, car="large", parameters=gain, **SHORT
    )
    setup = TrialSetup(
        participant=2,
        seed=3,
        condition="weak-rapid",
        car="large",
        parameters=tuple(gain.items()),
        **SHORT,
    )
    write_record(tmp_path / "shallow", shallow)
    write_record(tmp_path / "deep", simulate_trial(setup))
    assert (tmp_path / "shallow").read_bytes() == (tmp_path / "deep").read_bytes()


def test_objects_and_names_mean_the_same() -> None:
    named = costeer.simulate(method="ibhs", car="compact", participant=2, **SHORT)
    driver = participant_driver(1, 2, 70.0 / 3.6)
    given = costeer.simulate(
        method=IBHS, car=CARS["compact"], participant=2, driver=driver, **SHORT
    )
    for name, values in named.columns.items():
        np.testing.assert_array_equal(given.columns[name], values, err_msg=name)


def test_a_driver_of_a_file_drives(tmp_path: Path) -> None:
    driver = costeer.population(2)[1]
    write_driver(tmp_path / "driver.yaml", driver, {})
    found = costeer.simulate(driver=str(tmp_path / "driver.yaml"), **SHORT)
    expected = costeer.simulate(driver=driver, **SHORT)
    np.testing.assert_array_equal(
        found.columns["driver_torque"], expected.columns["driver_torque"]
    )


def test_every_drawn_driver_can_be_written_and_read(tmp_path: Path) -> None:
    for driver in costeer.population(25):
        write_driver(tmp_path / "driver.yaml", driver, {})
        assert read_driver(tmp_path / "driver.yaml") == driver


def test_the_population_is_that_of_the_trials() -> None:
    second = costeer.population(2, seed=5)[1]
    by_number = costeer.simulate("manual", seed=5, participant=2, **SHORT)
    by_driver = costeer.simulate(
        "manual", seed=5, participant=2, driver=second, **SHORT
    )
    np.testing.assert_array_equal(
        by_number.columns["driver_torque"], by_driver.columns["driver_torque"]
    )


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"condition": "strong-nomal"}, "did you mean strong-normal"),
        ({"method": "ibsh"}, "did you mean ibhs"),
        ({"parameters": {"guidance.lateral_gain": 1.0}}, "there is no parameter"),
        ({"parameters": {"guidance.lateral_error_gain": -1.0}}, "give a number from 0"),
        ({"length": 1.0}, "length is 1.0; give a number from 100"),
        ({"car": "tractor"}, "car 'tractor' is not known"),
        ({"driver": "nobody"}, "driver 'nobody' is not known"),
        ({"predictor": "grue"}, "predictor 'grue' is not known"),
    ],
)
def test_a_slip_is_an_error_that_says_the_way_out(
    given: dict[str, Any], told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        costeer.simulate(**given)


def test_an_unknown_keyword_is_an_error() -> None:
    with pytest.raises(TypeError, match="lenght"):
        costeer.simulate("manual", lenght=300)  # type: ignore[call-arg]  # the point


def test_a_study_gives_the_tables_of_the_deep_call(tmp_path: Path) -> None:
    small = {"participants": 1, "length": 300.0, "intention": "scripted"}
    done = costeer.study(
        tmp_path / "a", conditions="manual, weak-gentle", report=False, **small
    )
    settings = StudySettings(conditions=("manual", "weak-gentle"), **small)
    run_study(tmp_path / "b", settings, report=None)
    assert (done.num_trials, done.num_resumed) == (2, 0)
    tables = [tmp_path / each / "trials.csv" for each in "ab"]
    assert tables[0].read_bytes() == tables[1].read_bytes()


@pytest.mark.slow
def test_a_study_takes_cars_drivers_and_predictors_as_objects(tmp_path: Path) -> None:
    def never(window: np.ndarray[Any, Any]) -> float:
        return 0.0

    given: dict[str, Any] = {
        "participants": np.int64(1),
        "conditions": "manual,weak-gentle",
        "length": np.float64(300),
        "parameters": {"guidance.lateral_error_gain": np.float64(2)},
        "car": CARS["compact"],
        "driver": costeer.population(1)[0],
        "predictor": never,
        "report": False,
    }
    assert costeer.study(tmp_path / "a", **given).num_resumed == 0
    again = given | {"length": 300, "parameters": {"guidance.lateral_error_gain": 2}}
    assert costeer.study(tmp_path / "a", **again).num_resumed == 2
    other = given | {"car": CARS["compact"]._replace(mass=1111)}
    with pytest.raises(ValueError, match=r"car\.mass is .* there, 1111\.0 here"):
        costeer.study(tmp_path / "a", **other)
    text = (tmp_path / "a" / "study.yaml").read_text("utf-8")
    assert "costeer.study(FOLDER, ...) in Python" in text
    assert "predictor, driver 1 given as objects" in text
    assert "predictor: never" in text


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"speed": "70km/h"}, r"speed is '70km/h'; give a number \[m/s\]"),
        ({"length": "8 km"}, r"length is '8 km'; give a number \[m\]"),
        ({"car": 5}, "car is 5; give a name, a file NAME.yaml, or CarParameters"),
        ({"drivers": 5}, "driver is 5; give a name, a file NAME.yaml, or Driver"),
        ({"drivers": [CARS["large"]]}, "driver is CarParameters"),
        ({"predictor": 5}, "5 is no predictor"),
        ({"predictor": 5, "intention": "scripted"}, "asks no predictor"),
        ({"weights": 5}, "weights is 5; give the name of a file"),
        ({"conditions": 5}, "conditions is 5; give names"),
        ({"driver": "a.yaml", "drivers": ["b.yaml"]}, "give one of them"),
        ({"parameters": {"guidance.lateral_error_gain": "2"}}, "give a number"),
    ],
)
def test_a_setting_of_the_wrong_kind_is_one_line(
    given: dict[str, Any], told: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=told):
        costeer.study(tmp_path / "a", participants=1, **given)
    assert not (tmp_path / "a").exists()


def test_a_study_refuses_a_misspelt_condition(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="did you mean weak-gentle"):
        costeer.study(tmp_path / "a", conditions=["weak-gentel"])
    assert not (tmp_path / "a").exists()


def test_parameters_are_those_that_can_be_set() -> None:
    table = costeer.parameters(car="large")
    row = table.loc["guidance.lateral_error_gain"]
    assert (row.value, row.unit, row.low) == (1.5, "N·m/m", 0.0)
    assert row.source.startswith("assumed")
    assert table.value["car.mass"] == CARS["large"].mass
    with pytest.raises(ValueError, match="did you mean strong-normal"):
        costeer.parameters(condition="strong-nomal")


def test_number_of_drivers_must_be_one_or_more() -> None:
    with pytest.raises(ValueError, match="number is 0; give 1 or more"):
        costeer.population(0)


@pytest.mark.slow
def test_a_function_of_windows_is_judged_as_the_predictor_it_copies() -> None:
    from costeer.intention.predictors.registry import predictor

    record = costeer.simulate("manual", length=1200, intention="off")
    known = predictor("line-time")

    def copied(window: np.ndarray[Any, Any]) -> float:
        return float(known.probabilities(window, ())[-1])

    by_name = costeer.evaluate("line-time", [record])
    assert costeer.evaluate(known, record) == by_name
    assert costeer.evaluate(copied, record.to_frame()) == by_name


def test_an_evaluation_refuses_a_threshold_that_is_none() -> None:
    with pytest.raises(ValueError, match="threshold is 2"):
        costeer.evaluate("gru", [], threshold=2.0)
