"""Linear mixed model with participant as random effect, for cells that are missing.

One random intercept per participant, fitted by restricted maximum likelihood (REML).
With a single random intercept, generalised least squares is ordinary least squares on
values from which a share of the participant's mean is taken; only that share has to be
searched. We do not use `statsmodels.MixedLM`, whose fit fails to converge where the
participants' variance is estimated as zero; elsewhere a test holds both equal.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from numpy.typing import NDArray

from costeer.study.anova import ONE_LEVEL, FTest, no_f_test, vanishes
from costeer.study.contrasts import Effect

BOUNDARY = (
    "boundary fit: the participants' variance is estimated as zero, "
    "so that the model treats all cells as independent"
)

_LARGEST_LOG_RATIO = 30.0  # residuals a millionth of the participants' spread and less


class _Model(NamedTuple):
    """Cells that are there, one row each.

    Attributes:
        values: Cell means, shape (rows,).
        design: Fixed effects, shape (rows, coefficients), intercept first.
        participants: Participant of each row, 0 to n - 1, shape (rows,).
    """

    values: NDArray[np.float64]
    design: NDArray[np.float64]
    participants: NDArray[np.intp]


def mixed_f_tests(
    means: Float[NDArray[np.float64], "participant cell"], effects: Sequence[Effect]
) -> tuple[FTest, ...]:
    """Wald F tests of the fixed effects beside a random participant.

    The error's degrees of freedom are those left after participants and fixed effects,
    so that without missing cells F and both degrees of freedom are those of the
    repeated-measures analysis before its correction for sphericity.

    Args:
        means: Shape (participants, cells), NaN where a cell is missing.
        effects: Effects to test, over the same cells.

    Returns:
        One test per effect, in their order.
    """
    model = _model(means, effects)
    reason = _obstacle(model, means)
    if reason:
        return tuple(no_f_test(reason) for _ in effects)
    ratio = _variance_ratio(model)
    df2 = model.values.size - _rank_within(model)
    return _wald_tests(model, effects, ratio, df2)


def _model(means: NDArray[np.float64], effects: Sequence[Effect]) -> _Model:
    rows, cells = np.nonzero(np.isfinite(means))
    fixed = np.hstack([effect.contrasts for effect in effects])
    return _Model(
        values=means[rows, cells],
        design=np.hstack([np.ones((rows.size, 1)), fixed[cells]]),
        participants=np.unique(rows, return_inverse=True)[1],
    )


def _obstacle(model: _Model, means: NDArray[np.float64]) -> str:
    if means.shape[1] < 2:
        return ONE_LEVEL
    if model.values.size == 0 or model.participants.max() < 1:
        return "fewer than two participants"
    if np.linalg.matrix_rank(model.design) < model.design.shape[1]:
        return "a cell is empty"
    if model.values.size <= _rank_within(model):
        return "too few cells within participants: no variance to compare with"
    if vanishes(_residuals_within(model), model.values):
        return "no variance of the effects between participants"
    return ""


def _within(model: _Model) -> NDArray[np.float64]:
    """Participants and fixed effects, both as columns."""
    return np.hstack(
        [np.eye(model.participants.max() + 1)[model.participants], model.design]
    )


def _rank_within(model: _Model) -> int:
    return int(np.linalg.matrix_rank(_within(model)))


def _residuals_within(model: _Model) -> NDArray[np.float64]:
    design = _within(model)
    coefficients = np.linalg.lstsq(design, model.values)[0]
    return model.values - design @ coefficients


def _variance_ratio(model: _Model) -> float:
    """Variance of participants over that of the residuals, by REML; 0 at the boundary.

    Searched over log(1 + ratio), on a grid first as there may be two valleys.
    """
    from scipy import optimize

    def criterion(log_ratio: float) -> float:
        return _restricted_deviance(model, float(np.expm1(log_ratio)))

    grid = np.linspace(0.0, _LARGEST_LOG_RATIO, 65)
    best = int(np.argmin([criterion(point) for point in grid]))
    bounds = grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]
    found = optimize.minimize_scalar(
        criterion, bounds=bounds, method="bounded", options={"xatol": 1e-12}
    )
    return float(np.expm1(found.x)) if found.fun < criterion(0.0) else 0.0


def _restricted_deviance(model: _Model, ratio: float) -> float:
    """-2 log restricted likelihood but for a constant; residual variance profiled out.

    Source: Pinheiro and Bates (2000), Mixed-Effects Models in S and S-PLUS, Sec. 2.2.
    """
    independent = _made_independent(model, ratio)
    triangle = np.linalg.qr(
        np.column_stack([independent.design, independent.values]), mode="r"
    )
    diagonal = np.abs(np.diag(triangle))
    df = model.values.size - model.design.shape[1]
    spread = np.log1p(ratio * np.bincount(model.participants)).sum()
    deviance = 2.0 * df * np.log(diagonal[-1]) + 2.0 * np.log(diagonal[:-1]).sum()
    return float(deviance + spread)


def _made_independent(model: _Model, ratio: float) -> _Model:
    """Take from each row a share of its participant's mean, to make rows independent.

    A participant with m rows loses the share 1 - 1 / sqrt(1 + m * ratio).
    """
    counts = np.bincount(model.participants)
    share = 1.0 - 1.0 / np.sqrt(1.0 + counts * ratio)
    membership = np.eye(counts.size)[model.participants]
    taken = (membership * (share / counts)) @ membership.T
    return _Model(
        values=model.values - taken @ model.values,
        design=model.design - taken @ model.design,
        participants=model.participants,
    )


def _wald_tests(
    model: _Model, effects: Sequence[Effect], ratio: float, df2: int
) -> tuple[FTest, ...]:
    independent = _made_independent(model, ratio)
    design, values = independent.design, independent.values
    coefficients = np.linalg.lstsq(design, values)[0]
    residuals = values - design @ coefficients
    variance = residuals @ residuals / (values.size - design.shape[1])
    covariance = variance * np.linalg.inv(design.T @ design)
    note = "" if ratio > 0.0 else BOUNDARY
    tests, start = [], 1
    for effect in effects:
        df1 = effect.contrasts.shape[1]
        part = slice(start, start + df1)
        start += df1
        if df1 == 0:
            tests.append(no_f_test(ONE_LEVEL))
            continue
        chosen = coefficients[part]
        wald = float(chosen @ np.linalg.solve(covariance[part, part], chosen))
        test = FTest(wald / df1, float(df1), float(df2), note=note)
        tests.append(test._replace(error_share=math.nan))
    return tuple(tests)
