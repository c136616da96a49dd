"""Whether the loop can run a driver: judged once, before anything is simulated."""

from __future__ import annotations

from functools import cache
from typing import Any

from costeer.base.judged import (
    called,
    check_like,
    check_parts,
    checked_answer,
    checked_kinds,
    checked_numbers,
)
from costeer.drivers.arm import ArmCommand, ArmParameters
from costeer.drivers.interface import (
    Action,
    AnyDriver,
    Draw,
    DriverModel,
    DriverNoise,
    Knowledge,
    Perception,
)
from costeer.drivers.longitudinal import Pedals
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.road import cruising_lane, lane_centre
from costeer.plant.traffic import no_leader
from costeer.sensing.measurement import standing_start

_DT = 1.0 / 60.0


def checked_driver(driver: Any) -> AnyDriver:  # Any: of whoever made it
    """The driver, if the loop can run it.

    Raises:
        ValueError: Naming what is missing or wrong.
    """
    if not isinstance(driver, DriverModel):
        raise ValueError(
            f"driver is {driver!r}; give a name, parameters, or a driver model made "
            "with costeer.DriverModel(name=..., ...)"
        )
    return _checked(driver)


@cache
def _checked(driver: AnyDriver) -> AnyDriver:
    """`checked_driver` of what is a driver model, judged once."""
    check_parts(driver, "driver model", ("parameters", "initial_state", "act"))
    parameters = drawn_parameters(driver, Draw())
    _check_act(driver, parameters)
    return driver


def drawn_parameters(driver: AnyDriver, draw: Draw) -> Any:  # Any: of the driver's own
    """Parameters of one driver of a model.

    Raises:
        ValueError: If its function breaks, or gives something that cannot be driven.
    """
    whose = f"driver model '{driver.name}'"
    given = called(whose, "parameters", "a Draw", driver.parameters, draw)
    checked_numbers(whose, given)
    arm = getattr(given, "arm", None)
    if not isinstance(arm, ArmParameters):
        raise ValueError(
            f"parameters of {whose} have no field arm with costeer.drivers.arm."
            "ArmParameters; it says how hands and arms move with the wheel"
        )
    return given


def _check_act(driver: AnyDriver, parameters: Any) -> None:
    """Refuse a driver whose act gives something else than state and action.

    Raises:
        ValueError: Saying what it gives.
    """
    whose, road = f"driver model '{driver.name}'", RoadParameters()
    centre = lane_centre(road, cruising_lane(road))
    takes = "parameters, lane_centre"
    state = called(
        whose, "initial_state", takes, driver.initial_state, parameters, centre
    )
    checked_kinds(whose, "states", state)
    knowledge = Knowledge(car=CarParameters(), column=ColumnParameters(), road=road)
    seen = Perception(
        measurement=standing_start(road), leader=no_leader(), guidance_torque=0.0
    )
    noise = DriverNoise(*([0.0] * len(DriverNoise._fields)))
    takes = "parameters, state, knowledge, perception, noise, dt"
    given = (parameters, state, knowledge, seen, noise, _DT)
    answer = called(whose, "act", takes, driver.act, *given)
    name = f"act of {whose}"
    action = checked_answer(name, state, answer, "action")
    like = Action(arm=ArmCommand(), pedals=Pedals(accelerator=0.0, brake=0.0))
    check_like(name, action, like, "Action(arm=ArmCommand(...), pedals=Pedals(...))")
