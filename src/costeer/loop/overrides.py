"""Parameters of a trial by name: all of them listed, any of them changed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from costeer.base.array import Real
from costeer.base.described import Described, described, nearest, with_values
from costeer.loop.parameters import LoopParameters
from costeer.methods.conditions import Condition
from costeer.methods.interface import usual_parameters
from costeer.methods.registry import AnyMethod

METHOD = "controller."
"""Prefix of the method's own parameters; it may be left out."""

OPTIONS = {
    "road.length": "length",
    "start.speed": "speed",
    "start.lateral_offset": "initial_offset",
    "start.events": "events",
    "follows_plan": "follows_plan",
    "plant_steps": "plant_steps",
    "controller.actuation.strength_factor": "condition",
    "controller.trajectory.change_duration": "condition",
}
"""What an option of its own decides, and its name in Python."""


def parameter_list(parameters: LoopParameters[Any]) -> list[Described]:
    """Every parameter of a trial that can be set by name, the method's first."""
    return [each for each in described(parameters) if each.name not in OPTIONS]


def built(
    world: LoopParameters[Any],
    method: AnyMethod,
    condition: Condition,
    values: Mapping[str, Real],
) -> LoopParameters[Any]:
    """All parameters of a trial with some set by name.

    The method is made for car, column and road as they are set; what is set of the
    method itself comes last.

    Args:
        world: Parameters without those of the method.
        method: Makes its own.
        condition: Of the trial.
        values: By dotted name; `controller.` may be left out.

    Raises:
        ValueError: If a name is not known, has an option of its own, or a value is out
            of range.
    """
    usual = method.parameters(condition, world.car, world.column, world.road)
    if not values:
        return world._replace(controller=usual)
    known = {each.name for each in described(world._replace(controller=usual))}
    named = {_full_name(name, known): value for name, value in values.items()}
    own = {name: v for name, v in named.items() if name.startswith(METHOD)}
    others = {name: v for name, v in named.items() if name not in own}
    around = with_values(world, others)
    controller = method.parameters(condition, around.car, around.column, around.road)
    return with_values(around._replace(controller=controller), own)


def shared_values(
    world: LoopParameters[Any], method: AnyMethod, values: Mapping[str, Real]
) -> dict[str, Real]:
    """Those of the values that a trial with another method has too."""
    like = world._replace(controller=usual_parameters(method))
    known = {each.name for each in described(like)}
    return {n: v for n, v in values.items() if {n, METHOD + n} & known}


def _full_name(name: str, known: set[str]) -> str:
    """The dotted name in the parameters of a trial.

    Raises:
        ValueError: If there is none, or an option of its own decides it.
    """
    full = name if name in known else METHOD + name
    if full in OPTIONS:
        raise ValueError(f"{name} is decided by {OPTIONS[full]}; set that one instead")
    if full not in known:
        names = [each.removeprefix(METHOD) for each in sorted(known - OPTIONS.keys())]
        raise ValueError(
            f"there is no parameter '{name}'{nearest(name, names)} "
            "`costeer parameters` lists all"
        )
    return full
