"""One source, three engines: the same trial in Python, Numba and JAX.

Seen on an x86-64 machine (Python 3.11, Numba 0.68, JAX 0.10.2), largest difference
from Numba over the largest value of a column: Python 5e-16 (the pseudo-works,
whose sixty products NumPy adds in another order; all else to the bit), JAX 4e-14.
"""

from __future__ import annotations

import subprocess
import sys
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.controller.step import ControllerParameters
from costeer.drivers.interface import DriverNoise
from costeer.loop.jax_rollout import Fixed, float64, jax_rollouts, trace
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import LoopParameters
from costeer.loop.rollout import rollout
from costeer.loop.rows import rules_of, writer_of
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.tick import INTENTION_NETWORK, INTENTION_SCRIPTED, Script
from costeer.loop.trial import idle_network
from costeer.methods.ibhs import IBHS
from costeer.records.row import ROW_COLUMNS

ENGINES = ("python", "numba", "jax")
STEPS = 2400

STRONG = TrialSetup(
    participant=2,
    seed=900_001,
    condition="strong-normal",
    intention="scripted",
)
SCRIPT = Script(INTENTION_SCRIPTED, STRONG.prediction_horizon, np.array([35.0]))


def early_event(setup: TrialSetup) -> LoopParameters[ControllerParameters]:
    """The trial with its first leader after 100 m, so that 40 s hold an overtaking."""
    parameters = loop_parameters(setup)
    traffic = parameters.traffic._replace(first_event=100.0, appearance_distance=60.0)
    return parameters._replace(traffic=traffic)


def noise(setup: TrialSetup) -> NDArray[np.float64]:
    return driver_noise(setup.seed, setup.participant, setup.condition, STEPS)


@cache
def rows(engine: str, steps: int = STEPS) -> NDArray[np.float64]:
    """Forty seconds with scripted intention, strong guidance and an overtaking."""
    drawn = noise(STRONG)[:steps]
    return rollout(IBHS, early_event(STRONG), SCRIPT, idle_network(), drawn, engine)


def column(engine: str, name: str) -> NDArray[np.float64]:
    return rows(engine)[:, ROW_COLUMNS.index(name)]


