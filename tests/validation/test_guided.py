"""Driver and guidance at one wheel do not make it swing; who does is found."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.drivers.driver import DriverParameters
from costeer.drivers.population import (
    SECOND,
    USUAL,
    Population,
    participant_driver,
)
from costeer.loop.parameters import DT
from costeer.loop.rollout import rollout
from costeer.loop.tick import INTENTION_OFF, Script
from costeer.loop.trial import idle_network
from costeer.methods.ibhs import IBHS
from costeer.plant.parameters import CARS
from costeer.records.row import ROW_COLUMNS
from costeer.validation import guided
from costeer.validation.driver_loop import (
    STATES,
    linear_core,
    quiet,
    smooth,
    transition,
)
from costeer.validation.guided import (
    CONSTANT,
    MOST_SWING,
    SMALLEST_SWING,
    Guided,
    Wheel,
    guided_drivers,
    guided_parameters,
    lasts,
    least_damping,
    swinging,
    without_compensation,
)
from costeer.validation.swing import LEAST_DAMPING

SLOW = 50.0 / 3.6
FAST = 110.0 / 3.6
PLACE = ROW_COLUMNS.index("lateral_position")

Drivers = list[DriverParameters]


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


def drawn(number: int, speed: float, population: Population = USUAL) -> Drivers:
    """The first drivers of a population."""
    return [participant_driver(101, n + 1, speed, population) for n in range(number)]


def too_eager(driver: DriverParameters, gain: float, delay: float) -> DriverParameters:
    """The same who asks for so many times the angle, and sees so late [s]."""
    eyes = driver.vision
    return driver._replace(
        vision=eyes._replace(
            far_gain=gain * eyes.far_gain,
            near_gain=gain * eyes.near_gain,
            delay=delay,
        )
    )


@pytest.mark.parametrize("car", CARS)
def test_nobody_swings_with_the_guidance_at_the_highest_speed(car: str) -> None:
    assert not swinging(guided_drivers(101, drawn(4, FAST), car, FAST)).any()


def test_single_corrections_are_no_swing_however_large() -> None:
    found = guided_drivers(101, drawn(6, SLOW), "default", SLOW)
    # By its size alone every one of these wheels would be said to swing.
    assert np.all(found.driven.amplitude > MOST_SWING)
    assert not swinging(found).any()


@pytest.mark.slow
@pytest.mark.parametrize("population", [USUAL, SECOND], ids=lambda p: p.name)
@pytest.mark.parametrize(("gain", "delay"), [(4.0, 0.04), (2.0, 0.4), (1.0, 1.2)])
def test_too_much_gain_or_delay_is_found_in_every_look(
    population: Population, gain: float, delay: float
) -> None:
    usual = drawn(2, SLOW, population)
    eager = [too_eager(driver, gain, delay) for driver in usual]
    found = guided_drivers(101, eager, "default", SLOW)
    assert np.all(found.damping_ratio < 0.0)
    assert lasts(found.free, SMALLEST_SWING).all()
    assert lasts(found.driven, MOST_SWING).all()


@pytest.mark.parametrize("population", [USUAL, SECOND], ids=lambda p: p.name)
def test_a_swing_that_only_just_decays_is_found_in_the_drive(
    population: Population,
) -> None:
    usual = drawn(2, SLOW, population)
    eager = [too_eager(driver, 3.0, 0.04) for driver in usual]
    found = guided_drivers(101, eager, "default", SLOW)
    # Without noise it comes to rest; noise keeps it alive at its own period.
    assert np.all((found.damping_ratio > 0.0) & (found.damping_ratio < LEAST_DAMPING))
    assert lasts(found.driven, MOST_SWING).all()


def test_what_falls_into_line_by_chance_is_driven_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    driver = guided_parameters("default", SLOW)
    lengths: list[int] = []
    shares = iter([0.6, 0.2, 0.6, 0.6, 0.2])

    def told(_: object, noise: NDArray[np.float64]) -> Wheel:
        lengths.append(len(noise))
        return Wheel(2.0 * MOST_SWING, next(shares))

    monkeypatch.setattr(guided, "wheel", told)
    found = [guided.driven_wheel(driver, 101, 1).kept for _ in range(3)]
    assert found == [0.2, 0.6, 0.2]
    assert [round(n * DT) for n in lengths] == [120, 300, 120, 300, 120]


def test_each_look_alone_makes_a_driver_swing() -> None:
    still = Wheel(np.zeros(1), np.zeros(1))
    ones = np.ones(1)
    calm = Guided("default", SLOW, ones, ones, still, still, ones, ones)
    assert not swinging(calm).any()
    wide = Wheel(2.0 * MOST_SWING * ones, 0.4 * ones)
    assert not swinging(calm._replace(free=wide, driven=wide)).any()
    repeats = Wheel(2.0 * MOST_SWING * ones, 0.6 * ones)
    assert swinging(calm._replace(damping_ratio=0.05 * ones)).all()
    assert swinging(calm._replace(free=repeats)).all()
    assert swinging(calm._replace(driven=repeats)).all()
    assert swinging(calm._replace(driven=Wheel(np.inf * ones, ones))).all()


def test_with_a_constant_gain_the_large_car_would_swing() -> None:
    ratio, _ = least_damping(drawn(8, FAST), "large", FAST, CONSTANT)
    assert (ratio < LEAST_DAMPING).all()
    assert ratio.min() < 0.0
