"""A constant degree of sharing: Mars, Deroo, Hoc 2014.

Their experiment compares none and five levels of one lane-keeping torque. The level is
the same whatever the driver does.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

from costeer.base.array import Real, compiled
from costeer.controller.actuation import ActuationParameters
from costeer.controller.guidance import GuidanceParameters
from costeer.controller.preview import PreviewParameters
from costeer.controller.signals import Assistance, Request
from costeer.methods import lane_keeping
from costeer.methods.ibhs import like_ibhs, shared_tunables
from costeer.methods.interface import Method, Tunable
from costeer.methods.lane_keeping import LaneKeepingState
from costeer.methods.lanes import LaneParameters
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.sensing.measurement import Measurement

LEVELS = 5.0
"""The highest level, all of the lane-keeping torque [-]."""


class SharingParameters(NamedTuple):
    """How much of the torque the automation gives.

    Attributes:
        level: 0 none, 5 all of it [-]. Source: Mars, Deroo, Hoc 2014 vary it from 0 to
            5; assumed 3, the middle of the five.
    """

    level: Real = 3.0


class FixedSharingParameters(NamedTuple):
    """Lane keeping at a constant level.

    Attributes:
        car: Nominal car [SI units]. Source: plant/parameters.py.
        column: Nominal column [SI units]. Source: plant/parameters.py.
        road: Lanes [SI units]. Source: plant/parameters.py.
        lanes: When the followed lane changes [SI units]. Source: methods/lanes.py.
        preview: Preview time [SI units]. Source: Fig. 4.
        guidance: Gains [SI units]. Source: Eq. (5).
        sharing: Level [SI units]. Source: Mars, Deroo, Hoc 2014.
        actuation: Strength and limits [SI units]. Source: Eq. (6), Table IV.
    """

    car: CarParameters = CarParameters()
    column: ColumnParameters = ColumnParameters()
    road: RoadParameters = RoadParameters()
    lanes: LaneParameters = LaneParameters()
    preview: PreviewParameters = PreviewParameters()
    guidance: GuidanceParameters = GuidanceParameters()
    sharing: SharingParameters = SharingParameters()
    actuation: ActuationParameters = ActuationParameters()


@compiled
def step(
    parameters: FixedSharingParameters,
    state: LaneKeepingState,
    measurement: Measurement,
    request: Request,
    dt: Real,
) -> tuple[LaneKeepingState, Assistance]:
    """A constant share of the lane-keeping torque; a request changes nothing."""
    share = parameters.sharing.level / LEVELS
    return lane_keeping.assist(parameters, state, measurement, share, dt)


METHOD = Method(
    name="fixed-sharing",
    version="1",
    source="Mars, Deroo, Hoc 2014: constant degree of sharing in lane keeping",
    parameters=partial(like_ibhs, FixedSharingParameters),
    initial_state=lane_keeping.initial_state,
    step=step,
    tunables=(
        Tunable("level", "sharing.level", "-", 0.0, LEVELS, "degree of sharing"),
        *shared_tunables(FixedSharingParameters),
    ),
)
