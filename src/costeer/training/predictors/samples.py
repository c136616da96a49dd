"""Which windows the predictors are fitted on, and the numbers that summarise them.

The same choice as for the network (training/dataset.py): every sixth sample where
something happens, every eighteenth elsewhere with threefold weight, so that weighted
losses are those of natural driving.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import FEATURES, NUM_FEATURES, full_windows
from costeer.intention.predictors.summary import (
    CHANNELS,
    bounded,
    summary,
    summary_names,
)
from costeer.intention.predictors.variants import held_head
from costeer.training.dataset import DatasetParameters, interesting
from costeer.training.recordings import Recording

ALL_COLUMNS = summary_names(FEATURES)


class FeatureScaling(NamedTuple):
    """Mean and standard deviation of each signal, `(feature,)`."""

    mean: NDArray[np.float64]
    scale: NDArray[np.float64]


class Answers(NamedTuple):
    """What is asked of windows, and how much each counts.

    Attributes:
        positive: Whether the car crosses within 3 s, `(window,)`.
        weight: In the loss [-], `(window,)`.
    """

    positive: NDArray[np.bool_]
    weight: NDArray[np.float64]


class Table(NamedTuple):
    """Windows as rows of numbers.

    Attributes:
        numbers: NaN where a signal is missing, `(window, column)`.
        answers: Of the same windows.
    """

    numbers: NDArray[np.float64]
    answers: Answers


def feature_scaling(recordings: Sequence[Recording]) -> FeatureScaling:
    """Over all finite values; mean 0 and scale 1 of a signal that is never there."""
    mean, scale = np.zeros(NUM_FEATURES), np.ones(NUM_FEATURES)
    for index, name in enumerate(FEATURES):
        parts = [r.features[:, index] for r in recordings if name not in r.absent]
        values = np.concatenate([*parts, np.empty(0)])
        values = values[np.isfinite(values)]
        if values.size and values.std() > 0.0:
            mean[index], scale[index] = values.mean(), values.std()
    return FeatureScaling(mean, scale)


def chosen_rows(
    recording: Recording, parameters: DatasetParameters
) -> tuple[NDArray[np.int64], Answers]:
    """Samples of a recording at which windows end, and their answers."""
    usable = full_windows(recording.features, recording.absent)
    hard = interesting(recording, parameters)
    here = np.arange(len(usable))
    close = here % parameters.stride == 0
    far = here % (parameters.stride * parameters.easy_factor) == 0
    chosen = usable & recording.labels.known & np.where(hard, close, far)
    rows = np.flatnonzero(chosen)
    weight = np.where(hard[rows], 1.0, float(parameters.easy_factor))
    return rows, Answers(recording.labels.positive[rows], weight)


def joined(answers: Sequence[Answers]) -> Answers:
    """Answers of several recordings in one row."""
    return Answers(
        positive=np.concatenate([a.positive for a in answers]),
        weight=np.concatenate([a.weight for a in answers]),
    )


def table(numbers: Sequence[NDArray[np.float64]], answers: Sequence[Answers]) -> Table:
    """Rows of several recordings, one below the other.

    Raises:
        ValueError: If there is none, or all are of one class.
    """
    truth = joined(answers)
    if not 0 < truth.positive.sum() < len(truth.positive):
        raise ValueError(
            f"{len(truth.positive)} windows hold {int(truth.positive.sum())} that "
            "precede a crossing; both kinds are needed"
        )
    return Table(np.concatenate(numbers), truth)


def summary_table(
    recordings: Sequence[Recording],
    scaling: FeatureScaling,
    parameters: DatasetParameters,
) -> Table:
    """Windows with the numbers of summary.py, columns as `ALL_COLUMNS`.

    Raises:
        ValueError: If there is none, or all are of one class.
    """
    numbers, answers = [], []
    for one in recordings:
        rows, answer = chosen_rows(one, parameters)
        numbers.append(_summary_rows(one, scaling, rows))
        answers.append(answer)
    return table(numbers, answers)


def _summary_rows(
    recording: Recording, scaling: FeatureScaling, rows: NDArray[np.int64]
) -> NDArray[np.float64]:
    held, seen = held_head(recording.features)
    numbers = summary(bounded(held, *scaling), FEATURES)[rows]
    for index, name in enumerate(ALL_COLUMNS):
        needs = CHANNELS[name.split()[0]].needs
        if set(needs) & set(recording.absent):
            numbers[:, index] = np.nan
        elif "head_yaw" in needs:
            numbers[~seen[rows], index] = np.nan
    return numbers


def columns_of(signals: tuple[str, ...]) -> NDArray[np.int64]:
    """Places in `ALL_COLUMNS` of the columns that these signals give."""
    names = summary_names(signals)
    return np.array([ALL_COLUMNS.index(name) for name in names], np.int64)


def with_columns(data: Table, columns: NDArray[np.int64]) -> Table:
    """Some columns of a table, and only the rows that have them all."""
    numbers = data.numbers[:, columns]
    whole = np.isfinite(numbers).all(axis=1)
    answers = Answers(data.answers.positive[whole], data.answers.weight[whole])
    return Table(numbers[whole], answers)


def thinned(data: Table, seed: int, most: int) -> Table:
    """At most so many rows of a table, drawn without replacement, in their order."""
    rows = np.random.default_rng([seed, 6]).permutation(len(data.numbers))
    rows = np.sort(rows[:most])
    answers = Answers(data.answers.positive[rows], data.answers.weight[rows])
    return Table(data.numbers[rows], answers)


def number_scaling(
    numbers: NDArray[np.float64], weight: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Weighted mean and standard deviation of columns; scale 1 of a constant."""
    mean = np.average(numbers, axis=0, weights=weight)
    scale = np.sqrt(np.average((numbers - mean) ** 2, axis=0, weights=weight))
    return mean, np.where(scale > 1e-9, scale, 1.0)
