"""A method of one's own closes the loop: in trials, with a person, from a file."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from costeer.base.array import Real, compiled
from costeer.base.packing import pack
from costeer.controller.signals import Assistance, Request
from costeer.loop.half_step import NO_FAULT, NOT_FINITE, OVER_LIMIT
from costeer.loop.realtime import (
    NOTHING_GIVEN,
    control_tick,
    hands_tick,
    person_memory,
)
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.loop.trial import simulate_trial
from costeer.methods.conditions import Condition
from costeer.methods.ibhs import IBHS
from costeer.methods.interface import Method
from costeer.methods.registry import METHODS
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.records.columns import TrialRecord
from costeer.records.row import ROW_COLUMNS
from costeer.sensing.measurement import Measurement


class SteadyParameters(NamedTuple):
    """What the method always asks for [N·m], and a scale that may be too large."""

    torque: Real
    scale: Real


class SteadyState(NamedTuple):
    """How often it was asked [-]."""

    num_steps: Real


@compiled
def nothing_yet(parameters: SteadyParameters, lane: Real) -> SteadyState:
    return SteadyState(num_steps=0.0)


@compiled
def ask(
    parameters: SteadyParameters,
    state: SteadyState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[SteadyState, Assistance]:
    """The same torque again; the gain tells how often it was asked before."""
    torque = parameters.torque * (parameters.scale * parameters.scale)
    asked = Assistance(applied_torque=torque, haptic_gain=state.num_steps)
    return SteadyState(num_steps=state.num_steps + 1.0), asked


def steady(torque: float) -> Method[SteadyParameters, SteadyState]:
    """A method that always asks for one torque [N·m]."""

    def parameters(
        condition: Condition,
        car: CarParameters,
        column: ColumnParameters,
        road: RoadParameters,
    ) -> SteadyParameters:
        # Parameters are finite; 1e200 squared is not, and 0 times that is no number.
        if math.isfinite(torque):
            return SteadyParameters(torque=torque, scale=1.0)
        return SteadyParameters(torque=-1.0 if torque < 0.0 else 0.0, scale=1e200)

    return Method(
        name="steady",
        version="7",
        source="this test",
        parameters=parameters,
        initial_state=nothing_yet,
        step=ask,
    )


CALM = steady(0.0)
SETUP = TrialSetup(
    condition="strong-normal",
    intention="off",
    events=False,
    initial_offset=0.5,
    length=100.0,
)
PLACE = f"{__file__}:CALM"
ENGINES = pytest.mark.parametrize(
    "engine", [pytest.param("numba", marks=pytest.mark.slow), "python"]
)


@cache
def trial(method: str | Method[Any, Any], engine: str = "numba") -> TrialRecord:
    return simulate_trial(SETUP._replace(method=method), engine)


def as_bytes(record: TrialRecord) -> dict[str, bytes]:
    return {name: np.ma.filled(v, -9).tobytes() for name, v in record.columns.items()}


@ENGINES
def test_a_method_that_asks_for_nothing_gives_nothing(engine: str) -> None:
    columns = trial(CALM, engine).columns
    assert not columns["applied_torque"].any()
    num_steps = len(columns["haptic_gain"])
    np.testing.assert_array_equal(columns["haptic_gain"], np.arange(num_steps))
    assert trial(IBHS).columns["applied_torque"].any()  # which would push back


@pytest.mark.slow
def test_what_a_method_does_not_compute_is_missing_in_its_record() -> None:
    columns = trial(CALM).columns
    assert np.isnan(columns["lateral_error"]).all()
    assert np.ma.getmaskarray(columns["target_lane"]).all()


@pytest.mark.slow
def test_the_method_closes_the_loop_of_a_person() -> None:
    parameters = loop_parameters(SETUP._replace(method=CALM, plant_steps=16))
    memory = person_memory(CALM, parameters)
    pack(memory.given, NOTHING_GIVEN._replace(intended_angle=0.1, grip=1.0))
    rows = []
    for _ in range(60):
        control_tick(CALM)(
            memory.parameters,
            memory.state,
            memory.motion,
            memory.given,
            False,
            memory.held,
            memory.row,
        )
        rows.append(dict(zip(ROW_COLUMNS, memory.row.tolist(), strict=True)))
        for _ in range(16):
            hands_tick(memory.plant, memory.motion, memory.held)
    assert {row["applied_torque"] for row in rows} == {0.0}
    assert [row["haptic_gain"] for row in rows] == list(range(60))
    assert rows[-1]["steering_wheel_angle"] > 0.05  # the hands turned the wheel


@pytest.mark.slow
def test_object_name_and_place_of_a_method_give_the_same_bytes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    there = trial(PLACE)
    monkeypatch.setitem(METHODS, "steady", CALM)
    named = simulate_trial(SETUP._replace(method="steady"))
    for other in (there, named):
        assert as_bytes(other) == as_bytes(trial(CALM))
        assert other.metadata["method"] == "steady"
        assert other.metadata["method_version"] == "7"
        assert (
            other.metadata["method_source_hash"]
            == trial(CALM).metadata["method_source_hash"]
            != trial(IBHS).metadata["method_source_hash"]
        )


@pytest.mark.parametrize("known", [CALM, IBHS])
def test_two_methods_of_one_name_are_refused(
    known: Method[Any, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(METHODS, known.name, known)
    other = steady(1.0)._replace(name=known.name)
    with pytest.raises(ValueError, match=f"two methods are called '{known.name}'"):
        loop_parameters(SETUP._replace(method=other))


@ENGINES
@pytest.mark.parametrize(
    ("torque", "fault", "command"),
    [
        (0.0, NO_FAULT, 0.0),
        (-5.0, NO_FAULT, -5.0),
        (math.nan, NOT_FINITE, 0.0),
        pytest.param(-math.inf, NOT_FINITE, 0.0, marks=pytest.mark.slow),
        (50.0, OVER_LIMIT, 5.0),
        pytest.param(-50.0, OVER_LIMIT, -5.0, marks=pytest.mark.slow),
    ],
)
def test_a_torque_that_cannot_be_given_is_contained_and_told(
    torque: float, fault: float, command: float, engine: str
) -> None:
    record = trial(steady(torque), engine)
    assert set(record.columns["torque_fault"]) == {fault}
    num_steps = len(record.columns["torque_fault"])
    assert record.metadata["torque_faults"] == (num_steps if fault else 0)
    torques = record.columns["applied_torque"]
    # After five seconds the motor's lag of 20 ms is over.
    assert torques[-1] == pytest.approx(command)
    assert np.abs(torques).max() <= abs(command)


PROGRAM = """
import sys
from costeer.loop.parameters import LoopParameters
from costeer.loop.realtime import control_tick, person_memory
from costeer.records.row import ROW_COLUMNS
from costeer.methods.interface import usual_parameters
from costeer.methods.registry import method_named

