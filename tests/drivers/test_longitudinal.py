"""Speed: the preferred one on a free road, the leader's behind a leader."""

from __future__ import annotations

import pytest

from costeer.drivers import decision, longitudinal
from costeer.drivers.decision import (
    CHANGING,
    CRUISING,
    PASSING,
    PREPARING,
    PREPARING_RETURN,
    RETURNING,
    DecisionState,
)
from costeer.drivers.longitudinal import LongitudinalParameters
from costeer.plant.parameters import CarParameters
from costeer.plant.vehicle import drive_command, resistance
from tests.drivers.samples import DT, NO_LEADER, SPEED, driving, leader

PARAMETERS = LongitudinalParameters()


def in_phase(phase: float) -> DecisionState:
    return decision.initial_state()._replace(phase=phase)


def drive(
    speed: float, phase: float, leader_speed: float | None, seconds: float
) -> tuple[float, float]:
    """Speed [m/s] and gap [m] after a while, 60 m behind a leader if there is one."""
    state, position, ahead = longitudinal.initial_state(), 0.0, 60.0
    for _ in range(round(seconds / DT)):
        other = NO_LEADER if leader_speed is None else leader(ahead, leader_speed)
        car = driving(position, speed=speed)
        state = longitudinal.step(
            PARAMETERS, state, car, (other, NO_LEADER), in_phase(phase), 0.0, DT
        )
        speed += state.wanted_acceleration * DT
        position += speed * DT
        ahead += (leader_speed or 0.0) * DT
    return speed, ahead - position


def test_a_driver_settles_at_the_preferred_speed() -> None:
    # Linearised, the model closes in with 4 · 1.2 / 19.4 per second: e^-10 in 40 s.
    for start in (0.8 * SPEED, 1.1 * SPEED):
        assert drive(start, CRUISING, None, 60.0)[0] == pytest.approx(SPEED, abs=0.01)


def test_a_driver_behind_a_leader_takes_its_speed_and_keeps_a_gap() -> None:
    speed, gap = drive(SPEED, CRUISING, SPEED - 3.0, 120.0)
    assert speed == pytest.approx(SPEED - 3.0, abs=0.05)
    wanted = PARAMETERS.standstill_gap + speed * PARAMETERS.headway
    assert wanted <= gap < 2.0 * wanted


def test_a_driver_behind_a_stopped_car_stops_without_touching_it() -> None:
    speed, gap = drive(SPEED, CRUISING, 0.0, 60.0)
    assert abs(speed) < 0.3
    assert gap > 4.5


def test_overtaking_is_faster_by_the_drivers_own_amount() -> None:
    speed, _ = drive(SPEED, PASSING, None, 60.0)
    assert speed == pytest.approx(SPEED + PARAMETERS.overtaking_speed, abs=0.01)


@pytest.mark.parametrize("phase", [PREPARING, CHANGING, PASSING])
def test_a_driver_is_faster_from_the_decision_until_the_return(phase: float) -> None:
    rest = longitudinal.initial_state()
    more = PARAMETERS.overtaking_speed
    assert longitudinal.wanted_speed(PARAMETERS, rest, phase) == SPEED + more
    assert more > 0.0


@pytest.mark.parametrize("phase", [CRUISING, PREPARING_RETURN, RETURNING])
def test_a_driver_is_not_faster_otherwise(phase: float) -> None:
    rest = longitudinal.initial_state()
    assert longitudinal.wanted_speed(PARAMETERS, rest, phase) == SPEED


def test_a_driver_about_to_overtake_comes_closer() -> None:
    car, ahead = driving(), leader(30.0, SPEED - 3.0)
    follow = longitudinal.interaction(PARAMETERS, car, ahead, CRUISING)
    for phase in (PREPARING, CHANGING):
        overtake = longitudinal.interaction(PARAMETERS, car, ahead, phase)
        assert 0.0 < overtake < follow


def test_a_leader_beside_or_behind_is_not_followed() -> None:
    for other in (leader(30.0, 10.0, lane=0.0), leader(-5.0, 10.0), NO_LEADER):
        assert longitudinal.interaction(PARAMETERS, driving(), other, CRUISING) == 0.0


@pytest.mark.parametrize("wanted", [-4.0, -0.05, 0.0, 1.0])
def test_pedals_give_the_acceleration_that_is_wanted(wanted: float) -> None:
    car = CarParameters()
    pressed = longitudinal.pedals(car, wanted, SPEED)
    given = drive_command(car, pressed.accelerator, pressed.brake)
    assert given - resistance(car, SPEED) == pytest.approx(wanted, abs=1e-12)
    assert min(pressed.accelerator, pressed.brake) == 0.0


def test_pedals_stay_within_their_travel() -> None:
    car = CarParameters()
    assert longitudinal.pedals(car, 50.0, SPEED).accelerator == 1.0
    assert longitudinal.pedals(car, -50.0, SPEED).brake == 1.0
