"""A steering wheel that is not there: a rim on a motor, held by hands or by nobody.

It steps by exactly `dt` at each reading, so that tests need no wall clock. Between two
readings the torques are constant and the motion is exact: wheels/rim.py.
"""

from __future__ import annotations

import json
import math
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from costeer.devices.wheels.calibration import (
    WheelCalibration,
    device_command,
    device_torque,
    largest_torque,
)
from costeer.devices.wheels.hands import KINDS, Seen
from costeer.devices.wheels.interface import (
    EFFECT_LIFE,
    WheelDescription,
    WheelLost,
    WheelReading,
    limited,
)
from costeer.devices.wheels.rim import Rim, moved
from costeer.devices.wheels.torque_cell import TorqueCell

Hands = Callable[[float, float, float], float]
"""Torque of hands [N·m] from time [s], angle [rad] and rate [rad/s]; left positive."""


class SimulatedWheelParameters(NamedTuple):
    """A device as it is, whatever its calibration says; left is positive.

    Attributes:
        inertia: Of rim and motor [kg·m²]. Source: assumed, a consumer wheel.
        damping: Of the gear [N·m·s/rad]. Source: assumed, a consumer wheel.
        friction: Coulomb friction of the gear [N·m]. Source: assumed, a consumer wheel.
        full_range: Lock to lock [rad]. Source: assumed, 900 deg as most wheels have.
        torque_curve: Command in [0, 1] [-] and torque that it gives [N·m]; straight
            lines between. Source: assumed, 2.2 N·m at most as a Logitech G29.
        angle_sign: Of its axis [-], +1 if it grows to the left. Source: assumed, to the
            right as evdev and DirectInput have it.
        torque_sign: Of its motor [-], +1 if a positive command pushes to the left.
            Source: assumed, to the right.
        latency: Readings from a command until it pushes [samples]. Source: assumed, 5
            samples of 1/960 s as a wheel on USB.
        resolution: Smallest step of the angle [rad]; 0 for none. Source: assumed, 16
            bit over 900 deg.
        measures_torque: Whether it has a torque sensor [-]. Source: assumed, a consumer
            wheel has none.
        measures_rate: Whether it tells its rate [-]. Source: assumed, as above.
        accelerator: Where the pedal rests [-]; NaN for none. Source: assumed, none.
        brake: Where the pedal rests [-]; NaN for none. Source: assumed, none.
        dt: From one reading to the next [s]. Source: assumed, the loop's 960 Hz.
        unplug_at: When it is unplugged [s]. Source: assumed, never.
        freeze_at: When its reading stands still for ever [s]. Source: assumed, never.
    """

    inertia: float = 0.04
    damping: float = 0.05
    friction: float = 0.1
    full_range: float = 5.0 * math.pi
    torque_curve: tuple[tuple[float, float], ...] = ((0.0, 0.0), (1.0, 2.2))
    angle_sign: float = -1.0
    torque_sign: float = -1.0
    latency: int = 5
    resolution: float = 5.0 * math.pi / 65536.0
    measures_torque: bool = False
    measures_rate: bool = False
    accelerator: float = math.nan
    brake: float = math.nan
    dt: float = 1.0 / 960.0
    unplug_at: float = math.inf
    freeze_at: float = math.inf


class SpringHands(NamedTuple):
    """Hands that pull the rim towards an angle that swings; they can be pickled.

    Attributes:
        stiffness: Of the arms [N·m/rad].
        damping: Of the arms [N·m·s/rad].
        amplitude: Of the angle that they want [rad].
        period: Of its swing [s].
    """

    stiffness: float = 3.0
    damping: float = 0.5
    amplitude: float = 0.0
    period: float = 4.0

    def __call__(self, time: float, angle: float, rate: float) -> float:
        """Torque of the hands [N·m]."""
        wanted = self.amplitude * math.sin(2.0 * math.pi * time / self.period)
        return self.stiffness * (wanted - angle) - self.damping * rate


def no_hands(time: float, angle: float, rate: float) -> float:
    """Nobody holds the rim."""
    return 0.0


def true_calibration(
    parameters: SimulatedWheelParameters, identity: str = "simulated"
) -> WheelCalibration:
    """The calibration that says of a simulated wheel what is so."""
    return WheelCalibration(
        identity=identity,
        angle_sign=parameters.angle_sign,
        full_range=parameters.full_range,
        torque_sign=parameters.torque_sign,
        torque_curve=parameters.torque_curve,
        inertia=parameters.inertia,
        damping=parameters.damping,
        friction=parameters.friction,
        latency=parameters.latency * parameters.dt,
    )


