"""Parameters of a trial by name: all of them listed, any of them changed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from costeer.base.array import Real
from costeer.base.described import Described, described, nearest, with_values
from costeer.loop.mistakes import believed_car, judged, true_column
from costeer.loop.parameters import LoopParameters
from costeer.methods.checked import parameters_of
from costeer.methods.conditions import Condition
from costeer.methods.interface import usual_parameters
from costeer.methods.registry import AnyMethod

METHOD = "controller."
"""Prefix of the method's own parameters; it may be left out."""

OPTIONS = {
    "road.length": "--length (in Python length)",
    "start.speed": "--speed (in Python speed)",
    "start.lateral_offset": "--initial-offset (in Python initial_offset)",
    "start.events": "--no-events (in Python events)",
    "follows_plan": "follows_plan of TrialSetup in Python",
    "plant_steps": "plant_steps of TrialSetup in Python",
    "assists": "--method (in Python method)",
    "mistakes.any": "the other mistakes",
    "alignment.num_stations": "--scenario (in Python scenario)",
    "fleet.num_places": "--scenario (in Python scenario)",
    "fleet.range": "--scenario (in Python scenario)",
    "stretches.num_stretches": "--scenario (in Python scenario)",
    "actuation.strength_factor": "--condition (in Python condition)",
    "trajectory.change_duration": "--condition (in Python condition)",
}
"""What an option of its own decides; names of the method's without `controller.`."""


def is_option(name: str) -> bool:
    """Whether an option of its own decides what is called so."""
    return name.removeprefix(METHOD) in OPTIONS


def parameter_list(
    parameters: LoopParameters[Any], usual: LoopParameters[Any] | None = None
) -> list[Described]:
    """Every parameter of a trial that can be set by name, the method's first.

    `controller.` is left out where the rest says enough: `controller.car.mass` is what
    the method believes, `car.mass` what the car has.

    Args:
        parameters: Whose values are listed.
        usual: Whose values the ranges are judged by, if others than those.
    """
    listed = described(parameters)
    ranges = {each.name: each.allowed for each in described(usual or parameters)}
    known = {each.name for each in listed}
    return [
        each._replace(name=_short(each.name, known), allowed=ranges[each.name])
        for each in listed
        if not is_option(each.name)
    ]


def _short(name: str, known: set[str]) -> str:
    """The name without `controller.`, if nothing else is called so."""
    short = name.removeprefix(METHOD)
    return name if short in known else short


def built(
    world: LoopParameters[Any],
    method: AnyMethod,
    condition: Condition,
    values: Mapping[str, Real],
) -> LoopParameters[Any]:
    """All parameters of a trial with some set by name.

    The method is made for car, column and road as they are set, unless it is mistaken
    about them; what is set of the method itself comes last.

    Args:
        world: Parameters without those of the method.
        method: Makes its own.
        condition: Of the trial.
        values: By dotted name; `controller.` may be left out.

    Raises:
        ValueError: If a name is not known, has an option of its own, or a value is out
            of range.
    """
    world = world._replace(assists=1.0 if method.assists else 0.0)
    usual = parameters_of(method, condition, world.car, world.column, world.road)
    if not values:
        return world._replace(controller=usual)
    named = full_names(world._replace(controller=usual), values)
    own = {name: v for name, v in named.items() if name.startswith(METHOD)}
    others = {name: v for name, v in named.items() if name not in own}
    around = with_values(world, others)
    around = around._replace(mistakes=judged(around.mistakes))
    known = believed_car(around.mistakes, around.car)
    controller = parameters_of(method, condition, known, around.column, around.road)
    column = true_column(around.mistakes, around.column)
    built = around._replace(controller=controller, column=column)
    return with_values(built, own)


def full_names(
    parameters: LoopParameters[Any], values: Mapping[str, Real]
) -> dict[str, Real]:
    """The values by the whole of their names.

    Raises:
        ValueError: If a name is not known, has an option of its own, or one parameter
            is set by two names.
    """
    known = {each.name for each in described(parameters)}
    named: dict[str, Real] = {}
    for name, value in values.items():
        full = _full_name(name, known)
        if full in named:
            raise ValueError(f"{name} is set twice, also as {full}; set it once")
        named[full] = value
    return named


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
    if not isinstance(name, str):
        raise ValueError(f"{name!r} is no name of a parameter; give text")
    full = name if name in known else METHOD + name
    if is_option(full):
        option = OPTIONS[full.removeprefix(METHOD)]
        raise ValueError(f"{name} is set by {option}; give that one instead")
    if full not in known:
        names = [_short(each, known) for each in sorted(known) if not is_option(each)]
        raise ValueError(
            f"there is no parameter '{name}'{nearest(name, names)}; "
            "`costeer parameters` lists all, and with --method those of another method"
        )
    return full
