"""The mirrored world gives the mirrored trial: nothing in the loop knows a side.

Right-hand traffic, the driver's bias and all signed noise mirrored: positions mirror at
the line between the lanes, lanes change places, every signed signal changes its sign.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.controller.step import ControllerParameters
from costeer.drivers.interface import DriverNoise
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import LoopParameters
from costeer.loop.rollout import rollout
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.tick import INTENTION_SCRIPTED, Script
from costeer.loop.trial import idle_network
from costeer.methods.ibhs import IBHS
from costeer.records.columns import COLUMNS, Column
from costeer.records.row import ROW_COLUMNS
from tests.records.mirror import mirrored_column

SETUP = TrialSetup(
    participant=2,
    seed=900_001,
    condition="strong-normal",
    intention="scripted",
    initial_offset=0.3,
)
STEPS = 5400
SCRIPT = Script(INTENTION_SCRIPTED, 3.0, np.array([75.0]))

SIGNED_DRAWS = ("near", "motor", "wander", "head_drift", "head_tracker")


def mirrored_parameters(
    parameters: LoopParameters[ControllerParameters],
) -> LoopParameters[ControllerParameters]:
    """Right-hand traffic and a driver who leans to the other side."""
    road = parameters.road._replace(overtaking_side=1.0)
    driver = parameters.driver
    bias = -driver.tracking.lane_bias
    return parameters._replace(
        road=road,
        controller=parameters.controller._replace(road=road),
        driver=driver._replace(tracking=driver.tracking._replace(lane_bias=bias)),
        start=parameters.start._replace(
            lateral_offset=-parameters.start.lateral_offset
        ),
    )


def mirrored_noise(noise: NDArray[np.float64]) -> NDArray[np.float64]:
    """Signed draws change sign; a draw of the left side becomes one of the right."""
    mirrored = noise.copy()
    for name in SIGNED_DRAWS:
        mirrored[:, DriverNoise._fields.index(name)] *= -1.0
    side = DriverNoise._fields.index("glance_side_uniform")
    mirrored[:, side] = 1.0 - noise[:, side]
    return mirrored


@cache
def trial(mirrored: bool) -> NDArray[np.float64]:
    """Ninety seconds with an overtaking after 100 m, in one of the two worlds."""
    parameters = loop_parameters(SETUP)
    traffic = parameters.traffic._replace(first_event=100.0, appearance_distance=60.0)
    parameters = parameters._replace(traffic=traffic)
    noise = driver_noise(SETUP.seed, SETUP.participant, SETUP.condition, STEPS)
    if mirrored:
        parameters, noise = mirrored_parameters(parameters), mirrored_noise(noise)
    return rollout(IBHS, parameters, SCRIPT, idle_network(), noise, "numba")


def test_the_trial_changes_lanes_under_guidance_that_fades_and_returns() -> None:
    lanes = trial(mirrored=False)[:, ROW_COLUMNS.index("lane")]
    gains = trial(mirrored=False)[:, ROW_COLUMNS.index("haptic_gain")]
    assert set(lanes) == {0.0, 1.0}
    assert gains.min() < 0.5


@pytest.mark.parametrize("column", COLUMNS, ids=lambda column: column.name)
def test_a_column_mirrors(column: Column) -> None:
    place = ROW_COLUMNS.index(column.name)
    here, there = (trial(mirrored=side)[:, place] for side in (False, True))
    # Positions near 0 and near -3.5 m are rounded differently, by 4e-16; the loop damps
    # that after raising it to 2e-11 at most; no verdict may fall a step apart.
    scale = max(1.0, float(np.nanmax(np.abs(here))))
    wanted = mirrored_column(column, here)
    np.testing.assert_allclose(there, wanted, rtol=0.0, atol=1e-9 * scale)


def test_every_signed_column_is_seen_on_both_sides() -> None:
    # The road is straight; tests/closed_loop/test_curves.py mirrors bends.
    places = [
        k
        for k, column in enumerate(COLUMNS)
        if column.mirrored == "flipped" and column.name != "road_curvature"
    ]
    signed = trial(mirrored=False)[:, places]
    assert (signed.min(axis=0) < 0.0).all()
    assert (signed.max(axis=0) > 0.0).all()
