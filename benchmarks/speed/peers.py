"""Plant against plant: the same manoeuvre here and in four peers.

Peers that let the step be chosen take ours, 480 Hz; the two with a physics engine,
which is compiled, keep the step that they are made for.

Only the car is compared, with a steering angle given from outside: no driver, no
controller, no column. The peers are Python packages; most of the ratio to them is
compilation, which the same plant in plain Python shows.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.speed.timing import Effort, Figure, Outcome, Skipped, figure, seconds_of
from costeer.base import array as xp
from costeer.base.array import compiled
from costeer.base.entry import entry
from costeer.base.extras import install_command
from costeer.base.integrate import rk4
from costeer.plant.parameters import CarParameters
from costeer.plant.vehicle import VehicleInput, VehicleState, vehicle_rate

UNIT = "vehicle-s/s"
SPEED = 70.0 / 3.6
PERIOD = 5.0
"""Of the manoeuvre [s]. Compiled in: who wants to measure less changes `SECONDS`."""
SECONDS = PERIOD
PLANT_DT = 1.0 / 480.0
TICK = 1.0 / 60.0
AMPLITUDE = 0.01
"""Of one period of a sine of the road-wheel angle [rad]: a lane change."""

COMPILED = "costeer's car, compiled"
PLAIN = "costeer's car, plain Python"
_INSTALL = f"not installed; install it with: {install_command('bench')}"


@compiled
def steering(time: float) -> float:
    """Road-wheel angle of the manoeuvre [rad]."""
    return AMPLITUDE * xp.sin(2.0 * math.pi * time / PERIOD)


@compiled
def drive(car: CarParameters, num_steps: int) -> VehicleState:
    """Take our car through the manoeuvre, Runge-Kutta at the plant's step."""
    state = VehicleState(0.0, 0.0, 0.0, SPEED, 0.0, 0.0, 0.0)
    for k in range(num_steps):
        motion = VehicleInput(car, steering(k * PLANT_DT), 0.0)
        state = rk4(vehicle_rate, state, motion, PLANT_DT)
    return state


@entry
def drive_compiled(car: CarParameters, num_steps: int) -> VehicleState:
    """`drive` as machine code."""
    return drive(car, num_steps)


def measure_peers(effort: Effort) -> Outcome:
    """Vehicle-seconds per second of each plant, and the ratios to ours."""
    car = CarParameters()
    outcome: Outcome = [
        _speed(COMPILED, lambda n: drive_compiled(car, n), PLANT_DT, effort),
        _speed(PLAIN, lambda n: drive(car, n), PLANT_DT, effort),
        *_highway_env(effort),
        *_commonroad(effort),
        *_car_racing(effort),
        *_racecar(effort),
    ]
    return [*outcome, *ratios([o for o in outcome if isinstance(o, Figure)])]


def _speed(
    name: str,
    run: Callable[[int], object],
    dt: float,
    effort: Effort,
    remark: str = "",
) -> Figure:
    """Speed of a plant that `run` takes through a number of steps."""
    steps = round(SECONDS / dt)
    run(2)
    times = seconds_of(lambda: run(steps), effort.rounds)
    return figure("plant", name, UNIT, SECONDS / times, remark or f"{1 / dt:.0f} Hz")


def ratios(figures: list[Figure]) -> list[Figure]:
    """How many times faster the compiled car is than each other plant."""
    ours = next(f for f in figures if f.name == COMPILED)
    return [
        Figure(
            "plant",
            f"compiled over {other.name}",
            "x",
            ours.median / other.median,
            ours.low / other.high,
            ours.high / other.low,
            "compilation alone" if other.name == PLAIN else "",
        )
        for other in figures
        if other is not ours
    ]


def _highway_env(effort: Effort) -> Outcome:
    """highway-env's dynamic bicycle by its own `step`, without a road."""
    name = "highway-env, dynamic bicycle"
    try:
        from highway_env.vehicle.dynamics import BicycleVehicle
    except ImportError:
        return [Skipped("plant", name, _INSTALL)]

    def run(num_steps: int) -> float:
        car = BicycleVehicle(None, [0.0, 0.0], 0.0, SPEED)
        for k in range(num_steps):
            car.action = {"steering": steering(k * PLANT_DT), "acceleration": 0.0}
            car.step(PLANT_DT)
        return float(car.position[1])

    return [_speed(name, run, PLANT_DT, effort)]


