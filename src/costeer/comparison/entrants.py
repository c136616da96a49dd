"""Who is compared, and where."""

from __future__ import annotations

from typing import NamedTuple

from costeer.methods.registry import AnyMethod
from costeer.scenarios.definition import Scenario


class Entrant(NamedTuple):
    """A method in the comparison: its name, how it was given, whether it assists."""

    name: str
    given: str | AnyMethod
    assists: bool


class Course(NamedTuple):
    """A scenario in the comparison: name, how it was given, length [m], speed [m/s]."""

    name: str
    given: str | Scenario
    length: float
    speed: float
