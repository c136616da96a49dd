"""How a trial ends: a car that stands for good, and what its record says."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from costeer.loop.endings import has_stopped, outcome_of, still, stopped_rows
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.plant.place import BARRIER
from costeer.records.columns import TrialRecord
from costeer.records.row import ROW_COLUMNS
from costeer.scenarios.definition import Actor, Road, Scenario, When

DT = 1.0 / 60.0
SPEED = ROW_COLUMNS.index("longitudinal_velocity")
PLACE = ROW_COLUMNS.index("longitudinal_position")
CONTACT = ROW_COLUMNS.index("contact")

BLOCKED = Scenario(
    "blocked",
    road=Road(length=1500.0),
    actors=(
        Actor("load", "obstacle", 1, appears=When(place=300.0), headway=3.0),
        Actor("close behind", lane=0, at=-12.5, speed="70 km/h", follows=True),
    ),
)
"""An obstacle in the lane, and no room beside it."""


@cache
def blocked(engine: str = "numba", participant: int = 3, **_: object) -> TrialRecord:
    setup = TrialSetup(
        participant=participant,
        seed=3,
        condition="manual",
        intention="off",
        length=1500.0,
        scenario=BLOCKED,
    )
    return simulate_trial(setup, engine)


def rows_of(speeds: np.ndarray) -> np.ndarray:
    rows = np.zeros((len(speeds), len(ROW_COLUMNS)))
    rows[:, SPEED] = speeds
    rows[:, PLACE] = np.cumsum(speeds) * DT
    return rows


def test_who_stands_behind_an_obstacle_for_good_ends_the_trial() -> None:
    record = blocked()
    speed = record.columns["longitudinal_velocity"]
    assert record.metadata["outcome"] == "stopped"
    assert record.columns["contact"][-1] == 0.0
    # Half a minute of standing, and not a step more.
    assert (speed[-1800:] < 0.1).all()
    assert speed[-1801] >= 0.1


@pytest.mark.slow
@pytest.mark.no_cover
def test_engines_end_at_the_same_step() -> None:
    ends = {len(blocked(engine).columns["time"]) for engine in ("numba", "jax")}
    assert len(ends) == 1


def test_standing_counts_anew_after_a_metre() -> None:
    speeds = np.concatenate([np.zeros(1799), [1.0], np.zeros(1801)])
    found = np.flatnonzero(stopped_rows(rows_of(speeds)))
    np.testing.assert_array_equal(found, [3599, 3600])
    standing, ends = 0.0, []
    for k, speed in enumerate(speeds):
        standing = still(standing, float(speed))
        ends += [k] if has_stopped(standing) else []
    assert ends == [3599, 3600]


@pytest.mark.parametrize(
    ("speed", "length", "contact", "told"),
    [
        (20.0, 20.0, 0.0, "arrived"),
        (20.0, 30.0, 0.0, "out of time"),
        (20.0, 20.0, BARRIER, "collision"),
    ],
)
def test_a_record_says_how_it_ended(
    speed: float, length: float, contact: float, told: str
) -> None:
    rows = rows_of(np.full(60, speed))
    rows[-1, CONTACT] = contact
    assert outcome_of(rows, length) == told
