"""Guidance only outside a band about the lane's centre.

`bandwidth` (Petermeijer, Abbink, de Winter 2015): no torque inside the band; outside,
lane keeping until the car is back. `bandwidth-constant` (Park et al. 2018): the same
rule, with a torque of one size towards the centre.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.controller import actuation
from costeer.controller.actuation import ActuationParameters, ActuationState
from costeer.controller.guidance import GuidanceParameters
from costeer.controller.preview import PreviewParameters
from costeer.controller.signals import Assistance, Guidance, Request
from costeer.methods.ibhs import like_ibhs, shared_tunables
from costeer.methods.interface import Method, Tunable
from costeer.methods.lanes import (
    LaneParameters,
    followed_lane,
    keep,
    lane_target,
    lateral_velocity,
    offset_from,
)
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.records.columns import Column
from costeer.sensing.measurement import Measurement


class BandParameters(NamedTuple):
    """Where there is guidance.

    Attributes:
        half_width: Of the band about the lane's centre [m]. Source: Petermeijer et al.
            2015 and Park et al. 2018, 0.4 or 0.5.
        return_offset: Guidance lasts until the car is nearer to the centre [m].
            Source: as above, 0.15.
        prediction_time: Guidance also begins when the car leaves the band within this
            time at its present velocity across the road [s]. Source: assumed.
    """

    half_width: Real = 0.5
    return_offset: Real = 0.15
    prediction_time: Real = 0.5


class ConstantParameters(NamedTuple):
    """How strong a torque of one size is.

    Attributes:
        torque: Towards the centre [N·m]. Source: Park et al. 2018, 1, 2 or 3.
    """

    torque: Real = 2.0


class BandwidthParameters(NamedTuple):
    """Lane keeping outside a band.

    Attributes:
        car: Nominal car [SI units]. Source: plant/parameters.py.
        column: Nominal column [SI units]. Source: plant/parameters.py.
        road: Lanes [SI units]. Source: plant/parameters.py.
        lanes: When the followed lane changes [SI units]. Source: methods/lanes.py.
        band: Where there is guidance [SI units]. Source: Petermeijer et al. 2015.
        preview: Preview time [SI units]. Source: Fig. 4.
        guidance: Gains [SI units]. Source: Eq. (5).
        actuation: Strength and limits [SI units]. Source: Eq. (6), Table IV.
    """

    car: CarParameters = CarParameters()
    column: ColumnParameters = ColumnParameters()
    road: RoadParameters = RoadParameters()
    lanes: LaneParameters = LaneParameters()
    band: BandParameters = BandParameters()
    preview: PreviewParameters = PreviewParameters()
    guidance: GuidanceParameters = GuidanceParameters()
    actuation: ActuationParameters = ActuationParameters()


class BandwidthConstantParameters(NamedTuple):
    """A torque of one size outside a band.

    Attributes:
        road: Lanes [SI units]. Source: plant/parameters.py.
        lanes: When the followed lane changes [SI units]. Source: methods/lanes.py.
        band: Where there is guidance [SI units]. Source: Park et al. 2018.
        constant: Size of the torque [SI units]. Source: Park et al. 2018.
        actuation: Strength and limits [SI units]. Source: Eq. (6), Table IV.
    """

    road: RoadParameters = RoadParameters()
    lanes: LaneParameters = LaneParameters()
    band: BandParameters = BandParameters(half_width=0.4, prediction_time=0.0)
    constant: ConstantParameters = ConstantParameters()
    actuation: ActuationParameters = ActuationParameters()


class BandwidthState(NamedTuple):
    """What the method remembers.

    Attributes:
        lane: That is followed [-].
        departed: Side on which the car has left the band, or is about to, -1 right or
            +1 left; 0 without guidance [-].
        actuation: Last torque.
    """

    lane: Real
    departed: Real
    actuation: ActuationState


@compiled
def initial_state(
    parameters: BandwidthParameters | BandwidthConstantParameters, lane: Real
) -> BandwidthState:
    """Follow the lane that the car starts in, without guidance."""
    return BandwidthState(lane=lane, departed=0.0, actuation=actuation.initial_state())


@compiled
def is_outside(parameters: BandParameters, offset: Real, ahead: Real) -> Flag:
    """Whether the car has left the band on the left, or is about to.

    Args:
        parameters: Band.
        offset: From the lane's centre, towards the side that is asked about [m].
        ahead: The same after the prediction time [m].
    """
    width = parameters.half_width
    return (offset > width) | (ahead > width)


@compiled
def departure(
    parameters: BandParameters, departed: Real, offset: Real, velocity: Real
) -> Real:
    """Side of the band on which there is guidance now, 0 for none [-].

    A sample that is lost changes nothing.

    Args:
        parameters: Band, and where guidance ends.
        departed: The same at the step before [-].
        offset: Of the car from the lane's centre, left positive [m].
        velocity: Of the car across the road [m/s].
    """
    ahead = offset + parameters.prediction_time * velocity
    left = is_outside(parameters, offset, ahead)
    right = is_outside(parameters, -offset, -ahead)
    begun = xp.select(left, 1.0, xp.select(right, -1.0, 0.0))
    leaving = is_outside(parameters, departed * offset, departed * ahead)
    back = departed * offset < parameters.return_offset
    ends = back & xp.logical_not(leaving)
    return xp.select(departed == 0.0, begun, xp.select(ends, 0.0, departed))


@compiled
def step(
    parameters: BandwidthParameters,
    state: BandwidthState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[BandwidthState, Assistance]:
    """Lane keeping outside the band, nothing inside.

    Args:
        parameters: Lanes, band, guidance, limits.
        state: Lane, side of departure, last torque.
        measurement: This step's sample.
        request: Not looked at.
        dt: Control step [s].
    """
    lane, target, errors, torques = keep(parameters, state.lane, measurement)
    offset = offset_from(parameters.road, lane, measurement)
    departed = departure(
        parameters.band, state.departed, offset, lateral_velocity(measurement)
    )
    share = xp.select(departed == 0.0, 0.0, 1.0)
    limited, torque = actuation.step(
        parameters.actuation, state.actuation, share, torques.instructed_torque, dt
    )
    new_state = BandwidthState(lane=lane, departed=departed, actuation=limited)
    return new_state, Assistance(
        applied_torque=torque, target=target, preview=errors, guidance=torques
    )


@compiled
def constant_step(
    parameters: BandwidthConstantParameters,
    state: BandwidthState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[BandwidthState, Assistance]:
    """A torque of one size outside the band, nothing inside.

    Args:
        parameters: Lanes, band, torque, limits.
        state: Lane, side of departure, last torque.
        measurement: This step's sample; without a place there is no torque.
        request: Not looked at.
        dt: Control step [s].
    """
    road = parameters.road
    lane = followed_lane(parameters.lanes, road, state.lane, measurement)
    target = lane_target(road, lane, measurement)
    offset = offset_from(road, lane, measurement)
    departed = departure(
        parameters.band, state.departed, offset, lateral_velocity(measurement)
    )
    wanted = -departed * parameters.constant.torque
    known = xp.select(xp.isfinite(offset), wanted, offset)
    limited, torque = actuation.step(
        parameters.actuation, state.actuation, 1.0, known, dt
    )
    new_state = BandwidthState(lane=lane, departed=departed, actuation=limited)
    return new_state, Assistance(
        applied_torque=torque,
        target=target,
        guidance=Guidance(instructed_torque=wanted),
    )


_DEPARTED = Column(
    "method_departed",
    "-",
    "float64",
    "side on which the band was left, -1 right, +1 left; 0 without guidance",
    "method.departed",
    stepped=True,
    mirrored="flipped",
)
_BAND = tuple(
    Tunable(leaf, f"band.{leaf}", unit, 0.0, high, label)
    for leaf, unit, high, label in (
        ("half_width", "m", 1.5, "half the band's width"),
        ("return_offset", "m", 1.5, "offset at which guidance ends"),
        ("prediction_time", "s", 2.0, "prediction of a departure"),
    )
)

BANDWIDTH = Method(
    name="bandwidth",
    version="1",
    source="Petermeijer, Abbink, de Winter 2015: guidance outside a band",
    parameters=partial(like_ibhs, BandwidthParameters),
    initial_state=initial_state,
    step=step,
    columns=(_DEPARTED,),
    tunables=(*_BAND, *shared_tunables(BandwidthParameters)),
)
CONSTANT = Method(
    name="bandwidth-constant",
    version="1",
    source="Park et al. 2018: torque of one size outside a band",
    parameters=partial(like_ibhs, BandwidthConstantParameters),
    initial_state=initial_state,
    step=constant_step,
    columns=(_DEPARTED,),
    tunables=(
        Tunable("torque", "constant.torque", "N·m", 0.0, 5.0, "size of the torque"),
        *_BAND,
        *shared_tunables(BandwidthConstantParameters),
    ),
)