def _commonroad(effort: Effort) -> Outcome:
    """CommonRoad's single track: our Runge-Kutta, and odeint anew at every tick."""
    name = "CommonRoad, single track"
    try:
        from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
        from vehiclemodels.vehicle_dynamics_st import vehicle_dynamics_st
    except ImportError:
        return [Skipped("plant", name, _INSTALL)]
    car = parameters_vehicle2()

    def rate(state: NDArray[np.float64], time: float) -> NDArray[np.float64]:
        return np.array(vehicle_dynamics_st(state, [_steering_rate(time), 0.0], car))

    return [
        _speed(f"{name}, Runge-Kutta", lambda n: _rk4_run(rate, n), PLANT_DT, effort),
        _speed(
            f"{name}, odeint",
            lambda n: _odeint_run(rate, n),
            TICK,
            effort,
            "restarted at 60 Hz, its own steps between",
        ),
    ]


def _car_racing(effort: Effort) -> Outcome:
    """The car of Gymnasium's CarRacing, five bodies of Box2D, without a track."""
    name = "Gymnasium CarRacing, car of Box2D"
    try:
        from Box2D import b2World
        from gymnasium.envs.box2d.car_dynamics import Car
    except ImportError:
        return [Skipped("plant", name, _INSTALL)]

    def run(num_steps: int) -> float:
        world = b2World((0.0, 0.0))
        car: Any = Car(world, 0.0, 0.0, 0.0)  # Any: attributes are not declared
        for body in (car.hull, *car.wheels):
            body.linearVelocity = (0.0, SPEED)
        for k in range(num_steps):
            car.steer(steering(k / _RACING_RATE))
            car.step(1.0 / _RACING_RATE)
            world.Step(1.0 / _RACING_RATE, 6 * 30, 2 * 30)
        return float(car.hull.position[0])

    return [_speed(name, run, 1.0 / _RACING_RATE, effort)]


def _racecar(effort: Effort) -> Outcome:
    """PyBullet's racecar on a plane, by its own step."""
    name = "PyBullet, racecar"
    try:
        import pybullet
        import pybullet_data
    except ImportError:
        return [Skipped("plant", name, _INSTALL)]
    world = pybullet.connect(pybullet.DIRECT)
    pybullet.setAdditionalSearchPath(pybullet_data.getDataPath())

    def run(num_steps: int) -> float:
        pybullet.resetSimulation()
        pybullet.setGravity(0.0, 0.0, -9.81)
        pybullet.loadURDF("plane.urdf")
        car = pybullet.loadURDF("racecar/racecar.urdf")
        pybullet.resetBaseVelocity(car, (SPEED, 0.0, 0.0))
        for k in range(num_steps):
            angle = steering(k / _BULLET_RATE)
            for joint in _BULLET_STEERED:
                pybullet.setJointMotorControl2(
                    car, joint, pybullet.POSITION_CONTROL, targetPosition=angle
                )
            pybullet.stepSimulation()
        return float(pybullet.getBasePositionAndOrientation(car)[0][1])

    try:
        return [_speed(name, run, 1.0 / _BULLET_RATE, effort)]
    finally:
        pybullet.disconnect(world)


_RACING_RATE, _BULLET_RATE = 50.0, 240.0
"""Steps a second that the two are made for [1/s]."""
_BULLET_STEERED = (4, 6)
"""Joints of the front wheels."""


def _steering_rate(time: float) -> float:
    """Rate of the road-wheel angle of the manoeuvre [rad/s]."""
    frequency = 2.0 * math.pi / PERIOD
    return AMPLITUDE * frequency * math.cos(frequency * time)


_COMMONROAD_START = (0.0, 0.0, 0.0, SPEED, 0.0, 0.0, 0.0)
Rate = Callable[[NDArray[np.float64], float], NDArray[np.float64]]


def _rk4_run(rate: Rate, num_steps: int) -> float:
    state, dt = np.array(_COMMONROAD_START), PLANT_DT
    for k in range(num_steps):
        time = k * dt
        k1 = rate(state, time)
        k2 = rate(state + dt / 2.0 * k1, time + dt / 2.0)
        k3 = rate(state + dt / 2.0 * k2, time + dt / 2.0)
        k4 = rate(state + dt * k3, time + dt)
        state = state + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return float(state[1])


def _odeint_run(rate: Rate, num_ticks: int) -> float:
    from scipy.integrate import odeint

    state = np.array(_COMMONROAD_START)
    for k in range(num_ticks):
        state = odeint(rate, state, [k * TICK, (k + 1) * TICK])[-1]
    return float(state[1])
