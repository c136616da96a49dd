"""Setups: what is refused, by name and range, and what follows from one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from costeer.base.packing import packed
from costeer.loop.scenario import (
    PILOT_SEED,
    TrialSetup,
    check_setup,
    check_study_seed,
    is_assisted,
    loop_parameters,
    trial_driver,
)
from costeer.loop.trial import simulate_trial
from costeer.plant.fleet import KINDS, CarKind, FleetParameters
from costeer.plant.parameters import CARS
from costeer.scenarios.definition import Actor, Bent, Order, Road, Scenario, When

STRONG = TrialSetup(condition="strong-normal")
OWN = {"condition": "own", "strength_factor": 0.7}

REFUSED = {
    "strength_factor is 1.5; give a number from 0 to 1": OWN | {"strength_factor": 1.5},
    "condition strong-normal has strength_factor 1, not 0.4; leave": {
        "strength_factor": 0.4
    },
    "condition strong-normal has change_duration 6, not 4; leave": {
        "change_duration": 4.0
    },
    "unknown condition 'strong-nomal' (did you mean strong-normal?); choose": {
        "condition": "strong-nomal"
    },
    "unknown condition 'weak-normel' (did you mean weak-normal?); choose": OWN
    | {"condition": "weak-normel"},
    "unknown condition 'own'; choose from manual": {"condition": "own"},
    "length is 50.0; give a number from 100.0 to 200000.0 m": {"length": 50.0},
    "speed is 80 m/s (288 km/h); give a number from 12 to 31 m/s": {"speed": 80.0},
    "speed is nan m/s (nan km/h); give a number from 12 to 31 m/s": {"speed": math.nan},
    "initial_offset is -2.0; give a number": {"initial_offset": -2.0},
    "prediction_horizon is 0.0; give": {"prediction_horizon": 0.0},
    "participant is -1; give a number from 1": {"participant": -1},
    "seed is -5; give a number from 0": {"seed": -5},
    "plant_steps is 2; give a number from 4 to 64": {"plant_steps": 2},
    "abandoned_share is 1.5; give a number from 0.0 to 1.0": {"abandoned_share": 1.5},
    "abandoned_share is nan; give a number": {"abandoned_share": math.nan},
    "wander_factor is -1; give a number from 0.0 to 5.0": {"wander_factor": -1},
    "wander_factor is 5.1; give a number": {"wander_factor": 5.1},
    "change_duration is 60; give a number from 1 to 30 s": OWN
    | {"change_duration": 60.0},
    "trigger time -3.0 is not possible; give seconds": {"trigger_times": (-3.0,)},
    "trigger time nan is not possible": {"trigger_times": (math.nan,)},
    "car 'lorry' is not known; choose one of default, compact": {"car": "lorry"},
    "driver 'robot' is not known; choose one of virtual": {"driver": "robot"},
    "intention 'oracle' is not known; choose one of off": {"intention": "oracle"},
    "method 'magic' is not known; choose one of ibhs": {"method": "magic"},
}


@pytest.mark.parametrize("message", REFUSED)
def test_a_setup_that_cannot_be_run_is_refused_by_name(message: str) -> None:
    with pytest.raises(ValueError, match=r"give|choose") as error:
        check_setup(STRONG._replace(**REFUSED[message]))
    assert str(error.value).startswith(message)


def test_a_condition_says_strength_and_duration_by_its_name() -> None:
    controller = loop_parameters(STRONG).controller
    assert controller.actuation.strength_factor == 1.0
    assert controller.trajectory.change_duration == 6.0
    same = STRONG._replace(strength_factor=1.0, change_duration=6.0)
    np.testing.assert_array_equal(
        packed(loop_parameters(same)), packed(loop_parameters(STRONG))
    )


def test_a_condition_of_ones_own_says_them_itself() -> None:
    own = STRONG._replace(**OWN)
    controller = loop_parameters(own).controller
    assert controller.actuation.strength_factor == 0.7
    assert controller.trajectory.change_duration == 6.0  # the method's own
    gentle = loop_parameters(own._replace(change_duration=8.0)).controller
    assert gentle.trajectory.change_duration == 8.0


def test_the_pilot_drivers_are_no_participants() -> None:
    check_study_seed(1)
    with pytest.raises(ValueError, match="pilot drivers"):
        check_study_seed(PILOT_SEED)


def test_a_trial_is_assisted_if_method_and_strength_give_torque() -> None:
    assert is_assisted(STRONG)
    assert not is_assisted(STRONG._replace(**OWN | {"strength_factor": 0.0}))
    assert not is_assisted(TrialSetup())
    assert not is_assisted(STRONG._replace(method="manual"))
    manual = loop_parameters(STRONG._replace(method="manual"))
    assert manual.controller.actuation.strength_factor == 0.0


@pytest.mark.parametrize("name", CARS)
def test_the_controller_knows_the_car_that_is_driven(name: str) -> None:
    parameters = loop_parameters(STRONG._replace(car=name))
    gain = parameters.controller.guidance.slip_angle_gain
    assert parameters.car == parameters.controller.car == CARS[name]
    assert gain == pytest.approx(0.45 * CARS[name].aligning_stiffness)


def test_a_setup_reaches_road_start_and_plant() -> None:
    parameters = loop_parameters(
        STRONG._replace(length=500.0, initial_offset=0.5, events=False, plant_steps=16)
    )
    assert parameters.road.length == parameters.controller.road.length == 500.0
    assert parameters.start.lateral_offset == 0.5
    assert parameters.start.events == 0.0
    assert parameters.plant_steps == 16


def test_the_driver_follows_from_seed_and_participant_alone() -> None:
    other = STRONG._replace(condition="weak-gentle", car="large")
    assert trial_driver(STRONG) == trial_driver(other)
    assert trial_driver(STRONG) != trial_driver(STRONG._replace(participant=2))
    assert trial_driver(STRONG._replace(driver="hands-off")).arm.hands_on == 0.0


@pytest.mark.parametrize("factor", [0.0, 1.0, 1.5, 2.0])
def test_the_factor_scales_the_wander_and_nothing_else(factor: float) -> None:
    drawn = trial_driver(STRONG)
    wanders = trial_driver(STRONG._replace(wander_factor=factor))
    own = drawn.tracking.wander_deviation
    assert wanders.tracking.wander_deviation == pytest.approx(factor * own)
    assert own > 0.0
    tracking = wanders.tracking._replace(wander_deviation=own)
    assert wanders._replace(tracking=tracking) == drawn


def test_the_share_of_given_up_lane_changes_reaches_the_decision_alone() -> None:
    drawn = trial_driver(STRONG)
    fickle = trial_driver(STRONG._replace(abandoned_share=0.3))
    assert fickle.decision.abandoned_share == 0.3
    assert drawn.decision.abandoned_share == 0.0
    faithful = fickle.decision._replace(abandoned_share=0.0)
    assert fickle._replace(decision=faithful) == drawn


CURVED = Scenario(
    "bends",
    speed="50 km/h",
    road=Road(length=900.0, stations=(Bent(0.0, 120.0),)),
)


def test_a_speed_too_fast_for_the_curves_is_refused_in_python_too() -> None:
    with pytest.raises(ValueError, match=r"curve of 120 m at 0 m is too tight") as told:
        simulate_trial(TrialSetup(scenario=CURVED, speed=22.0))
    assert "scenario bends" in str(told.value)
    assert "smaller speed" in str(told.value)
    assert loop_parameters(TrialSetup(scenario=CURVED, speed=15.0)).start.speed == 15.0


def kinds_of(fleet: FleetParameters) -> list[CarKind]:
    places = range(int(fleet.num_places))
    return [KINDS.read(fleet.kinds, place) for place in places]


OBSTACLE = Scenario(
    "beside",
    road=Road(length=300.0),
    actors=(Actor("box", "obstacle", 0, 1.3, appears=When(place=150.0), headway=0.6),),
)
"""Its left side is 1.325 m to the right of the left lane's centre."""


