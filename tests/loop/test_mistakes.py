"""What goes wrong on purpose: each mistake does what its name says, and no more."""

from __future__ import annotations

import math

import numpy as np
import pytest

from costeer.base.described import described
from costeer.controller.signals import Request
from costeer.drivers.interface import Action, ArmCommand, Pedals
from costeer.loop.clock import DT
from costeer.loop.mistakes import (
    Heard,
    MistakeParameters,
    MistakeState,
    believed_car,
    given_torque,
    heard,
    judged,
)
from costeer.loop.scenario import TrialSetup, loop_parameters, trial_mistakes
from costeer.loop.trial import simulate_trial
from costeer.plant.parameters import CARS, ColumnParameters, RoadParameters
from costeer.records.record import TrialRecord
from costeer.scenarios.mistakes import (
    MISTAKES,
    Mistake,
    parsed_mistakes,
    size_of,
    values_of,
)
from costeer.sensing.measurement import standing_start

ROAD = RoadParameters()
WHO = Action(arm=ArmCommand(intended_angle=0.0), pedals=Pedals(0.0, 0.0))
HERE = standing_start(ROAD)
NOTHING, AT_FIRST = Request(), MistakeState()


def one_step(
    wrong: MistakeParameters,
    request: Request = NOTHING,
    *,
    action: Action = WHO,
    state: MistakeState = AT_FIRST,
    time: float = 0.0,
) -> Heard:
    return heard(wrong, state, ROAD, HERE, request, action, time)


def test_without_a_mistake_everything_is_heard_as_it_is() -> None:
    request = Request(crossing_probability=0.7, requested=True, indicator=-1.0)
    got = one_step(MistakeParameters(), request)
    assert got.request == request
    assert got.measurement == HERE
    _, torque = given_torque(
        MistakeParameters(), MistakeState(), 1.0, 1.25, 5.0, time=70.0
    )
    assert torque == 1.25


def test_a_missed_trigger_is_never_heard() -> None:
    request = Request(crossing_probability=0.99, requested=True, indicator=1.0)
    got = one_step(MistakeParameters(missed_trigger=1.0), request).request
    assert got == Request(crossing_probability=0.0, requested=False, indicator=0.0)


def test_a_missed_trigger_leaves_a_verdict_of_no_and_no_verdict_alone() -> None:
    wrong = MistakeParameters(missed_trigger=1.0)
    assert one_step(wrong, Request(0.3)).request.crossing_probability == 0.3
    assert math.isnan(one_step(wrong, Request()).request.crossing_probability)


@pytest.mark.parametrize("delay", [0.25, 1.0])
def test_a_late_trigger_is_heard_after_its_delay(delay: float) -> None:
    wrong, state, first = MistakeParameters(trigger_delay=delay), MistakeState(), 0
    for step in range(1, 200):
        got = one_step(wrong, Request(0.9), state=state, time=step * DT)
        state = got.memory
        if got.request.crossing_probability >= 0.5:
            first = step
            break
    # Present from step 1 on, heard once it has lasted as long as the delay.
    assert first * DT == pytest.approx(delay, abs=1.01 * DT)


def test_a_false_trigger_comes_once_a_period_and_only_if_nobody_changes_lanes() -> None:
    wrong = MistakeParameters(false_trigger=1.0, false_trigger_period=10.0)
    times = np.arange(0.0, 35.0, DT)
    forced = [
        one_step(wrong, time=float(t)).request.crossing_probability == 1.0
        for t in times
    ]
    starts = times[1:][np.diff(np.array(forced, int)) == 1]
    assert starts == pytest.approx([10.0, 20.0, 30.0], abs=1.01 * DT)
    changing = WHO._replace(intention=1.0)
    got = one_step(wrong, action=changing, time=10.0).request
    assert math.isnan(got.crossing_probability)


def test_a_trigger_comes_when_a_lane_change_is_given_up_and_not_when_it_is_made() -> (
    None
):
    wrong = MistakeParameters(trigger_when_given_up=1.0)

    def last(lane_at_end: float) -> float:
        means = one_step(wrong, action=WHO._replace(intention=1.0))
        after = HERE._replace(lane=lane_at_end)
        got = heard(wrong, means.memory, ROAD, after, Request(0.0), WHO, 1.0)
        return float(got.request.crossing_probability)

    assert last(HERE.lane) == 1.0
    assert last(HERE.lane + HERE.side) == 0.0