def simulated_description(
    identity: str = "simulated",
    hands: SpringHands | Mapping[str, Any] | None = None,
    torque_cell: str = "",
    **options: Any,  # Any: fields of SimulatedWheelParameters, each of its own type
) -> WheelDescription:
    """Describe a simulated wheel, for another process to open.

    Args:
        identity: Key of its calibration.
        hands: Who holds it; nobody if None. A mapping names moving hands: `kind` is one
            of `hands.KINDS`, the rest is theirs.
        torque_cell: Name of the shared memory that shows its torque; see `TorqueCell`.
        **options: Fields of `SimulatedWheelParameters` that differ.

    Raises:
        ValueError: If an option is none.
    """
    SimulatedWheelParameters(**_known(options))
    content: dict[str, Any] = dict(options)  # Any: what JSON holds
    if isinstance(hands, SpringHands):
        content["hands"] = hands._asdict()
    elif hands is not None:
        content["hands"] = dict(hands)
    content |= {"torque_cell": torque_cell} if torque_cell else {}
    return WheelDescription(
        "simulated", json.dumps(content), "simulated wheel", identity
    )


def held_by(description: WheelDescription | None) -> str:
    """Word of the moving hands on a simulated wheel; empty for any other."""
    if description is None or description.kind != "simulated":
        return ""
    hands = _content(description).get("hands") or {}
    return str(hands.get("kind", ""))


def in_hands_of(
    description: WheelDescription | None, participant: int, trial: str, speed: float
) -> WheelDescription | None:
    """A simulated wheel in the hands of a virtual driver; any other as it is.

    Args:
        description: Of the wheel.
        participant: Number of the driver.
        trial: Picks the driver's noise.
        speed: That is suggested [m/s].
    """
    if description is None or held_by(description) != "virtual":
        return description
    content = _content(description)
    driven = {"participant": participant, "trial": trial, "speed": speed}
    content["hands"] = {**content["hands"], **driven}
    return description._replace(address=json.dumps(content))


def open_simulated(
    description: WheelDescription,
    calibration: WheelCalibration,
    clock: Callable[[], float] | None = None,
) -> SimulatedWheel:
    """Make the wheel that a description tells of.

    Args:
        description: As `simulated_description` gave it.
        calibration: What is believed of it.
        clock: Gives the time of a reading; simulated time if None.

    Raises:
        ValueError: If the description is none of a simulated wheel.
    """
    content = _content(description)
    hands = content.pop("hands", None)
    cell = content.pop("torque_cell", "")
    if "torque_curve" in content:
        content["torque_curve"] = tuple(tuple(p) for p in content["torque_curve"])
    parameters = SimulatedWheelParameters(**_known(content))
    return SimulatedWheel(
        parameters,
        calibration,
        _hands(hands, parameters.dt),
        torque_cell=TorqueCell(cell) if cell else None,
        clock=clock,
    )


def _hands(said: dict[str, Any] | None, dt: float) -> Hands:
    """Who holds the wheel.

    Raises:
        ValueError: If there are no such hands.
    """
    if said is None:
        return no_hands
    if "kind" not in said:
        return SpringHands(**said).__call__  # a named tuple is no `Callable` to mypy
    if said["kind"] not in KINDS:
        raise ValueError(
            f"hands of kind {said['kind']!r} are not known; {', '.join(KINDS)} are"
        )
    return KINDS[said["kind"]](said, dt)


def stop_simulated(description: WheelDescription) -> None:
    """Set the torque that a simulated wheel shows to zero, from another process."""
    if name := _content(description).get("torque_cell", ""):
        cell = TorqueCell(name)
        cell.write(0.0)
        cell.close()


