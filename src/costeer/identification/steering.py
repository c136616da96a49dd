"""The steering of a driver: what the likelihood tells, and what it does not."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from costeer.drivers.driver import DriverParameters
from costeer.identification.estimate import (
    Maximum,
    Vector,
    Weakest,
    alone,
    deviations,
    half_width,
    likeliest_noise,
    maximise,
    observed_information,
)
from costeer.identification.likelihood import NO_NOISE, Evidence
from costeer.identification.parameters import (
    STEERING,
    Estimate,
    NotIdentified,
    Parameter,
    value_of,
)

WIDEST = 1.0
"""Largest standard error of a logarithm that still says something [-]."""
WIDEST_SHIFT = 0.5
"""The same of a signed quantity, in its unit."""

_NEAR_LIMIT = 0.1
_MOVED = ("arm.damping", "arm.inertia")
_MOST_TURNS = 8
_SAME_NOISE = 0.05


class Steering(NamedTuple):
    """The part of a fit that the likelihood gives.

    Attributes:
        driver: With the estimates.
        estimates: With their intervals.
        missing: Parameters that this recording does not tell, and why.
        notes: What the reader should know.
        evidence: With the noise of the measured torque.
    """

    driver: DriverParameters
    estimates: list[Estimate]
    missing: list[NotIdentified]
    notes: list[str]
    evidence: Evidence


def fit_steering(usual: DriverParameters, evidence: Evidence) -> Steering:
    """Estimate the parameters of the steering that the recording excites.

    What it does not tell keeps its usual value, and the others are estimated anew.

    Args:
        usual: Where the search begins; gives what is not searched.
        evidence: Recording and stretches.

    Raises:
        ValueError: If the recording tells nothing of the steering.
    """
    errors = alone(usual, STEERING, evidence)
    reasons = {
        p.name: _too_unsure(p, float(error), evidence)
        for p, error in zip(STEERING, errors, strict=True)
    }
    told = [p for p in STEERING if not reasons[p.name]]
    while told:
        best, evidence = _settled(usual, told, evidence)
        noisy = _blurred(told, evidence)
        if noisy:
            reasons |= noisy
            told = [p for p in told if p.name not in noisy]
            continue
        information = observed_information(best.driver, told, evidence)
        unsure = _unsure(best.driver, told, information, evidence)
        if not unsure:
            return _told(best, told, information, evidence, reasons)
        reasons |= unsure
        told = [p for p in told if p.name not in unsure]
    raise ValueError(
        "the recording tells nothing of the steering: "
        + "; ".join(f"{name}: {reason}" for name, reason in reasons.items())
    )


def _blurred(told: list[Parameter], evidence: Evidence) -> dict[str, str]:
    """Parameters that noise of the measured torque hides, and why."""
    deviation = evidence.noise.deviation
    if deviation <= NO_NOISE.deviation:
        return {}
    reason = (
        f"the measured torque has noise of {deviation:.2g} N·m: what moves the arms is "
        "not told from it"
    )
    return {p.name: reason for p in told if p.name in _MOVED}


def _settled(
    usual: DriverParameters, told: list[Parameter], evidence: Evidence
) -> tuple[Maximum, Evidence]:
    """The best driver with the torque noise that goes with it, found in turns."""
    best = maximise(usual, told, evidence)
    for _ in range(_MOST_TURNS):
        noise = likeliest_noise(best.driver, evidence)
        if abs(noise.deviation / evidence.noise.deviation - 1.0) < _SAME_NOISE:
            break
        evidence = evidence._replace(noise=noise)
        best = maximise(usual, told, evidence)
    return best, evidence


def _told(
    best: Maximum,
    told: list[Parameter],
    information: Vector,
    evidence: Evidence,
    reasons: dict[str, str],
) -> Steering:
    errors = np.sqrt(np.diag(np.linalg.inv(information)))
    return Steering(
        driver=best.driver,
        estimates=[
            _estimate(parameter, best.driver, float(error))
            for parameter, error in zip(told, errors, strict=True)
        ],
        missing=[
            NotIdentified(name, f"{why}; held at the usual value")
            for name, why in reasons.items()
            if why
        ],
        notes=_notes(best, evidence),
        evidence=evidence,
    )


def _notes(best: Maximum, evidence: Evidence) -> list[str]:
    """What the reader should know of a search and of the torque it looked at."""
    notes = [] if best.converged else ["the search for the best driver did not end"]
    deviation = evidence.noise.deviation
    if deviation > NO_NOISE.deviation:
        notes.append(
            f"the measured torque has noise of {deviation:.2g} N·m; from 0.02 N·m the "
            "stiffness comes out 5 to 20 % too low"
        )
    return notes


def _unsure(
    driver: DriverParameters,
    told: list[Parameter],
    information: Vector,
    evidence: Evidence,
) -> dict[str, str]:
    """The parameter that is told least and why; empty if each is told well enough."""
    errors = deviations(information)
    if isinstance(errors, Weakest):
        name, other = told[errors.first].name, told[errors.second].name
        beside = f" apart from {other}" if name != other else ""
        return {name: f"the recording does not tell it{beside}: too little excitation"}
    for parameter in told:
        if _at_a_limit(parameter, value_of(driver, parameter.name)):
            limits = f"{parameter.low:g} to {parameter.high:g} {parameter.unit}"
            return {parameter.name: f"the best value is at a limit of {limits}"}
    worst = int((errors / [_widest(p) for p in told]).argmax())
    reason = _too_unsure(told[worst], float(errors[worst]), evidence)
    return {told[worst].name: reason} if reason else {}


def _at_a_limit(parameter: Parameter, value: float) -> bool:
    """Whether a value is as good as at a limit of what is searched."""
    room = _NEAR_LIMIT * (value if parameter.positive else parameter.high)
    return value - parameter.low < room or parameter.high - value < room


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
