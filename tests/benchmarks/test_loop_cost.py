"""Operations are counted as they are written, and counting changes no number."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import loop_cost
from benchmarks.loop_cost import Number, counted_loop, counts
from costeer.base import array as xp
from costeer.base.packing import packed
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT
from costeer.loop.rollout import rollout
from costeer.loop.scenario import loop_parameters, trial_method
from costeer.loop.tick import INTENTION_SCRIPTED, PREDICTION_HORIZON, Script
from costeer.loop.trial import idle_network
from costeer.records.row import ROW_COLUMNS

SECONDS = 2.0


def test_a_formula_has_the_operations_one_sees() -> None:
    counts.clear()
    x, k = Number(0.5), Number(2.0)
    with loop_cost._counted_functions():
        value = xp.sin(x) * k + 1.0 / x - xp.clip(x, 0.0, k)
    assert float(value) == np.sin(0.5) * 2.0 + 2.0 - 0.5
    seen = {kind: n for (stage, kind), n in counts.items() if stage == "rest"}
    assert seen == {"sin": 1, "x": 1, "+ -": 2, "/": 1, "compare": 2, "select": 2}


def test_counting_changes_no_number_and_sees_every_plant_step() -> None:
    setup = loop_cost.SETUP
    state = counted_loop(setup, SECONDS)
    parameters, steps = loop_parameters(setup), round(SECONDS / DT)
    script = Script(INTENTION_SCRIPTED, PREDICTION_HORIZON, np.empty(0))
    noise = driver_noise(setup.seed, setup.participant, setup.condition, steps + 1)
    method, network = trial_method(setup), idle_network()
    rows = rollout(method, parameters, script, network, noise, "python")
    position = rows[-1, ROW_COLUMNS.index("longitudinal_position")]
    assert state.world.vehicle.longitudinal_position == position
    assert np.isfinite(packed(state.world)).all()
    # Runge-Kutta of fourth order: the heading's sine and cosine four times a plant
    # step, and once more for what the road does to the car.
    plant_steps = steps * parameters.plant_steps
    assert counts["car, column and arms", "sin"] % plant_steps == 0
    assert counts["car, column and arms", "sin"] >= 4 * plant_steps


@pytest.mark.parametrize("stage", ["driver", "method", "sensors", "rest"])
def test_each_stage_has_operations_of_its_own(stage: str) -> None:
    counted_loop(loop_cost.SETUP, 0.5)
    assert counts[stage, "+ -"] > 0
