"""The compiled control step between packed arrays is the controller, nothing else."""

from __future__ import annotations

import math

import numpy as np
import pytest

from costeer.base.packing import pack, packed
from costeer.controller import step as controller
from costeer.controller.realtime import (
    INPUT_NAMES,
    SIGNAL_NAMES,
    ControlInput,
    control_step,
    packed_controller,
)
from costeer.controller.signals import Request
from costeer.controller.step import ControllerParameters
from costeer.sensing.measurement import Measurement

# Drives and trials run another entry; this one, for benchmarks, compiles for long.
pytestmark = pytest.mark.slow

DT = 1.0 / 60.0
PARAMETERS = ControllerParameters()
LEFT_LANE = 1.0


def inputs() -> list[ControlInput]:
    """Five seconds: keeping the lane, then a lane change with a driver who resists."""
    generator = np.random.default_rng(1)
    return [
        ControlInput(
            measurement=Measurement(
                longitudinal_position=19.4 * DT * k,
                lateral_position=0.3 * math.sin(k / 9.0),
                yaw_angle=0.01 * math.cos(k / 9.0),
                yaw_rate=0.05 + 0.02 * float(generator.normal()),
                longitudinal_velocity=19.4,
                longitudinal_acceleration=0.0,
                lateral_velocity=0.0,
                lateral_acceleration=0.0,
                steering_wheel_angle=0.05 * math.sin(k / 5.0),
                steering_wheel_rate=0.0,
                front_slip_angle=0.0,
                driver_torque=2.0 + float(generator.normal()) / 4.0,
                head_yaw=0.0,
                head_yaw_valid=True,
                lane=LEFT_LANE,
                side=-1.0,
                distance_to_adjacent_lane=1.75,
            ),
            request=Request(1.0 if k > 100 else math.nan),
        )
        for k in range(300)
    ]


def test_packed_step_gives_the_signals_and_the_state_of_the_python_step() -> None:
    memory = packed_controller(PARAMETERS, LEFT_LANE)
    state = controller.initial_state(PARAMETERS, LEFT_LANE)
    gains = []
    for given in inputs():
        state, signals = controller.step(PARAMETERS, state, *given, DT)
        pack(memory.given, given)
        control_step(*memory, DT)
        # Sums of 60 products may differ in order: a few units in the last place.
        np.testing.assert_allclose(memory.signals, packed(signals), 1e-12, 1e-15)
        np.testing.assert_allclose(memory.state, packed(state), 1e-12, 1e-15)
        gains.append(signals.haptic_gain)
    assert min(gains) < 0.5  # the fade was part of the run


def test_compiled_and_plain_step_between_arrays_agree() -> None:
    here, there = (packed_controller(PARAMETERS, LEFT_LANE) for _ in range(2))
    plain = control_step.py_func  # type: ignore[attr-defined]  # Numba adds it
    for given in inputs()[:120]:
        for memory, run in ((here, control_step), (there, plain)):
            pack(memory.given, given)
            run(*memory, DT)
        np.testing.assert_allclose(here.signals, there.signals, 1e-12, 1e-15)


def test_names_tell_every_packed_number() -> None:
    memory = packed_controller(PARAMETERS, LEFT_LANE)
    assert len(INPUT_NAMES) == memory.given.size == len(set(INPUT_NAMES))
    assert len(SIGNAL_NAMES) == memory.signals.size == len(set(SIGNAL_NAMES))
