"""An agent of Gymnasium in the seat of the guidance or of the driver."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import costeer
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.methods import lane_keeping
from costeer.plant.parameters import ColumnParameters
from costeer.records.columns import Column, TrialRecord

pytest.importorskip("gymnasium", reason="the extra gym is not installed")

from gymnasium.utils.env_checker import check_env

from costeer.environment.steering import HAND_TORQUE, SteeringEnvironment

SETUP = TrialSetup(
    condition="strong-normal", intention="off", length=100.0, seed=5, participant=2
)
TRIAL = {"seed": 5, "participant": 2}
STEPS = 200


def driven(environment: SteeringEnvironment, actions: Any) -> TrialRecord:
    """The record of an episode on the trial of these tests."""
    environment.reset(seed=1, options=TRIAL)
    for action in actions:
        environment.step(action)
    return environment.record()


@pytest.mark.parametrize("agent", ["guidance", "driver"])
def test_gymnasium_finds_nothing_wrong(agent: str) -> None:
    check_env(SteeringEnvironment(agent, SETUP), skip_render_check=True)


@pytest.mark.parametrize("agent", ["guidance", "driver"])
def test_a_seed_makes_the_same_episodes_and_another_seed_others(agent: str) -> None:
    def seen(seed: int) -> list[Any]:
        environment = SteeringEnvironment(agent, SETUP)
        environment.action_space.seed(seed)
        found = []
        for given in (seed, None):  # the second episode follows from the first
            found.append(environment.reset(seed=given)[1])
            actions = [environment.action_space.sample() for _ in range(20)]
            found.extend(environment.step(each)[0].tolist() for each in actions)
        return found

    assert seen(3) == seen(3)
    assert seen(3) != seen(4)
    first, second = seen(3)[0], seen(3)[21]
    assert first != second


def test_the_torques_of_a_method_drive_the_car_as_the_method_does() -> None:
    # The column applied_torque is behind the motor's lag; this one is before it.
    asked = Column("method_asked", "N·m", "float64", "asked", "signals.applied_torque")
    method = lane_keeping.METHOD._replace(name="asking", columns=(asked,))
    setup = SETUP._replace(method=method, initial_offset=0.5)
    wanted = simulate_trial(setup, "python").columns
    shares = wanted["method_asked"][:STEPS] / ColumnParameters().torque_limit
    found = driven(SteeringEnvironment("guidance", setup), shares[:, None]).columns
    assert np.abs(shares).max() > 0.05
    for name in ("lateral_position", "driver_torque", "steering_wheel_angle"):
        # A share and back is off by a rounding, which 3 s of driving carry on.
        np.testing.assert_allclose(found[name], wanted[name][:STEPS], atol=1e-9)


def test_the_hands_of_a_record_drive_the_car_as_replayed_hands_do() -> None:
    hands = costeer.replayed_hands(simulate_trial(SETUP, "python"))
    wanted = simulate_trial(SETUP._replace(driver=hands), "python").columns
    torque = wanted["driver_torque"][1 : STEPS + 1] / HAND_TORQUE
    pedals = (wanted["accelerator"] - wanted["brake"])[:STEPS]
    found = driven(
        SteeringEnvironment("driver", SETUP), np.stack([torque, pedals], axis=1)
    ).columns
    for name in ("lateral_position", "longitudinal_velocity", "applied_torque"):
        np.testing.assert_allclose(found[name], wanted[name][:STEPS], atol=1e-9)


def test_left_is_positive() -> None:
    for agent, parts in (("guidance", 1), ("driver", 2)):
        environment = SteeringEnvironment(agent, SETUP)
        action = np.zeros(parts)
        action[0] = 0.2
        before, _ = environment.reset(options=TRIAL)
        for _ in range(30):
            after, *_ = environment.step(action)
        place = [each.name for each in environment.signals].index("yaw_angle")
        assert after[place] > before[place]


def test_a_crash_ends_the_episode_and_the_end_of_the_road_cuts_it_off() -> None:
    crashing = SteeringEnvironment("driver", SETUP._replace(length=1000.0))
    crashing.reset(options=TRIAL)
    ends = [crashing.step(np.array([0.5, 0.0]))[2:4] for _ in range(200)]
    assert (True, False) in ends
    arriving = SteeringEnvironment("guidance", SETUP)
    arriving.reset(options=TRIAL)
    # 100 m at about 19.4 m/s are 5.1 s or 310 steps.
    ended = [arriving.step(np.zeros(1))[2:4] for _ in range(320)]
    assert 290 < ended.index((False, True)) < 320
    assert arriving.record().metadata["outcome"] == "arrived"


def test_an_episode_can_be_measured_like_any_trial() -> None:
    record = driven(SteeringEnvironment("guidance", SETUP), np.zeros((STEPS, 1)))
    assert record.metadata["method"] == "agent"
    assert costeer.measures(record).value["sdlp"] > 0.0


def test_a_driver_sees_the_car_ahead_and_guidance_does_not() -> None:
    names = {
        agent: [each.name for each in SteeringEnvironment(agent, SETUP).signals]
        for agent in ("guidance", "driver")
    }
    assert set(names["driver"]) - set(names["guidance"]) == {
        "guidance_torque",
        "lead_distance",
        "lead_velocity",
    }
    environment = SteeringEnvironment("driver", SETUP._replace(events=False))
    seen, _ = environment.reset(options=TRIAL)
    assert seen[names["driver"].index("lead_distance")] == 200.0  # nobody is ahead


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(ValueError, match="agent 'car' is not known"):
        SteeringEnvironment("car")
    with pytest.raises(ValueError, match="in which nobody assists"):
        SteeringEnvironment("guidance", SETUP._replace(condition="manual"))
    with pytest.raises(ValueError, match="has off or scripted"):
        SteeringEnvironment("driver", SETUP._replace(intention="network"))
    environment = SteeringEnvironment("guidance", SETUP)
    with pytest.raises(ValueError, match="no step yet"):
        environment.record()
    with pytest.raises(ValueError, match=r"options are \['driver'\]"):
        environment.reset(options={"driver": 3})
    for wrong in (np.zeros(2), np.array([np.nan])):
        with pytest.raises(ValueError, match="action is"):
            environment.step(wrong)