class SimulatedWheel:
    """A device that steps by `dt` at each reading."""

    write_rate = 960.0

    def __init__(
        self,
        parameters: SimulatedWheelParameters,
        calibration: WheelCalibration,
        hands: Hands = no_hands,
        torque_cell: TorqueCell | None = None,
        clock: Callable[[], float] | None = None,
    ) -> None:
        """Put the wheel at rest, straight ahead.

        Args:
            parameters: What the device is.
            calibration: What is believed of it.
            hands: Who holds it.
            torque_cell: Shows the torque of the motor to other processes.
            clock: Gives the time of a reading; simulated time if None.
        """
        self.torque_limit = largest_torque(calibration)
        self.measures_torque = parameters.measures_torque
        self.angle = 0.0
        self.rate = 0.0
        self.motor_torque = 0.0
        self._parameters = parameters
        self._rim = Rim(parameters.inertia, parameters.damping, parameters.friction)
        self._device = true_calibration(parameters)
        self._calibration = calibration
        self._hands = hands
        self._cell = torque_cell
        self._clock = clock
        self._steps = 0
        self._written_at = -math.inf
        self._commanded = 0.0
        self._on_the_way = deque([0.0] * parameters.latency)
        self._frozen: WheelReading | None = None
        self._open = True

    @property
    def time(self) -> float:
        """Simulated time since it was opened [s]."""
        return self._steps * self._parameters.dt

    def read(self) -> WheelReading:
        """See `Wheel.read`; advances by `dt` first."""
        self._check_plugged()
        held = self._step()
        if self._frozen is not None:
            return self._frozen
        reading = self._reading(held)
        if self.time >= self._parameters.freeze_at:
            self._frozen = reading
        return reading

    def axes(self) -> tuple[float, ...]:
        """Every axis of the device, in [-1, 1], as it is now: only the steering.

        Raises:
            WheelLost: If it is unplugged.
        """
        self._check_plugged()
        return (self._axis(),)

    def see(self, seen: Seen) -> None:
        """Let hands that move look at the drive, once in a control step."""
        if look := getattr(self._hands, "see", None):
            look(seen)

    def write(self, torque: float) -> None:
        """See `Wheel.write`."""
        self._check_plugged()
        torque = limited(torque, self.torque_limit)
        self._commanded = device_command(self._calibration, torque)
        self._written_at = self.time
        if self._cell is not None:
            self._cell.write(device_torque(self._device, self._commanded))

    def close(self) -> None:
        """See `Wheel.close`."""
        if self._open and self._cell is not None:
            self._cell.write(0.0)
            self._cell.close()
        self._open = False
        self._commanded = 0.0

    def _check_plugged(self) -> None:
        if not self._open:
            raise WheelLost("the simulated wheel is closed")
        if self.time >= self._parameters.unplug_at:
            raise WheelLost("the simulated wheel was unplugged")

    def _step(self) -> float:
        """Advance by `dt`; return the torque of the hands during it."""
        parameters = self._parameters
        if self.time - self._written_at >= EFFECT_LIFE:
            self._commanded = 0.0
        self._on_the_way.append(self._commanded)
        self.motor_torque = device_torque(self._device, self._on_the_way.popleft())
        held = self._hands(self.time, self.angle, self.rate)
        torque = self.motor_torque + held
        turned, self.rate = moved(self._rim, self.rate, torque, parameters.dt)
        self._steps += 1
        end = parameters.full_range / 2.0
        self.angle += turned
        if abs(self.angle) > end:
            self.angle, self.rate = math.copysign(end, self.angle), 0.0
        return held

    def _axis(self) -> float:
        """The axis as the device sends it."""
        parameters = self._parameters
        angle = self.angle
        if parameters.resolution > 0.0:
            angle = round(angle / parameters.resolution) * parameters.resolution
        return parameters.angle_sign * angle / (parameters.full_range / 2.0)

    def _reading(self, held: float) -> WheelReading:
        parameters, known = self._parameters, self._calibration
        seen = parameters.angle_sign * known.angle_sign
        pressed = getattr(self._hands, "pedals", None)
        accelerator, brake = pressed() if pressed else (math.nan, math.nan)
        if math.isnan(accelerator):
            accelerator, brake = parameters.accelerator, parameters.brake
        return WheelReading(
            time=self.time if self._clock is None else self._clock(),
            steering_wheel_angle=self._axis() * known.angle_sign * known.full_range / 2,
            steering_wheel_rate=seen * self.rate
            if parameters.measures_rate
            else math.nan,
            driver_torque=held if parameters.measures_torque else math.nan,
            accelerator=accelerator,
            brake=brake,
            buttons=0,
        )


def _content(description: WheelDescription) -> dict[str, Any]:  # Any: of JSON
    """What the address of a simulated wheel says."""
    try:
        content = json.loads(description.address or "{}")
    except json.JSONDecodeError:
        content = None
    if not isinstance(content, dict):
        raise ValueError(
            f"address {description.address!r} of a simulated wheel is no JSON object; "
            "make it with simulated_description"
        )
    return content


def _known(options: dict[str, Any]) -> dict[str, Any]:  # Any: of JSON
    """The options, if a simulated wheel has them all.

    Raises:
        ValueError: If one is unknown.
    """
    for name in options:
        if name not in SimulatedWheelParameters._fields:
            known = ", ".join(SimulatedWheelParameters._fields)
            raise ValueError(f"a simulated wheel has no {name!r}; it has {known}")
    return options
