"""From recordings to training windows: who drives, who learns, which samples.

Drivers are split, never their samples: no driver who trained the network judges it.
Windows end at every sixth sample where something happens (positives, glances, drifts
towards the line, the seconds around a lane change) and at every eighteenth elsewhere;
the latter count threefold in the loss. So the loss estimates that of natural driving,
probabilities stay calibrated at natural prevalence, and the batches hold more of what
is hard. No sample is repeated to balance the classes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import (
    FEATURES,
    NUM_FEATURES,
    WINDOW_LENGTH,
    scaled,
)
from costeer.loop.scenario import TrialSetup
from costeer.loop.trial import simulate_trial
from costeer.training.recordings import Recording, recordings_of

FIRST_PARTICIPANT = 100_001
"""Number of the first simulated driver; those of studies count from 1."""

SPEEDS_KMH = (70.0, 60.0, 80.0, 70.0, 90.0, 50.0, 70.0, 100.0)
"""Suggested speeds that simulated drivers take in turn [km/h]; studies drive 70."""

_HEAD = FEATURES.index("head_yaw")
_DISTANCE = FEATURES.index("distance_to_adjacent_lane")


class DatasetParameters(NamedTuple):
    """Who is in which part, and which samples end a window.

    Attributes:
        validation_share: Share of drivers that stop the training and choose the
            hidden size [-]. Source: assumed.
        test_share: Share of drivers that judge the result [-]. Source: assumed.
        stride: Samples between windows where something happens [-]. Source: assumed,
            0.1 s; neighbours tell nothing new.
        easy_factor: Windows of quiet driving are so much rarer and weigh as much more
            [-]. Source: assumed.
        glance: Head yaw towards the adjacent side that counts as a glance [-].
            Source: assumed, a third of a look into the mirror.
        near_line: Distance to the boundary that counts as a drift [m]. Source:
            assumed, half of the usual distance in a 3.5 m lane.
        around_crossing: Time after and before a crossing where every window is of
            interest [s]. Source: assumed, twice the prediction horizon.
    """

    validation_share: float = 0.2
    test_share: float = 0.2
    stride: int = 6
    easy_factor: int = 3
    glance: float = 0.2
    near_line: float = 0.9
    around_crossing: float = 6.0


class Split(NamedTuple):
    """Recordings of disjoint sets of drivers."""

    training: list[Recording]
    validation: list[Recording]
    test: list[Recording]


class Windows(NamedTuple):
    """Windows to train on.

    Attributes:
        features: Scaled signals of all recordings, one after another,
            `(time, feature)`.
        ends: Row of each window's last sample, `(window,)`.
        positive: 1 where the car crosses within the horizon, else 0, `(window,)`.
        weight: In the loss [-], `(window,)`.
    """

    features: NDArray[np.float32]
    ends: NDArray[np.int64]
    positive: NDArray[np.float32]
    weight: NDArray[np.float32]


def simulate_recordings(
    num_drivers: int,
    seed: int,
    jobs: int = 1,
    progress: Callable[[int], None] | None = None,
) -> list[Recording]:
    """Manual trials of virtual drivers, one each, with other drivers than any study.

    Args:
        num_drivers: How many.
        seed: Of the population and of all noise.
        jobs: Threads.
        progress: Told after each trial.
    """
    speeds = len(SPEEDS_KMH)
    setups = [
        TrialSetup(
            participant=FIRST_PARTICIPANT + i,
            seed=seed,
            condition="manual",
            method="manual",
            change_duration=math.nan,
            speed=SPEEDS_KMH[i % speeds] / 3.6,
            intention="off",
        )
        for i in range(num_drivers)
    ]
    found: list[Recording] = []
    with ThreadPoolExecutor(jobs) as pool:
        for setup, record in zip(setups, pool.map(simulate_trial, setups), strict=True):
            found += recordings_of(record, f"simulated driver {setup.participant}")
            if progress:
                progress(1)
    return found


def split_by_driver(
    recordings: Sequence[Recording], seed: int, parameters: DatasetParameters
) -> Split:
    """Deal the drivers to training, validation and test.

    Raises:
        ValueError: If there are fewer than three drivers.
    """
    drivers = sorted({r.driver for r in recordings})
    if len(drivers) < 3:
        raise ValueError(
            f"the recordings are of {len(drivers)} driver(s): {', '.join(drivers)}; "
            "training, validation and test need different ones, at least 3"
        )
    order = np.random.default_rng([seed, 1]).permutation(len(drivers))
    num_validation = max(1, round(parameters.validation_share * len(drivers)))
    num_test = max(1, round(parameters.test_share * len(drivers)))
    part = {
        drivers[driver]: 0
        if i < num_validation
        else 1
        if i < num_validation + num_test
        else 2
        for i, driver in enumerate(order)
    }
    return Split(
        validation=[r for r in recordings if part[r.driver] == 0],
        test=[r for r in recordings if part[r.driver] == 1],
        training=[r for r in recordings if part[r.driver] == 2],
    )


def scaling(
    recordings: Sequence[Recording],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean and standard deviation of each signal over all valid samples.

    Raises:
        ValueError: If a signal never changes or is never valid.
    """
    rows = np.concatenate([r.features for r in recordings])
    rows = rows[np.isfinite(rows).all(axis=1)]
    if len(rows) == 0:
        raise ValueError("no sample of the recordings has all six signals")
    mean, scale = rows.mean(axis=0), rows.std(axis=0)
    for name, deviation in zip(FEATURES, scale, strict=True):
        if not deviation > 0.0:
            raise ValueError(
                f"{name} never changes in the training recordings; a network needs "
                "signals that do"
            )
    return mean, scale


