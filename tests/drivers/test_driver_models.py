"""Drivers of another law: they hold the wheel, and the record says who did."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import costeer
from costeer.base.array import compiled
from costeer.drivers.arm import ArmCommand, ArmParameters
from costeer.drivers.interface import Action, Draw, DriverModel
from costeer.drivers.longitudinal import Pedals
from costeer.drivers.registry import driver_named
from costeer.drivers.replayed import replayed_hands
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.records.record import TrialRecord

EXAMPLE = Path(__file__).parents[2] / "examples/drivers/two_point.py"
ALONE = TrialSetup(
    condition="manual", intention="off", events=False, length=150.0, seed=3
)


class Push(NamedTuple):
    """Torque of the hands [N·m]."""

    torque: float = 0.5
    arm: ArmParameters = ArmParameters(stiffness=0.0, holding_gain=0.0, inertia=0.0)


class Count(NamedTuple):
    """Steps [-]."""

    steps: float = 0.0


@compiled
def begin(parameters: Push, lane_centre: float) -> Count:
    return Count()


@compiled
def push(
    parameters: Push, state: Count, known: Any, seen: Any, noise: Any, dt: float
) -> tuple[Count, Action]:
    action = Action(
        arm=ArmCommand(torque=parameters.torque), pedals=Pedals(0.1, 0.0), head_yaw=0.25
    )
    return Count(state.steps + 1.0), action


@cache
def hundred_metres() -> TrialRecord:
    """A short drive of costeer's own driver."""
    return simulate_trial(ALONE._replace(length=100.0), "python")


def model(**changed: Any) -> DriverModel[Any, Any]:
    """A driver who pushes."""
    usual = DriverModel("push", "7", "this test", lambda draw: Push(), begin, push)
    return usual._replace(**changed)


def test_the_law_holds_the_wheel_and_the_record_says_so() -> None:
    record = simulate_trial(ALONE._replace(driver=model()), "python")
    torque = record.columns["driver_torque"]
    damping = ArmParameters().damping * record.columns["steering_wheel_rate"]
    np.testing.assert_allclose(torque[1:200], 0.5 - damping[1:200], atol=0.02)
    assert record.columns["steering_wheel_angle"][200] > 0.01
    assert record.metadata["driver"] == "push 7"
    assert record.metadata["driver_kind"] == "virtual"
    assert np.median(record.columns["head_yaw"]) == pytest.approx(0.25, abs=0.02)


def test_each_participant_has_parameters_drawn_for_it() -> None:
    drawn: list[Draw] = []

    def parameters(draw: Draw) -> Push:
        drawn.append(draw)
        return Push(torque=0.4 * draw.participant)

    several = model(parameters=parameters)
    turned = [
        simulate_trial(
            ALONE._replace(driver=several, participant=who, length=100.0), "python"
        ).columns["steering_wheel_angle"][-1]
        for who in (1, 3)
    ]
    assert turned[1] > 2.0 * turned[0] > 0.0
    assert drawn[-1] == Draw(3, 3, ALONE.speed)


def test_parameters_of_the_driver_are_set_by_name() -> None:
    still = ALONE._replace(driver=model(), parameters=(("driver.torque", 0.0),))
    assert not simulate_trial(still, "python").columns["steering_wheel_angle"].any()


def test_the_example_brings_the_car_back_and_mirrors() -> None:
    def driven(offset: float) -> Any:
        setup = ALONE._replace(driver=str(EXAMPLE), initial_offset=offset)
        return simulate_trial(setup, "python").columns["lateral_position"]

    left, right = driven(0.5), driven(-0.5)
    np.testing.assert_allclose(left, -right, atol=1e-12)
    assert np.abs(left[-120:]).max() < 0.15


@pytest.mark.slow
def test_replayed_hands_repeat_the_drive_they_were_taken_from() -> None:
    """Torque, not position, is replayed: the car drifts where the world differs."""
    short = ALONE._replace(length=110.0, initial_offset=0.4)
    first = simulate_trial(short, "python")
    again = short._replace(driver=replayed_hands(first))
    second = simulate_trial(again, "python")
    for name, tolerance in (
        ("driver_torque", 0.02),
        ("steering_wheel_angle", 0.004),
        ("lateral_position", 0.03),
        ("longitudinal_velocity", 0.01),
    ):
        apart = first.columns[name][:300] - second.columns[name][:300]
        assert np.abs(apart).max() < tolerance, name
    moved = simulate_trial(again._replace(initial_offset=-0.4), "python")
    apart = second.columns["lateral_position"] - moved.columns["lateral_position"]
    np.testing.assert_allclose(apart[:300], 0.8, atol=0.01)  # nobody looks


