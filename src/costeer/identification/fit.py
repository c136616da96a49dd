"""A driver fitted to one recording of manual driving."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from costeer.drivers.driver import DriverParameters
from costeer.identification.direct import Direct, direct_estimates
from costeer.identification.drive import Drive
from costeer.identification.estimate import (
    Maximum,
    Weakest,
    alone,
    deviations,
    half_width,
    maximise,
)
from costeer.identification.likelihood import Evidence, predicted
from costeer.identification.model import wheel_motion
from costeer.identification.parameters import (
    NOT_IDENTIFIED,
    STEERING,
    NotIdentified,
    Parameter,
    driver_at,
    natural,
    value_of,
    with_value,
)
from costeer.identification.recording import drive_of
from costeer.identification.stretches import (
    MARGIN_BEFORE,
    SHORTEST,
    changes,
    completed,
    lane_keeping,
    total_time,
)
from costeer.loop.columns import TrialRecord

SHORTEST_FIT = 60.0
"""Lane keeping that a fit needs in all [s]: about ten swings of the wander."""
WHITE = 0.05
"""Largest autocorrelation of prediction errors that is chance [-]: of 15,000 samples
one is within 0.016 in 95 of 100, the largest of 30 within 0.03."""
WIDEST = 1.0
"""Largest standard error of a logarithm that still says something [-]."""
WIDEST_SHIFT = 0.5
"""The same of a signed quantity, in its unit."""

_NEAR_LIMIT = 0.1


class Estimate(NamedTuple):
    """A parameter of the driver, as the recording tells it.

    Attributes:
        name: Part of the driver and field, as in `vision.lead_time`.
        value: Best estimate.
        low: Lower end of the 95 % interval.
        high: Upper end.
        unit: Of all three.
        how: Of the estimate and its interval.
    """

    name: str
    value: float
    low: float
    high: float
    unit: str
    how: str


class DriverFit(NamedTuple):
    """What a recording tells of its driver.

    Attributes:
        driver: With the estimates; what is not identified has its usual value.
        estimates: Of the identifiable set, with 95 % intervals.
        not_identified: What this recording, or any, does not tell, and why.
        lane_keeping: How long the stretches of lane keeping are together [s].
        num_changes: Completed lane changes.
        prediction_error: Standard deviation of torque less its prediction [N·m].
        whiteness: Largest autocorrelation of the standardised prediction errors over
            lags up to 0.5 s; about 0.03 for a driver of the model [-].
        notes: What the reader should know.
    """

    driver: DriverParameters
    estimates: tuple[Estimate, ...]
    not_identified: tuple[NotIdentified, ...]
    lane_keeping: float
    num_changes: int
    prediction_error: float
    whiteness: float
    notes: tuple[str, ...]


class _Steering(NamedTuple):
    """The part of the fit that the likelihood gives."""

    driver: DriverParameters
    estimates: list[Estimate]
    missing: list[NotIdentified]
    notes: list[str]


def fit_driver(record: TrialRecord, car: str | None = None) -> DriverFit:
    """Fit a driver to a recording of manual driving.

    Args:
        record: Trial record, or a table with the columns of
            `identification.recording.NEEDED`.
        car: Name of the car that was driven; None takes the record's, else the
            default car.

    Raises:
        ValueError: If the recording is assisted, too short, sampled at another rate,
            has gaps, lacks columns, or shows no hands on the wheel.
    """
    drive = drive_of(record, car)
    found = changes(drive)
    rows = lane_keeping(drive, found)
    _check_length(drive, rows)
    usual = DriverParameters()
    evidence = Evidence(drive, wheel_motion(drive, usual.arm), rows)
    steering = _steering(usual, evidence)
    direct = direct_estimates(drive, found)
    errors, whiteness = _residuals(steering.driver, evidence)
    return DriverFit(
        driver=_with_direct(steering.driver, direct),
        estimates=(*steering.estimates, *_known(direct)),
        not_identified=(*steering.missing, *_unknown(direct), *NOT_IDENTIFIED),
        lane_keeping=total_time(drive, rows),
        num_changes=len(completed(drive, found)),
        prediction_error=errors,
        whiteness=whiteness,
        notes=tuple(steering.notes),
    )


def _check_length(drive: Drive, rows: list[slice]) -> None:
    total = total_time(drive, rows)
    if total < SHORTEST_FIT:
        raise ValueError(
            f"the recording has {total:.0f} s of lane keeping in stretches of "
            f"{SHORTEST:g} s or more, {MARGIN_BEFORE:g} s and more away from lane "
            f"changes; a fit needs {SHORTEST_FIT:g} s: give a longer recording"
        )


def _steering(usual: DriverParameters, evidence: Evidence) -> _Steering:
    """Estimate the parameters of the steering that the recording excites.

    What it does not tell keeps its usual value, and the others are estimated anew.
    """
    errors = alone(usual, STEERING, evidence)
    reasons = {
        p.name: _too_unsure(p, float(error), evidence)
        for p, error in zip(STEERING, errors, strict=True)
    }
    told = [p for p in STEERING if not reasons[p.name]]
    while told:
        best = maximise(usual, told, evidence)
        unsure = _unsure(best, told, evidence)
        if not unsure:
            return _told(usual, told, best, reasons)
        reasons |= unsure
        told = [p for p in told if p.name not in unsure]
    raise ValueError(
        "the recording tells nothing of the steering: "
        + "; ".join(f"{name}: {reason}" for name, reason in reasons.items())
    )


def _told(
    usual: DriverParameters,
    told: list[Parameter],
    best: Maximum,
    reasons: dict[str, str],
) -> _Steering:
    driver = driver_at(usual, told, best.point)
    errors = np.sqrt(np.diag(np.linalg.inv(best.information)))
    return _Steering(
        driver=driver,
        estimates=[
            _estimate(parameter, driver, float(error))
            for parameter, error in zip(told, errors, strict=True)
        ],
        missing=[
            NotIdentified(name, f"{why}; held at the usual value")
            for name, why in reasons.items()
            if why
        ],
        notes=[] if best.converged else ["the search for the best driver did not end"],
    )


def _unsure(best: Maximum, told: list[Parameter], evidence: Evidence) -> dict[str, str]:
    """The parameter that is told least and why; empty if each is told well enough."""
    errors = deviations(best.information)
    if isinstance(errors, Weakest):
        name, other = told[errors.first].name, told[errors.second].name
        beside = f" apart from {other}" if name != other else ""
        return {name: f"the recording does not tell it{beside}: too little excitation"}
    for parameter, value in zip(told, natural(told, best.point), strict=True):
        room = _NEAR_LIMIT * (abs(parameter.low) + abs(parameter.high)) / 2.0
        if parameter.positive:
            room = _NEAR_LIMIT * value
        if value - parameter.low < room or parameter.high - value < room:
            limits = f"{parameter.low:g} to {parameter.high:g} {parameter.unit}"
            return {parameter.name: f"the best value is at a limit of {limits}"}
    worst = int((errors / [_widest(p) for p in told]).argmax())
    reason = _too_unsure(told[worst], float(errors[worst]), evidence)
    return {told[worst].name: reason} if reason else {}


def _widest(parameter: Parameter) -> float:
    return WIDEST if parameter.positive else WIDEST_SHIFT


def _too_unsure(parameter: Parameter, deviation: float, evidence: Evidence) -> str:
    """Why a standard error says that a parameter is not told; empty if it is."""
    if deviation <= _widest(parameter):
        return ""
    angle = evidence.drive.steering_wheel_angle
    if not math.isfinite(deviation) and float(np.ptp(angle)) == 0.0:
        return "the wheel never moves, and nothing else depends on it"
    if not math.isfinite(deviation):
        return "the likelihood does not depend on it in this recording"
    size = f"{100.0 * deviation:.0f} %" if parameter.positive else f"{deviation:.2g} m"
    return f"its standard error would be {size}: too little excitation"


def _estimate(
    parameter: Parameter, driver: DriverParameters, deviation: float
) -> Estimate:
    value, half = value_of(driver, parameter.name), half_width(deviation)
    grown = math.exp(half)
    low, high = (
        (value / grown, value * grown)
        if parameter.positive
        else (value - half, value + half)
    )
    how = "maximum likelihood of the torque"
    if parameter.tied:
        how += f"; {', '.join(parameter.tied)} in the usual ratio"
    return Estimate(parameter.name, value, low, high, parameter.unit, how)


def _known(direct: list[Direct]) -> list[Estimate]:
    return [Estimate(*each) for each in direct if math.isfinite(each.value)]


def _unknown(direct: list[Direct]) -> list[NotIdentified]:
    return [
        NotIdentified(each.name, each.how)
        for each in direct
        if not math.isfinite(each.value)
    ]


def _with_direct(driver: DriverParameters, direct: list[Direct]) -> DriverParameters:
    for each in _known(direct):
        driver = with_value(driver, each.name, each.value)
    return driver


def _residuals(driver: DriverParameters, evidence: Evidence) -> tuple[float, float]:
    """Deviation of the prediction errors [N·m], and how far they are from white."""
    found = predicted(driver, evidence)
    standard = found.errors / np.sqrt(found.variances)
    standard = (standard - standard.mean()) / standard.std()
    lags = range(1, round(0.5 / evidence.drive.dt) + 1)
    together = [abs(float(np.mean(standard[k:] * standard[:-k]))) for k in lags]
    return float(found.errors.std()), max(together)
