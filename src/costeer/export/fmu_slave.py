"""The guidance as a model of FMI 3.0; this file lies in every FMU that costeer writes.

A tool that opens the FMU runs it with the Python in which costeer is installed. What is
in the FMU's `controller.json` says which method and condition it is.
"""

from __future__ import annotations

import json
import math
from functools import partial
from pathlib import Path
from typing import Any

from pythonfmu3 import (
    Boolean,
    DefaultExperiment,
    Float64,
    Fmi3Causality,
    Fmi3Slave,
    Fmi3Variability,
)

from costeer import __version__
from costeer.base.described import Described, described, value_at, with_values
from costeer.controller.signals import Assistance, Request
from costeer.loop.parameters import DT
from costeer.loop.scenario import TrialSetup, loop_parameters
from costeer.methods.registry import method_named
from costeer.sensing.measurement import standing_start

NO_REQUEST = Request(crossing_probability=-1.0, change_duration=0.0)
"""At the start. FMI cannot write down NaN: a negative probability is no verdict, a
duration of 0 the method's own."""

OUTPUTS = {
    "applied_torque": ("applied_torque", "asked of the motor [N·m]"),
    "planned_steering_angle": (
        "preview.planned_steering_angle",
        "of the wheel at the preview point [rad]",
    ),
    "target_lateral_position": ("target.lateral_position", "planned, at the car [m]"),
    "mode": ("target.mode", "1 lane keeping, 2 lane changing"),
    "haptic_gain": ("haptic_gain", "K_h [-]"),
    "intention": ("intention", "1 if a lane change has been detected"),
    "consistent": ("consistency.consistent", "verdict of Table III, 1 or 0"),
}
"""Name of each output, its place in the `Assistance`, and what it is."""


class Controller(Fmi3Slave):  # type: ignore[misc]  # it ships no types
    """A method of assistance, called once in a control step."""

    def __init__(self, **told: Any) -> None:  # Any: of pythonfmu3
        super().__init__(**told)
        folder = Path(self.resources)
        about = json.loads((folder / "controller.json").read_text("utf-8"))
        if about["method"].endswith(".py"):
            about["method"] = str(folder / about["method"])
        self._method = method_named(about["method"])
        world = loop_parameters(TrialSetup(intention="off", **about))
        self._parameters = world.controller
        self._measurement, self._request = standing_start(world.road), NO_REQUEST
        self._assistance, self._state, self._time = Assistance(), None, 0.0
        self.modelName = "Controller"
        self.version = __version__
        self.description = f"costeer {self._method.name}, {about['condition']}"
        self.default_experiment = DefaultExperiment(step_size=DT)
        self._register_all()

    def _register_all(self) -> None:
        """Declare time, inputs, outputs and parameters."""
        self._register(
            Float64(
                "time",
                causality=Fmi3Causality.independent,
                variability=Fmi3Variability.continuous,
                getter=lambda: self._time,
            )
        )
        for each in described(self._measurement):
            self._register_input("_measurement", each)
        for each in described(self._request):
            if each.name != "side":  # a method hears it as that of the measurement
                self._register_input("_request", each)
        for name, (place, meaning) in OUTPUTS.items():
            self._register(
                Float64(
                    name,
                    causality=Fmi3Causality.output,
                    description=meaning,
                    getter=partial(self._output, place),
                )
            )
        for each in described(self._parameters):
            self._register(
                Float64(
                    each.name,
                    causality=Fmi3Causality.parameter,
                    variability=Fmi3Variability.tunable,
                    description=f"{each.meaning} [{each.unit}]",
                    getter=partial(self._parameter, each.name),
                    setter=partial(self._set_parameter, each.name),
                )
            )

    def _register(self, variable: Any) -> None:  # Any: of pythonfmu3
        self.register_variable(variable, nested=False)

    def _register_input(self, record: str, field: Described) -> None:
        is_flag = isinstance(field.value, bool)
        kind, variability = (
            (Boolean, Fmi3Variability.discrete)
            if is_flag
            else (Float64, Fmi3Variability.continuous)
        )
        self._register(
            kind(
                field.name,
                causality=Fmi3Causality.input,
                variability=variability,
                description=f"{field.meaning} [{field.unit or '-'}]",
                getter=lambda: getattr(getattr(self, record), field.name),
                setter=partial(self._set_input, record, field.name),
            )
        )

    def _set_input(self, record: str, name: str, value: float | bool) -> None:
        setattr(self, record, getattr(self, record)._replace(**{name: value}))

    def _output(self, place: str) -> float:
        return float(value_at(self._assistance, place))

    def _parameter(self, name: str) -> float:
        return float(value_at(self._parameters, name))

    def _set_parameter(self, name: str, value: float) -> None:
        self._parameters = with_values(self._parameters, {name: value})

    def exit_initialization_mode(self) -> None:
        """The method begins in the lane that the car is in."""
        lane = self._measurement.lane
        self._state = self._method.initial_state(self._parameters, lane)

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Run the method for one communication step, a whole number of 1/60 s."""
        steps, self._time = round(step_size / DT), current_time + step_size
        if steps < 1 or not math.isclose(steps * DT, step_size, rel_tol=1e-6):
            raise ValueError(f"the step is {step_size} s; give a multiple of {DT} s")
        request = self._request
        if request.crossing_probability < 0.0:
            request = request._replace(crossing_probability=math.nan)
        if request.change_duration <= 0.0:
            request = request._replace(change_duration=math.nan)
        for _ in range(steps):
            self._state, self._assistance = self._method.step(
                self._parameters, self._state, self._measurement, request, DT
            )
        return True
