"""IDM and MOBIL against their published equations and what follows from them."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from costeer.plant.following import (
    LONGEST_GAP,
    Ahead,
    FollowingParameters,
    LaneOutlook,
    advantage,
    following_acceleration,
)

LAW = FollowingParameters()
DESIRED = 30.0
LENGTH = 4.5
DT = 1.0 / 60.0
FREE = LaneOutlook()


def equilibrium_gap(speed: float) -> float:
    """Treiber et al. (2000), Eq. (6): the gap of a car that keeps its speed [m]."""
    spacing = LAW.standstill_gap + LAW.headway * speed
    return spacing / math.sqrt(1.0 - (speed / DESIRED) ** 4)


@pytest.mark.parametrize("speed", [0.0, 5.0, 15.0, 25.0, 29.0])
def test_a_car_at_the_equilibrium_gap_keeps_its_speed(speed: float) -> None:
    gap = equilibrium_gap(speed)
    here = following_acceleration(LAW, speed, DESIRED, gap, speed)
    assert here == pytest.approx(0.0, abs=1e-12)
    assert following_acceleration(LAW, speed, DESIRED, gap + 1.0, speed) > 0.0
    assert following_acceleration(LAW, speed, DESIRED, gap - 1.0, speed) < 0.0


def test_the_values_are_those_that_were_published() -> None:
    # Treiber et al. (2000), Table I; Kesting et al. (2007), Table 2 and Sec. 2.
    assert (LAW.headway, LAW.acceleration, LAW.deceleration) == (1.6, 0.73, 1.67)
    assert (LAW.standstill_gap, LAW.changing_threshold) == (2.0, 0.1)
    assert 0.0 <= LAW.politeness <= 0.5
    assert LAW.safe_braking == 4.0


@pytest.mark.parametrize(("speed", "share"), [(0.0, 1.0), (15.0, 15 / 16), (30.0, 0.0)])
def test_on_a_free_road_only_the_desired_speed_counts(
    speed: float, share: float
) -> None:
    free = following_acceleration(LAW, speed, DESIRED, LONGEST_GAP, 0.0)
    assert free == pytest.approx(share * LAW.acceleration, abs=1e-6)


def test_a_car_that_comes_nearer_brakes_by_the_published_term() -> None:
    # s* = s0 + v T + v Δv / (2 √(a b)), a [1 - (v/v0)^4 - (s*/s)²].
    speed, ahead, gap = 20.0, 14.0, 60.0
    wanted = 2.0 + 20.0 * 1.6 + 20.0 * 6.0 / (2.0 * math.sqrt(0.73 * 1.67))
    expected = 0.73 * (1.0 - (20.0 / 30.0) ** 4 - (wanted / gap) ** 2)
    found = following_acceleration(LAW, speed, DESIRED, gap, ahead)
    assert found == pytest.approx(expected, rel=1e-12)


def test_nobody_brakes_harder_than_tyres_can() -> None:
    for gap in (-3.0, 0.0, 0.5):
        assert following_acceleration(LAW, 30.0, DESIRED, gap, 0.0) == -8.0


def string_behind(
    leader: list[float], count: int, speed: float, gap: float
) -> tuple[list[float], list[float], float]:
    """Cars that follow one whose speeds are given: gaps, speeds, the least gap met."""
    places = [-k * (gap + LENGTH) for k in range(count + 1)]
    speeds, least = [speed] * (count + 1), gap
    for told in leader:
        pushes = [
            following_acceleration(
                LAW,
                speeds[k],
                DESIRED,
                places[k - 1] - places[k] - LENGTH,
                speeds[k - 1],
            )
            for k in range(1, count + 1)
        ]
        then = [
            told,
            *(max(v + a * DT, 0.0) for v, a in zip(speeds[1:], pushes, strict=True)),
        ]
        places = [
            p + (v + w) / 2.0 * DT for p, v, w in zip(places, speeds, then, strict=True)
        ]
        speeds = then
        gaps = [places[k] - places[k + 1] - LENGTH for k in range(count)]
        least = min(least, *gaps)
    return gaps, speeds, least


def test_a_string_of_cars_settles_at_the_equilibrium() -> None:
    gaps, speeds, _ = string_behind([20.0] * 240 * 60, 4, 24.0, 60.0)
    assert speeds[1:] == pytest.approx([20.0] * 4, abs=0.02)
    assert gaps == pytest.approx([equilibrium_gap(20.0)] * 4, abs=0.3)


@pytest.mark.parametrize("braking", [3.0, 8.0])
def test_no_car_hits_a_leader_that_brakes_to_a_stand(braking: float) -> None:
    told = [max(25.0 - braking * k * DT, 0.0) for k in range(30 * 60)]
    gaps, speeds, least = string_behind(told, 4, 25.0, equilibrium_gap(25.0))
    assert speeds == pytest.approx([0.0] * 5, abs=0.05)
    # They stand s0 behind each other, less what is left of their slow approach.
    assert least > 0.5 * LAW.standstill_gap
    assert gaps == pytest.approx([LAW.standstill_gap] * 4, abs=1.0)


def lane(
    ahead: float = LONGEST_GAP, behind: float = LONGEST_GAP, speed: float = 25.0
) -> LaneOutlook:
    """A lane with cars of one speed at given gaps."""
    return LaneOutlook(Ahead(ahead, speed, DESIRED), Ahead(behind, speed, DESIRED))


def test_a_gap_that_asks_the_follower_for_hard_braking_is_not_safe() -> None:
    # The follower's deceleration a [1 - (v/v0)^4 - (s*/s)²] is b_safe at this gap.
    speed, own = 25.0, 20.0
    wanted = 2.0 + speed * 1.6 + speed * 5.0 / (2.0 * math.sqrt(0.73 * 1.67))
    closeness = 1.0 - (speed / DESIRED) ** 4 + LAW.safe_braking / LAW.acceleration
    limit = wanted / math.sqrt(closeness)
    for gap, safe in ((limit - 0.01, False), (limit + 0.01, True)):
        found, _ = advantage(LAW, own, DESIRED, LENGTH, FREE, lane(behind=gap))
        assert found == safe


def test_a_gap_ahead_that_asks_oneself_for_hard_braking_is_not_safe() -> None:
    speed, slower = 25.0, 15.0
    wanted = 2.0 + speed * 1.6 + speed * 10.0 / (2.0 * math.sqrt(0.73 * 1.67))
    closeness = 1.0 - (speed / DESIRED) ** 4 + LAW.safe_braking / LAW.acceleration
    limit = wanted / math.sqrt(closeness)
    for gap, safe in ((limit - 0.01, False), (limit + 0.01, True)):
        other = lane(ahead=gap, speed=slower)
        assert advantage(LAW, speed, DESIRED, LENGTH, FREE, other)[0] == safe


@pytest.mark.parametrize("place", ["ahead", "behind"])
@pytest.mark.parametrize("gap", [-1.0, 0.0, 1.9])
def test_no_lane_change_into_a_gap_that_is_none(place: str, gap: float) -> None:
    # Nobody would have to brake here: all stand.
    stand = lane(**{place: gap}, speed=0.0)
    assert not advantage(LAW, 0.0, DESIRED, LENGTH, FREE, stand)[0]


def test_an_egoist_gains_what_the_own_acceleration_gains() -> None:
    egoist = LAW._replace(politeness=0.0)
    slow, fast = lane(ahead=30.0, speed=18.0), lane(ahead=80.0, speed=25.0)
    now = following_acceleration(LAW, 20.0, DESIRED, 30.0, 18.0)
    then = following_acceleration(LAW, 20.0, DESIRED, 80.0, 25.0)
    _, worth = advantage(egoist, 20.0, DESIRED, LENGTH, slow, fast)
    assert worth == pytest.approx(then - now)
    _, back = advantage(egoist, 20.0, DESIRED, LENGTH, fast, slow)
    assert back == -worth


def test_politeness_weighs_what_others_lose_and_gain() -> None:
    own, other = lane(30.0, 40.0, 20.0), lane(50.0, 25.0, 22.0)
    follows = following_acceleration
    # New follower: first the car ahead there, then this one. Old follower: freed.
    lost = follows(LAW, 22.0, DESIRED, 25.0, 20.0) - follows(
        LAW, 22.0, DESIRED, 50.0 + 25.0 + LENGTH, 22.0
    )
    gained = follows(LAW, 20.0, DESIRED, 30.0 + 40.0 + LENGTH, 20.0) - follows(
        LAW, 20.0, DESIRED, 40.0, 20.0
    )
    worths = [
        advantage(LAW._replace(politeness=p), 20.0, DESIRED, LENGTH, own, other)[1]
        for p in (0.0, 0.5, 1.0)
    ]
    assert lost < 0.0 < gained
    assert worths[2] - worths[0] == pytest.approx(lost + gained, rel=1e-12)
    assert worths[1] - worths[0] == pytest.approx(0.5 * (lost + gained), rel=1e-12)


@given(*[st.floats(5.0, 200.0)] * 4, st.floats(5.0, 29.0))
def test_what_one_change_wins_the_way_back_loses(
    ahead: float, behind: float, beside: float, after: float, speed: float
) -> None:
    # With the same cars, a change to the other lane and one back cancel: what the
    # follower there loses by this car, it wins when this car leaves.
    one, other = lane(ahead, behind, speed), lane(beside, after, speed)
    _, there = advantage(LAW, 15.0, DESIRED, LENGTH, one, other)
    _, back = advantage(LAW, 15.0, DESIRED, LENGTH, other, one)
    assert there == pytest.approx(-back, abs=1e-12)
