"""What the network sees of car and driver: the six signals of Eq. (1).

The network is trained on straight roads. In a bend it is shown what would be left of
the signals there: what steady cornering asks of wheel and heading is taken off
(`beyond_bend`). On a straight road nothing is.

The network is trained for the adjacent lane on the right. Whenever the adjacent lane
is on the left it is shown the mirrored world: head yaw, steering-wheel angle and yaw
angle change sign; speed, acceleration and the distance to the shared boundary do not.

Each sample is mirrored by the side that held *at that sample*. The other reading
would turn the whole window by the side that holds now; it costs a second run of the
window after every crossing, and the two differ only while a window reaches back over
a crossing, at most 3 s. Training follows the same rule, so the network has seen such
windows.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base import array as xp
from costeer.base.array import Real, compiled
from costeer.plant.alignment import line_curvature
from costeer.plant.parameters import (
    DEFAULT_CAR,
    CarParameters,
    steady_sideslip_angle,
    steady_steering_wheel_angle,
)
from costeer.records.columns import COLUMNS_BY_NAME

WINDOW_LENGTH = 180
"""Samples in a window, k of Eq. (1) [-]."""

SAMPLE_RATE = 60.0
"""Samples a second [Hz]."""

ADJACENT_RIGHT = -1
ADJACENT_LEFT = 1

FEATURE_LIMIT = 10.0
"""Scaled signals are held within ± this many standard deviations [-].

Source: assumed; far outside of anything trained on, it only keeps a wrong unit or a
broken sensor from overflowing the arithmetic.
"""


class IntentionSample(NamedTuple):
    """One sample of the six signals of Eq. (1), in the order the network takes them.

    Attributes:
        head_yaw: Normalised to [-1, 1], left positive; NaN if the head was not
            tracked [-].
        longitudinal_acceleration: Along the car's axis [m/s²].
        longitudinal_velocity: Along the car's axis [m/s].
        steering_wheel_angle: Left positive [rad].
        distance_to_adjacent_lane: From the centre of gravity to the boundary shared
            with the adjacent lane, positive inside the own lane [m].
        yaw_angle: Against the road, left positive [rad].
    """

    head_yaw: Real
    longitudinal_acceleration: Real
    longitudinal_velocity: Real
    steering_wheel_angle: Real
    distance_to_adjacent_lane: Real
    yaw_angle: Real


FEATURES: tuple[str, ...] = IntentionSample._fields
NUM_FEATURES = len(FEATURES)
HEAD_YAW = FEATURES.index("head_yaw")
"""Place of the one signal that is lost and found while a drive goes on."""
DISTANCE = FEATURES.index("distance_to_adjacent_lane")

VARIANTS: dict[str, tuple[str, ...]] = {
    "full": (),
    "no-head": ("head_yaw",),
    "no-wheel": ("steering_wheel_angle",),
    "motion": ("head_yaw", "steering_wheel_angle"),
    "motion-without-place": (
        "head_yaw",
        "steering_wheel_angle",
        "distance_to_adjacent_lane",
    ),
    "head": (
        "longitudinal_acceleration",
        "steering_wheel_angle",
        "distance_to_adjacent_lane",
        "yaw_angle",
    ),
}
"""Sets of signals that a recording may lack, by the name of what is left."""

SCALED = (*FEATURES, "approach_velocity")
"""What is scaled before it enters the network."""

INPUTS = (*SCALED, *(f"{name}_missing" for name in FEATURES))
"""All inputs of the network."""

NUM_SCALED = len(SCALED)
NUM_INPUTS = len(INPUTS)
_VELOCITY = FEATURES.index("longitudinal_velocity")
_YAW = FEATURES.index("yaw_angle")
_MIRRORED = [n for n in FEATURES if COLUMNS_BY_NAME[n].mirrored == "flipped"]


@compiled
def beyond_bend(
    car: CarParameters, sample: IntentionSample, curvature: Real
) -> IntentionSample:
    """The sample less what steady cornering along the road asks for.

    The wheel is held at steering_ratio (wheelbase + K_us v²) kappa, and the car points
    out of its direction of travel by its sideslip angle. Source: steady cornering of
    the linear single-track car, as for theta_d and psi_d of the planned motion
    (controller/preview.py); ours, the paper's road is straight.

    Args:
        car: With linear tyres.
        sample: In the car's own signs.
        curvature: Of the line along the road that the car is on, left positive [1/m].
    """
    speed = sample.longitudinal_velocity
    angle = steady_steering_wheel_angle(car, speed, curvature)
    sideslip = steady_sideslip_angle(car, speed, curvature)
    return sample._replace(
        steering_wheel_angle=sample.steering_wheel_angle - angle,
        yaw_angle=sample.yaw_angle + sideslip,
    )


@compiled
def facing(sample: IntentionSample, adjacent_side: Real) -> IntentionSample:
    """The sample as if the adjacent lane were on the right.

    Args:
        sample: In the car's own signs.
        adjacent_side: -1 right, +1 left.
    """
    turn = -1.0 * adjacent_side
    return sample._replace(
        head_yaw=turn * sample.head_yaw,
        steering_wheel_angle=turn * sample.steering_wheel_angle,
        yaw_angle=turn * sample.yaw_angle,
    )


def adjacent_side(lane: NDArray[np.int8]) -> NDArray[np.int8]:
    """Side of the adjacent lane on a two-lane road: -1 right, +1 left.

    Args:
        lane: 0 for the right lane, 1 for the left one.

    Raises:
        ValueError: If there is another lane.
    """
    unknown = set(np.unique(lane)) - {0, 1}
    if unknown:
        raise ValueError(
            f"lane has the values {sorted(int(v) for v in unknown)}; on a two-lane "
            "road they are 0 (right) and 1 (left)"
        )
    side = np.where(lane == 0, ADJACENT_LEFT, ADJACENT_RIGHT)
    return side.astype(np.int8)


def mirrored(features: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same drive in a mirror, shape `(*batch, feature)`.

    The distance stays that to the line it was measured to.
    """
    turn = np.array([-1.0 if name in _MIRRORED else 1.0 for name in FEATURES])
    return np.asarray(features * turn)


