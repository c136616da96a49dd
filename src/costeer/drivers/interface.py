"""What a driver is who holds the wheel: parameters, a state, and one act a step.

The loop calls nothing else. A driver sees what eyes and hands can tell and commands
arms and pedals; the arms themselves (drivers/arm.py) move with the wheel in the plant's
steps. The functions are pure and marked `compiled`, so that every engine runs them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Generic, NamedTuple, TypeVar

from costeer.base import array as xp
from costeer.base.array import Flag, Real, compiled
from costeer.base.sources import source_hash
from costeer.drivers.arm import ArmCommand
from costeer.drivers.longitudinal import Pedals
from costeer.plant.alignment import STRAIGHT, Alignment
from costeer.plant.fleet import CarKind
from costeer.plant.following import LONGEST_GAP, Ahead
from costeer.plant.outlook import Neighbours
from costeer.plant.parameters import CarParameters, ColumnParameters, RoadParameters
from costeer.plant.traffic import LeaderState, no_leader
from costeer.sensing.measurement import Measurement

P = TypeVar("P")
S = TypeVar("S")


class Knowledge(NamedTuple):
    """What the driver knows by experience and sees of the road ahead.

    Attributes:
        car: As the driver knows it.
        column: Of the wheel.
        road: Its lanes.
        alignment: How it runs; `plant.alignment` has what it looks like from the car.
    """

    car: CarParameters
    column: ColumnParameters
    road: RoadParameters
    alignment: Alignment = STRAIGHT


class Perception(NamedTuple):
    """What reaches the driver in one step.

    Attributes:
        measurement: Motion of the car, as seen and felt.
        leader: The car ahead.
        guidance_torque: At the wheel, felt by the hands [N·m].
        around: The cars about the own one, and a lane change that is asked for.
    """

    measurement: Measurement
    leader: LeaderState
    guidance_torque: Real
    around: Neighbours = Neighbours()


LENGTH = CarKind().length
"""Of a usual car [m]: drivers follow by the distance of the cars' middles."""


@compiled
def as_leader(ahead: Ahead, measurement: Measurement) -> LeaderState:
    """The next car in the way, as a driver takes it for a leader.

    Args:
        ahead: Of the driven car.
        measurement: Of the driven car.
    """
    seen = ahead.gap < LONGEST_GAP
    return no_leader()._replace(
        present=seen,
        longitudinal_position=measurement.longitudinal_position + ahead.gap + LENGTH,
        longitudinal_velocity=ahead.velocity,
        lane=measurement.lane,
    )


@compiled
def leader_in(perception: Perception, direction: Real) -> LeaderState:
    """The next car in the lane that the driver changes to; none without a change.

    Args:
        perception: With the cars around.
        direction: Of the lane change, -1 right, 0 none, +1 left [-].
    """
    around = perception.around
    lane = xp.select(direction > 0.0, around.left, around.right)
    leader = as_leader(lane.ahead, perception.measurement)
    changes = direction != 0.0
    return leader._replace(present=leader.present & changes)


@compiled
def unless(unseen: Flag, leader: LeaderState) -> LeaderState:
    """The leader, if the driver has had the time to see it."""
    return leader._replace(present=leader.present & xp.logical_not(unseen))


class DriverNoise(NamedTuple):
    """Random numbers of one control step: standard normal, `_uniform` in [0, 1).

    `NORMAL_DRAWS` of them come first.
    """

    near: Real
    motor: Real
    wander: Real
    speed: Real
    head_drift: Real
    head_tracker: Real
    glance_amplitude: Real
    change_duration: Real
    preparation_time: Real
    look_uniform: Real
    glance_uniform: Real
    glance_side_uniform: Real
    leader_uniform: Real
    tracker_uniform: Real
    abandoned_uniform: Real
    indicator_uniform: Real


NORMAL_DRAWS = 9
"""Fields of `DriverNoise` that are standard normal."""


class Plan(NamedTuple):
    """When a driver's own lane change is to happen.

    Attributes:
        change_duration: Of the lane change, NaN for none planned [s].
        time_to_crossing: Until it crosses the line; negative after it [s].
        side: Of the lane that it leads to, -1 right, +1 left; 0: the usual one [-].
    """

    change_duration: Real = math.nan
    time_to_crossing: Real = 1e9
    side: Real = 0.0


