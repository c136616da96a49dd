"""Half a minute of closed loop with each method, on two roads, in each engine."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from costeer.loop.noise import driver_noise
from costeer.loop.rollout import rollout
from costeer.loop.rows import writer_of
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.tick import INTENTION_SCRIPTED, Script
from costeer.loop.trial import idle_network
from costeer.methods.registry import METHODS

STEPS = 1800
ROADS = ("expressway", "expressway-curves")


@cache
def rows(
    method: str,
    road: str,
    engine: str,
    steps: int = STEPS,
    strength_factor: float = math.nan,
) -> NDArray[np.float64]:
    """A pilot driver under strong guidance overtakes a leader who appears at 100 m.

    Args:
        method: Its name.
        road: Name of the scenario; its first bend begins at 300 m, if it has any.
        engine: "python", "numba" or "jax".
        steps: Of 1/60 s; a lane change is asked for from outside at 25 s.
        strength_factor: Of the guidance [-]; NaN: that of strong-normal.

    Returns:
        Rows in the order of `names`, shape `(time, column)`.
    """
    usual = math.isnan(strength_factor)
    setup = TrialSetup(
        participant=2,
        seed=900_001,
        condition="strong-normal" if usual else "strong",
        strength_factor=strength_factor,
        change_duration=math.nan if usual else 6.0,
        method=method,
        intention="scripted",
        initial_offset=0.3,
        scenario=road,
    )
    given = loop_parameters(setup)
    soon = given.traffic._replace(first_event=100.0, appearance_distance=60.0)
    noise = driver_noise(setup.seed, setup.participant, setup.condition, STEPS)
    return rollout(
        METHODS[method],
        given._replace(traffic=soon),
        Script(INTENTION_SCRIPTED, setup.prediction_horizon, np.array([25.0])),
        idle_network(),
        noise[:steps],
        engine,
    )


def names(method: str) -> list[str]:
    """Of the columns, those that the method adds included."""
    return [column.name for column in writer_of(METHODS[method]).columns]


def apart(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest difference of each column over the column's largest value.

    Raises:
        AssertionError: If one has a number where the other has none.
    """
    np.testing.assert_array_equal(np.isnan(one), np.isnan(other))
    scale = np.max(np.abs(np.nan_to_num(other)), axis=0)
    difference = np.max(np.abs(np.nan_to_num(one - other)), axis=0)
    return np.asarray(difference / np.where(scale > 0.0, scale, 1.0))