def relative_difference(
    one: NDArray[np.float64], other: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Largest difference of each column over the column's largest value."""
    scale = np.nanmax(np.abs(other), axis=0)
    return np.nanmax(np.abs(one - other), axis=0) / np.where(scale > 0.0, scale, 1.0)


def test_the_drive_holds_lane_changes_guidance_and_a_dispute() -> None:
    assert set(column("numba", "lane")) == {0.0, 1.0}
    assert set(column("numba", "mode")) == {1.0, 2.0}
    assert set(column("numba", "driver_intention")) == {-1.0, 0.0, 1.0}
    assert set(column("numba", "consistent")) == {0.0, 1.0}
    assert column("numba", "haptic_gain").min() < 0.05 < 0.99
    assert np.abs(column("numba", "applied_torque")).max() > 1.0


@pytest.mark.no_cover  # tracing so much plain Python takes half a minute
@pytest.mark.parametrize(
    ("engine", "steps"),
    [
        ("python", 800),
        *(pytest.param(e, STEPS, marks=pytest.mark.slow) for e in ("python", "jax")),
    ],
)
def test_every_column_agrees_to_one_in_a_billion(engine: str, steps: int) -> None:
    # Rounding alone parts the engines, and the loop damps it: 1e-9 leaves room for
    # another order of additions and other libraries' tanh, not for another equation.
    # A verdict drawn one step apart would show as a difference of 1.
    there, here = rows(engine, steps), rows("numba")[:steps]
    np.testing.assert_array_equal(np.isnan(there), np.isnan(here))
    difference = relative_difference(there, here)
    worst = int(np.argmax(difference))
    print(f"{engine}: {difference[worst]:.0e} in {ROW_COLUMNS[worst]}")
    assert difference[worst] < 1e-9, ROW_COLUMNS[worst]


def test_another_plant_step_is_seen_as_a_difference() -> None:
    # What 1e-9 would catch: 9 plant steps in a control step instead of 8.
    finer = early_event(STRONG)._replace(plant_steps=9)
    other = rollout(IBHS, finer, SCRIPT, idle_network(), noise(STRONG), "numba")
    assert relative_difference(other, rows("numba")).max() > 1e-6


@pytest.mark.slow  # compiles the batch, 10 s
def test_drivers_together_in_jax_drive_as_each_alone() -> None:
    others = [STRONG, STRONG._replace(participant=3)]
    together = jax_rollouts(
        IBHS,
        [early_event(setup) for setup in others],
        SCRIPT,
        np.stack([noise(setup) for setup in others]),
    )
    for setup, drove in zip(others, together, strict=True):
        alone = rollout(
            IBHS,
            early_event(setup),
            SCRIPT,
            idle_network(),
            noise(setup),
            "numba",
        )
        assert relative_difference(drove, alone).max() < 1e-9


@pytest.mark.slow
def test_a_road_that_ends_ends_the_trial_in_every_engine() -> None:
    parameters = early_event(STRONG)
    short = parameters._replace(road=parameters.road._replace(length=200.0))
    counts = {
        engine: len(
            rollout(
                IBHS,
                short,
                SCRIPT,
                idle_network(),
                noise(STRONG),
                engine,
            )
        )
        for engine in ENGINES
    }
    assert counts["python"] == counts["numba"] == counts["jax"] < STEPS


def test_jax_refuses_the_network() -> None:
    asked = Script(INTENTION_NETWORK, 3.0, np.array([]))
    with pytest.raises(ValueError, match="'jax' does not run the intention network"):
        rollout(
            IBHS,
            early_event(STRONG),
            asked,
            idle_network(),
            noise(STRONG),
            "jax",
        )


def test_trials_together_need_one_number_of_plant_steps() -> None:
    parameters = early_event(STRONG)
    two = [parameters, parameters._replace(plant_steps=16)]
    with pytest.raises(ValueError, match=r"have \[8, 16\] plant steps"):
        jax_rollouts(IBHS, two, SCRIPT, np.zeros((2, 10, len(DriverNoise._fields))))


def test_an_unknown_engine_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="engine 'cuda' is not known; choose numba"):
        rows("cuda")


@pytest.mark.slow
def test_without_jax_the_engine_says_what_to_install() -> None:
    program = (
        "import sys; sys.modules['jax'] = None\n"
        "from costeer.loop.scenario import TrialSetup\n"
        "from costeer.loop.trial import simulate_trial\n"
        "simulate_trial(TrialSetup(intention='off', length=100.0), 'jax')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "[jax]', or choose the engine numba or python" in done.stderr


@pytest.mark.slow
def test_a_gradient_through_the_loop_equals_a_finite_difference() -> None:
    import jax

    setup = STRONG._replace(driver="hands-off", events=False, initial_offset=0.5)
    parameters, drawn = loop_parameters(setup), noise(setup)[:180]

    def offset_after_three_seconds(gain: float) -> float:
        guidance = parameters.controller.guidance._replace(lateral_error_gain=gain)
        controller = parameters.controller._replace(guidance=guidance)
        changed = parameters._replace(controller=controller)
        fixed = Fixed(rules_of(IBHS), writer_of(IBHS).values, 8, INTENTION_SCRIPTED, 0)
        _, filled = trace(changed, 3.0, np.array([]), drawn, fixed)
        return filled[-1, ROW_COLUMNS.index("lateral_position")]

    with float64():
        slope = float(jax.grad(offset_after_three_seconds)(1.5))
        step = 1e-6
        after, before = map(
            jax.jit(offset_after_three_seconds), (1.5 + step, 1.5 - step)
        )
        # Central difference of numbers near 0.1 m: rounding 1e-17 / 1e-6, and the
        # square of the step; stiction's kinks are not met by so small a step.
        assert slope == pytest.approx(float(after - before) / (2.0 * step), rel=1e-6)
    assert abs(slope) > 1e-4
