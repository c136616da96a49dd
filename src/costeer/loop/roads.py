"""Roads on which nobody could drive a scenario."""

from __future__ import annotations

from costeer.plant.parameters import RoadParameters
from costeer.scenarios.definition import Scenario


def check_road(road: RoadParameters) -> None:
    """Refuse a road on which nobody could change lanes.

    Raises:
        ValueError: Naming the number.
    """
    if road.overtaking_side not in (-1.0, 1.0):
        raise ValueError(
            f"road.overtaking_side is {road.overtaking_side:g}; give 1 for left or -1 "
            "for right"
        )
    if road.num_lanes < 2.0 or road.num_lanes % 1.0 != 0.0:
        raise ValueError(f"road.num_lanes is {road.num_lanes:g}; give 2 or more")


def check_lanes(road: RoadParameters, scenario: Scenario) -> None:
    """Refuse a road without a lane that something in the scenario is in.

    Raises:
        ValueError: Naming it.
    """
    for actor in scenario.actors:
        for lane in (actor.lane, *(each.lane for each in actor.orders)):
            if lane is not None and lane >= road.num_lanes:
                raise ValueError(
                    f"road.num_lanes is {road.num_lanes:g}; {actor.name} of scenario "
                    f"{scenario.name} is in lane {lane}, give {lane + 1} or more"
                )
