"""What determines a study is in its hash, and wrong settings are refused."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from costeer.intention.gru import random_weights
from costeer.intention.weights import intention_network, save_weights
from costeer.loop.scenario import trial_condition, trial_method
from costeer.study.configuration import (
    PUBLISHED_STUDY,
    StudySettings,
    check_settings,
    settings_of,
    study_configuration,
    trial_setup,
)
from costeer.study.design import Trial
from costeer.study.folder import configuration_hash, opened_study, read_study

SCRIPTED = StudySettings(intention="scripted")


def settings_with(**changes: Any) -> StudySettings:  # Any: values that are wrong too
    return StudySettings(**{**SCRIPTED._asdict(), **changes})


def hash_of(settings: StudySettings) -> str:
    return configuration_hash(study_configuration(check_settings(settings)))


@pytest.mark.parametrize(
    "changes",
    [
        {"participants": 6},
        {"conditions": ("manual", "weak-normal")},
        {"seed": 2},
        {"method": "manual"},
        {"length": 4000.0},
        {"speed": 20.0},
        {"car": "large"},
    ],
)
def test_every_setting_changes_the_hash(changes: dict[str, Any]) -> None:
    assert hash_of(settings_with(**changes)) != hash_of(SCRIPTED)


def test_the_order_in_which_conditions_are_listed_does_not_change_the_hash() -> None:
    turned = settings_with(conditions=SCRIPTED.conditions[::-1])
    assert hash_of(turned) == hash_of(SCRIPTED)


def test_an_edit_of_the_simulation_changes_the_hash(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = hash_of(SCRIPTED)
    monkeypatch.setattr(
        "costeer.study.configuration.simulation_source", lambda: "edited"
    )
    assert hash_of(SCRIPTED) != before


def test_a_threshold_changes_the_hash(monkeypatch: pytest.MonkeyPatch) -> None:
    before = hash_of(SCRIPTED)
    monkeypatch.setattr(
        "costeer.study.configuration._thresholds", lambda: {"replan_gain": 0.1}
    )
    assert hash_of(SCRIPTED) != before


def test_other_weights_change_the_hash(tmp_path: Path) -> None:
    file = tmp_path / "own.npz"
    hashes = set()
    for seed in (1, 2):
        save_weights(file, intention_network(random_weights(4, seed), {}))
        own = tmp_path / f"{seed}.npz"
        own.write_bytes(file.read_bytes())
        about = study_configuration(PUBLISHED_STUDY._replace(weights=str(own)))
        hashes.add(about["intention_model_hash"])
    assert len(hashes) == 2


def test_settings_come_back_from_their_configuration() -> None:
    assert settings_of(study_configuration(SCRIPTED)) == SCRIPTED


def test_a_configuration_without_a_seed_is_refused() -> None:
    configuration = study_configuration(SCRIPTED)
    del configuration["seed"]
    with pytest.raises(ValueError, match="lacks seed"):
        settings_of(configuration)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"participants": 0}, "participants is 0; give a whole number 1 to 100000"),
        ({"participants": True}, "participants must be a whole number, not True"),
        ({"participants": 1.5}, "participants must be a whole number, not 1.5"),
        ({"seed": -1}, "seed is -1; give a whole number 0 to"),
        ({"method": "magic"}, "method 'magic' is not known"),
        ({"intention": "off"}, "intention 'off' is not known; choose one of network"),
        ({"car": "lorry"}, "car 'lorry' is not known"),
        ({"length": math.inf}, "length is inf"),
        ({"length": -8000.0}, "length is -8000"),
        ({"speed": math.nan}, "speed is nan"),
        ({"speed": 70.0}, "speed is 70"),
        ({"conditions": ("manual", "manual")}, "given twice"),
        ({"conditions": ()}, "no condition given"),
    ],
)
def test_a_wrong_setting_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        check_settings(settings_with(**changes))


def test_manual_trials_know_no_other_method() -> None:
    setup = trial_setup(SCRIPTED, Trial(3, "manual", 1))
    assert trial_method(setup).name == "manual"
    assert trial_condition(setup).strength_factor == 0.0


def test_an_assisted_trial_takes_strength_and_duration_from_its_condition() -> None:
    setup = trial_setup(SCRIPTED, Trial(3, "weak-rapid", 4))
    assert (setup.participant, setup.condition) == (3, "weak-rapid")
    assert trial_method(setup).name == "ibhs"
    assert trial_condition(setup)[-2:] == (0.4, 4.0)


def test_a_file_that_was_written_anew_is_read_anew(tmp_path: Path) -> None:
    car, driver = tmp_path / "car.yaml", tmp_path / "driver.yaml"
    settings = settings_with(car=str(car), drivers=(str(driver),))
    found = []
    for mass, stiffness in ((1500, 11.0), (1720, 12.0)):
        car.write_text(f"mass: {mass}")
        driver.write_text(f"arm.stiffness: {stiffness}")
        setup = trial_setup(settings, Trial(1, "manual", 1))
        found.append((setup.car.mass, setup.driver.arm.stiffness))  # type: ignore[union-attr]  # both are of a file
    assert found == [(1500.0, 11.0), (1720.0, 12.0)]


def test_the_same_numbers_of_another_kind_are_the_same_study() -> None:
    gain = "guidance.lateral_error_gain"
    whole = settings_with(length=4000, parameters=((gain, 2),))
    of_numpy = settings_with(
        length=np.float64(4000), parameters=((gain, np.float32(2)),), seed=np.int64(1)
    )
    exact = settings_with(length=4000.0, parameters=((gain, 2.0),))
    assert hash_of(whole) == hash_of(of_numpy) == hash_of(exact)


def test_a_predictor_that_nobody_asks_is_refused() -> None:
    with pytest.raises(ValueError, match="intention 'scripted' asks no predictor"):
        study_configuration(settings_with(predictor="line-time"))


def test_a_study_on_the_published_road_says_nothing_of_it() -> None:
    # As before there were others: its settings have the hash that they had.
    told = study_configuration(PUBLISHED_STUDY)
    assert not {"scenario", "scenario_content"} & set(told)
    other = study_configuration(PUBLISHED_STUDY._replace(scenario="cut-in"))
    assert other["scenario"] == "cut-in"
    assert settings_of(other).scenario.road.length == 3000.0  # type: ignore[union-attr]


TWO_POINT = str(Path(__file__).parents[2] / "examples" / "drivers" / "two_point.py")


@pytest.mark.parametrize("driver", ["virtual-2", "hands-off", TWO_POINT])
def test_a_study_of_any_driver_can_be_read_again(tmp_path: Path, driver: str) -> None:
    settings = settings_with(drivers=(driver,))
    with opened_study(tmp_path, study_configuration(settings), "costeer study"):
        pass
    configuration = read_study(tmp_path).configuration
    assert settings_of(configuration) == settings
    (told,) = configuration["driver_parameters"]
    assert {"name", "version"} <= told.keys()
