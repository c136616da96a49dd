"""What an experimenter has chosen: condition, method and tuned values."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from costeer.methods.registry import method_named
from costeer.runtime.cabin import Cabin
from costeer.runtime.markers import Marker
from costeer.runtime.setup import DriveSetup, strength_of
from costeer.runtime.tunables import checked_value, tunable_named
from costeer.study.conditions import CONDITION_NAMES, condition


class Chosen(NamedTuple):
    """What holds in a drive.

    Attributes:
        condition: Its name.
        method: Its name.
        values: Of tunables by name, each in its unit.
    """

    condition: str
    method: str
    values: dict[str, float]


def followed(chosen: Chosen, marker: Marker) -> Chosen:
    """What holds after a marker; the same object if that changed nothing."""
    match marker:
        case Marker(kind="condition", after=str(name)):
            return chosen._replace(condition=name)
        case Marker(kind="method", after=str(name)):
            return chosen._replace(method=name)
        case Marker(kind="parameter", after=float(value)):
            return chosen._replace(values={**chosen.values, marker.name: value})
    return chosen


def checked_choice(name: str, value: float | str) -> float | str:
    """What is to be set, if it can be.

    Args:
        name: `condition`, `method`, or of a tunable.
        value: A name for the first two, else a number in the tunable's unit.

    Raises:
        ValueError: If there is none of that name, or the value is out of range.
    """
    if name == "condition":
        return condition(str(value)).name
    if name == "method":
        return method_named(str(value)).name
    tunable = tunable_named(name)
    if isinstance(value, str):
        raise ValueError(f"{name} is {value!r}; give a number")
    return float(checked_value(tunable, value))


class Choices:
    """Applies what is chosen to a drive, and marks every change with what was.

    Args:
        cabin: Of the drive.
        setup: Of the drive, with what holds at the start.
        mark: Takes a marker; its time is filled in there.
    """

    def __init__(
        self, cabin: Cabin, setup: DriveSetup, mark: Callable[[Marker], None]
    ) -> None:
        self._cabin = cabin
        self._condition = setup.trial.condition
        self._method = setup.method
        self._mark = mark

    @property
    def number(self) -> float:
        """Of the condition, in the order of `CONDITION_NAMES`."""
        return float(CONDITION_NAMES.index(self._condition))

    def set(self, name: str, value: float | str) -> None:
        """Drive on with another condition, method or value of a tunable.

        Raises:
            ValueError: As `checked_choice`.
        """
        value = checked_choice(name, value)
        if name == "condition":
            self._choose_condition(str(value))
        elif name == "method":
            self._choose_method(str(value))
        else:
            self._tune(name, float(value))

    def _choose_condition(self, name: str) -> None:
        """Take on a condition: its strength and its duration."""
        self._mark(Marker("condition", before=self._condition, after=name))
        self._condition = name
        self._apply_strength()
        duration = condition(name).change_duration
        if math.isfinite(duration):
            self._tune("change_duration", duration)

    def _choose_method(self, name: str) -> None:
        self._mark(Marker("method", before=self._method, after=name))
        self._method = name
        self._apply_strength()

    def _apply_strength(self) -> None:
        """The strength factor that condition and method ask for together."""
        factor = strength_of(condition(self._condition), self._method)
        self._tune("strength_factor", float(factor))

    def _tune(self, name: str, value: float) -> None:
        tunable = tunable_named(name)
        before = self._cabin.tune(tunable, value)
        if before != value:
            self._mark(Marker("parameter", name, before, value, tunable.unit))