def test_the_wrong_side_is_named_only_where_there_is_a_lane() -> None:
    wrong = MistakeParameters(wrong_side=1.0)
    assert one_step(wrong).measurement.side == HERE.side  # two lanes
    wide = ROAD._replace(num_lanes=3.0)
    middle = standing_start(wide)._replace(
        lane=1.0, side=1.0, lateral_position=-3.5 - 0.3
    )
    request = Request(indicator=1.0)
    got = heard(wrong, MistakeState(), wide, middle, request, WHO, 0.0)
    assert got.measurement.side == -1.0
    assert got.request.indicator == -1.0
    # 0.3 m right of the middle lane's centre, 1.75 m to its line.
    assert got.measurement.distance_to_adjacent_lane == pytest.approx(1.45)


def test_the_torque_sensor_errs_and_only_it() -> None:
    felt = HERE._replace(driver_torque=0.8)
    bias = MistakeParameters(torque_bias=0.5)
    dead = MistakeParameters(torque_dead=1.0)
    for wrong, torque in ((bias, 1.3), (dead, 0.0)):
        got = heard(wrong, MistakeState(), ROAD, felt, Request(), WHO, 0.0).measurement
        assert got == felt._replace(driver_torque=torque)


def test_a_reference_beside_the_centre_moves_the_measured_car_the_other_way() -> None:
    got = one_step(MistakeParameters(lateral_offset=0.4)).measurement
    assert got.lateral_position == pytest.approx(HERE.lateral_position - 0.4)


@pytest.mark.parametrize("steps", range(7))
def test_latency_delays_the_torque_by_whole_steps(steps: int) -> None:
    wrong, state, got = MistakeParameters(latency=steps / 60.0), MistakeState(), []
    for k in range(12):
        state, torque = given_torque(wrong, state, 1.0, 0.1 * k, 5.0, k * DT)
        got.append(torque)
    assert got == pytest.approx([max(0.0, 0.1 * (k - steps)) for k in range(12)])


@pytest.mark.parametrize(
    ("wrong", "time", "torque"),
    [
        (MistakeParameters(motor_limit=1.5), 0.0, 1.5),
        (MistakeParameters(off=1.0, off_time=60.0), 59.9, 4.0),
        (MistakeParameters(off=1.0, off_time=60.0), 60.1, 0.0),
        (MistakeParameters(off=1.0, off_duration=4.0), 61.0, 3.0),
        (MistakeParameters(off=1.0, off_duration=4.0), 64.1, 0.0),
        (MistakeParameters(false_steer=3.0), 60.5, 1.0),
        (MistakeParameters(false_steer=3.0), 61.5, 4.0),
    ],
)
def test_the_motor_is_weak_goes_off_or_steers_by_itself(
    wrong: MistakeParameters, time: float, torque: float
) -> None:
    # The method asks for 4 N·m, the other lane lies to the right.
    _, got = given_torque(wrong, MistakeState(), -1.0, 4.0, 5.0, time)
    assert got == pytest.approx(torque)


def test_no_mistake_gives_torque_where_nothing_assists() -> None:
    wrong = MistakeParameters(false_steer=3.0)
    _, torque = given_torque(wrong, MistakeState(), 1.0, 0.0, 0.0, time=60.5)
    assert torque == 0.0


def test_the_method_believes_in_another_car_and_the_plant_has_the_true_one() -> None:
    setup = TrialSetup(
        condition="strong-normal", mistakes=("wrong-mass", "wrong-tyres", "friction=3")
    )
    parameters = loop_parameters(setup)
    true, believed = CARS["default"], parameters.controller.car
    assert parameters.car == true
    assert believed.mass == pytest.approx(1.3 * true.mass)
    assert believed.front_cornering_stiffness == pytest.approx(
        0.7 * true.front_cornering_stiffness
    )
    nominal = ColumnParameters().friction
    assert parameters.controller.column.friction == nominal
    assert parameters.column.friction == pytest.approx(3.0 * nominal)


def test_only_what_is_named_is_believed_otherwise() -> None:
    car = CARS["large"]
    assert believed_car(MistakeParameters(), car) == car


def test_mistakes_are_gated_by_any() -> None:
    assert judged(MistakeParameters()).any == 0.0
    assert judged(MistakeParameters(torque_bias=0.1)).any == 1.0


