"""What a record says of the world it was driven in: scenario, car, sizes of others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.nested import filled
from costeer.plant.fleet import KINDS, CarKind
from costeer.plant.parameters import CarParameters
from costeer.plant.recorded import recorded_car
from costeer.records.columns import TrialRecord
from costeer.scenarios.definition import Scenario, Zone
from costeer.scenarios.reading import scenario_named
from costeer.scenarios.world import Draw, world_of

PAPERS = "expressway"
"""The paper's scenario. Records without one were driven on its road."""


class Surroundings(NamedTuple):
    """What of a record's description is needed beside its columns.

    Attributes:
        car: That was driven.
        lengths: Of the other cars [m], shape `(car,)`; empty if they are not known.
        zones: Stretches for which measures are computed by themselves.
        is_papers: Whether the scenario is that of the paper, or none is told.
    """

    car: CarParameters = CarParameters()
    lengths: NDArray[np.float64] = np.zeros(0)
    zones: tuple[Zone, ...] = ()
    is_papers: bool = True


def surroundings(record: TrialRecord) -> Surroundings:
    """What a record says of its world; what it does not say is as usual."""
    car, scenario = recorded_car(record.metadata), recorded_scenario(record)
    if scenario is None:
        return Surroundings(car=car)
    return Surroundings(
        car=car,
        lengths=_lengths(record, scenario, car),
        zones=scenario.zones,
        is_papers=scenario == scenario_named(PAPERS),
    )


def recorded_scenario(record: TrialRecord) -> Scenario | None:
    """The scenario of a record; None if it tells none that this costeer knows."""
    told = record.metadata.get("scenario")
    if not isinstance(told, Mapping):
        return None
    try:
        return filled(Scenario, _without_none(told), "scenario")
    except (ValueError, TypeError):
        return None


# Any, in these two: a tree of values as JSON gives it back.
def _without_none(told: Any) -> Any:
    """Without the values that are undefined: the definition has them by default."""
    if isinstance(told, Mapping):
        return {k: _without_none(v) for k, v in told.items() if v is not None}
    return [_without_none(each) for each in told] if isinstance(told, list) else told


def _part(about: Mapping[str, object], name: str) -> Mapping[str, Any]:
    """A part of the configuration that a record keeps; empty if it does not."""
    configuration = about.get("configuration")
    part = configuration.get(name) if isinstance(configuration, Mapping) else None
    return part if isinstance(part, Mapping) else {}


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _lengths(
    record: TrialRecord, scenario: Scenario, car: CarParameters
) -> NDArray[np.float64]:
    """Lengths of the other cars [m].

    Older records do not say them; they follow from what the trial was asked to be.
    """
    told = record.metadata.get("other_cars")
    if isinstance(told, list):
        lengths = [
            each.get("length") if isinstance(each, Mapping) else None for each in told
        ]
        known = [each if _is_number(each) else CarKind().length for each in lengths]
        return np.array(known, np.float64)
    setup = _part(record.metadata, "setup")
    try:
        draw = Draw(
            seed=int(setup["seed"]),
            participant=int(setup["participant"]),
            length=float(setup["length"]),
            car=car,
        )
        fleet = world_of(scenario, draw).fleet
    except (KeyError, ValueError, TypeError):
        return np.zeros(0)
    table = np.asarray(fleet.kinds).reshape(-1, KINDS.width)
    others = table[1 : int(fleet.num_places), CarKind._fields.index("length")]
    return np.asarray(others, np.float64)
