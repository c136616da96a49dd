"""Intention-based haptic guidance steering: system, simulator, drivers, experiment.

The package follows Yan et al., *Intention-Based Lane Changing and Lane Keeping
Haptic Guidance Steering System*; its docstrings call that "the paper". `__all__` lists
what is public, docs/python.md shows it; each name is imported when it is first used.
Each folder is a room, and a room imports only those below it in the list of layers in
pyproject.toml (docs/decisions/0001-layout.md).
"""

import sys
from importlib import import_module
from importlib.metadata import version
from types import ModuleType
from typing import TYPE_CHECKING, Any

from costeer import moved

if TYPE_CHECKING:
    from costeer.api.comparing import compare
    from costeer.api.measuring import (
        measures,
        sdlp,
        steering_wheel_reversal_rate,
    )
    from costeer.api.people import evaluate, fit_driver, population
    from costeer.api.recordings import ReadingWarning, load_record
    from costeer.api.trials import parameters, simulate, study
    from costeer.base.array import compiled
    from costeer.drivers.driver import DriverParameters as Driver
    from costeer.drivers.interface import DriverModel
    from costeer.drivers.replayed import replayed_hands
    from costeer.intention.predictors.interface import Predictor
    from costeer.methods.interface import Method
    from costeer.records.columns import Column
    from costeer.records.columns import TrialRecord as Record
    from costeer.records.record import write_record
    from costeer.scenarios.definition import Scenario

moved.install()

__all__ = [
    "Column",
    "Driver",
    "DriverModel",
    "Method",
    "Predictor",
    "ReadingWarning",
    "Record",
    "Scenario",
    "__version__",
    "compare",
    "compiled",
    "evaluate",
    "fit_driver",
    "load_record",
    "measures",
    "parameters",
    "population",
    "replayed_hands",
    "sdlp",
    "simulate",
    "steering_wheel_reversal_rate",
    "study",
    "write_record",
]

__version__ = version("costeer")

_PLACES = {
    "Column": "records.columns:Column",
    "Driver": "drivers.driver:DriverParameters",
    "DriverModel": "drivers.interface:DriverModel",
    "Method": "methods.interface:Method",
    "Predictor": "intention.predictors.interface:Predictor",
    "ReadingWarning": "api.recordings:ReadingWarning",
    "Record": "records.columns:TrialRecord",
    "Scenario": "scenarios.definition:Scenario",
    "compare": "api.comparing:compare",
    "compiled": "base.array:compiled",
    "evaluate": "api.people:evaluate",
    "fit_driver": "api.people:fit_driver",
    "load_record": "api.recordings:load_record",
    "measures": "api.measuring:measures",
    "parameters": "api.trials:parameters",
    "population": "api.people:population",
    "replayed_hands": "drivers.replayed:replayed_hands",
    "sdlp": "api.measuring:sdlp",
    "simulate": "api.trials:simulate",
    "steering_wheel_reversal_rate": "api.measuring:steering_wheel_reversal_rate",
    "write_record": "records.record:write_record",
}
"""Where each public name is."""


def __getattr__(name: str) -> Any:  # Any: whatever has the name
    """A public name, imported when it is first used."""
    if name == "study":
        return import_module("costeer.study")
    if name not in _PLACES:
        raise AttributeError(f"module 'costeer' has no attribute '{name}'")
    place, _, own = _PLACES[name].partition(":")
    found = getattr(import_module(f"costeer.{place}"), own)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(__all__)


class _Study(ModuleType):
    """The room of the experiment, which is run by calling it."""

    def __call__(self, *given: Any, **named: Any) -> Any:
        """Run the experiment: `costeer.api.trials.study`."""
        return import_module("costeer.api.trials").study(*given, **named)

    @property
    def __signature__(self) -> Any:
        return import_module("inspect").signature(
            import_module("costeer.api.trials").study
        )


class _Package(ModuleType):
    """The package, in which `study` is both a room and a function."""

    def __setattr__(self, name: str, value: object) -> None:
        if name == "study" and isinstance(value, ModuleType):
            value.__class__ = _Study
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