@pytest.mark.parametrize(("width", "hits"), [(1.8, False), (2.9, True)])
def test_others_meet_the_car_at_the_size_that_is_set(width: float, hits: bool) -> None:
    setup = TrialSetup(
        driver="hands-off",
        condition="manual",
        intention="off",
        length=300.0,
        events=False,
        scenario=OBSTACLE,
        parameters=(("car.width", width), ("car.length", 6.0)),
    )
    ego = kinds_of(loop_parameters(setup).fleet)[0]
    assert (ego.length, ego.width) == (6.0, width)
    record = simulate_trial(setup)
    assert record.metadata["outcome"] == ("collision" if hits else "arrived")


def test_others_drive_in_the_lanes_that_are_set() -> None:
    setup = TrialSetup(scenario=OBSTACLE, parameters=(("road.lane_width", 4.0),))
    assert kinds_of(loop_parameters(setup).fleet)[1].lateral == pytest.approx(-2.7)


def test_a_lane_that_an_actor_needs_cannot_be_set_away() -> None:
    order = Order(When(time=3.0), lane=2)
    three = Scenario(
        "three", road=Road(lanes=3), actors=(Actor("a", at=50.0, orders=(order,)),)
    )
    setup = TrialSetup(scenario=three, parameters=(("road.num_lanes", 2.0),))
    with pytest.raises(ValueError, match=r"road.num_lanes is 2; a of scenario three"):
        loop_parameters(setup)


def test_a_record_says_what_the_other_cars_are() -> None:
    cars = simulate_trial(
        TrialSetup(condition="manual", intention="off", length=300.0, scenario=OBSTACLE)
    ).metadata["other_cars"]
    assert cars == [{"kind": "obstacle", "length": 1.0, "width": 1.75}]
