"""One trial from its setup to its record."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from costeer.intention.gru import random_weights
from costeer.intention.weights import intention_network, save_weights
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial, trial_duration
from costeer.records.columns import COLUMNS, TrialRecord
from costeer.records.metadata import METADATA_FIELDS

MANUAL = TrialSetup(seed=3, intention="off", length=1800.0)
STRONG = TrialSetup(
    seed=3,
    condition="strong-normal",
    intention="scripted",
    length=1800.0,
)
OF_THE_GUIDANCE = """
target_lane estimated_driver_torque instructed_torque haptic_gain lateral_error
heading_error_rate guidance_pseudo_work driver_pseudo_work torque_agreement consistent
target_lateral_position
"""


@cache
def trial(setup: TrialSetup, engine: str = "numba") -> TrialRecord:
    return simulate_trial(setup, engine)


def as_bytes(record: TrialRecord, num_rows: int | None = None) -> dict[str, bytes]:
    """Each column's bytes, missing values marked."""
    return {
        name: np.ma.filled(values[:num_rows], -9).tobytes()
        for name, values in record.columns.items()
    }


def is_empty(values: np.ndarray) -> bool:  # type: ignore[type-arg]
    """Whether no row of a column says anything."""
    if values.dtype.kind == "f":
        return bool(np.isnan(values).all())
    return bool(np.ma.getmaskarray(values).all())


def test_the_same_setup_gives_the_same_bytes() -> None:
    again = simulate_trial(STRONG)
    assert as_bytes(again) == as_bytes(trial(STRONG))
    assert again.metadata == trial(STRONG).metadata


def test_a_longer_trial_begins_like_a_shorter_one() -> None:
    short = trial(STRONG)
    long = trial(STRONG._replace(length=2500.0))
    count = len(short.columns["time"])
    assert len(long.columns["time"]) > count
    assert as_bytes(long, count) == as_bytes(short)


def test_a_record_has_every_column_and_field_of_the_format() -> None:
    record = trial(STRONG)
    assert tuple(record.columns) == tuple(column.name for column in COLUMNS)
    of_plug_ins = {"method_version", "method_source_hash", "predictor", "torque_faults"}
    of_plug_ins |= {"driver_source_hash", "scenario", "other_cars", "outcome"}
    of_plug_ins |= {"mistakes", "network_form"}
    assert set(record.metadata) == set(METADATA_FIELDS) | of_plug_ins
    assert json.loads(json.dumps(record.metadata)) == record.metadata


def test_a_record_tells_the_strength_that_was_applied() -> None:
    asked = STRONG._replace(length=150.0)
    assert trial(asked).metadata["strength_factor"] == 1.0
    assert trial(asked._replace(method="manual")).metadata["strength_factor"] == 0.0


def test_rows_are_60_per_second_from_zero() -> None:
    time = trial(STRONG).columns["time"]
    # Summed steps of 1/60: rounding of 1e-16 a step.
    np.testing.assert_allclose(time, np.arange(time.size) / 60.0, atol=1e-9)
    assert trial_duration(trial(STRONG)) == pytest.approx(time[-1] + 1.0 / 60.0)


def test_a_trial_ends_where_the_road_ends() -> None:
    columns = trial(STRONG).columns
    step = columns["longitudinal_velocity"][-1] / 60.0
    # The step that arrives is the last row, which shows where it began.
    left = 1800.0 - columns["longitudinal_position"][-1]
    assert 0.0 < left <= 1.05 * step


def test_a_leader_is_overtaken_and_returned_from() -> None:
    columns = trial(STRONG).columns
    assert set(columns["event"]) == {0, 1}
    assert set(columns["driver_intention"].compressed()) == {-1, 0, 1}
    lanes = columns["lane"]
    assert lanes[0] == lanes[-1] == 1
    assert (lanes == 0).any()


def test_without_events_the_road_stays_empty() -> None:
    columns = trial(STRONG._replace(events=False)).columns
    assert not columns["event"].any()
    assert np.isnan(columns["lead_distance"]).all()
    assert not columns["driver_intention"].any()
    assert (columns["lane"] == 1).all()


def test_manual_driving_has_no_torque_and_no_guidance() -> None:
    columns = trial(MANUAL).columns
    assert not columns["applied_torque"].any()
    assert set(columns["mode"]) == {"manual"}
    # Written out by hand, so that a name forgotten in the code is missed here. Without
    # leaders, or without a network asked, these are empty in manual driving, too.
    absent = {"lead_distance", "lead_velocity", "lead_lane", "crossing_probability"}
    empty = {name for name, values in columns.items() if is_empty(values)}
    assert empty - absent == set(OF_THE_GUIDANCE.split())


def test_assisted_driving_fills_every_column() -> None:
    columns = trial(STRONG).columns
    filled = set(columns) - {"crossing_probability"}
    later = {name: columns[name][60:] for name in filled if "lead_" not in name}
    for name, values in later.items():
        assert not np.ma.getmaskarray(values).any(), name
        if values.dtype.kind == "f":
            assert np.isfinite(values).all(), name


