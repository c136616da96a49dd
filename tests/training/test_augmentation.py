"""Windows in other variants: shares, what is kept, and how large the errors are."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from costeer.intention.features import FEATURES, VARIANTS, mirrored
from costeer.training.augmentation import (
    ALL_SIGNALS,
    AugmentationParameters,
    augmented,
    dispensable,
    shares,
)

Windows = NDArray[np.float64]

DEFAULTS = AugmentationParameters()
PLACE = {name: place for place, name in enumerate(FEATURES)}
HEAD, ACCELERATION = PLACE["head_yaw"], PLACE["longitudinal_acceleration"]
SPEED, YAW = PLACE["longitudinal_velocity"], PLACE["yaw_angle"]
DISTANCE = PLACE["distance_to_adjacent_lane"]
ERRORS = [
    name
    for name in AugmentationParameters._fields
    if name.endswith(("_spread", "_error", "_noise", "_drift"))
] + ["sway", "no_acceleration"]


def only(variant: str, **errors: float) -> AugmentationParameters:
    """One variant, without any error but those given."""
    none = dict.fromkeys(ERRORS, 0.0)
    every = dict.fromkeys((name.replace("-", "_") for name in VARIANTS), 0.0)
    chosen = {variant.replace("-", "_"): 1.0}
    return AugmentationParameters(**(every | chosen | none | errors))


def windows(num: int, length: int = 180, seed: int = 0) -> Windows:
    """Smooth windows: glances, speeds near 20 m/s, yaw angles of a lane change."""
    rng = np.random.default_rng(seed)
    time = np.arange(length) / 60.0
    phase = rng.uniform(0.0, 6.3, (num, len(FEATURES), 1))
    waves = np.sin(time + phase)
    size = np.array([0.4, 0.3, 0.5, 0.1, 0.8, 0.03])
    middle = np.array([0.0, 0.0, 20.0, 0.0, 1.75, 0.0])
    return (middle[:, None] + size[:, None] * waves).transpose(0, 2, 1)


def at_the_same_speed(num: int, length: int) -> Windows:
    """Windows whose speed and acceleration tell nothing apart."""
    made = windows(num, length)
    made[..., SPEED], made[..., ACCELERATION] = 20.0, 0.1
    return made


def shown(
    parameters: AugmentationParameters, given_windows: Windows, seed: int = 3
) -> Windows:
    return augmented(parameters, given_windows, np.random.default_rng(seed))


def variants_of(seen: Windows) -> list[str]:
    """By the signals that are missing, throughout a window or not at all.

    Of motion alone the acceleration may be missing too.
    """
    missing = np.isnan(seen)
    assert (missing == missing[:, :1]).all()
    names = {absent: variant for variant, absent in VARIANTS.items()}
    for variant in ("motion", "motion-without-place"):
        lacking = {*VARIANTS[variant], "longitudinal_acceleration"}
        names[tuple(name for name in FEATURES if name in lacking)] = variant
    return [
        names[tuple(name for name in FEATURES if row[PLACE[name]])]
        for row in missing[:, 0]
    ]


def test_each_variant_gets_its_share() -> None:
    num = 20_000
    found = Counter(variants_of(shown(DEFAULTS, windows(num, length=6))))
    for variant, share in zip(VARIANTS, shares(DEFAULTS), strict=True):
        # Binomial: four standard deviations.
        allowed = 4.0 * math.sqrt(num * share * (1.0 - share))
        assert found[variant] == pytest.approx(num * share, abs=allowed)


def test_shares_sum_to_one_and_keep_their_ratios() -> None:
    assert shares(DEFAULTS).sum() == pytest.approx(1.0)
    two = only("full")._replace(head=3.0)
    np.testing.assert_allclose(shares(two), [0.25, 0.0, 0.0, 0.0, 0.0, 0.75])


def test_the_default_shares_are_what_they_say() -> None:
    np.testing.assert_allclose(shares(DEFAULTS), [0.4, 0.12, 0.1, 0.2, 0.08, 0.1])


def test_a_network_does_without_what_some_variant_lacks() -> None:
    def names(parameters: AugmentationParameters) -> set[str]:
        return {n for n, d in zip(FEATURES, dispensable(parameters), strict=True) if d}

    assert names(ALL_SIGNALS) == set()
    for variant, absent in VARIANTS.items():
        assert names(only(variant)) == set(absent)
    assert names(only("no-head")._replace(no_wheel=0.1)) == set(VARIANTS["motion"])
    assert names(DEFAULTS) == set(FEATURES) - {"longitudinal_velocity"}


def test_with_all_signals_windows_are_exact() -> None:
    made = windows(50)
    np.testing.assert_array_equal(shown(ALL_SIGNALS, made), made)


def test_the_full_windows_among_others_are_exact() -> None:
    made = windows(400, length=30)
    seen = shown(DEFAULTS, made)
    for variant in ("full", "no-head", "no-wheel"):
        rows = [i for i, name in enumerate(variants_of(seen)) if name == variant]
        there = [PLACE[name] for name in FEATURES if name not in VARIANTS[variant]]
        assert len(rows) > 20
        np.testing.assert_array_equal(seen[rows][..., there], made[rows][..., there])


def test_what_is_given_is_not_changed() -> None:
    made = windows(100, length=30)
    before = made.copy()
    assert np.isnan(shown(DEFAULTS, made)).any()
    np.testing.assert_array_equal(made, before)


def test_the_same_lots_give_the_same_windows() -> None:
    made = windows(60, length=30)
    once, again = (shown(DEFAULTS, made) for _ in range(2))
    np.testing.assert_array_equal(once, again)
    other = shown(DEFAULTS, made, seed=4)
    assert variants_of(other) != variants_of(once)


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_window_in_a_mirror_is_shown_in_a_mirror(variant: str) -> None:
    # Errors of sensors know no side, but are the same numbers here: leave them out.
    parameters = only(variant, size_spread=0.12, head_spread=0.3)
    made = windows(80, length=30)
    np.testing.assert_array_equal(
        shown(parameters, mirrored(made)), mirrored(shown(parameters, made))
    )


def test_windows_keep_their_order() -> None:
    made = windows(80, length=60)
    motion = shown(only("motion"), made)
    np.testing.assert_array_equal(motion[..., DISTANCE], made[..., DISTANCE])
    speed, own = (w[..., SPEED] for w in (shown(only("head"), made), made))
    # Scaled as a whole: ups and downs over the mean stay, and tell windows apart.
    np.testing.assert_allclose(
        speed / speed.mean(axis=1, keepdims=True),
        own / own.mean(axis=1, keepdims=True),
        rtol=1e-12,
    )


def is_exact(seen: Windows, made: Windows) -> NDArray[np.bool_]:
    """Windows whose signals, so far as they are there, were left as they were."""
    return np.asarray(((seen == made) | np.isnan(seen)).all(axis=(1, 2)))


def binomial(share: float, num: int) -> float:
    """Four standard deviations of a share."""
    return 4.0 * math.sqrt(share * (1.0 - share) / num)


@pytest.mark.parametrize("variant", ["motion", "motion-without-place"])
def test_of_windows_with_motion_alone_a_share_is_of_other_traffic(
    variant: str,
) -> None:
    made = windows(4000, length=6)
    for share in (0.0, 0.3, DEFAULTS.other_traffic):
        seen = shown(only(variant, other_traffic=share), made)
        changed = 1.0 - is_exact(seen, made).mean()
        assert changed == pytest.approx(share, abs=binomial(share, 4000))


@pytest.mark.parametrize("variant", ["motion", "motion-without-place"])
def test_of_windows_with_motion_alone_a_share_lacks_the_acceleration(
    variant: str,
) -> None:
    made = windows(4000, length=6)
    for share in (0.0, DEFAULTS.no_acceleration):
        seen = shown(only(variant, no_acceleration=share), made)
        lacking = np.isnan(seen[..., ACCELERATION]).all(axis=1).mean()
        assert lacking == pytest.approx(share, abs=binomial(share, 4000))


def test_at_another_speed_the_lateral_velocity_is_the_same() -> None:
    made = windows(400)
    seen = shown(only("motion"), made)
    lateral, own = (w[..., SPEED] * np.tan(w[..., YAW]) for w in (seen, made))
    # Tangents, their inverses and products, of numbers below 1 m/s.
    np.testing.assert_allclose(lateral, own, rtol=0, atol=1e-12)
    assert not is_exact(seen, made).all()


def test_speed_and_acceleration_of_other_traffic_are_of_one_other_window() -> None:
    made = windows(60, length=60)
    seen = shown(only("motion", other_traffic=1.0), made)
    own, found = (w[..., ACCELERATION] for w in (made, seen))
    donors = [int(np.flatnonzero((own == row).all(axis=1))[0]) for row in found]
    assert sorted(donors) == list(range(60))
    assert donors != list(range(60))
    ratio = seen[..., SPEED] / made[donors][..., SPEED]
    np.testing.assert_allclose(ratio, np.broadcast_to(ratio[:, :1], ratio.shape))


def test_a_sway_moves_place_and_yaw_angle_together() -> None:
    made = at_the_same_speed(2000, length=180)
    made[..., DISTANCE], made[..., YAW] = 1.75, 0.0
    errors = {"sway": 0.15, "sway_reach": 0.6, "other_traffic": 1.0}
    seen = shown(only("motion", **errors), made)
    distance = seen[..., DISTANCE]
    approach = -seen[..., SPEED] * np.tan(seen[..., YAW])
    # Central differences of a sway of 4 s and more: (π/2/60)²/6 of 0.15 m/s; below
    # 1 m/s of speed the yaw angle would be another.
    slope = (distance[:, 2:] - distance[:, :-2]) * 30.0
    np.testing.assert_allclose(-slope, approach[:, 1:-1], rtol=0, atol=1e-4)
    assert 0.1 < np.abs(approach).max() <= 0.15 * (1.0 + 1e-12)
    assert np.abs(distance - 1.75).max() <= 0.6


def test_a_sway_reaches_no_farther_than_it_says() -> None:
    made = at_the_same_speed(2000, length=180)
    made[..., DISTANCE], made[..., YAW] = 1.75, 0.0
    seen = shown(only("motion", sway=3.0, sway_reach=0.2, other_traffic=1.0), made)
    reach = np.abs(seen[..., DISTANCE] - 1.75).max()
    assert 0.19 < reach <= 0.2 * (1.0 + 1e-12)


@pytest.mark.parametrize("variant", ["motion", "head"])
def test_other_speeds_are_those_of_roads_slow_and_fast(variant: str) -> None:
    made = windows(4000, length=6)
    seen = shown(only(variant), made)
    speed = seen[~is_exact(seen, made), :, SPEED].mean(axis=1)
    assert speed.min() >= DEFAULTS.slowest * (1.0 - 1e-12)
    assert speed.max() <= DEFAULTS.fastest * (1.0 + 1e-12)
    # Uniform in the logarithm: deviation of its width over √12; its own error is
    # 1/√(2n) at most, four of them.
    spread = math.log(DEFAULTS.fastest / DEFAULTS.slowest) / math.sqrt(12.0)
    allowed = 4.0 / math.sqrt(2.0 * len(speed))
    assert np.log(speed).std() == pytest.approx(spread, rel=allowed)


@given(st.floats(3.0, 40.0), st.floats(0.0, 0.1))
def test_a_car_that_stood_still_does_not_break_the_window(
    speed: float, yaw: float
) -> None:
    made = windows(20, length=12)
    made[..., SPEED] = 0.0
    made[..., YAW] = yaw
    seen = shown(only("motion")._replace(slowest=speed, fastest=42.0), made)
    there = [ACCELERATION, SPEED, DISTANCE, YAW]
    assert np.isfinite(seen[..., there]).all()


@pytest.mark.parametrize(
    ("variant", "error", "column", "rate"),
    [
        ("motion", "place_noise", DISTANCE, 10),
        ("motion", "place_drift", DISTANCE, 1),
        ("motion", "yaw_noise", YAW, 10),
        ("motion", "yaw_drift", YAW, 1),
        ("motion", "acceleration_noise", ACCELERATION, 10),
        ("motion-without-place", "yaw_noise", YAW, 10),
        ("head", "head_noise", HEAD, 10),
    ],
)
def test_noise_has_its_deviation_and_runs_straight_between_its_knots(
    variant: str, error: str, column: int, rate: int
) -> None:
    step = 60 // rate
    made, largest = at_the_same_speed(4000, length=2 * step + 1), 0.04
    same_speed = only(variant)._replace(slowest=20.0, fastest=20.0)
    parameters = same_speed._replace(**{error: largest})
    noise = shown(parameters, made)[..., column] - made[..., column]
    noise = noise[np.abs(noise).max(axis=1) > 1e-12]
    assert noise.shape[0] > 0.4 * len(made)
    bends = np.abs(np.diff(noise, n=2, axis=1)).max(axis=0)
    straight = np.arange(1, 2 * step) % step != 0
    # Rounding of numbers near 2.
    assert bends[straight].max() < 1e-14
    assert bends[~straight].min() > largest / step
    # The deviation is uniform up to the largest, so the mean square at a knot is a
    # third of its square; one of fourth powers is 3/5: a relative error of 2.1/√n.
    knots = noise[:, ::step]
    allowed = 4.0 * math.sqrt(3.0 * 9.0 / 5.0 - 1.0) / math.sqrt(len(knots))
    mean_square = (knots**2).mean(axis=0)
    np.testing.assert_allclose(mean_square, largest**2 / 3.0, rtol=allowed)
    neighbours = (knots[:, :-1] * knots[:, 1:]).mean(axis=0)
    assert np.abs(neighbours).max() < allowed * largest**2 / 3.0


@pytest.mark.parametrize(
    ("variant", "error", "column"),
    [
        ("motion", "place_error", DISTANCE),
        ("motion", "yaw_error", YAW),
        ("head", "head_error", HEAD),
    ],
)
def test_a_constant_error_has_its_deviation(
    variant: str, error: str, column: int
) -> None:
    made = at_the_same_speed(4000, length=12)
    same_speed = only(variant)._replace(slowest=20.0, fastest=20.0)
    seen = shown(same_speed._replace(**{error: 0.02}), made)
    off = (seen - made)[~is_exact(seen, made), :, column]
    np.testing.assert_allclose(off, np.broadcast_to(off[:, :1], off.shape), atol=1e-14)
    # A standard deviation's own relative error is 1/√(2n); four of them.
    allowed = 4.0 / math.sqrt(2.0 * len(off))
    assert off[:, 0].std() == pytest.approx(0.02, rel=allowed)
    assert off[:, 0].mean() == pytest.approx(0.0, abs=4.0 * 0.02 / math.sqrt(len(off)))


def test_a_larger_motion_is_larger_in_place_and_yaw_alike() -> None:
    made = at_the_same_speed(4000, length=12)
    made[..., DISTANCE] = 1.0
    parameters = only("motion", size_spread=0.12)
    seen = shown(parameters._replace(slowest=20.0, fastest=20.0), made)
    other = ~is_exact(seen, made)
    size = seen[other, :, DISTANCE]
    np.testing.assert_allclose(seen[other, :, YAW], size * made[other, :, YAW])
    spread = np.log(size[:, 0]).std()
    assert spread == pytest.approx(0.12, rel=4.0 / math.sqrt(2.0 * len(size)))


def test_another_head_turns_more_or_less_and_stays_within_bounds() -> None:
    made = windows(4000, length=12)
    made[..., HEAD] = 0.1
    turned = shown(only("head", head_spread=0.3), made)[..., HEAD]
    spread = np.log(turned[:, 0] / 0.1).std()
    assert spread == pytest.approx(0.3, rel=4.0 / math.sqrt(2.0 * 4000))
    made[..., HEAD] = 1.0
    held = shown(only("head", head_spread=0.3, head_noise=0.1), made)[..., HEAD]
    assert held.max() == 1.0
    made[:, 3:6, HEAD] = np.nan
    lost = np.isnan(shown(only("head", head_spread=0.3), made)[..., HEAD])
    assert (lost == np.isnan(made[..., HEAD])).all()
