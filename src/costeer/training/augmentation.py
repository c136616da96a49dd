"""Windows as other cars, trackers and roads would show them.

One network is to serve with and without head and wheel signals, in a simulator and in
a car. So each training window is shown in a variant drawn by lot (`features.VARIANTS`):
signals are taken away, and those that are left are given the errors of their sensors.
A simulator knows place and yaw exactly; from cameras and maps they come at 10 Hz, with
noise, in lanes of other widths and at speeds that no virtual driver drives. The motion
in the lane is kept: yaw angles follow when a speed is changed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.intention.features import FEATURES, SAMPLE_RATE, VARIANTS

Windows = NDArray[np.float64]

_PLACE = {name: place for place, name in enumerate(FEATURES)}
_HEAD = _PLACE["head_yaw"]
_ACCELERATION = _PLACE["longitudinal_acceleration"]
_SPEED = _PLACE["longitudinal_velocity"]
_DISTANCE = _PLACE["distance_to_adjacent_lane"]
_YAW = _PLACE["yaw_angle"]

_FAST = 6
"""Samples between knots of noise at 10 Hz, as from a tracker; straight between them."""

_SLOW = 60
"""The same at 1 Hz."""


class AugmentationParameters(NamedTuple):
    """How often which variant is drawn, and how large the errors are.

    Attributes:
        full: Share of windows with all signals, exact [-]. Source: assumed; the main
            use gets the most.
        no_head: Share without head yaw [-]. Source: assumed.
        no_wheel: Share without the steering wheel's angle [-]. Source: assumed.
        motion: Share without both [-]. Source: assumed.
        motion_without_place: Share that lacks the distance too [-]. Source: assumed.
        head: Share with head yaw and speed only [-]. Source: assumed.
        other_traffic: Share of the windows with motion alone that are from another car
            on another road; the others stay exact [-]. Source: chosen on the shared
            halves of recordings of people (docs/decisions/0010-missing-signals.md).
        no_acceleration: Share of windows with motion alone that lack the acceleration
            too [-]. Source: assumed.
        slowest: Least speed of a window with motion alone [m/s]. Source: assumed, a
            motorway at a crawl.
        fastest: Greatest [m/s]. Source: assumed, 150 km/h.
        size_spread: Standard deviation of the logarithm of the lateral motion's size
            [-]. Source: assumed, lanes of 3 to 4.2 m.
        sway: Largest lateral speed of a sway that has nothing to do with a lane change
            [m/s]. Source: chosen as `other_traffic`; people in dense traffic sway more
            than virtual drivers on an empty road.
        sway_reach: Largest way of that sway to each side [m]. Source: assumed.
        place_error: Constant error of the distance, standard deviation [m]. Source:
            assumed, a map or a camera.
        place_noise: Largest standard deviation of its noise at 10 Hz [m]. Source:
            assumed.
        place_drift: The same of noise at 1 Hz [m]. Source: chosen as `other_traffic`,
            a map whose lines do not run as the lanes do.
        yaw_error: Constant error of the yaw angle, standard deviation [rad]. Source:
            assumed, as above.
        yaw_noise: Largest standard deviation of its noise at 10 Hz [rad]. Source:
            assumed, cars tracked from afar.
        yaw_drift: The same of noise at 1 Hz [rad]. Source: chosen as `other_traffic`.
        acceleration_noise: Largest standard deviation of the acceleration's noise
            [m/s²]. Source: assumed, as above.
        head_spread: Standard deviation of the logarithm of the head's size [-].
            Source: assumed, people and trackers differ.
        head_error: Constant error of the head yaw, standard deviation [-]. Source:
            assumed, 2 deg of 90.
        head_noise: Largest standard deviation of its noise [-]. Source: assumed, 3 deg
            of 90.
    """

    full: Real = 0.4
    no_head: Real = 0.12
    no_wheel: Real = 0.1
    motion: Real = 0.2
    motion_without_place: Real = 0.08
    head: Real = 0.1
    other_traffic: Real = 0.85
    no_acceleration: Real = 0.1
    slowest: Real = 2.0
    fastest: Real = 42.0
    size_spread: Real = 0.12
    sway: Real = 0.15
    sway_reach: Real = 0.6
    place_error: Real = 0.25
    place_noise: Real = 0.1
    place_drift: Real = 0.08
    yaw_error: Real = 0.008
    yaw_noise: Real = 0.03
    yaw_drift: Real = 0.008
    acceleration_noise: Real = 1.0
    head_spread: Real = 0.3
    head_error: Real = 0.02
    head_noise: Real = 0.035


DEFAULTS = AugmentationParameters()

ALL_SIGNALS = AugmentationParameters(
    full=1.0,
    no_head=0.0,
    no_wheel=0.0,
    motion=0.0,
    motion_without_place=0.0,
    head=0.0,
)
"""Nothing is taken away and nothing is added: the paper's own network."""