method = method_named(sys.argv[1])
memory = person_memory(method, LoopParameters(controller=usual_parameters(method)))
tick = control_tick(method)
arrays = memory.parameters, memory.state, memory.motion, memory.given
tick(*arrays, False, memory.held, memory.row)
gain = memory.row[ROW_COLUMNS.index("haptic_gain")]
print(gain, sum(tick.stats.cache_hits.values()))
"""

RIVAL = """
from typing import NamedTuple

from costeer.base.array import compiled
from costeer.controller.signals import Assistance
from costeer.methods.interface import Method
from law import gain

FACTOR = {factor}

class Nothing(NamedTuple):
    nothing: float

def parameters(condition, car, column, road):
    return Nothing(0.0)

@compiled
def initial_state(parameters, lane):
    return parameters

@compiled
def step(parameters, state, measurement, request, dt):
    return state, Assistance(haptic_gain=FACTOR * gain())

METHOD = Method("rival", "1", "a file", parameters, initial_state, step)
"""

LAW = """
from costeer.base.array import compiled

@compiled
def gain():
    return {gain}
"""


@pytest.mark.slow
def test_an_edited_file_runs_as_edited_and_an_unchanged_one_from_the_cache(
    tmp_path: Path,
) -> None:
    rival, law = tmp_path / "rival.py", tmp_path / "law.py"

    def ran() -> tuple[float, int]:
        """The gain that a new process records, and what it took from the cache."""
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, str(rival)],
            env=os.environ | {"COSTEER_CACHE": str(tmp_path / "cache")},
            capture_output=True,
            text=True,
            check=True,
        )
        gain, hits = done.stdout.split()
        return float(gain), int(hits)

    rival.write_text(RIVAL.format(factor=2.0))
    law.write_text(LAW.format(gain=0.25))
    assert ran() == (0.5, 0)
    assert ran() == (0.5, 1)
    law.write_text(LAW.format(gain=0.5))
    assert ran() == (1.0, 0)
    rival.write_text(RIVAL.format(factor=4.0))
    assert ran() == (2.0, 0)