def valid_samples(
    features: NDArray[np.float64], absent: tuple[str, ...] = ()
) -> NDArray[np.bool_]:
    """Whether each sample may be used, shape `(time,)`.

    A signal that the recording does not have may be anything. A head yaw that is NaN
    is a head that was not tracked, and counts as missing at that sample. Every other
    value that is not finite makes its sample invalid.

    Args:
        features: Shape `(time, feature)`.
        absent: Signals that the recording does not have.
    """
    good = np.isfinite(features)
    good[:, HEAD_YAW] |= np.isnan(features[:, HEAD_YAW])
    good[:, [FEATURES.index(name) for name in absent]] = True
    return np.asarray(good.all(axis=1))


def hide(features: NDArray[np.float64], absent: tuple[str, ...]) -> NDArray[np.float64]:
    """A copy with NaN for the absent signals, shape `(*batch, feature)`."""
    hidden = np.array(features, np.float64)
    hidden[..., [FEATURES.index(name) for name in absent]] = np.nan
    return hidden


def full_windows(
    features: NDArray[np.float64], absent: tuple[str, ...] = ()
) -> NDArray[np.bool_]:
    """Whether a window of 180 valid samples ends at each sample, shape `(time,)`."""
    valid = valid_samples(features, absent)
    here = np.arange(len(valid))
    last_bad = np.maximum.accumulate(np.where(valid, -1, here))
    return np.asarray(here - last_bad >= WINDOW_LENGTH)


