"""Checks of numbers that enter by the command line, as callbacks of options.

Each maker returns a callback for `typer.Option(callback=...)`. It takes what the
option holds, None and lists included, and gives it back, or says in one line which
value was refused and what is allowed. NaN and infinity are never allowed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TypeVar

import typer

Value = TypeVar("Value")
Number = int | float


def positive(unit: str = "") -> Callable[[Value], Value]:
    """Allow numbers above zero."""
    return _check(lambda number: number > 0, f"above 0{_spaced(unit)}")


def at_least(low: Number, unit: str = "") -> Callable[[Value], Value]:
    """Allow numbers from `low` on."""
    return _check(lambda number: number >= low, f"at least {low}{_spaced(unit)}")


def in_range(low: Number, high: Number, unit: str = "") -> Callable[[Value], Value]:
    """Allow numbers from `low` to `high`, both included."""
    allowed = f"from {low} to {high}{_spaced(unit)}"
    return _check(lambda number: low <= number <= high, allowed)


def fraction() -> Callable[[Value], Value]:
    """Allow numbers from 0 to 1."""
    return in_range(0, 1)


def finite(unit: str = "") -> Callable[[Value], Value]:
    """Allow any number but NaN and infinity."""
    return _check(lambda _: True, f"a finite number{_spaced(unit)}")


def one_of(choices: Sequence[str]) -> Callable[[Value], Value]:
    """Allow one of the words, or a list of them."""

    def callback(value: Value) -> Value:
        for word in _members(value):
            if word not in choices:
                _refuse(word, f"one of {', '.join(choices)}")
        return value

    return callback


def _check(allows: Callable[[Number], bool], allowed: str) -> Callable[[Value], Value]:
    """Make a callback that refuses what `allows` does not."""

    def callback(value: Value) -> Value:
        for member in _members(value):
            if not isinstance(member, (int, float)):
                _refuse(member, "a number")
            elif not math.isfinite(member) or not allows(member):
                _refuse(member, allowed)
        return value

    return callback


def _members(value: object) -> Sequence[object]:
    """The values in an option: none, one, or those of a repeated option."""
    if value is None:
        return ()
    return value if isinstance(value, (list, tuple)) else (value,)


def _refuse(value: object, allowed: str) -> None:
    """Name the value and what is allowed instead."""
    raise typer.BadParameter(f"{value} is not allowed; give {allowed}.")


def _spaced(unit: str) -> str:
    return f" {unit}" if unit else ""