def full_windows(features: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether a window of 180 valid samples ends at each sample, shape `(time,)`."""
    valid = np.asarray(np.isfinite(features).all(axis=1))
    bad = np.where(valid, -1, np.arange(len(valid)))
    since = np.arange(len(valid)) - np.maximum.accumulate(bad)
    return np.asarray(since >= WINDOW_LENGTH)


def interesting(
    recording: Recording, parameters: DatasetParameters
) -> NDArray[np.bool_]:
    """Samples where quiet driving ends: glances, drifts, around lane changes."""
    reach = round(parameters.around_crossing * 60.0)
    crossed = np.flatnonzero(recording.intended)
    here = np.arange(len(recording.intended))
    edges = np.concatenate([[-(10**9)], crossed, [10**9]])
    following = np.searchsorted(edges, here, side="right")
    near = np.minimum(here - edges[following - 1], edges[following] - here) <= reach
    with np.errstate(invalid="ignore"):
        glances = recording.features[:, _HEAD] < -parameters.glance
        drifts = recording.features[:, _DISTANCE] < parameters.near_line
    return np.asarray(near | glances | drifts | recording.labels.positive)


def windows(
    recordings: Sequence[Recording],
    mean: NDArray[np.float64],
    scale: NDArray[np.float64],
    parameters: DatasetParameters,
) -> Windows:
    """Windows that end where the strides say.

    Raises:
        ValueError: If there is none, or all are of one class.
    """
    ends, positive, weight, offset = [], [], [], 0
    for one in recordings:
        chosen, weights = _chosen(one, parameters)
        ends.append(chosen + offset)
        positive.append(one.labels.positive[chosen])
        weight.append(weights)
        offset += len(one.features)
    rows = np.concatenate([r.features for r in recordings])
    truth = np.concatenate(positive).astype(np.float32)
    if not 0 < truth.sum() < len(truth):
        raise ValueError(
            f"{len(truth)} training windows hold {int(truth.sum())} that precede a "
            "crossing; both kinds are needed"
        )
    return Windows(
        features=np.nan_to_num(scaled(rows, mean, scale)).astype(np.float32),
        ends=np.concatenate(ends),
        positive=truth,
        weight=np.concatenate(weight).astype(np.float32),
    )


def _chosen(
    recording: Recording, parameters: DatasetParameters
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Rows at which windows end, and their weights."""
    usable = full_windows(recording.features) & recording.labels.known
    hard = interesting(recording, parameters)
    here = np.arange(len(usable))
    close = here % parameters.stride == 0
    far = here % (parameters.stride * parameters.easy_factor) == 0
    rows = np.flatnonzero(usable & np.where(hard, close, far))
    return rows, np.where(hard[rows], 1.0, float(parameters.easy_factor))


def batches(
    data: Windows, size: int, seed: int
) -> Iterator[tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]]:
    """Batches without end; each window comes once per pass, in a new order.

    Yields:
        Features `(batch, time, feature)`, truth and weight `(batch,)`.
    """
    rng = np.random.default_rng([seed, 2])
    back = np.arange(1 - WINDOW_LENGTH, 1)
    size = min(size, len(data.ends))
    while True:
        order = rng.permutation(len(data.ends))
        for start in range(0, len(order) - size + 1, size):
            chosen = order[start : start + size]
            rows = data.ends[chosen][:, None] + back
            batch = data.features[rows].reshape(size, WINDOW_LENGTH, NUM_FEATURES)
            yield batch, data.positive[chosen], data.weight[chosen]
