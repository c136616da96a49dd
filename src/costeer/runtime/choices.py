"""What an experimenter has chosen: condition, method and tuned values."""

from __future__ import annotations

import math
from collections.abc import Callable

from costeer.methods.conditions import CONDITION_NAMES, condition
from costeer.methods.registry import method_named
from costeer.runtime.cabin import Cabin
from costeer.runtime.setup import DriveSetup, strength_of
from costeer.runtime.tunables import checked_value, tunable_named


class Choices:
    """Applies what is chosen to a drive, and marks every change with what was.

    Args:
        cabin: Of the drive.
        setup: Of the drive, with what holds at the start.
        mark: Takes kind and text of a marker.
    """

    def __init__(
        self, cabin: Cabin, setup: DriveSetup, mark: Callable[[str, str], None]
    ) -> None:
        self._cabin = cabin
        self._condition = setup.trial.condition
        self._method = setup.method
        self._mark = mark

    @property
    def number(self) -> float:
        """Of the condition, in the order of `CONDITION_NAMES`."""
        return float(CONDITION_NAMES.index(self._condition))

    def set(self, name: str, value: float) -> None:
        """Set a tunable.

        Raises:
            ValueError: If there is none of that name, or the value is out of range.
        """
        tunable = tunable_named(self._cabin.method, name)
        before = self._cabin.tune(tunable, checked_value(tunable, value))
        if before != value:
            self._mark("gain", f"{name} {before:.9g} -> {value:.9g} {tunable.unit}")

    def choose_condition(self, name: str) -> None:
        """Drive on under a condition: its strength and its duration.

        Raises:
            ValueError: If there is none of that name.
        """
        chosen = condition(name)
        self._mark("condition", f"{self._condition} -> {chosen.name}")
        self._condition = chosen.name
        self._apply_strength()
        if math.isfinite(chosen.change_duration):
            self.set("change_duration", chosen.change_duration)

    def choose_method(self, name: str) -> None:
        """Drive on with a method.

        Raises:
            ValueError: If there is none of that name.
        """
        method_named(name)
        self._mark("method", f"{self._method} -> {name}")
        self._method = name
        self._apply_strength()

    def _apply_strength(self) -> None:
        """The strength factor that condition and method ask for together."""
        factor = strength_of(condition(self._condition), self._method)
        self.set("strength_factor", factor)
