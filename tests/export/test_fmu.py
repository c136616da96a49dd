"""The guidance as an FMU, read and run by FMPy."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pythonfmu3", reason="the extra fmu is not installed")
pytest.importorskip("fmpy", reason="FMPy is not installed")

from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

from costeer.base.described import described
from costeer.controller.signals import Request
from costeer.export.fmu import write_fmu
from costeer.loop.parameters import DT
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.methods.ibhs import IBHS
from costeer.sensing.measurement import Measurement, standing_start

GAIN = "guidance.lateral_error_gain"
STEPS = 90

RUN = """
import sys
from fmpy import simulate_fmu
from costeer.loop.parameters import DT
times = {"stop_time": 2 * DT, "step_size": DT, "output_interval": DT}
start = {"distance_to_adjacent_lane": 1.0}
for row in simulate_fmu(sys.argv[1], start_values=start, **times):
    print(row["applied_torque"])
"""


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> str:
    return str(write_fmu(tmp_path_factory.mktemp("fmu") / "guidance.fmu"))


def by_causality(fmu: str, causality: str) -> dict[str, Any]:
    """The variables of an FMU of one kind, by name."""
    variables = read_model_description(fmu).modelVariables
    return {each.name: each for each in variables if each.causality == causality}


def test_the_file_keeps_the_standard(fmu: str) -> None:
    assert validate_fmu(fmu) == []
    assert read_model_description(fmu).fmiVersion == "3.0"


def test_inputs_are_the_signals_of_a_method_and_parameters_have_their_names(
    fmu: str,
) -> None:
    assert set(by_causality(fmu, "input")) == {*Measurement._fields, *Request._fields}
    world = loop_parameters(TrialSetup(condition="strong-normal", intention="off"))
    wanted = {each.name: each.value for each in described(world.controller)}
    found = by_causality(fmu, "parameter")
    assert {name: float(each.start) for name, each in found.items()} == wanted
    assert {"applied_torque", "planned_steering_angle", "mode"} <= set(
        by_causality(fmu, "output")
    )


def given_signals() -> np.ndarray:
    """A car that swings about its lane, and a lane change that is announced."""
    time = np.arange(STEPS + 1) * DT
    rows = np.zeros(
        len(time),
        dtype=[
            ("time", float),
            ("lateral_position", float),
            ("steering_wheel_angle", float),
            ("crossing_probability", float),
        ],
    )
    rows["time"] = time
    rows["lateral_position"] = 0.3 * np.sin(2.0 * time)
    rows["steering_wheel_angle"] = 0.05 * np.cos(2.0 * time)
    rows["crossing_probability"] = np.where(time > 0.7, 0.9, -1.0)
    return rows


def test_it_computes_what_the_method_computes(fmu: str) -> None:
    signals = given_signals()
    result = simulate_fmu(
        fmu,
        stop_time=STEPS * DT,
        step_size=DT,
        output_interval=DT,
        start_values={GAIN: 3.0},
        input=signals,
        output=["applied_torque", "planned_steering_angle", "mode"],
    )
    setup = TrialSetup(
        condition="strong-normal", intention="off", parameters=((GAIN, 3.0),)
    )
    world = loop_parameters(setup)
    start = standing_start(world.road)
    state = IBHS.initial_state(world.controller, start.lane)
    modes = set()
    for k in range(STEPS):
        probability = float(signals["crossing_probability"][k])
        state, wanted = IBHS.step(
            world.controller,
            state,
            start._replace(
                lateral_position=float(signals["lateral_position"][k]),
                steering_wheel_angle=float(signals["steering_wheel_angle"][k]),
            ),
            Request(probability if probability >= 0.0 else math.nan),
            DT,
        )
        row = result[k + 1]  # FMPy's first row is that before the first step
        # FMPy interpolates its inputs, which costs a rounding.
        assert row["applied_torque"] == pytest.approx(wanted.applied_torque, abs=1e-9)
        planned = wanted.preview.planned_steering_angle
        assert row["planned_steering_angle"] == pytest.approx(planned, abs=1e-9)
        assert row["mode"] == wanted.target.mode
        modes.add(row["mode"])
    assert modes == {1.0, 2.0}


@pytest.mark.slow
def test_a_method_of_ones_own_is_in_the_file(tmp_path: Path) -> None:
    own = Path(__file__).parents[2] / "examples" / "methods" / "pi_keeping.py"
    fmu = str(write_fmu(tmp_path / "pi.fmu", str(own), "weak-gentle"))
    assert float(by_causality(fmu, "parameter")["strength"].start) == 0.4
    # In a process of its own: this one may have loaded the method from its own place.
    run = subprocess.run(
        [sys.executable, "-c", RUN, fmu], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    found = [float(line) for line in run.stdout.split()]
    # 0.75 m right of the middle: 0.4 (1.2 · 0.75 + 0.2 · 0.75 k/60) N·m to the left.
    wanted = [0.4 * 0.75 * (1.2 + 0.2 * k * DT) for k in (1, 2)]
    assert found[1:] == pytest.approx(wanted)


def test_a_step_that_is_no_control_step_is_refused(fmu: str) -> None:
    with pytest.raises(Exception, match="fmi3DoStep"):
        simulate_fmu(fmu, stop_time=0.02, step_size=0.01, output_interval=0.01)


def test_a_file_that_exists_and_what_cannot_be_run_are_refused(
    fmu: str, tmp_path: Path
) -> None:
    for wrong in (fmu, str(tmp_path / "guidance.zip")):
        with pytest.raises(ValueError, match="new name that ends in"):
            write_fmu(wrong)
    with pytest.raises(ValueError, match="nobody"):
        write_fmu(tmp_path / "a.fmu", "nobody")
    with pytest.raises(ValueError, match="condition"):
        write_fmu(tmp_path / "a.fmu", condition="strong")
