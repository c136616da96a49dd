"""The table of a scenario: a row for each value, zones apart, none of the paper."""

from __future__ import annotations

from math import pi, sqrt
from typing import Any

import numpy as np
import pytest

from costeer.records.columns import TrialRecord
from costeer.scenarios.definition import Actor, Road, Scenario, Stream, Zone
from costeer.scenarios.reading import scenario_named
from costeer.study.dictionary import tables
from costeer.study.measures import scenario_measure_rows
from costeer.study.scenario import surroundings
from tests.study.worlds import LANE, SPEED, Columns, car, changing, record, straight

ZONES = (Zone("first", 0.0, 400.0), Zone("second", 400.0, 1200.0))
WORLD = Scenario("made-up", road=Road(length=2000.0, lanes=3), zones=ZONES)


def plain(value: Any) -> Any:
    """Named tuples as records keep them; NaN, which JSON has not, as null."""
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return {name: plain(part) for name, part in value._asdict().items()}
    if isinstance(value, tuple):
        return [plain(each) for each in value]
    return None if value != value else value


def on(scenario: Scenario, columns: Columns) -> TrialRecord:
    made = record(columns)
    setup = {"seed": 1, "participant": 1, "length": scenario.road.length}
    told = made.metadata["configuration"] | {"setup": setup}  # type: ignore[operator]
    about = {"scenario": plain(scenario), "configuration": told, "condition": "manual"}
    return made._replace(metadata=about)


def found(trial: TrialRecord) -> dict[tuple[object, object, object], object]:
    rows = scenario_measure_rows(trial)
    return {(r["zone"], r["lane_change"], r["measure"]): r["value"] for r in rows}


def test_the_papers_scenario_and_old_records_have_no_rows() -> None:
    assert scenario_measure_rows(record(straight())) == []
    assert scenario_measure_rows(on(scenario_named("expressway"), straight())) == []
    assert scenario_measure_rows(on(WORLD, straight()))


def test_a_scenario_that_only_has_the_papers_name_has_rows() -> None:
    renamed = WORLD._replace(name="expressway")
    assert scenario_measure_rows(on(renamed, straight()))


def test_zones_are_measured_by_themselves() -> None:
    drive = straight()
    time = drive["time"]
    early = 0.2 * np.sin(2 * pi * 0.2 * time)  # 400 m are four of these
    late = 0.4 * np.sin(2 * pi * 0.1 * time)  # 800 m are four of those
    drive["lateral_position"] = np.where(time < 20.0, early, late)
    drive["driver_torque"] = np.where(time < 20.0, 1.0, 3.0)
    measured = found(on(WORLD, drive))
    for zone, amplitude, torque in (("first", 0.2, 1.0), ("second", 0.4, 3.0)):
        sdlp = measured[zone, None, "sdlp"]
        assert sdlp == pytest.approx(amplitude / sqrt(2), rel=2e-3)
        assert measured[zone, None, "driver_torque_rms"] == pytest.approx(torque)
    assert measured["first", None, "duration"] == pytest.approx(20.0, abs=0.02)


def test_a_lane_change_counts_in_the_zone_of_its_crossing() -> None:
    drive = changing([(17.5, -1)])  # crosses at 20.5 s and 410 m
    drive |= car(1, 34.5, -LANE, SPEED)
    measured = found(on(WORLD, drive))
    assert measured["first", None, "num_lane_changes"] == 0
    assert measured["second", None, "num_lane_changes"] == 1
    assert measured["whole course", 1, "to_lane"] == 1
    assert measured["whole course", 1, "lead_gap"] == pytest.approx(30.0)


def test_a_zone_that_was_not_reached_is_not_defined() -> None:
    far = WORLD._replace(zones=(Zone("far", 1500.0, 1800.0),))
    measured = found(on(far, straight()))
    values = [value for key, value in measured.items() if key[0] == "far"]
    assert values
    assert np.isnan(np.array(values, float)).all()


def test_lengths_of_the_other_cars_follow_from_the_scenario() -> None:
    actors = (Actor("a", "truck", at=50.0), Actor("b", length=3.0, lane=1, at=80.0))
    world = WORLD._replace(actors=actors)
    assert surroundings(on(world, straight())).lengths.tolist() == [12.0, 3.0]
    gap = 20.0 + (12.0 + 4.5) / 2.0
    measured = found(on(world, straight() | car(1, gap, 0.0, SPEED)))
    assert measured["whole course", None, "time_gap_mean"] == pytest.approx(
        20.0 / SPEED
    )
    expected = (20.0 + 12.0) / SPEED
    headway = measured["whole course", None, "time_headway_mean"]
    assert headway == pytest.approx(expected)


def test_lengths_are_those_that_the_record_tells() -> None:
    world = WORLD._replace(actors=(Actor("a", "truck", at=50.0),))
    trial = on(world, straight())
    told = [{"kind": "car", "length": 5.5, "width": 2.0}, {"length": "long"}, None]
    about = dict(trial.metadata) | {"other_cars": told}
    lengths = surroundings(trial._replace(metadata=about)).lengths
    assert lengths.tolist() == [5.5, 4.5, 4.5]


def test_without_other_cars_their_measures_are_empty() -> None:
    measured = found(on(WORLD, changing([(20.0, -1)])))
    names = ("time_to_collision_minimum", "time_headway_mean", "time_gap_minimum")
    for name in names:
        assert np.isnan(float(str(measured["whole course", None, name])))
    assert np.isnan(float(str(measured["whole course", 1, "lag_gap"])))


def test_columns_are_those_of_the_dictionary() -> None:
    row = scenario_measure_rows(on(WORLD._replace(stream=Stream()), straight()))[0]
    known = tables()["scenario_measures.csv"]
    simulated = [each.column for each in known if "sessions only" not in each.meaning]
    assert list(row) == simulated
