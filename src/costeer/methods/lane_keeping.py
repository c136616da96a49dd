"""Lane keeping: guidance to the centre of the lane the car is in, at full gain.

The guidance that the paper sets out from: it helps until the driver wants to leave the
lane, and resists then.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple, Protocol

from costeer.base.array import Real, compiled
from costeer.controller import actuation
from costeer.controller.actuation import ActuationParameters, ActuationState
from costeer.controller.guidance import GuidanceParameters
from costeer.controller.preview import PreviewParameters
from costeer.controller.signals import Assistance, Request
from costeer.methods.ibhs import like_ibhs, shared_tunables
from costeer.methods.interface import Method
from costeer.methods.lanes import Keeping, LaneParameters, keep
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.sensing.measurement import Measurement


class LaneKeepingParameters(NamedTuple):
    """Guidance to the centre of a lane.

    Attributes:
        car: Nominal car [SI units]. Source: plant/parameters.py.
        column: Nominal column [SI units]. Source: plant/parameters.py.
        road: Lanes [SI units]. Source: plant/parameters.py.
        lanes: When the followed lane changes [SI units]. Source: methods/lanes.py.
        preview: Preview time [SI units]. Source: Fig. 4.
        guidance: Gains [SI units]. Source: Eq. (5).
        actuation: Strength and limits [SI units]. Source: Eq. (6), Table IV.
    """

    car: CarParameters = CarParameters()
    column: ColumnParameters = ColumnParameters()
    road: RoadParameters = RoadParameters()
    lanes: LaneParameters = LaneParameters()
    preview: PreviewParameters = PreviewParameters()
    guidance: GuidanceParameters = GuidanceParameters()
    actuation: ActuationParameters = ActuationParameters()


class LaneKeepingState(NamedTuple):
    """What lane keeping remembers.

    Attributes:
        lane: That is followed [-].
        actuation: Last torque.
    """

    lane: Real
    actuation: ActuationState


class KeepingAtStrength(Keeping, Protocol):
    """Parameters of lane keeping whose torque reaches the motor."""

    @property
    def actuation(self) -> ActuationParameters: ...  # noqa: D102


@compiled
def initial_state(parameters: KeepingAtStrength, lane: Real) -> LaneKeepingState:
    """Follow the lane that the car starts in."""
    return LaneKeepingState(lane=lane, actuation=actuation.initial_state())


@compiled
def assist(
    parameters: KeepingAtStrength,
    state: LaneKeepingState,
    measurement: Measurement,
    share: Real,
    dt: Real,
) -> tuple[LaneKeepingState, Assistance]:
    """A share of the lane-keeping torque, limited.

    Args:
        parameters: Lanes, guidance, limits.
        state: Followed lane and last torque.
        measurement: This step's sample.
        share: Of the torque [-].
        dt: Control step [s].
    """
    lane, target, errors, torques = keep(parameters, state.lane, measurement)
    wanted = torques.instructed_torque
    limited, torque = actuation.step(
        parameters.actuation, state.actuation, share, wanted, dt
    )
    new_state = LaneKeepingState(lane=lane, actuation=limited)
    return new_state, Assistance(
        applied_torque=torque, target=target, preview=errors, guidance=torques
    )


@compiled
def step(
    parameters: LaneKeepingParameters,
    state: LaneKeepingState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[LaneKeepingState, Assistance]:
    """Eqs. (3) to (6) with K_h = 1 and no lane change; a request changes nothing."""
    return assist(parameters, state, measurement, 1.0, dt)


METHOD = Method(
    name="lane-keeping",
    version="1",
    source="Yan et al., Eqs. (3) to (6) in lane-keeping mode; K_h = 1",
    parameters=partial(like_ibhs, LaneKeepingParameters),
    initial_state=initial_state,
    step=step,
    tunables=shared_tunables(LaneKeepingParameters),
)