class Action(NamedTuple):
    """What the driver does until the next step.

    Attributes:
        arm: Command to the arms.
        pedals: Accelerator and brake.
        head_yaw: In [-1, 1], left positive [-].
        intention: Side of the decided lane change, -1 right, 0 none, +1 left; NaN if
            nobody knows it [-].
        at_home: Whether the driver keeps the cruising lane, which ends an event zone.
        plan: Of the decided lane change, for a scripted intention.
        indicator: Side that the indicator is set to, -1 right, 0 off, +1 left [-].
    """

    arm: ArmCommand
    pedals: Pedals
    head_yaw: Real = 0.0
    intention: Real = 0.0
    at_home: Flag = True
    plan: Plan = Plan()
    indicator: Real = 0.0


class Draw(NamedTuple):
    """Which driver is wanted.

    Attributes:
        seed: Of the population; other seeds are other people.
        participant: Number of the driver.
        speed: That is suggested [m/s].
        car: That is driven.
    """

    seed: int = 1
    participant: int = 1
    speed: Real = 70.0 / 3.6
    car: CarParameters = CarParameters()


class DriverLaw(NamedTuple, Generic[P, S]):
    """The functions of a driver that the loop calls, as compiled code takes them.

    Attributes:
        initial_state: From the parameters and the centre of the lane that the car
            starts in [m].
        act: Parameters, state, knowledge, perception, noise and dt to the new state
            and the action.
    """

    initial_state: Callable[[P, Real], S]
    act: Callable[[P, S, Knowledge, Perception, DriverNoise, Real], tuple[S, Action]]


class DriverModel(NamedTuple, Generic[P, S]):
    """A population of drivers who follow one law.

    Attributes:
        name: On the command line and in records: small letters, digits, hyphens.
        version: Changes with the law.
        source: Publication it follows.
        parameters: From a `Draw` to this driver's parameters: a named tuple of floats,
            arrays and flags with a field `arm`, the `ArmParameters` of hands and arms.
        initial_state: From the parameters and the centre of the lane that the car
            starts in [m].
        act: One control step.

    Example:
        >>> from typing import NamedTuple
        >>> import costeer
        >>> from costeer.drivers.arm import ArmCommand, ArmParameters
        >>> from costeer.drivers.interface import Action
        >>> from costeer.drivers.longitudinal import Pedals
        >>> class Still(NamedTuple):
        ...     arm: ArmParameters = ArmParameters()
        ...     pedal: float = 0.1
        >>> class Memory(NamedTuple):
        ...     steps: float = 0.0
        >>> @costeer.compiled
        ... def initial_state(parameters, lane_centre):
        ...     return Memory()
        >>> @costeer.compiled
        ... def act(parameters, state, knowledge, perception, noise, dt):
        ...     pedals = Pedals(accelerator=parameters.pedal, brake=0.0)
        ...     held = ArmCommand(intended_angle=0.0)
        ...     return Memory(state.steps + 1.0), Action(arm=held, pedals=pedals)
        >>> still = costeer.DriverModel(
        ...     name="still",
        ...     version="1",
        ...     source="an example",
        ...     parameters=lambda draw: Still(),
        ...     initial_state=initial_state,
        ...     act=act,
        ... )
        >>> quick = {"length": 100, "intention": "off", "engine": "python"}
        >>> costeer.simulate("manual", driver=still, **quick).metadata["driver"]
        'still 1'
    """

    name: str
    version: str
    source: str
    parameters: Callable[[Draw], P]
    initial_state: Callable[[P, Real], S]
    act: Callable[[P, S, Knowledge, Perception, DriverNoise, Real], tuple[S, Action]]

    def __repr__(self) -> str:
        """Name and version; functions say nothing."""
        return f"<costeer driver model {self.name} {self.version}>"


AnyDriver = DriverModel[Any, Any]  # Any: parameters and state are its own


def law_of(driver: DriverModel[P, S]) -> DriverLaw[P, S]:
    """What the loop calls of a driver."""
    return DriverLaw(initial_state=driver.initial_state, act=driver.act)


def driver_sources(driver: DriverModel[P, S]) -> str:
    """Hash of all that decides what a driver does, outside costeer."""
    return source_hash((driver.parameters, driver.initial_state, driver.act))