def feature_series(
    columns: Mapping[str, NDArray[np.float64]],
    side: NDArray[np.int8],
    car: CarParameters = DEFAULT_CAR,
) -> NDArray[np.float64]:
    """Signals of Eq. (1) as the network takes them, before scaling.

    Args:
        columns: The arrays of `FEATURES`, shape `(time,)` each, and `road_curvature`
            with `lateral_position` where they are known.
        side: Side of the adjacent lane at each sample, -1 or +1, shape `(time,)`.
        car: That was driven; matters in bends alone.

    Returns:
        Less what the road's bends ask for, mirrored where the side is left, shape
        `(time, feature)`.
    """
    # Any: Real stands for arrays too.
    series: list[Any] = [np.asarray(columns[name], np.float64) for name in FEATURES]
    turned: Any = np.asarray(side, np.float64)
    bend: Any = curvature_series(columns)
    seen = facing(beyond_bend(car, IntentionSample(*series), bend), turned)
    return np.stack([np.asarray(each) for each in seen], axis=-1)


def curvature_series(
    columns: Mapping[str, NDArray[np.float64]],
) -> NDArray[np.float64]:
    """Curvature of the line along the road that the car is on, `(time,)` [1/m].

    Args:
        columns: `road_curvature` of the road's reference line, and `lateral_position`
            from it, shape `(time,)` each. 0 stands for what is not known.
    """
    nothing = np.zeros(len(next(iter(columns.values()))))
    found: list[Any] = []  # Any: as above
    for name in ("road_curvature", "lateral_position"):
        values = np.ma.asarray(columns.get(name, nothing), np.float64)
        found.append(np.nan_to_num(np.ma.filled(values, np.nan)))
    return np.asarray(line_curvature(*found))


@compiled
def approach_velocity(longitudinal_velocity: Real, yaw_angle: Real) -> Real:
    """Velocity towards the line to the adjacent lane on the right [m/s].

    Args:
        longitudinal_velocity: [m/s].
        yaw_angle: Facing right [rad].
    """
    return -longitudinal_velocity * xp.sin(yaw_angle)


def approach_series(features: NDArray[np.float64]) -> NDArray[np.float64]:
    """Velocity towards the line, `(*batch,)` [m/s], of `(*batch, feature)`."""
    velocity: Any = features[..., _VELOCITY]  # Any: Real stands for arrays too
    yaw: Any = features[..., _YAW]
    with np.errstate(invalid="ignore"):
        return np.asarray(approach_velocity(velocity, yaw))


def scaled(
    features: NDArray[np.float64],
    mean: NDArray[np.float64],
    scale: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Features as standard deviations from the mean of the training set.

    Args:
        features: Shape `(*batch, feature)`.
        mean: Of each feature, in its unit, shape `(feature,)`.
        scale: Standard deviation of each feature, in its unit, shape `(feature,)`.

    Returns:
        Within ±`FEATURE_LIMIT`, same shape; NaN stays NaN.
    """
    return np.clip((features - mean) / scale, -FEATURE_LIMIT, FEATURE_LIMIT)


def network_inputs(
    features: NDArray[np.float64],
    mean: NDArray[np.float64],
    scale: NDArray[np.float64],
) -> NDArray[np.float64]:
    """What enters the network: scaled signals, approach velocity, missing flags.

    The approach velocity is a product of two signals of Eq. (1) and no new one: with it
    the same motion in the lane looks alike at every speed. A missing signal is 0, its
    mean, with its flag at 1.

    Args:
        features: Facing right, NaN where missing, shape `(*batch, feature)`.
        mean: Of the signals and the approach velocity, shape `(7,)`.
        scale: Their standard deviations, shape `(7,)`.

    Returns:
        Shape `(*batch, input)`, in the order of `INPUTS`.
    """
    approach = approach_series(features)
    signals = np.concatenate([features, approach[..., None]], axis=-1)
    values = np.nan_to_num(scaled(signals, mean, scale))
    missing = np.isnan(features).astype(np.float64)
    return np.concatenate([values, missing], axis=-1)
