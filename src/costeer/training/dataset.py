"""From recordings to training windows: who drives, who learns, which samples.

Drivers are split, never their samples: no driver who trained the network judges it.
Windows end at every sixth sample where something happens (positives, glances, drifts
towards the line, the seconds around a lane change) and at every eighteenth elsewhere;
the latter count threefold in the loss. So the loss estimates that of natural driving,
probabilities stay calibrated at natural prevalence, and the batches hold more of what
is hard. No sample is repeated to balance the classes.

A recording of two lanes is shown thrice: as it is, and as the runs to the right and to
the left on a road with more lanes (`recordings.wide_views`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import (
    DISTANCE,
    HEAD_YAW,
    WINDOW_LENGTH,
    full_windows,
    hide,
    network_inputs,
)
from costeer.training.augmentation import (
    ALL_SIGNALS,
    AugmentationParameters,
    augmented,
)
from costeer.training.recordings import Recording, wide_views
from costeer.training.scaling import Scaling


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
        features: Signals of all recordings in their units, NaN where missing, one
            recording after another, `(time, feature)`.
        ends: Row of each window's last sample, `(window,)`.
        positive: 1 where the car crosses within the horizon, else 0, `(window,)`.
        weight: In the loss [-], `(window,)`.
    """

    features: NDArray[np.float32]
    ends: NDArray[np.int64]
    positive: NDArray[np.float32]
    weight: NDArray[np.float32]


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


def interesting(
    recording: Recording, parameters: DatasetParameters
) -> NDArray[np.bool_]:
    """Samples where quiet driving ends: glances, drifts, around lane changes.

    Lane changes are those that the driver meant, in a run those to its side.
    """
    reach = round(parameters.around_crossing * 60.0)
    crossed = np.flatnonzero(recording.intended)
    here = np.arange(len(recording.intended))
    edges = np.concatenate([[-(10**9)], crossed, [10**9]])
    following = np.searchsorted(edges, here, side="right")
    near = np.minimum(here - edges[following - 1], edges[following] - here) <= reach
    with np.errstate(invalid="ignore"):
        glances = recording.features[:, HEAD_YAW] < -parameters.glance
        drifts = recording.features[:, DISTANCE] < parameters.near_line
    return np.asarray(near | glances | drifts | recording.labels.positive)


def shown(recordings: Sequence[Recording]) -> list[Recording]:
    """Recordings as they are and, where they have all signals, on a wider road.

    A run that looks to one side all the time is of such a road already.
    """
    whole = [r for r in recordings if not r.absent and len(np.unique(r.side)) > 1]
    return [*recordings, *(view for r in whole for view in wide_views(r))]


def windows(
    recordings: Sequence[Recording],
    parameters: DatasetParameters,
    needs_both: bool = True,
) -> Windows:
    """Windows that end where the strides say.

    Args:
        recordings: At least one.
        parameters: Which samples end a window.
        needs_both: Whether both classes must be there, as in a training.

    Raises:
        ValueError: If they must, and are not.
    """
    ends, positive, weight, offset = [], [], [], 0
    for one in recordings:
        chosen, weights = _chosen(one, parameters)
        ends.append(chosen + offset)
        positive.append(one.labels.positive[chosen])
        weight.append(weights)
        offset += len(one.features)
    truth = np.concatenate(positive).astype(np.float32)
    if needs_both and not 0 < truth.sum() < len(truth):
        raise ValueError(
            f"{len(truth)} training windows hold {int(truth.sum())} that precede a "
            "crossing; both kinds are needed"
        )
    rows = np.concatenate([hide(r.features, r.absent) for r in recordings])
    return Windows(
        features=rows.astype(np.float32),
        ends=np.concatenate(ends),
        positive=truth,
        weight=np.concatenate(weight).astype(np.float32),
    )


def _chosen(
    recording: Recording, parameters: DatasetParameters
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Rows at which windows end, and their weights."""
    full = full_windows(recording.features, recording.absent)
    usable = full & recording.labels.known
    hard = interesting(recording, parameters)
    here = np.arange(len(usable))
    close = here % parameters.stride == 0
    far = here % (parameters.stride * parameters.easy_factor) == 0
    rows = np.flatnonzero(usable & np.where(hard, close, far))
    return rows, np.where(hard[rows], 1.0, float(parameters.easy_factor))


class Batch(NamedTuple):
    """Windows of one training step.

    Attributes:
        inputs: Of the network, `(window, time, input)`.
        positive: Truth, `(window,)`.
        weight: In the loss [-], `(window,)`.
    """

    inputs: NDArray[np.float32]
    positive: NDArray[np.float32]
    weight: NDArray[np.float32]


def batches(
    data: Windows,
    scale: Scaling,
    size: int,
    seed: int,
    augmentation: AugmentationParameters = ALL_SIGNALS,
) -> Iterator[Batch]:
    """Batches without end; each window comes once per pass, in a new order.

    Args:
        data: Windows of all recordings.
        scale: Of the signals.
        size: Windows in a batch.
        seed: Of the order and of the variants.
        augmentation: In which variants windows are shown.
    """
    rng = np.random.default_rng([seed, 2])
    back = np.arange(1 - WINDOW_LENGTH, 1)
    size = min(size, len(data.ends))
    while True:
        order = rng.permutation(len(data.ends))
        for start in range(0, len(order) - size + 1, size):
            chosen = order[start : start + size]
            rows = data.ends[chosen][:, None] + back
            seen = augmented(augmentation, data.features[rows], rng)
            inputs = network_inputs(seen, scale.mean, scale.scale)
            yield Batch(
                inputs=inputs.astype(np.float32),
                positive=data.positive[chosen],
                weight=data.weight[chosen],
            )
