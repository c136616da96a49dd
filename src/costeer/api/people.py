"""Virtual drivers, and what predicts where a driver goes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from costeer.api.recordings import File, Recorded, by_name, noted, warn_of
from costeer.api.trials import SUGGESTED_SPEED
from costeer.drivers.driver import DriverParameters
from costeer.drivers.population import participant_driver
from costeer.identification import fit
from costeer.identification.fit import DriverFit
from costeer.identification.recording import doubts_of
from costeer.intention.predictors.chosen import Judge
from costeer.intention.predictors.interface import Predictor
from costeer.loop.outside import any_predictor
from costeer.plant.parameters import CarParameters
from costeer.records.columns import TrialRecord
from costeer.training import evaluate as training
from costeer.training.recordings import Recording, recordings_of
from costeer.training.thresholds import chosen_threshold


def population(
    number: int, seed: int = 1, speed: float = SUGGESTED_SPEED
) -> list[DriverParameters]:
    """The first virtual drivers of a population.

    Args:
        number: How many.
        seed: Other seeds are other people.
        speed: Suggested to them [m/s].

    Raises:
        ValueError: If the number is not 1 or more.

    Example:
        >>> import costeer
        >>> drivers = costeer.population(3)
        >>> [round(driver.arm.stiffness, 1) for driver in drivers]
        [12.0, 11.1, 13.9]
        >>> record = costeer.simulate("weak-rapid", length=200, driver=drivers[1])
    """
    if number < 1:
        raise ValueError(f"number is {number}; give 1 or more drivers")
    return [participant_driver(seed, each, speed) for each in range(1, number + 1)]


def fit_driver(
    recording: Recorded | File, car: File | CarParameters | None = None
) -> DriverFit:
    """The virtual driver who explains a recording of manual driving: docs/fit.md.

    Args:
        recording: A record, its file, a data frame or a mapping of arrays, 60 rows a
            second.
        car: That was driven: a name, parameters, or the file of one; None takes the
            record's, else the default car.

    Raises:
        ValueError: If the recording is assisted, too short, or lacks something.
        OSError: If the file of the car cannot be read.

    Example:
        >>> import costeer
        >>> record = costeer.simulate("manual", length=4000, intention="off")
        >>> fit = costeer.fit_driver(record)
        >>> again = costeer.simulate("manual", length=200, driver=fit.driver)
    """
    record, told = noted(recording)
    warn_of([*told, *doubts_of(record)], 2)
    found = fit.fit_driver(record, by_name(car))
    return found._replace(notes=(*told, *found.notes))


def evaluate(
    predictor: File | Predictor | Judge,
    recordings: Recorded | File | Sequence[Recorded | File],
    *,
    weights: File | None = None,
    threshold: float | None = None,
    false_per_km: float = 0.05,
    resample: bool = False,
) -> dict[str, Any]:
    """Judge what predicts lane crossings on recordings: docs/intention.md.

    Args:
        predictor: "gru" or another name, its place, a `Predictor`, or a function from
            a window, shape `(180, 6)`, to a probability.
        recordings: One or several records, tables or files, 60 rows a second.
        weights: File of the predictor's numbers, .npz or .onnx.
        threshold: Positive from this probability on [-]; that of the weights, else 0.5,
            if None.
        false_per_km: Rate of false triggers at which leads are compared [1/km].
        resample: Bring tables of another rate to 60 Hz.

    Returns:
        Plain numbers, lists and dictionaries: scores over samples and triggers, with
        95 % intervals over drivers. What looks wrong in a recording, or was assumed
        of it, is a `costeer.ReadingWarning`.

    Raises:
        ValueError: If there is no such predictor, or nothing can be judged.
        OSError: If a file cannot be read.

    Example:
        >>> import costeer
        >>> record = costeer.simulate("manual", length=2000, intention="off")
        >>> judged = costeer.evaluate("line-time", record)
        >>> judged["triggers"]["missed"]
        0.0
        >>> never = costeer.evaluate(lambda window: 0.0, record)
        >>> never["triggers"]["true_triggers"]
        0.0
    """
    path = None if weights is None else os.fspath(weights)
    threshold = chosen_threshold(threshold, by_name(predictor), path)
    if not 0.0 < threshold < 1.0 or not false_per_km > 0.0:
        raise ValueError(
            f"threshold is {threshold:g} and false_per_km {false_per_km:g}; give a "
            "threshold between 0 and 1, and a rate above 0"
        )
    single = isinstance(recordings, str | TrialRecord)
    several = isinstance(recordings, Sequence) and not single
    given: Any = recordings if several else [recordings]  # Any: one or several
    stretches: list[Recording] = []
    for place, each in enumerate(given, 1):
        record, told = noted(each)
        stretches += recordings_of(record, f"recording {place}", resample, told)
    warn_of(dict.fromkeys(n for one in stretches for n in one.notes), 2)
    usual = training.DEFAULTS
    asked = usual._replace(
        triggers=usual.triggers._replace(threshold=threshold), false_per_km=false_per_km
    )
    judged = any_predictor(by_name(predictor), path)
    return training.evaluate(judged.probabilities, stretches, asked)
