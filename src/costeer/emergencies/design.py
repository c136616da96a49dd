"""Which emergencies are driven: Sec. V-C's four situations, speeds, times and sides.

An obstacle appears so many seconds ahead. What the assistance does at that moment, and
whether driver and system agree, makes the situation; a drive is *meant* to come to it,
what it came to is read from its record.
"""

from __future__ import annotations

from typing import NamedTuple

from costeer.loop.scenario import TrialSetup
from costeer.methods.conditions import MANUAL
from costeer.scenarios.definition import Actor, Event, Road, Scenario, When

SITUATIONS = {
    1: "no lane change assisted, consistent",
    2: "no lane change assisted, inconsistent",
    3: "lane change assisted, consistent",
    4: "lane change assisted, inconsistent",
}
"""The four situations of Sec. V-C, by number."""

CONDITIONS = (MANUAL, "weak-normal", "strong-normal")
SPEEDS = (70.0 / 3.6, 90.0 / 3.6)
"""Suggested speeds [m/s]. Source: spec section 12."""

TIMES = (1.5, 2.0, 3.0, 4.0)
"""Time to collision when the obstacle appears [s]. Source: spec section 12."""

APPEARS_AT = 300.0
"""Where the car is when the obstacle appears [m]."""

_CHANGE_BEFORE = {2: 3.6, 3: 3.6, 4: 1.6}
"""A lane change is asked for, or started by the system, so long before [s]."""

_ASKED_FOR = 0.2
"""How long a lane change is asked for [s]."""

_LENGTH = 750.0
_HOME, _OUTER = 1, 0
"""Lanes of a road with left-hand traffic: driven in, and overtaken in [-]."""

_BESIDE = 8.0
"""A car in the other lane drives so far behind the own one [m]."""


class Emergency(NamedTuple):
    """One drive with an obstacle.

    Attributes:
        condition: Of the guidance.
        situation: That it is meant to come to, 1 to 4 [-].
        speed: Suggested [m/s].
        time_to_collision: When the obstacle appears [s].
        lane_is_free: Whether nothing drives in the lane beside.
        participant: Number of the driver.
    """

    condition: str
    situation: int
    speed: float
    time_to_collision: float
    lane_is_free: bool
    participant: int


class Settings(NamedTuple):
    """What the user of `costeer emergencies` decides.

    Attributes:
        drivers: How many virtual drivers.
        seed: Of drivers and noise.
        conditions: Of the guidance.
        method: Of the assistance: its name, or where it is.
    """

    drivers: int = 10
    seed: int = 1
    conditions: tuple[str, ...] = CONDITIONS
    method: str = "ibhs"


def situations_of(condition: str) -> tuple[int, ...]:
    """Situations that a condition can come to: without assistance, one.

    A driver alone meets the obstacle while keeping the lane and in a lane change.
    """
    return (1, 3) if condition == MANUAL else tuple(SITUATIONS)


def planned(settings: Settings) -> list[Emergency]:
    """All drives, in the order of the tables."""
    return [
        Emergency(condition, situation, speed, time, is_free, participant)
        for condition in settings.conditions
        for situation in situations_of(condition)
        for speed in SPEEDS
        for time in TIMES
        for is_free in (True, False)
        for participant in range(1, settings.drivers + 1)
    ]


def undisturbed(drive: Emergency) -> Emergency:
    """What stands for all drives that are one until the obstacle appears."""
    return drive._replace(time_to_collision=TIMES[0], lane_is_free=True)


def scenario_of(drive: Emergency) -> Scenario:
    """Road, obstacle and lane change of a drive.

    The obstacle lies in the lane that is driven in or, where a lane change is under
    way, in the one that is changed to.
    """
    lane = _OUTER if drive.situation in (2, 3) else _HOME
    obstacle = Actor(
        name="obstacle",
        kind="obstacle",
        lane=lane,
        appears=When(place=APPEARS_AT),
        headway=drive.time_to_collision,
    )
    beside = Actor(
        name="car beside",
        lane=_HOME if lane == _OUTER else _OUTER,
        at=APPEARS_AT - _BESIDE,
        speed=f"{drive.speed}",
        appears=When(place=APPEARS_AT),
        follows=True,
    )
    return Scenario(
        name="emergency",
        about="An obstacle appears ahead.",
        speed=f"{drive.speed}",
        road=Road(length=_LENGTH),
        actors=(obstacle,) if drive.lane_is_free else (obstacle, beside),
        events=_asked(drive),
    )


def _asked(drive: Emergency) -> tuple[Event, ...]:
    """A lane change that the driver is asked for before the obstacle appears."""
    if drive.situation not in (2, 3):
        return ()
    start = APPEARS_AT - drive.speed * _CHANGE_BEFORE[drive.situation]
    length = drive.speed * _ASKED_FOR
    return (Event(kind="lane-change", at=start, length=length, side="right"),)


def setup_of(
    settings: Settings, drive: Emergency, with_obstacle: bool = True
) -> TrialSetup:
    """The trial of a drive, or the same without the obstacle.

    The system knows of the driver's lane change in situation 3 and not in 2; in 4 it
    starts one that nobody wants.
    """
    begins = APPEARS_AT / drive.speed - _CHANGE_BEFORE.get(drive.situation, 0.0)
    started = (begins,) if drive.situation == 4 else ()
    scenario = scenario_of(drive)
    return TrialSetup(
        participant=drive.participant,
        seed=settings.seed,
        condition=drive.condition,
        method=settings.method,
        length=_LENGTH,
        speed=drive.speed,
        intention="scripted" if drive.situation == 3 else "off",
        trigger_times=started,
        events=False,
        scenario=scenario if with_obstacle else scenario._replace(actors=()),
    )
