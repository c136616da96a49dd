"""Hands that move a simulated wheel: keys, a script, or a virtual driver.

So a lab rehearses a study without a wheel, and without people. All are arms
(drivers/arm.py) with an intended angle; who says the angle differs.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from costeer.base.packing import packed
from costeer.drivers import arm, driver
from costeer.drivers.arm import ArmCommand, ArmParameters
from costeer.drivers.driver import DriverParameters
from costeer.drivers.interface import DriverNoise, Knowledge, Perception
from costeer.drivers.population import participant_driver
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT
from costeer.loop.realtime import arms_tick
from costeer.plant.parameters import (
    CarParameters,
    ColumnParameters,
    RoadParameters,
    holding_stiffness,
)
from costeer.plant.road import adjacent_side, cruising_lane, lane_centre
from costeer.plant.traffic import LeaderState
from costeer.records.row import ROW_COLUMNS
from costeer.sensing.measurement import Measurement

# Any, in this file: of JSON, and rows of numbers.
_NOISE_STEPS = 36_000
"""Random numbers are drawn for ten minutes, then come again [samples]."""


class Seen(NamedTuple):
    """What hands are told at each control step.

    Attributes:
        row: Of the drive, in the order of `ROW_COLUMNS`.
        car: That is driven.
        road: It drives on.
        intended_angle: That keys or stick of the page ask for [rad].
        grip: Whether they do, from 0 to 1 [-].
        accelerator: Of the page's pedals [-].
        brake: The same.
    """

    row: Any
    car: CarParameters
    road: RoadParameters
    intended_angle: float = 0.0
    grip: float = 0.0
    accelerator: float = 0.0
    brake: float = 0.0


class MovingHands(Protocol):
    """Hands on a simulated wheel that look at the drive."""

    is_virtual: bool

    def see(self, seen: Seen) -> None:
        """Look, once in a control step."""
        ...

    def pedals(self) -> tuple[float, float]:
        """Accelerator and brake, 0 to 1; NaN to leave them to the page."""
        ...

    def __call__(self, time: float, angle: float, rate: float) -> float:
        """Torque on the rim [N·m]."""
        ...


class _Arms:
    """Two arms with an intended angle."""

    is_virtual = False

    def __init__(self, parameters: ArmParameters, dt: float) -> None:
        self._dt = dt
        self._rest()
        self._hold(parameters)
        self._ask(ArmCommand())

    def _rest(self) -> None:
        self._state = packed(arm.initial_state())

    def _hold(self, parameters: ArmParameters) -> None:
        self._arms, self._numbers = parameters, packed(parameters)

    def _ask(self, command: ArmCommand) -> None:
        self._asked = packed(command)
        self._damping = float(arm.arm_damping(self._arms, command.stiffening))

    def pedals(self) -> tuple[float, float]:
        """No pedals of its own."""
        return math.nan, math.nan

    def __call__(self, time: float, angle: float, rate: float) -> float:
        """Torque of muscles on the rim [N·m], less what damps the arms."""
        pulled = arms_tick(self._numbers, self._state, self._asked, angle, self._dt)
        return float(pulled - self._damping * rate)

    def _intend(self, angle: float, speed: float, car: CarParameters) -> None:
        stiffness = holding_stiffness(car, ColumnParameters(), max(speed, 1.0))
        self._ask(ArmCommand(intended_angle=angle, holding_stiffness=stiffness))


_SPEED = ROW_COLUMNS.index("longitudinal_velocity")


class KeyHands(_Arms):
    """Keys or stick of the driver's page move the hands, as in a drive without wheel.

    Args:
        dt: Step of the wheel [s].
    """

    def __init__(self, dt: float) -> None:
        super().__init__(ArmParameters(), dt)
        self._relaxed = ArmParameters()

    def see(self, seen: Seen) -> None:
        """Take what is asked; hands that ask nothing rest on the rim."""
        hands, grip = self._relaxed, seen.grip
        self._hold(
            hands._replace(
                holding_gain=hands.holding_gain * grip, stiffness=hands.stiffness * grip
            )
        )
        self._intend(seen.intended_angle, float(seen.row[_SPEED]), seen.car)


def warm_up_hands() -> None:
    """Compile what moves the arms of a simulated wheel, which nobody sees."""
    KeyHands(1.0 / 960.0)(0.0, 0.0, 0.0)


class ScriptHands(_Arms):
    """A script says when the hands intend which angle; straight lines between.

    Args:
        script: Pairs of time [s] and angle [rad], in order.
        dt: Step of the wheel [s].
    """

    def __init__(self, script: tuple[tuple[float, float], ...], dt: float) -> None:
        super().__init__(ArmParameters(), dt)
        self._script = script

    def see(self, seen: Seen) -> None:
        """Intend what the script has for the time of the trial."""
        now = float(seen.row[_TIME])
        angle = angle_at(self._script, now)
        self._intend(angle, float(seen.row[_SPEED]), seen.car)


def angle_at(script: tuple[tuple[float, float], ...], time: float) -> float:
    """Angle of a script at a time [rad]; held before its start and after its end."""
    if time <= script[0][0]:
        return script[0][1]
    for (begin, low), (end, high) in pairwise(script):
        if time <= end:
            return low + (high - low) * (time - begin) / (end - begin)
    return script[-1][1]


def read_script(path: Path) -> tuple[tuple[float, float], ...]:
    """A script of a CSV file with the columns `time` [s] and `angle_deg` [deg].

    Raises:
        ValueError: If it is none, or its times do not grow.
        OSError: If it cannot be read.
    """
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    try:
        pairs = tuple(
            (float(row["time"]), math.radians(float(row["angle_deg"]))) for row in rows
        )
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(
            f"{path} is no script of hands; give the columns time [s] and angle_deg"
        ) from error
    grows = all(a[0] < b[0] for a, b in pairwise(pairs))
    if not pairs or not grows or not all(map(math.isfinite, sum(pairs, ()))):
        raise ValueError(f"{path}: times must grow, and all numbers be finite")
    return pairs


_TIME = ROW_COLUMNS.index("time")
_DIRECT = {
    name: ROW_COLUMNS.index(name) for name in Measurement._fields if name in ROW_COLUMNS
}
_LEADER = {
    name: ROW_COLUMNS.index(name)
    for name in ("lead_distance", "lead_velocity", "lead_lane", "event")
}


class VirtualHands(_Arms):
    """A virtual driver of the population at the wheel and the pedals.

    What it does is what it does in `costeer simulate`, but for the device between: the
    wheel's own inertia, friction and latency.

    Args:
        parameters: Of the driver.
        noise: Random numbers, shape `(time, draw)`.
        dt: Step of the wheel [s].
    """

    is_virtual = True

    def __init__(self, parameters: DriverParameters, noise: Any, dt: float) -> None:
        super().__init__(parameters.arm, dt)
        self._driver, self._noise = parameters, noise
        self._road: RoadParameters | None = None
        self._mind: Any = None
        self._pedals = (0.0, 0.0)
        self._last = math.inf
        self._steps = 0

    def pedals(self) -> tuple[float, float]:
        """Of the driver's foot."""
        return self._pedals

    def see(self, seen: Seen) -> None:
        """Decide and act for a control step."""
        now = float(seen.row[_TIME])
        if now < self._last:  # a trial begins
            centre = lane_centre(seen.road, cruising_lane(seen.road))
            self._mind = driver.initial_state(self._driver, centre)
            self._rest()
            self._steps = 0
        self._last = now
        known = Knowledge(car=seen.car, column=ColumnParameters(), road=seen.road)
        draws = DriverNoise(*self._noise[self._steps % len(self._noise)].tolist())
        self._steps += 1
        self._mind, action = driver.act(
            self._driver, self._mind, known, perceived(seen), draws, DT
        )
        self._ask(action.arm)
        self._pedals = (float(action.pedals.accelerator), float(action.pedals.brake))


