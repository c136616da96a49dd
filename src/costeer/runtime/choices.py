"""What an experimenter has chosen: condition, method and tuned values."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from costeer.base.described import value_at, with_value_at
from costeer.loop.parameters import LoopParameters
from costeer.methods.conditions import CONDITION_NAMES, condition
from costeer.methods.ibhs import IBHS
from costeer.methods.manual import MANUAL
from costeer.methods.registry import method_named
from costeer.runtime.cabin import Cabin
from costeer.runtime.markers import Kind, Marker
from costeer.runtime.setup import (
    DriveSetup,
    drive_method,
    drive_parameters,
    offered_methods,
    under,
)
from costeer.runtime.tunables import checked_value, place_of, tunable_named

_OF_THE_CONDITION = ("strength_factor", "change_duration")
"""Tunables that a condition sets anew."""

Values = dict[str, float]


class Chosen(NamedTuple):
    """What holds in a drive.

    Attributes:
        condition: Its name.
        method: Its name.
        tuned: Values of tunables that were changed, each in its unit, by the name of
            the method and their own.
    """

    condition: str
    method: str
    tuned: dict[str, Values]


def first_choice(setup: DriveSetup) -> Chosen:
    """What holds when a drive begins."""
    return Chosen(setup.trial.condition, method_named(setup.trial.method).name, {})


def followed(chosen: Chosen, marker: Marker) -> Chosen:
    """What holds after a marker; the same object if that changed nothing."""
    match marker:
        case Marker(kind="condition", after=str(name)):
            kept = {
                method: {n: v for n, v in values.items() if n not in _OF_THE_CONDITION}
                for method, values in chosen.tuned.items()
            }
            return chosen._replace(condition=name, tuned=kept)
        case Marker(kind="method", after=str(name)):
            return chosen._replace(method=name)
        case Marker(kind="parameter", after=float(value)):
            own = {**_tuned(chosen), marker.name: value}
            return chosen._replace(tuned={**chosen.tuned, _owner(chosen): own})
    return chosen


def _owner(chosen: Chosen) -> str:
    """Whose tuned values hold: manual driving runs the paper's method in the shadow."""
    return IBHS.name if chosen.method == MANUAL.name else chosen.method


def _tuned(chosen: Chosen) -> Values:
    """Tuned values of the method that was chosen."""
    return chosen.tuned.get(_owner(chosen), {})


def chosen_setup(setup: DriveSetup, chosen: Chosen) -> DriveSetup:
    """The drive under what was chosen, without tuned values."""
    return under(setup, chosen.condition, chosen.method)


def chosen_parameters(setup: DriveSetup, chosen: Chosen) -> LoopParameters[Any]:
    """All parameters of the loop under what was chosen."""
    now = chosen_setup(setup, chosen)
    method, parameters = drive_method(now), drive_parameters(now)
    for name, value in _tuned(chosen).items():
        parameters = with_value_at(
            parameters, place_of(tunable_named(method, name)), value
        )
    return parameters


def tuned_values(setup: DriveSetup, chosen: Chosen) -> Values:
    """Every tunable of the method that runs, changed or not."""
    method = drive_method(chosen_setup(setup, chosen))
    now = chosen_parameters(setup, chosen)
    return {each.name: value_at(now, place_of(each)) for each in method.tunables}


def checked_choice(
    setup: DriveSetup, chosen: Chosen, name: str, value: float | str
) -> float | str:
    """What is to be set, if it can be.

    Args:
        setup: Of the drive.
        chosen: What holds.
        name: `condition`, `method`, or of a tunable.
        value: A name for the first two, else a number in the tunable's unit.

    Raises:
        ValueError: If there is none of that name, or the value is out of range.
    """
    if name == "condition":
        return condition(str(value)).name
    if name == "method":
        under(setup, chosen.condition, str(value))
        return str(value)
    tunable = tunable_named(drive_method(chosen_setup(setup, chosen)), name)
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
        self._setup = setup
        self._chosen = first_choice(setup)
        self._mark = mark
        for method in offered_methods(setup):  # while nobody waits
            for name in CONDITION_NAMES:
                drive_parameters(under(setup, name, method))

    @property
    def number(self) -> float:
        """Of the condition, in the order of `CONDITION_NAMES`."""
        return float(CONDITION_NAMES.index(self._chosen.condition))

    def set(self, name: str, value: float | str) -> None:
        """Drive on with another condition, method or value of a tunable.

        Raises:
            ValueError: As `checked_choice`.
        """
        value = checked_choice(self._setup, self._chosen, name, value)
        before = tuned_values(self._setup, self._chosen)
        if name in ("condition", "method"):
            was = getattr(self._chosen, name)
            kind: Kind = "condition" if name == "condition" else "method"
            self._take(Marker(kind, before=was, after=value))
            self._tell_changes(before)
        elif before[name] != value:
            self._take(self._parameter(name, before[name], float(value)))
        now = chosen_setup(self._setup, self._chosen)
        parameters = chosen_parameters(self._setup, self._chosen)
        self._cabin.take_on(drive_method(now), parameters)

    def _take(self, marker: Marker) -> None:
        self._chosen = followed(self._chosen, marker)
        self._mark(marker)

    def _tell_changes(self, before: Values) -> None:
        """Mark each tunable that another condition or method has changed."""
        for name, value in tuned_values(self._setup, self._chosen).items():
            if name in before and before[name] != value:
                self._mark(self._parameter(name, before[name], value))

    def _parameter(self, name: str, before: float, after: float) -> Marker:
        method = drive_method(chosen_setup(self._setup, self._chosen))
        unit = tunable_named(method, name).unit
        return Marker("parameter", name, before, after, unit)
