"""No assistance: the guidance is computed in the shadow and never applied.

It runs so that the intention trigger can be judged in manual driving too; with a
strength factor of 0 the motor gives no torque.
"""

from __future__ import annotations

from costeer.controller.step import ControllerParameters
from costeer.methods.conditions import Condition
from costeer.methods.ibhs import IBHS
from costeer.methods.ibhs import parameters as guidance
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters


def parameters(
    condition: Condition,
    car: CarParameters,
    column: ColumnParameters,
    road: RoadParameters,
) -> ControllerParameters:
    """The controller without strength, whatever the condition asks for."""
    return guidance(condition._replace(strength_factor=0.0), car, column, road)


MANUAL = IBHS._replace(
    name="manual",
    source="Yan et al., condition without assistance",
    parameters=parameters,
    assists=False,
)
