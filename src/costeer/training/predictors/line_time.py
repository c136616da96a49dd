"""Fit of the threshold on time to lane crossing: a lag, and a logit over log time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.predictors.line_time import (
    NEEDS,
    LineTimeWeights,
    time_to_lane_crossing,
)
from costeer.intention.predictors.store import Baseline
from costeer.training.dataset import DatasetParameters, Split
from costeer.training.predictors.logit import LogitFit, fit_logit, logit_loss
from costeer.training.predictors.samples import Table, chosen_rows, table
from costeer.training.recordings import Recording


class LineTimeParameters(NamedTuple):
    """What the validation drivers choose from.

    Attributes:
        time_constants: Of the lag on the velocity towards the line [s]. Source:
            assumed, from none to that of a lane change.
    """

    time_constants: tuple[float, ...] = (0.0, 0.1, 0.2, 0.4, 0.8)


DEFAULTS = LineTimeParameters()


def log_times(
    recordings: Sequence[Recording], time_constant: float, dataset: DatasetParameters
) -> Table:
    """Windows with the logarithm of their time to lane crossing, one column."""
    numbers, answers = [], []
    for one in recordings:
        if set(NEEDS) & set(one.absent):
            continue
        rows, answer = chosen_rows(one, dataset)
        time = time_to_lane_crossing(one.features, time_constant)
        numbers.append(np.log(time[rows])[:, None])
        answers.append(answer)
    return table(numbers, answers)


def fit_line_time(
    split: Split,
    dataset: DatasetParameters,
    parameters: LineTimeParameters = DEFAULTS,
) -> Baseline:
    """Fit on the training drivers with the lag that suits the validation drivers.

    Raises:
        ValueError: If no recording has the signals, or all windows are of one class.
    """
    fits: dict[float, LogitFit] = {}
    losses: dict[float, float] = {}
    for lag in parameters.time_constants:
        training = log_times(split.training, lag, dataset)
        validation = log_times(split.validation, lag, dataset)
        fits[lag] = fit_logit(*training)
        losses[lag] = logit_loss(_logit(fits[lag], validation.numbers), validation[1])
    best = min(losses, key=lambda lag: losses[lag])
    weights = LineTimeWeights(
        time_constant=np.array([best]),
        intercept=np.array([fits[best].intercept]),
        slope=fits[best].coefficients,
    )
    looked = {f"{lag:g} s": loss for lag, loss in losses.items()}
    return Baseline({"motion": weights}, {"validation_log_loss": looked})


def _logit(fit: LogitFit, numbers: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(numbers @ fit.coefficients + fit.intercept)