@pytest.mark.slow
def test_after_the_recording_the_hands_rest() -> None:
    first = hundred_metres()
    columns = {name: values[:60] for name, values in first.columns.items()}
    short = replayed_hands(first._replace(columns=columns))
    second = simulate_trial(ALONE._replace(length=100.0, driver=short), "python")
    assert not second.columns["driver_torque"][62:].any()
    assert second.columns["driver_torque"][:60].any()


def test_hands_without_a_torque_cannot_be_replayed() -> None:
    first = hundred_metres()
    columns = {n: v for n, v in first.columns.items() if n != "driver_torque"}
    with pytest.raises(ValueError, match="without driver_torque"):
        replayed_hands(first._replace(columns=columns))


class NoArms(NamedTuple):
    """Nothing that moves with the wheel."""

    torque: float = 0.5


class Whole(NamedTuple):
    """A whole number."""

    torque: int = 1
    arm: ArmParameters = ArmParameters()


def _gives(answer: Any) -> Callable[..., Any]:
    return lambda *given: answer


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"name": "virtual"}, "two drivers are called 'virtual'"),
        ({"name": "Mine"}, "small letters"),
        ({"act": None}, "has no act function"),
        ({"version": 2}, "version of driver model 'push' is 2; give text"),
        ({"parameters": _gives(NoArms())}, "no field arm"),
        ({"parameters": _gives(Whole())}, "torque of driver model 'push' is a whole"),
        ({"parameters": _gives(Push(float("nan")))}, "torque .* is nan; give"),
        ({"act": _gives(3)}, "gives 3; give the new state and action"),
        ({"act": _gives((Count(), 3))}, "gives 3 as its action"),
        ({"act": _gives((NoArms(), 3))}, "makes steps of the state nothing"),
        ({"act": lambda a: a}, "act of driver model 'push' broke: TypeError"),
    ],
)
def test_what_cannot_be_driven_is_refused(changed: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        driver_named(model(**changed))


def test_an_unknown_driver_is_refused_with_those_there_are() -> None:
    with pytest.raises(
        ValueError, match=r"not known .*virtual-traffic, virtual-2, hands-off"
    ):
        driver_named("vitrual")


def test_what_only_virtual_drivers_have_is_refused() -> None:
    with pytest.raises(ValueError, match=r"wander_factor is 2.*no such thing"):
        simulate_trial(ALONE._replace(driver=model(), wander_factor=2.0), "python")


def test_a_law_that_breaks_on_the_way_ends_the_trial_with_its_name() -> None:
    def breaks(parameters: Any, state: Count, *rest: Any) -> tuple[Count, Action]:
        if state.steps > 5.0:
            raise RuntimeError("no more")
        return push(parameters, state, *rest)

    with pytest.raises(ValueError, match="driver 'push' broke: RuntimeError: no more"):
        simulate_trial(ALONE._replace(driver=model(act=breaks)), "python")


@pytest.mark.slow
@pytest.mark.parametrize("driver", ["two-point", "replayed"])
def test_compiled_code_drives_as_python_does(driver: str) -> None:
    setup = ALONE._replace(initial_offset=0.3, condition="strong-normal")
    given: Any = str(EXAMPLE)
    if driver == "replayed":
        given = replayed_hands(simulate_trial(setup, "numba"))
    rows = [
        simulate_trial(setup._replace(driver=given), engine).columns
        for engine in ("python", "numba")
    ]
    for name in ("lateral_position", "driver_torque", "applied_torque"):
        np.testing.assert_allclose(rows[0][name], rows[1][name], atol=1e-9)


def test_a_study_says_which_drivers_it_had(tmp_path: Path) -> None:
    from costeer.study.configuration import (
        StudySettings,
        check_settings,
        study_configuration,
    )

    mine = check_settings(StudySettings(drivers=(str(EXAMPLE), model())))
    told = study_configuration(mine)
    assert told["drivers"] == [str(EXAMPLE), "push"]
    first, second = told["driver_parameters"]  # type: ignore[misc]
    assert (first["name"], first["version"]) == ("two-point", "1")
    edited = tmp_path / "other_point.py"
    edited.write_text(EXAMPLE.read_text().replace("Real = 5.0", "Real = 5.5"))
    other = study_configuration(StudySettings(drivers=(str(edited),)))
    assert other["driver_parameters"][0]["source_hash"] != first["source_hash"]  # type: ignore[index]
    assert second["name"] == "push"


def test_python_takes_a_driver_model_as_an_object() -> None:
    record = costeer.simulate(
        "manual", length=100, driver=model(), intention="off", engine="python"
    )
    assert record.metadata["driver"] == "push 7"
