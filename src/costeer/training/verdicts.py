"""What a predictor says over recordings, driver by driver."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.predictors.interface import Probabilities
from costeer.training.recordings import Recording


class DriverVerdicts(NamedTuple):
    """Everything that is judged of one driver.

    Attributes:
        driver: Who.
        recordings: His or her stretches.
        probabilities: Verdicts of each stretch, NaN where none, `(time,)` each.
    """

    driver: str
    recordings: list[Recording]
    probabilities: list[NDArray[np.float64]]


def verdicts(
    predict: Probabilities, recordings: Sequence[Recording]
) -> list[DriverVerdicts]:
    """Ask a predictor over all recordings, by driver in order of name."""
    return by_driver(recordings, asked(predict, recordings))


def asked(
    predict: Probabilities, recordings: Sequence[Recording]
) -> list[NDArray[np.float64]]:
    """Verdicts on each recording, NaN where none, `(time,)` each."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(lambda r: predict(r.features, r.absent), recordings))


def by_driver(
    recordings: Sequence[Recording], probabilities: Sequence[NDArray[np.float64]]
) -> list[DriverVerdicts]:
    """Recordings and what was said of them, by driver in order of name.

    What was said where the answer is not known, near the end of a recording, is left
    out: a trigger there is neither true nor false.
    """
    grouped: dict[str, DriverVerdicts] = {
        name: DriverVerdicts(name, [], [])
        for name in sorted({r.driver for r in recordings})
    }
    for recording, said in zip(recordings, probabilities, strict=True):
        grouped[recording.driver].recordings.append(recording)
        judged = np.where(recording.labels.known, said, np.nan)
        grouped[recording.driver].probabilities.append(judged)
    return list(grouped.values())


def judged_samples(
    drivers: Sequence[DriverVerdicts],
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Probability and truth wherever both are known, all drivers in one row."""
    said, truth = [np.empty(0)], [np.empty(0, np.bool_)]
    for one in drivers:
        for recording, probability in zip(
            one.recordings, one.probabilities, strict=True
        ):
            rows = np.isfinite(probability) & recording.labels.known
            said.append(probability[rows])
            truth.append(recording.labels.positive[rows])
    return np.concatenate(said), np.concatenate(truth)
