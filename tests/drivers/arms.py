"""Arms on a wheel that is held at an angle, for tests of their parts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from costeer.drivers import arm
from costeer.drivers.arm import ArmCommand, ArmParameters, muscle_torque

PLANT_DT = 1.0 / 480.0
PARAMETERS = ArmParameters()
RELAXED = ArmCommand(
    intended_angle=0.0,
    holding_stiffness=3.0,
    stiffening=1.0,
    guidance=0.0,
    reliance=0.0,
)
TENSE = RELAXED._replace(stiffening=2.2)


def torques(
    command: ArmCommand,
    angle: float,
    seconds: float,
    parameters: ArmParameters = PARAMETERS,
) -> NDArray[np.float64]:
    """Muscle torque at each plant step on a wheel that is held at an angle [N·m]."""
    state, answers = arm.initial_state(), []
    for _ in range(round(seconds / PLANT_DT)):
        state = arm.step(parameters, state, command, angle, PLANT_DT)
        answers.append(muscle_torque(parameters, state, command, angle))
    return np.array(answers)


def settled_torque(
    command: ArmCommand, angle: float, parameters: ArmParameters = PARAMETERS
) -> float:
    """Torque on a wheel that is held still for 4 s: exp(-40) of the lag is left."""
    return float(torques(command, angle, 4.0, parameters)[-1])