def perceived(seen: Seen) -> Perception:
    """What a row of the drive shows to a virtual driver."""
    row = seen.row
    values: dict[str, Any] = {name: float(row[at]) for name, at in _DIRECT.items()}
    side = adjacent_side(seen.road, values["lane"])
    seen_now = Measurement(
        **{**dict.fromkeys(Measurement._fields, 0.0), **values, "side": side}
    )
    distance = float(row[_LEADER["lead_distance"]])
    leader = LeaderState(
        present=math.isfinite(distance),
        longitudinal_position=seen_now.longitudinal_position
        + (distance if math.isfinite(distance) else 0.0),
        longitudinal_velocity=_finite(row[_LEADER["lead_velocity"]]),
        lane=_finite(row[_LEADER["lead_lane"]]),
        num_appeared=_finite(row[_LEADER["event"]]),
    )
    torque = _finite(row[ROW_COLUMNS.index("applied_torque")])
    return Perception(measurement=seen_now, leader=leader, guidance_torque=torque)


def _finite(value: Any) -> float:
    return float(value) if math.isfinite(value) else 0.0


def virtual_hands(said: Mapping[str, Any], dt: float) -> VirtualHands:
    """Hands of the driver that a description names: seed, participant, speed, trial."""
    seed, who = int(said.get("seed", 1)), int(said.get("participant", 1))
    speed = float(said.get("speed", 70.0 / 3.6))
    noise = driver_noise(seed, who, str(said.get("trial", "")), _NOISE_STEPS)
    return VirtualHands(participant_driver(seed, who, speed), noise, dt)


def script_hands(said: Mapping[str, Any], dt: float) -> ScriptHands:
    """Hands of a script in a description."""
    return ScriptHands(tuple((float(t), float(a)) for t, a in said["script"]), dt)


def key_hands(said: Mapping[str, Any], dt: float) -> KeyHands:
    """Hands that keys move."""
    return KeyHands(dt)


KINDS: dict[str, Callable[[Mapping[str, Any], float], MovingHands]] = {
    "virtual": virtual_hands,
    "script": script_hands,
    "keys": key_hands,
}
"""Who moves the hands, by the word in a description."""