def shares(parameters: AugmentationParameters) -> NDArray[np.float64]:
    """Probability of each of `VARIANTS`, in their order; they sum to 1."""
    each = [getattr(parameters, name.replace("-", "_")) for name in VARIANTS]
    return np.asarray(np.array(each) / sum(each))


def dispensable(parameters: AugmentationParameters) -> NDArray[np.float64]:
    """1 for each signal that some variant lacks, `(feature,)`."""
    lacked = {
        name
        for share, absent in zip(shares(parameters), VARIANTS.values(), strict=True)
        for name in absent
        if share > 0.0
    }
    motion = parameters.motion + parameters.motion_without_place
    if motion > 0.0 and parameters.no_acceleration > 0.0:
        lacked.add(FEATURES[_ACCELERATION])
    return np.array([float(name in lacked) for name in FEATURES])


def augmented(
    parameters: AugmentationParameters, windows: Windows, rng: np.random.Generator
) -> Windows:
    """Show each window in a variant drawn by lot.

    Args:
        parameters: Shares and errors.
        windows: Facing right, shape `(window, time, feature)`.
        rng: Where the lots come from.

    Returns:
        A copy, NaN where a signal is missing.
    """
    shown = np.array(windows, np.float64)
    drawn = rng.choice(len(VARIANTS), len(shown), p=shares(parameters))
    for place, (variant, absent) in enumerate(VARIANTS.items()):
        rows = np.flatnonzero(drawn == place)
        if len(rows) == 0:
            continue
        part = shown[rows]
        if variant.startswith("motion"):
            part = _other_traffic(parameters, part, rng)
            lacking = rng.random(len(part)) < parameters.no_acceleration
            part[lacking, :, _ACCELERATION] = np.nan
        if variant == "head":
            part = _other_speed(parameters, _other_head(parameters, part, rng), rng)
        part[..., [_PLACE[name] for name in absent]] = np.nan
        shown[rows] = part
    return shown


def _other_traffic(
    parameters: AugmentationParameters, windows: Windows, rng: np.random.Generator
) -> Windows:
    """The same lane changes at other speeds, in other lanes, seen by other sensors."""
    some = rng.random(len(windows)) < parameters.other_traffic
    part = _other_leader(windows[some], rng)
    part = _other_speed(parameters, part, rng)
    size = np.exp(parameters.size_spread * rng.standard_normal((len(part), 1)))
    part[..., _YAW] *= size
    part[..., _DISTANCE] *= size
    part = _swaying(parameters, part, rng)
    one = (len(part), 1)
    part[..., _DISTANCE] += parameters.place_error * rng.standard_normal(one)
    part[..., _DISTANCE] += _noise(parameters.place_noise, _FAST, part, rng)
    part[..., _DISTANCE] += _noise(parameters.place_drift, _SLOW, part, rng)
    part[..., _YAW] += parameters.yaw_error * rng.standard_normal(one)
    part[..., _YAW] += _noise(parameters.yaw_noise, _FAST, part, rng)
    part[..., _YAW] += _noise(parameters.yaw_drift, _SLOW, part, rng)
    part[..., _ACCELERATION] += _noise(parameters.acceleration_noise, _FAST, part, rng)
    windows[some] = part
    return windows


