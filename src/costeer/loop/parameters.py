"""Everything that one trial needs besides random numbers."""

from __future__ import annotations

from typing import Any, Generic, NamedTuple, TypeVar

from costeer.base.array import Real
from costeer.drivers.driver import DriverParameters
from costeer.loop.clock import DT as DT
from costeer.loop.mistakes import MistakeParameters
from costeer.plant.alignment import STRAIGHT, Alignment
from costeer.plant.fleet import NO_FLEET, FleetParameters, num_cars
from costeer.plant.following import FollowingParameters
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.stretches import NOTHING_HAPPENS, Stretches
from costeer.plant.traffic import TrafficParameters
from costeer.sensing.sensors import SensorParameters

P = TypeVar("P")


class StartParameters(NamedTuple):
    """How a trial begins.

    Attributes:
        speed: Of the car [m/s]. Source: paper, about 70 km/h.
        lateral_offset: From the centre of the cruising lane [m]. Source: assumed, 0.
        events: 1 with leaders to overtake, 0 without [-]. Source: paper.
    """

    speed: Real = 70.0 / 3.6
    lateral_offset: Real = 0.0
    events: Real = 1.0


class LoopParameters(NamedTuple, Generic[P]):
    """Everything that one trial needs besides random numbers.

    Attributes:
        controller: Of the method [SI units]. Source: the method, methods/.
        car: Of the plant [SI units]. Source: plant/parameters.py.
        column: Of the plant [SI units]. Source: plant/parameters.py.
        road: Lanes [SI units]. Source: plant/parameters.py.
        traffic: Leaders [SI units]. Source: plant/traffic.py.
        sensors: Errors [SI units]. Source: sensing/sensors.py.
        driver: Who holds the wheel [SI units]. Source: the driver model, drivers/.
        start: How the trial begins [SI units]. Source: this file.
        follows_plan: 1 if the system's lane changes begin and last as the driver plans
            this one, 0 if as the method says [-]. Source: assumed, for the pilot runs
            in which nobody disagrees.
        assists: 1 if the method's torque may reach the motor, 0 if not [-]. Source:
            the method.
        plant_steps: Plant steps in a control step [-]. Source: assumed, 8 make 480
            Hz.
        following: How other cars drive [SI units]. Source: plant/following.py.
        alignment: How the road runs [SI units]. Source: the scenario.
        fleet: The other cars [SI units]. Source: the scenario.
        stretches: What happens along the road [SI units]. Source: the scenario.
        mistakes: What goes wrong [SI units]. Source: the scenario.
    """

    controller: P
    car: CarParameters = CarParameters()
    column: ColumnParameters = ColumnParameters()
    road: RoadParameters = RoadParameters()
    traffic: TrafficParameters = TrafficParameters()
    sensors: SensorParameters = SensorParameters()
    driver: Any = DriverParameters()  # Any: of the driver model's own
    start: StartParameters = StartParameters()
    follows_plan: Real = 0.0
    assists: Real = 1.0
    plant_steps: int = 8
    following: FollowingParameters = FollowingParameters()
    alignment: Alignment = STRAIGHT
    fleet: FleetParameters = NO_FLEET
    stretches: Stretches = NOTHING_HAPPENS
    mistakes: MistakeParameters = MistakeParameters()


class Bare(NamedTuple):
    """What a trial does without, so that its machine code has nothing of it.

    Attributes:
        fleet: There is no other car.
        mistakes: Nothing goes wrong on purpose.
    """

    fleet: bool
    mistakes: bool


def bare_of(parameters: LoopParameters[Any]) -> Bare:
    """What a trial does without."""
    return Bare(
        fleet=num_cars(parameters.fleet) == 0,
        mistakes=parameters.mistakes == MistakeParameters(),
    )


def without(parameters: LoopParameters[P], bare: Bare) -> LoopParameters[P]:
    """The parameters with None for what a trial does without."""
    nothing: Any = None  # Any: only compiled loops meet it, `goes_wrong` and the like
    return parameters._replace(
        fleet=nothing if bare.fleet else parameters.fleet,
        mistakes=nothing if bare.mistakes else parameters.mistakes,
    )
