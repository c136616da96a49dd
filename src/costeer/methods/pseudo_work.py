"""Consistency judged by lateral velocity: Saito, Wada, Sonoda 2018.

The pseudo-works that the paper takes over, as they were published first: torque times
lateral velocity instead of heading-error rate. All other stages are those of `ibhs`.
"""

from __future__ import annotations

from costeer.base.array import Real, compiled
from costeer.controller import step as controller
from costeer.controller.consistency import ConsistencyParameters
from costeer.controller.signals import Assistance, Preview, Request
from costeer.controller.step import ControllerParameters, ControllerState
from costeer.methods import ibhs
from costeer.methods.conditions import Condition
from costeer.methods.ibhs import IBHS
from costeer.methods.interface import Tunable
from costeer.methods.lanes import lateral_velocity
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.sensing.measurement import Measurement

INCONSISTENCY_THRESHOLD = 1.5
"""δ, least gap of the pseudo-works [W·m]. Source: ours, twice the 99.9th percentile of
agreeing runs of pilot drivers, benchmarks/rival_thresholds.py."""

_DELTA = "consistency.inconsistency_threshold"


@compiled
def velocity(measurement: Measurement, errors: Preview) -> Real:
    """What a torque is multiplied by: velocity across the road [m/s]."""
    return lateral_velocity(measurement)


@compiled
def step(
    parameters: ControllerParameters,
    state: ControllerState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[ControllerState, Assistance]:
    """All stages of `ibhs`, Eqs. (7) and (8) with the velocity across the road."""
    return controller.step_by(velocity, parameters, state, measurement, request, dt)


def parameters(
    condition: Condition,
    car: CarParameters,
    column: ColumnParameters,
    road: RoadParameters,
) -> ControllerParameters:
    """Those of `ibhs`, with a threshold of its own."""
    usual = ibhs.parameters(condition, car, column, road)
    judged = ConsistencyParameters(inconsistency_threshold=INCONSISTENCY_THRESHOLD)
    return usual._replace(consistency=judged)


def _own(tunable: Tunable) -> Tunable:
    """A tunable of `ibhs`, its range widened for the other threshold."""
    wider = tunable._replace(high=5.0, unit="W·m")
    return wider if tunable.leaf == _DELTA else tunable


METHOD = IBHS._replace(
    name="pseudo-work",
    source="Saito, Wada, Sonoda 2018: pseudo-work of torque and lateral velocity",
    parameters=parameters,
    step=step,
    tunables=tuple(_own(each) for each in ibhs.TUNABLES),
)