def test_guidance_never_passes_the_limit_nor_jumps() -> None:
    torque = trial(STRONG).columns["applied_torque"]
    assert np.abs(torque).max() <= 5.0
    assert np.abs(np.diff(torque)).max() <= 30.0 / 60.0 + 1e-12


def test_a_requested_lane_change_starts_whatever_the_driver_wants() -> None:
    setup = STRONG._replace(
        driver="hands-off", intention="off", events=False, trigger_times=(12.0, 4.0)
    )
    columns = trial(setup).columns
    time, changing = columns["time"], columns["mode"] == "lane_changing"
    starts = time[1:][changing[1:] & ~changing[:-1]]
    np.testing.assert_allclose(starts, [4.0, 12.0], atol=1.0 / 60.0)
    assert columns["lane"][np.searchsorted(time, 10.0)] == 0
    assert columns["lane"][-1] == 1


def test_the_scripted_intention_is_positive_before_the_drivers_own_crossing() -> None:
    columns = trial(STRONG).columns
    positive = columns["crossing_probability"] == 1.0
    intended = columns["driver_intention"] != 0
    assert positive.any()
    assert intended[positive].all()


def test_the_head_is_lost_as_often_as_the_tracker_loses_it() -> None:
    columns = trial(MANUAL._replace(length=20_000.0)).columns
    lost = ~np.asarray(columns["head_yaw_valid"])
    begins = np.count_nonzero(lost[1:] & ~lost[:-1])
    # 0.01 per second over 17 minutes and more for turned heads: about 10 to 20,
    # Poisson; each is a short run in which the angle stays.
    assert 2 <= begins <= 40
    assert lost.mean() < 0.02
    yaw = columns["head_yaw"]
    assert (yaw[1:] == yaw[:-1])[lost[1:]].all()
    assert np.abs(yaw).max() <= 1.0


def test_no_intention_is_asked_when_it_is_off() -> None:
    columns = trial(STRONG._replace(intention="off")).columns
    assert np.isnan(columns["crossing_probability"]).all()
    assert not columns["intention"].any()


def test_a_network_that_is_given_is_asked_and_named(tmp_path: Path) -> None:
    network = intention_network(random_weights(4, 1), {})
    save_weights(tmp_path / "network.npz", network)
    setup = STRONG._replace(
        intention="network", length=200.0, weights=str(tmp_path / "network.npz")
    )
    record = simulate_trial(setup)
    assert record.metadata["intention_model_hash"] == network.hash
    probability = record.columns["crossing_probability"]
    assert np.isnan(probability[:179]).all()  # no verdict before the window is full
    assert np.isfinite(probability[179:]).all()


def test_metadata_says_what_was_run() -> None:
    metadata = trial(STRONG).metadata
    assert metadata["seed"] == 3
    assert metadata["condition"] == "strong-normal"
    assert metadata["driver"] == "virtual, population 3"
    assert metadata["driver_kind"] == "virtual"
    assert metadata["record_version"] == 2
    assert metadata["intention_model_hash"] is None
    assert metadata["driver_torque_source"] == "simulated"
    assert len(str(metadata["configuration_hash"])) == 64


def test_another_setting_gives_another_configuration_hash() -> None:
    other = STRONG._replace(parameters=(("consistency.hold_time", 0.2),))
    hashes = {trial(s).metadata["configuration_hash"] for s in (STRONG, other, MANUAL)}
    assert len(hashes) == 3


def test_a_drive_that_leaves_the_numbers_is_refused_and_says_when() -> None:
    wild = (("driver.tracking.wander_frequency", 100.0),)
    setup = TrialSetup(length=1300.0, intention="scripted", parameters=wild)
    with pytest.raises(ValueError, match=r"after \d+\.\d\d s .*wander_frequency=100"):
        simulate_trial(setup)


def test_a_predictor_that_is_not_asked_is_refused() -> None:
    setup = TrialSetup(length=200.0, intention="scripted", predictor="crossing-time")
    with pytest.raises(ValueError, match="'scripted' asks no predictor; leave"):
        simulate_trial(setup, "python")


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("speed", "70km/h"),
        ("length", None),
        ("participant", 1.5),
        ("participant", True),
        ("participant", 0),
        ("plant_steps", 8.5),
        ("events", "no"),
        ("car", 3),
        ("driver", None),
    ],
)
def test_what_is_of_another_kind_is_refused(field: str, value: object) -> None:
    with pytest.raises(ValueError, match=rf"{field} .*(give|choose)"):
        simulate_trial(TrialSetup(**{field: value}))  # type: ignore[arg-type]


def test_a_setup_out_of_range_is_refused_before_anything_runs() -> None:
    with pytest.raises(ValueError, match=r"speed is 0 m/s .*; give a number from 12"):
        simulate_trial(STRONG._replace(speed=0))
