"""Maximum likelihood: where the driver explains the torque best, and how surely.

The search is Newton's within a trust region; the curvature it uses is the expected
one, which needs first derivatives of the predictions only (Fisher's scoring).
Intervals come from the observed information, the curvature of the likelihood itself.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize, minimize_scalar
from scipy.stats import norm

from costeer.drivers.driver import DriverParameters
from costeer.identification.likelihood import (
    NO_NOISE,
    Evidence,
    Prediction,
    TorqueNoise,
    log_likelihoods,
    predicted,
)
from costeer.identification.parameters import (
    Parameter,
    coordinates,
    driver_at,
    natural,
)

Vector = NDArray[np.float64]

CONFIDENCE = 0.95
_STEP = 1e-4
_CLOSE_ENOUGH = 1e-2
"""Largest gradient per standard error at a maximum."""
_NEARLY = 0.3
"""The same at a maximum that rounding blurs."""
_SINGULAR = 1e-5
"""Eigenvalue of a scaled information below which parameters are not told apart [-]; a
trial of 8 km has 3e-3 (benchmarks/driver_recovery.py)."""
_LEAST_NOISE = 5e-4
"""Less noise of the torque than this is none [N·m]: a fiftieth of what a step of the
driver's own noise gives."""
_MOST_NOISE = 1.0
_OPTIONS = {
    "gtol": _CLOSE_ENOUGH,
    "max_trust_radius": 1e3,
    "initial_trust_radius": 10.0,
    "maxiter": 60,
}


class Maximum(NamedTuple):
    """The driver who explains a recording best.

    Attributes:
        driver: With the parameters that were searched.
        log_likelihood: Of the recording [-].
        converged: Whether the gradient vanishes there.
    """

    driver: DriverParameters
    log_likelihood: float
    converged: bool


class _Slopes(NamedTuple):
    """Derivatives at a point: of the likelihood, and its expected curvature."""

    gradient: Vector
    curvature: Vector


class _Objective:
    """The likelihood as the optimiser asks for it; the last slopes are remembered."""

    def __init__(
        self,
        start: DriverParameters,
        parameters: Sequence[Parameter],
        evidence: Evidence,
    ) -> None:
        self.start, self.parameters, self.evidence = start, parameters, evidence
        self._at: Vector | None = None
        self._slopes = _Slopes(np.zeros(0), np.zeros((0, 0)))

    def predicted(self, point: Vector) -> Prediction:
        """One-step predictions of the driver at a point."""
        driver = driver_at(self.start, self.parameters, point)
        return predicted(driver, self.evidence)

    def value(self, point: Vector) -> float:
        """Negative log-likelihood; infinite outside the range that is searched."""
        values = natural(self.parameters, point)
        pairs = zip(self.parameters, values, strict=True)
        if not all(p.low <= value <= p.high for p, value in pairs):
            return np.inf
        return -float(log_likelihoods(self.predicted(point)).sum())

    def slopes(self, point: Vector) -> _Slopes:
        """Gradient and expected curvature of `value`, by central differences."""
        if self._at is None or not np.array_equal(self._at, point):
            self._at, self._slopes = point.copy(), self._differences(point)
        return self._slopes

    def _differences(self, point: Vector) -> _Slopes:
        here = self.predicted(point)
        steps = _STEP * np.eye(len(point))
        pairs = [(self.predicted(point + s), self.predicted(point - s)) for s in steps]
        errors, variances, jacobians = (
            np.array(
                [(getattr(a, f) - getattr(b, f)) / (2.0 * _STEP) for a, b in pairs]
            )
            for f in Prediction._fields
        )
        pull = here.errors / here.variances
        surprise = (1.0 - here.errors * pull) / (2.0 * here.variances)
        spread = variances / here.variances
        return _Slopes(
            gradient=errors @ pull + variances @ surprise - jacobians.sum(axis=1),
            curvature=(errors / here.variances) @ errors.T + spread @ spread.T / 2.0,
        )

    def gradient(self, point: Vector) -> Vector:
        """Of `value`, shape `(parameter,)`."""
        return self.slopes(point).gradient

    def curvature(self, point: Vector) -> Vector:
        """Of `value` as expected, shape `(parameter, parameter)`."""
        return self.slopes(point).curvature


def information(
    driver: DriverParameters, parameters: Sequence[Parameter], evidence: Evidence
) -> Vector:
    """Expected information on the searched scale, shape `(parameter, parameter)`.

    Args:
        driver: Where.
        parameters: On what.
        evidence: Recording and stretches.
    """
    objective = _Objective(driver, parameters, evidence)
    return objective.curvature(coordinates(driver, parameters))