def _other_leader(windows: Windows, rng: np.random.Generator) -> Windows:
    """The same lateral motion with the speed and acceleration of another window.

    Virtual drivers change lanes because of one slow car ahead, so their speed tells of
    it; in dense traffic speed changes for many reasons.
    """
    donors = windows[rng.permutation(len(windows))]
    ratio = donors[..., _SPEED] / np.maximum(windows[..., _SPEED], 1.0)
    windows[..., _YAW] = np.arctan(np.tan(windows[..., _YAW]) / np.maximum(ratio, 0.05))
    windows[..., _SPEED] = donors[..., _SPEED]
    windows[..., _ACCELERATION] = donors[..., _ACCELERATION]
    return windows


def _swaying(
    parameters: AugmentationParameters, windows: Windows, rng: np.random.Generator
) -> Windows:
    """The same with a slow sway in the lane, of 4 to 20 s, in place and yaw angle."""
    one = (len(windows), 1)
    rate = 2.0 * np.pi / np.exp(rng.uniform(np.log(4.0), np.log(20.0), one))
    speed = rng.uniform(0.0, parameters.sway, one)
    reach = np.minimum(speed / rate, parameters.sway_reach)
    phase = rate * np.arange(windows.shape[1]) / SAMPLE_RATE
    phase = phase + rng.uniform(0.0, 2.0 * np.pi, one)
    approach = reach * rate * np.cos(phase)
    windows[..., _YAW] -= np.arctan(approach / np.maximum(windows[..., _SPEED], 1.0))
    windows[..., _DISTANCE] = np.abs(windows[..., _DISTANCE] - reach * np.sin(phase))
    return windows


def _other_speed(
    parameters: AugmentationParameters, windows: Windows, rng: np.random.Generator
) -> Windows:
    """The same lateral motion at another speed: the yaw angle makes up for it."""
    low, high = np.log(parameters.slowest), np.log(parameters.fastest)
    speed = np.exp(rng.uniform(low, high, len(windows)))
    ratio = (speed / np.maximum(windows[..., _SPEED].mean(axis=1), 1.0))[:, None]
    windows[..., _SPEED] *= ratio
    windows[..., _YAW] = np.arctan(np.tan(windows[..., _YAW]) / ratio)
    return windows


def _other_head(
    parameters: AugmentationParameters, windows: Windows, rng: np.random.Generator
) -> Windows:
    """The same glances by another head before another tracker."""
    num = (len(windows), 1)
    size = np.exp(parameters.head_spread * rng.standard_normal(num))
    error = parameters.head_error * rng.standard_normal(num)
    turned = windows[..., _HEAD] * size + error
    noisy = turned + _noise(parameters.head_noise, _FAST, windows, rng)
    windows[..., _HEAD] = np.clip(noisy, -1.0, 1.0)
    return windows


def _noise(
    largest: Real, samples_per_knot: int, windows: Windows, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Noise of a sensor, another deviation for each window.

    Args:
        largest: Standard deviation at the knots, drawn from 0 to this.
        samples_per_knot: The noise runs straight from knot to knot.
        windows: For their shape, `(window, time, feature)`.
        rng: Where it comes from.

    Returns:
        Shape `(window, time)`.
    """
    num, length = windows.shape[:2]
    knots = length // samples_per_knot + 2
    values = rng.standard_normal((num, knots)) * rng.uniform(0.0, largest, (num, 1))
    place = np.arange(length) / samples_per_knot
    before = place.astype(np.int64)
    share = place - before
    return values[:, before] * (1.0 - share) + values[:, before + 1] * share