@pytest.mark.parametrize("name", MISTAKES)
def test_every_mistake_reaches_the_loop(name: str) -> None:
    setup = TrialSetup(condition="strong-normal", scenario="three-lanes", speed=25.0)
    usual = loop_parameters(setup)
    wrong = loop_parameters(setup._replace(mistakes=(name,)))
    assert described(wrong) != described(usual)
    assert wrong.mistakes.any == (0.0 if name == "short-sight" else 1.0)
    kind = MISTAKES[name]
    assert kind.low <= kind.size <= kind.high
    for value in (kind.low, kind.high) if kind.unit else ():
        loop_parameters(setup._replace(mistakes=(f"{name}={value!r}",)))


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("late",), "there is no mistake 'late'.*late-trigger"),
        (("late-trigger=9",), "late-trigger has size 9; give a number from 0.05 to 5"),
        (("late-trigger=x",), "no number after ="),
        (("late-trigger=nan",), "no finite size"),
        (("latency", "latency=0.05"), "latency stands twice"),
        (("head-lost=1",), "head-lost has no size; leave it out"),
        (("silent-off", "fade-off"), "fade-off and silent-off exclude each other"),
    ],
)
def test_what_is_no_mistake_is_refused(words: tuple[str, ...], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        parsed_mistakes(words)


def test_the_wrong_side_is_refused_where_it_can_never_be() -> None:
    setup = TrialSetup(condition="strong-normal", mistakes=("wrong-side",))
    with pytest.raises(ValueError, match="needs three lanes or more; this road has 2"):
        trial_mistakes(setup)


def test_the_size_is_the_usual_one_unless_it_is_given() -> None:
    assert size_of(Mistake("latency")) == 0.1
    assert values_of(parsed_mistakes(["latency=0.05"])) == {"mistakes.latency": 0.05}


def test_too_long_a_latency_is_refused_by_name_too() -> None:
    setup = TrialSetup(
        condition="strong-normal", parameters=(("mistakes.latency", 0.5),)
    )
    with pytest.raises(
        ValueError, match=r"mistakes\.latency is 0\.5; give a number from 0 to 0\.1 s"
    ):
        loop_parameters(setup)


def driven(*mistakes: str, **more: object) -> TrialRecord:
    setup = TrialSetup(condition="strong-normal", intention="scripted", length=1500.0)
    return simulate_trial(setup._replace(mistakes=mistakes, **more))


def test_a_record_tells_its_mistakes() -> None:
    record = driven("late-trigger=0.8", intention="off", length=200.0)
    assert record.metadata["mistakes"] == [
        {
            "kind": "late-trigger",
            "size": 0.8,
            "about": "triggers arrive 0.8 s late",
        }
    ]
    assert trial_mistakes(TrialSetup()) == ()


def test_a_false_trigger_starts_a_lane_change_that_nobody_wants() -> None:
    record = driven("false-trigger=20", length=900.0, events=False)
    time, trigger = record.columns["time"], record.columns["intention"]
    assert time[trigger.argmax()] == pytest.approx(20.0, abs=0.1)
    assert (record.columns["mode"] == "lane_changing").any()
    calm = driven(length=900.0, events=False)
    assert not calm.columns["intention"].any()


def test_a_weak_motor_never_gives_more_than_it_can() -> None:
    record = driven("weak-motor=0.3")
    assert np.abs(record.columns["applied_torque"]).max() <= 0.3 + 1e-9
    assert np.abs(driven().columns["applied_torque"]).max() > 0.5


@pytest.mark.slow
def test_engines_agree_on_mistakes() -> None:
    wrong = ("false-trigger=5", "latency", "torque-bias", "friction", "false-steer")
    for_steer = (("mistakes.false_steer_period", 7.0),)
    records = [
        simulate_trial(
            TrialSetup(
                condition="strong-normal",
                intention="scripted",
                length=250.0,
                mistakes=wrong,
                parameters=for_steer,
            ),
            engine=engine,
        )
        for engine in ("numba", "python", "jax")
    ]
    for name in ("lateral_position", "applied_torque", "steering_wheel_angle"):
        first, *others = (record.columns[name] for record in records)
        for other in others:
            np.testing.assert_allclose(other, first, rtol=0.0, atol=1e-9)
