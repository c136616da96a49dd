"""Repeated-measures analysis of variance of participants' cell means."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from numpy.typing import NDArray

from costeer.study.anova import ONE_LEVEL, FTest, no_f_test, vanishes
from costeer.study.contrasts import Effect


def repeated_f_test(
    means: Float[NDArray[np.float64], "participant cell"], effect: Effect
) -> FTest:
    """F test of an effect against its own interaction with participants.

    Each participant is reduced to the effect's orthonormal contrasts; the test asks
    whether their mean over participants is zero.

    Args:
        means: One per participant and cell, shape (participants, cells), no gap.
        effect: Effect over these cells.

    Returns:
        The test, with the Greenhouse-Geisser factor as `epsilon` and that of Huynh
        and Feldt beside it.
    """
    num_participants, df1 = means.shape[0], effect.contrasts.shape[1]
    if df1 == 0:
        return no_f_test(ONE_LEVEL)
    if num_participants < 2:
        return no_f_test(f"{num_participants} participant(s) with every cell, 2 needed")
    contrasts = means @ effect.contrasts
    mean = contrasts.mean(axis=0)
    deviations = contrasts - mean
    if vanishes(deviations, means):
        return no_f_test("no variance of the effect between participants")
    df2 = df1 * (num_participants - 1)
    own_error = float(np.sum(deviations**2))
    explained = num_participants * float(mean @ mean) / df1
    epsilon = greenhouse_geisser(deviations)
    return FTest(
        statistic=explained / (own_error / df2),
        df1=float(df1),
        df2=float(df2),
        epsilon=epsilon,
        huynh_feldt=huynh_feldt(epsilon, df1, num_participants),
        error_share=own_error / float(np.sum((means - means.mean(axis=0)) ** 2)),
    )


def greenhouse_geisser(
    deviations: Float[NDArray[np.float64], "participant contrast"],
) -> float:
    """Factor on the degrees of freedom, from 1 / contrasts to 1 under sphericity.

    Args:
        deviations: Contrasts minus their means, shape (participants, contrasts).

    Source: Greenhouse and Geisser (1959), Psychometrika 24, 95 to 112.
    """
    covariance = deviations.T @ deviations
    num_contrasts = covariance.shape[0]
    epsilon = np.trace(covariance) ** 2 / (num_contrasts * np.sum(covariance**2))
    return float(np.clip(epsilon, 1.0 / num_contrasts, 1.0))


def huynh_feldt(epsilon: float, num_contrasts: int, num_participants: int) -> float:
    """Factor on the degrees of freedom, never below that of Greenhouse and Geisser.

    With one group of participants, as here, the correction of Lecoutre (1991) changes
    nothing. Two participants do not determine it; the stricter factor stands in.

    Args:
        epsilon: Factor of Greenhouse and Geisser [-].
        num_contrasts: Degrees of freedom of the effect.
        num_participants: Those with every cell, two at least.

    Source: Huynh and Feldt (1976), Journal of Educational Statistics 1, 69 to 82;
        set to 1 where the formula gives more.
    """
    effective = num_contrasts * epsilon
    left = num_participants - 1.0 - effective
    if num_participants < 3:
        return epsilon
    if left <= 0.0:
        return 1.0
    ratio = (num_participants * effective - 2.0) / (num_contrasts * left)
    return float(np.clip(ratio, epsilon, 1.0))
