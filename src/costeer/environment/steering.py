"""Gymnasium's view of a trial: the agent is the guidance, or the driver.

One step of the environment is one control step of the loop (1/60 s). Torques have the
delays that they have in every trial: the hands act in the step, the guidance's torque
acts in the next one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from costeer.base.extras import install_command
from costeer.drivers.interface import DriverNoise
from costeer.environment.observation import SIGNALS, observation
from costeer.environment.seats import DRIVER, GUIDANCE, GivenHands, GivenTorque
from costeer.loop.endings import has_stopped, outcome_of, still
from costeer.loop.events import has_collided
from costeer.loop.noise import driver_noise
from costeer.loop.parameters import DT
from costeer.loop.rows import loop_rule
from costeer.loop.scenario import (
    INTENTIONS,
    TrialSetup,
    is_assisted,
    loop_parameters,
    trial_driver_model,
    trial_method,
)
from costeer.loop.step import initial_state, sense
from costeer.loop.tick import Script, tick
from costeer.loop.trial import SLOWEST_SHARE, idle_network, trial_metadata
from costeer.plant.fleet import num_cars, write_cars
from costeer.plant.road import lane_centre
from costeer.records.cars import car_columns
from costeer.records.columns import TrialRecord, with_method_columns
from costeer.records.row import record_columns
from costeer.sensing.measurement import Measurement

try:
    import gymnasium
except ModuleNotFoundError as error:
    told = f"gymnasium is not installed; {install_command('gym')}"
    raise ModuleNotFoundError(told, name="gymnasium") from error

Numbers: TypeAlias = NDArray[np.float64]
Seen: TypeAlias = NDArray[np.float32]
Reward: TypeAlias = Callable[[Measurement, float, Numbers], float]

HAND_TORQUE = 10.0
"""Of the hands at an action of 1 [N·m]. Source: assumed, firm steering."""

AGENTS = tuple(SIGNALS)
USUAL = TrialSetup(condition="strong-normal", intention="off", length=1000.0)


def lane_keeping(measurement: Measurement, offset: float, action: Numbers) -> float:
    """Reward of a step [s]: time near the middle of the lane, at little effort.

    Args:
        measurement: After the step.
        offset: From the middle of the lane that the car is in [m].
        action: That was taken, each part in [-1, 1].
    """
    return DT * (1.0 - offset**2 - 0.1 * float(action[0]) ** 2)


class SteeringEnvironment(gymnasium.Env):  # type: ignore[misc]  # of an extra: untyped
    """A trial in which an agent is the guidance or the driver.

    An episode ends (`terminated`) when the car hits something, and is cut off
    (`truncated`) at the end of the course, when its time is over or the car has stood
    for 30 s. `reset(seed=...)` makes the following episodes the same each time;
    `reset(options={"seed": 1, "participant": 3})` names the trial itself.

    Args:
        agent: "guidance": the action is a share of the motor's torque, shape `(1,)`.
            "driver": shares of 10 N·m at the wheel and of accelerator (positive) or
            brake, shape `(2,)`. Left is positive, each part lies in [-1, 1].
        setup: The trial. Of a guidance agent the driver is its driver, of a driver
            agent the guidance is its method. The intention is "off" or "scripted".
        reward: Of a step: from the measurement after it, the distance from the middle
            of the lane [m] and the action.

    Raises:
        ValueError: If there is no such agent, or the setup cannot be run.

    Example:
        >>> from costeer.environment.steering import SteeringEnvironment
        >>> environment = SteeringEnvironment("guidance")
        >>> seen, about = environment.reset(seed=1)
        >>> seen, reward, terminated, truncated, about = environment.step([0.1])
        >>> len(seen), terminated, truncated
        (15, False, False)
    """

    def __init__(
        self,
        agent: str = "guidance",
        setup: TrialSetup = USUAL,
        reward: Reward = lane_keeping,
    ) -> None:
        if agent not in AGENTS:
            raise ValueError(f"agent '{agent}' is not known; choose guidance or driver")
        if setup.intention not in ("off", "scripted"):
            raise ValueError(
                f"intention is {setup.intention}; an environment has off or scripted"
            )
        seat = {"method": GUIDANCE} if agent == "guidance" else {"driver": DRIVER}
        self._agent, self._setup = agent, setup._replace(**seat)
        if agent == "guidance" and not is_assisted(self._setup):
            raise ValueError(
                f"condition is {setup.condition}, in which nobody assists; choose "
                "another one for an agent that does"
            )
        self._reward = reward
        self._begin(self._setup)
        bounds = np.array([each.bound for each in self.signals], dtype=np.float32)
        self.observation_space = gymnasium.spaces.Box(-bounds, bounds)
        parts = 1 if agent == "guidance" else 2
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (parts,), np.float64)

    @property
    def signals(self) -> tuple[Any, ...]:
        """What each number of an observation is, in order."""
        return SIGNALS[self._agent]

    def _begin(self, setup: TrialSetup) -> None:
        """Put the car on the road."""
        self._parameters = loop_parameters(setup)
        method, driver = trial_method(setup), trial_driver_model(setup)
        self._loop = loop_rule(method, driver)
        self._state = initial_state(self._loop.rules, self._parameters)
        longest = setup.length / (SLOWEST_SHARE * setup.speed)
        self._noise = driver_noise(
            setup.seed, setup.participant, setup.condition, int(np.ceil(longest / DT))
        )
        times = np.array(sorted(setup.trigger_times), dtype=np.float64)
        intention = INTENTIONS[setup.intention]
        self._script = Script(intention, setup.prediction_horizon, times)
        added = (*method.columns, *car_columns(num_cars(self._parameters.fleet)))
        self._running, self._added, self._standing = setup, added, 0.0
        self._columns = len(with_method_columns(added))
        self._rows: list[Numbers] = []

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Seen, dict[str, Any]]:
        """Begin an episode: another driver, other noise.

        Args:
            seed: From which this and the following episodes are drawn.
            options: "seed" and "participant" of the trial, where they are not drawn.

        Raises:
            ValueError: If an option is not known or out of range.
        """
        super().reset(seed=seed)
        drawn = {name: int(self.np_random.integers(1, 10_000)) for name in _DRAWN}
        unknown = set(options or {}) - set(drawn)
        if unknown:
            raise ValueError(
                f"options are {sorted(unknown)}; give {' or '.join(_DRAWN)}"
            )
        trial = drawn | (options or {})
        self._begin(self._setup._replace(**trial))
        return self._seen(sense(self._parameters, self._state)), dict(trial)

    def _seen(self, measurement: Measurement) -> Seen:
        return observation(self._state, measurement, self.signals)

    def _given(self, action: Numbers) -> Any:  # Any: parameters of the loop
        """Parameters of the loop, in which the agent's seat has its action."""
        if self._agent == "guidance":
            torque = float(action[0]) * self._parameters.column.torque_limit
            return self._parameters._replace(controller=GivenTorque(torque))
        pedal = float(action[1])
        hands = GivenHands(
            torque=float(action[0]) * HAND_TORQUE,
            accelerator=max(pedal, 0.0),
            brake=max(-pedal, 0.0),
        )
        return self._parameters._replace(driver=hands)

    def step(self, action: Numbers) -> tuple[Seen, float, bool, bool, dict[str, Any]]:
        """Drive for one control step.

        Args:
            action: Each part in [-1, 1], shape `(1,)` or `(2,)`; beyond it is clipped.

        Returns:
            Observation, reward, whether the car has hit something, whether the course
            or its time is over, and a dictionary with `time` [s] and `mode` [-].

        Raises:
            ValueError: If the action has another shape or is not finite.
        """
        given = np.asarray(action, dtype=np.float64)
        if given.shape != self.action_space.shape or not np.isfinite(given).all():
            raise ValueError(f"action is {action}; give {self.action_space}")
        given = np.clip(given, -1.0, 1.0)
        noise = DriverNoise(*self._noise[len(self._rows)].tolist())
        self._state, sample = tick(
            self._loop.rules,
            self._given(given),
            self._state,
            self._script,
            idle_network(),
            noise,
        )
        self._keep(sample)
        measurement = sense(self._parameters, self._state)
        offset = measurement.lateral_position - lane_centre(
            self._parameters.road, measurement.lane
        )
        return (
            self._seen(measurement),
            float(self._reward(measurement, offset, given)),
            bool(has_collided(sample.events)),
            self._is_over(measurement),
            {"time": float(sample.time), "mode": float(sample.signals.target.mode)},
        )

    def _keep(self, sample: Any) -> None:  # Any: a sample of any method
        """Keep the row of a step."""
        row = np.full(self._columns, np.nan)
        self._loop.fill(row, sample)
        write_cars(row, num_cars(self._parameters.fleet), sample.events.fleet)
        self._rows.append(row)

    def _is_over(self, measurement: Measurement) -> bool:
        """Whether course or time are over, or the car stands for good."""
        self._standing = still(self._standing, measurement.longitudinal_velocity)
        arrived = measurement.longitudinal_position >= self._parameters.road.length
        late = len(self._rows) >= len(self._noise)
        return bool(arrived or late or has_stopped(self._standing))

    def record(self) -> TrialRecord:
        """The episode until now as the record of a trial, to measure or to replay.

        Raises:
            ValueError: If no step has been made.
        """
        if not self._rows:
            raise ValueError("there is no step yet; call step first")
        setup, rows = self._running, np.array(self._rows)
        columns = record_columns(
            rows, is_assisted(setup), with_method_columns(self._added)
        )
        about = trial_metadata(setup, self._parameters, None)
        about["torque_faults"] = int(np.count_nonzero(columns["torque_fault"]))
        about["outcome"] = outcome_of(rows, setup.length)
        return TrialRecord(about, columns, self._added)


_DRAWN = ("seed", "participant")
"""What an episode draws."""
