"""A driver fitted to one recording of manual driving.

What is fitted is the linear driver of population 2, who follows what is seen all the
time: of this one the likelihood is exact. Of a driver who lets things go (population 3)
it is the linear core.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from costeer.drivers.driver import DriverParameters
from costeer.drivers.population import SECOND
from costeer.identification.direct import direct_estimates
from costeer.identification.likelihood import Evidence, predicted
from costeer.identification.model import wheel_motion
from costeer.identification.parameters import (
    NOT_IDENTIFIED,
    Estimate,
    NotIdentified,
    with_value,
)
from costeer.identification.recording import doubts_of, drive_of
from costeer.identification.signals import Drive
from costeer.identification.steering import fit_steering
from costeer.identification.stretches import (
    MARGIN_BEFORE,
    SHORTEST,
    changes,
    completed,
    lane_keeping,
    total_time,
)
from costeer.plant.parameters import CarParameters
from costeer.records.columns import TrialRecord

SHORTEST_FIT = 60.0
"""Lane keeping that a fit needs in all [s]: about ten swings of the wander."""
USUAL = SECOND.usual
"""The driver whose values are kept where the recording does not tell."""
WHITE = 0.05
"""Autocorrelation of prediction errors that is no matter however long a recording is
[-]. Source: assumed, above what drivers of the model show in 8 km, 0.01 to 0.03."""
_CHANCE = 4.0
"""Of n independent errors an autocorrelation has the deviation 1/sqrt(n); the largest
of 30 passes four of them in one recording of 500 [-]."""


class DriverFit(NamedTuple):
    """What a recording tells of its driver.

    Attributes:
        driver: With the estimates; what is not identified is as in `USUAL`.
        estimates: Of the identifiable set, with 95 % intervals.
        not_identified: What this recording, or any, does not tell, and why.
        lane_keeping: How long the stretches of lane keeping are together [s].
        num_changes: Completed lane changes.
        torque_noise: Standard deviation of the measured torque's noise [N·m].
        prediction_error: Standard deviation of torque less its prediction [N·m].
        whiteness: Largest autocorrelation of the standardised prediction errors over
            lags up to 0.5 s; about 0.03 for a driver of the model [-].
        white_limit: Above it that is no chance [-]: `WHITE`, or more where there are
            few samples.
        notes: What the reader should know.
    """

    driver: DriverParameters
    estimates: tuple[Estimate, ...]
    not_identified: tuple[NotIdentified, ...]
    lane_keeping: float
    num_changes: int
    torque_noise: float
    prediction_error: float
    whiteness: float
    white_limit: float
    notes: tuple[str, ...]


def fit_driver(
    record: TrialRecord, car: str | CarParameters | None = None
) -> DriverFit:
    """Fit a driver to a recording of manual driving.

    Args:
        record: Trial record, or a table with the columns of
            `identification.recording.NEEDED`.
        car: That was driven: parameters, a name, or the file of one; None takes the
            record's, else the default car.

    Raises:
        ValueError: If the recording is assisted, too short, sampled at another rate,
            has gaps, lacks columns, or shows no hands on the wheel.
    """
    drive = drive_of(record, car)
    found = changes(drive)
    rows = lane_keeping(drive, found)
    _check_length(drive, rows)
    evidence = Evidence(drive, wheel_motion(drive, USUAL.arm), rows)
    steering = fit_steering(USUAL, evidence)
    direct = direct_estimates(drive, found)
    errors, whiteness, white_limit = _residuals(steering.driver, steering.evidence)
    return DriverFit(
        driver=_with_direct(steering.driver, direct),
        estimates=(*steering.estimates, *_known(direct)),
        not_identified=(*steering.missing, *_unknown(direct), *NOT_IDENTIFIED),
        lane_keeping=total_time(drive, rows),
        num_changes=len(completed(drive, found)),
        torque_noise=steering.evidence.noise.deviation,
        prediction_error=errors,
        whiteness=whiteness,
        white_limit=white_limit,
        notes=(*doubts_of(record), *steering.notes),
    )


def _check_length(drive: Drive, rows: list[slice]) -> None:
    total = total_time(drive, rows)
    if total < SHORTEST_FIT:
        told = math.floor(total * 10.0) / 10.0  # not rounded up to what is enough
        raise ValueError(
            f"the recording has {told:.1f} s of lane keeping in stretches of "
            f"{SHORTEST:g} s or more, {MARGIN_BEFORE:g} s and more away from lane "
            f"changes; a fit needs {SHORTEST_FIT:.1f} s: give a longer recording"
        )


def _known(direct: list[Estimate]) -> list[Estimate]:
    return [each for each in direct if math.isfinite(each.value)]


def _unknown(direct: list[Estimate]) -> list[NotIdentified]:
    return [
        NotIdentified(each.name, each.how)
        for each in direct
        if not math.isfinite(each.value)
    ]


def _with_direct(driver: DriverParameters, direct: list[Estimate]) -> DriverParameters:
    for each in _known(direct):
        driver = with_value(driver, each.name, each.value)
    return driver


def _residuals(
    driver: DriverParameters, evidence: Evidence
) -> tuple[float, float, float]:
    """Deviation of the prediction errors [N·m], how far from white, and the limit."""
    found = predicted(driver, evidence)
    standard = found.errors / np.sqrt(found.variances)
    standard = (standard - standard.mean()) / standard.std()
    lags = range(1, round(0.5 / evidence.drive.dt) + 1)
    together = [abs(float(np.mean(standard[k:] * standard[:-k]))) for k in lags]
    limit = max(WHITE, _CHANCE / math.sqrt(standard.size))
    return float(found.errors.std()), max(together), limit
