"""What a page is told of a scenario, by a drive and by its record alike."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.records.arrow import METADATA_KEY, record_schema
from costeer.runtime.recorder import drive_metadata
from costeer.runtime.setup import DriveSetup
from costeer.scenarios.definition import Actor, Bent, Event, Road, Scenario, Zone
from costeer.scenarios.reading import scenario_named, shipped
from costeer.web.scenery import cars_of, cars_of_record, scenery_of

WINDING = Scenario(
    "winding",
    road=Road(
        length=3000.0,
        shoulder=1.5,
        speed_limit="50 mph",
        stations=(Bent(100.0), Bent(200.0, 800.0), Bent(300.0, -400.0)),
    ),
    actors=(
        Actor("crate", kind="obstacle", lane=1, at=800.0),
        Actor("lorry", kind="truck", lane=0, at=300.0, speed="20 m/s", length=9.0),
    ),
    events=(
        Event("lane-change", 500.0, 200.0, side="right"),
        Event("gust", 900.0, 50.0, force=-800.0),
    ),
    zones=(Zone("bend", 200.0, 300.0),),
    after_collision="restart",
)


def told(setup: TrialSetup) -> dict[str, Any]:
    """The description of a trial as it comes out of a file."""
    about = drive_metadata(DriveSetup(trial=setup, intention="off"))
    metadata = record_schema(about, ()).metadata
    return dict(json.loads(metadata[METADATA_KEY]))


def test_road_with_everything_is_told_in_numbers() -> None:
    about = told(TrialSetup(scenario=WINDING))
    assert scenery_of(about["scenario"]) == {
        "name": "winding",
        "shoulder": 1.5,
        "after_collision": "restart",
        "rumble_strip": True,
        "speed_limit": [50, "mph"],
        "stations": [
            [100.0, 0.0],
            [200.0, pytest.approx(0.00125)],
            [300.0, pytest.approx(-0.0025)],
        ],
        "events": [
            ["lane-change", 500.0, 700.0, "right"],
            ["gust", 900.0, 950.0, "right"],
        ],
        "zones": [["bend", 200.0, 300.0]],
    }


@pytest.mark.parametrize("name", shipped())
def test_record_tells_of_the_same_cars_as_the_drive(name: str) -> None:
    setup = TrialSetup(scenario=name, seed=4, participant=7)
    fleet = loop_parameters(setup).fleet
    cars = cars_of(scenario_named(name), fleet)
    assert cars_of_record(told(setup), setup.length) == cars
    assert len(cars) == {"dense-traffic": 20, "three-lanes": 12}.get(name, len(cars))


def test_kinds_and_sizes_of_cars_are_those_of_the_scenario() -> None:
    cars = cars_of_record(told(TrialSetup(scenario=WINDING)), 3000.0)
    assert cars == [["obstacle", 1.0, 1.75], ["truck", 9.0, 2.5]]


@pytest.mark.parametrize(
    "scenario",
    [
        None,
        3,
        {"road": 5, "events": "gust", "zones": [None, {"start": "x"}]},
        {"road": {"stations": [{"at": math.nan, "radius": 0.0}, {"at": True}]}},
        {"road": {"shoulder": 1e9, "speed_limit": "<b>", "rumble_strip": 1}},
    ],
)
def test_record_from_anywhere_shows_a_usual_road(scenario: object) -> None:
    found = scenery_of(scenario)
    assert (found["shoulder"], found["speed_limit"]) == (2.5, None)
    assert (found["stations"], found["events"], found["zones"]) == ([], [], [])
    about = {"scenario": scenario, "configuration": {"setup": {"seed": 1}}}
    assert cars_of_record(about, 1000.0) == []


def test_sizes_that_a_record_tells_are_drawn_as_far_as_they_can_be() -> None:
    cars = [{"kind": "truck", "length": 9.0, "width": 2.5}, {"kind": 3, "length": 1e9}]
    found = cars_of_record({"other_cars": [*cars, "car"]}, 1000.0)
    assert found == [["truck", 9.0, 2.5], ["car", 4.5, 1.8]]
