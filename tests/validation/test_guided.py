"""Driver and guidance at one wheel do not make it swing."""

from __future__ import annotations

import numpy as np
import pytest

from costeer.drivers.population import participant_driver
from costeer.loop.parameters import DT
from costeer.loop.rollout import rollout
from costeer.loop.tick import INTENTION_OFF, Script
from costeer.loop.trial import idle_network
from costeer.methods.ibhs import IBHS
from costeer.plant.parameters import CARS
from costeer.records.row import ROW_COLUMNS
from costeer.validation.driver_loop import (
    STATES,
    linear_core,
    quiet,
    smooth,
    transition,
)
from costeer.validation.guided import (
    CONSTANT,
    guided_drivers,
    guided_parameters,
    swinging,
    without_compensation,
)

FAST = 110.0 / 3.6
PLACE = ROW_COLUMNS.index("lateral_position")


@pytest.mark.parametrize("speed", [50.0 / 3.6, 70.0 / 3.6, FAST])
@pytest.mark.parametrize("car", CARS)
def test_the_linear_loop_goes_the_way_of_the_simulation(car: str, speed: float) -> None:
    drawn = participant_driver(101, 3, speed)
    driver = linear_core(drawn)._replace(
        longitudinal=drawn.longitudinal._replace(preferred_speed=speed),
        tracking=drawn.tracking._replace(lane_bias=0.0),
    )
    parameters = smooth(without_compensation(guided_parameters(car, speed)))
    (matrix,) = transition(parameters, [driver], 1.0)
    start = parameters.start._replace(lateral_offset=0.01)
    given = parameters._replace(driver=driver, start=start)
    script = Script(INTENTION_OFF, 3.0, np.empty(0))
    rows = rollout(IBHS, given, script, idle_network(), quiet(round(10.0 / DT)))
    x, linear = np.eye(len(STATES))[0] * 0.01, []
    for _ in range(600):
        linear.append(x[0])
        x = matrix @ x
    # The rate limit of 30 N·m/s lets 1 cm through: 0.015 N·m.
    assert rows[:, PLACE] == pytest.approx(np.array(linear), abs=1e-5)


@pytest.mark.parametrize("car", CARS)
def test_nobody_swings_with_the_guidance_at_the_highest_speed(car: str) -> None:
    assert not swinging(guided_drivers(101, 8, car, FAST)).any()


def test_with_a_constant_gain_the_large_car_would_swing() -> None:
    found = guided_drivers(101, 8, "large", FAST, CONSTANT)
    assert swinging(found).all()
    assert found.damping_ratio.min() < 0.0