def alone(
    start: DriverParameters, parameters: Sequence[Parameter], evidence: Evidence
) -> Vector:
    """Standard errors at the start if each parameter were alone, shape `(parameter,)`.

    Infinite where nothing in the recording depends on the parameter.
    """
    with np.errstate(divide="ignore"):
        return np.asarray(
            1.0 / np.sqrt(np.diag(information(start, parameters, evidence)))
        )


def maximise(
    start: DriverParameters, parameters: Sequence[Parameter], evidence: Evidence
) -> Maximum:
    """Find the driver who explains the torque best.

    Args:
        start: Where the search begins; what is not searched keeps its value.
        parameters: What is searched, each with some effect.
        evidence: Recording and stretches.
    """
    objective = _Objective(start, parameters, evidence)
    first = coordinates(start, parameters)
    scale = 1.0 / np.sqrt(np.diag(objective.curvature(first)))
    search: Any = minimize  # Any: the stubs know no Hessian that is a plain matrix
    found = search(
        lambda z: objective.value(z * scale),
        first / scale,
        jac=lambda z: objective.gradient(z * scale) * scale,
        hess=lambda z: objective.curvature(z * scale) * np.outer(scale, scale),
        method="trust-exact",
        options=_OPTIONS,
    )
    point = np.asarray(found.x * scale)
    return Maximum(
        driver=driver_at(start, parameters, point),
        log_likelihood=-float(found.fun),
        converged=bool(np.abs(found.jac).max() < _NEARLY),
    )


class Weakest(NamedTuple):
    """A combination of parameters that the likelihood hardly depends on.

    Attributes:
        first: Place of the parameter with the largest part in it.
        second: Of that with the next; the same if there is only one parameter.
    """

    first: int
    second: int


def deviations(matrix: Vector) -> Vector | Weakest:
    """Standard errors, shape `(parameter,)`, or what an information leaves open.

    Args:
        matrix: Observed information, shape `(parameter, parameter)`.
    """
    size = np.sqrt(np.abs(np.diag(matrix)))
    values, vectors = np.linalg.eigh(matrix / np.outer(size, size))
    if values[0] > _SINGULAR:
        return np.asarray(np.sqrt(np.diag(np.linalg.inv(matrix))))
    order = np.argsort(-np.abs(vectors[:, 0]))
    return Weakest(first=int(order[0]), second=int(order[min(1, len(order) - 1)]))


def observed_information(
    driver: DriverParameters, parameters: Sequence[Parameter], evidence: Evidence
) -> Vector:
    """Curvature of the negative log-likelihood, shape `(parameter, parameter)`.

    Central differences of the gradient over a fifth of each standard error.

    Args:
        driver: The maximum.
        parameters: What was searched.
        evidence: Recording and stretches.
    """
    objective = _Objective(driver, parameters, evidence)
    point = coordinates(driver, parameters)
    covariance = np.linalg.pinv(objective.curvature(point))
    rows = []
    for k, deviation in enumerate(np.sqrt(np.diag(covariance))):
        step = np.zeros_like(point)
        step[k] = 0.2 * deviation
        rise = objective.gradient(point + step) - objective.gradient(point - step)
        rows.append(rise / (2.0 * step[k]))
    return np.asarray((np.array(rows) + np.transpose(rows)) / 2.0)


def likeliest_noise(driver: DriverParameters, evidence: Evidence) -> TorqueNoise:
    """Noise of the measured torque that explains a recording best.

    Args:
        driver: Who is taken to have driven.
        evidence: Recording and stretches.
    """

    def misfit(logarithm: float) -> float:
        noise = TorqueNoise(deviation=math.exp(logarithm), driven_share=1.0)
        found = predicted(driver, evidence._replace(noise=noise))
        return -float(log_likelihoods(found).sum())

    limits = (math.log(NO_NOISE.deviation), math.log(_MOST_NOISE))
    found = minimize_scalar(misfit, bounds=limits, method="bounded")
    deviation = math.exp(float(found.x))
    if deviation < _LEAST_NOISE:
        return NO_NOISE
    noise = TorqueNoise(deviation=deviation, driven_share=1.0)
    variances = predicted(driver, evidence._replace(noise=noise)).variances
    return TorqueNoise(deviation, 1.0 - deviation**2 * float(np.mean(1.0 / variances)))


def half_width(deviation: float) -> float:
    """Of the interval around an estimate with this standard error."""
    return float(norm.ppf(0.5 + CONFIDENCE / 2.0)) * deviation
