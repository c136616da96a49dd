"""The methods there are: costeer's own and those of installed packages."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import partial
from importlib.metadata import entry_points
from typing import Any, NamedTuple

from costeer.base.plugins import advertised
from costeer.controller.signals import Assistance, Request
from costeer.methods.checked import hears_triggers
from costeer.methods.registry import METHODS, AnyMethod, method_named
from costeer.sensing.measurement import Measurement

OURS = "costeer"
"""Where a method is from that needs no plug-in."""

_GROUP = "costeer.methods"

LAWS = {
    "ibhs": "the paper's: intention read, path, torque, verdict, fade, new plan",
    "manual": "no torque",
    "lane-keeping": "torque to the centre of the lane that the car is in",
    "lane-crossing-time": "lane keeping; a short time to the line begins a path",
    "indicator": "lane keeping; the driver's indicator begins a path",
    "indicator-acsf": "the same, 3 s after the lever, in 5 s",
    "cooperative-status": "lane keeping that fades where the driver leads elsewhere",
    "pseudo-work": "ibhs with a verdict by lateral velocity",
    "fixed-sharing": "a constant share of the lane-keeping torque",
    "four-design-choices": "reference, feedback, support and authority set apart",
    "bandwidth": "lane keeping outside a band, nothing inside",
    "bandwidth-constant": "2 N·m to the centre outside a band, nothing inside",
    "traded": "the larger the driver's torque, the less guidance",
    "inclusion": "a torque that lasts changes the plan",
}
"""In a line, as docs/methods.md has it in a table."""


class Listed(NamedTuple):
    """A method as `costeer methods` lists it.

    Attributes:
        name: That `--method` takes.
        law: In a line; empty if nobody says.
        intention: Whether it looks at what the driver is about to do.
        indicator: Whether it looks at the driver's indicator.
        version: Of the law.
        source: Publication.
        place: `module:object` of a plug-in, else "costeer".
        failure: Why it cannot be used; empty if it can.
    """

    name: str
    law: str
    intention: bool
    indicator: bool
    version: str
    source: str
    place: str
    failure: str = ""


def listed_methods() -> list[Listed]:
    """Every method that has a name, costeer's own first; those that fail say why."""
    return [
        *(_listed(name, OURS) for name in METHODS),
        *(_listed(name, place) for name, place in _installed()),
    ]


def _installed() -> Iterator[tuple[str, str]]:
    """Name and place of what installed packages offer; twins are named together."""
    try:
        yield from ((n, p) for n, p in advertised(_GROUP).items() if n not in METHODS)
    except ValueError:
        for point in sorted(set(entry_points(group=_GROUP))):
            if point.name not in METHODS:
                yield point.name, point.value


def _listed(name: str, place: str) -> Listed:
    try:
        return about_method(method_named(name), name, place)
    except ValueError as error:
        return Listed(name, "", False, False, "", "", place, str(error))


def about_method(method: AnyMethod, name: str = "", place: str = "") -> Listed:
    """What is to be said of a method.

    Args:
        method: Of costeer or of a plug-in.
        name: By which it was found; its own if empty.
        place: Where it was found.
    """
    return Listed(
        name=name or method.name,
        law=_law(method),
        intention=method.assists and _hears(method, "indicator"),
        indicator=method.assists and _hears(method, "crossing_probability"),
        version=method.version,
        source=method.source,
        place=place or (OURS if METHODS.get(method.name) is method else "a plug-in"),
    )


def _law(method: AnyMethod) -> str:
    """The line of ours; of others, the first of the file's docstring."""
    if METHODS.get(method.name) is method:
        return LAWS.get(method.name, "")
    for function in (method.step, method.parameters):
        module = getattr(function, "__module__", "")
        if module and not module.startswith("costeer."):
            text = (sys.modules[module].__doc__ or "").strip()
            return text.partition("\n")[0].rstrip(".")
    return ""


def _hears(method: AnyMethod, deaf_to: str) -> bool:
    """Whether a method that is not told one thing still hears a trigger."""
    return hears_triggers(method._replace(step=partial(_deaf_step, method, deaf_to)))


# Any: a method's own parameters and state.
def _deaf_step(
    method: AnyMethod,
    deaf_to: str,
    parameters: Any,
    state: Any,
    measurement: Measurement,
    request: Request,
    dt: float,
) -> tuple[Any, Assistance]:
    """A step of the method without one part of the request."""
    told = request._replace(**{deaf_to: getattr(Request(), deaf_to)})
    answer: tuple[Any, Assistance] = method.step(
        parameters, state, measurement, told, dt
    )
    return answer
