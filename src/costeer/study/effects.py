"""Effect sizes with exact intervals, by inverting noncentral F and t distributions.

An interval holds those noncentralities under which the observed statistic is neither
in the upper nor in the lower tail (Steiger and Fouladi 1997; Smithson 2003).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

CONFIDENCE = 0.95
"""Level of every interval. Source: assumed, the level of the paper's bar charts."""

PARTIAL_ETA_SQUARED = "partial eta squared"
COHENS_D = "Cohen's d"
COHENS_D_Z = "Cohen's d_z"
COHENS_D_AV = "Cohen's d_av"
GENERALISED_ETA_SQUARED = "generalised eta squared"

_SMALL_T = 1e-12
"""Below this t is zero to all printed digits."""

_LARGE_T = 1e4
# Above it the library's noncentral t loses its digits (NaN at 1e5). There the normal
# part of the statistic no longer counts: T = noncentrality / sqrt(chi2 / df), which at
# 1e4 agrees with the exact limits to 4e-7 of their value.


class EffectSize(NamedTuple):
    """How large an effect is, free of units.

    Attributes:
        value: Estimate from the sample, without correction for its bias [-].
        low: Lower end of the interval [-].
        high: Upper end of the interval [-].
        kind: Which effect size it is; empty where there is none.
    """

    value: float = math.nan
    low: float = math.nan
    high: float = math.nan
    kind: str = ""


def partial_eta_squared(
    statistic: float, df1: float, df2: float, confidence: float = CONFIDENCE
) -> EffectSize:
    """Share of variance an effect explains, of that which no other effect explains.

    A noncentrality becomes a share of the population by
    `noncentrality / (noncentrality + df1 + df2 + 1)`.

    Args:
        statistic: F [-].
        df1: Degrees of freedom of the effect, after a correction for sphericity.
        df2: Degrees of freedom of the error, after the same correction.
        confidence: Level of the interval.

    Source: Smithson (2003), Confidence Intervals, Sage. Exact between subjects; within
        subjects the share is that of the effect and its own error.
    """
    low, high = (
        _noncentrality_of_f(statistic, df1, df2, probability)
        for probability in _tails(confidence)
    )
    return EffectSize(
        value=statistic * df1 / (statistic * df1 + df2),
        low=low / (low + df1 + df2 + 1.0),
        high=high / (high + df1 + df2 + 1.0),
        kind=PARTIAL_ETA_SQUARED,
    )


def cohens_d(
    statistic: float, num_first: int, num_second: int, confidence: float = CONFIDENCE
) -> EffectSize:
    """Difference of two independent means in pooled standard deviations.

    Args:
        statistic: t of the equal-variance test [-].
        num_first: Number of values in the first group.
        num_second: Number of values in the second group.
        confidence: Level of the interval.
    """
    df = num_first + num_second - 2
    scale = math.sqrt(1.0 / num_first + 1.0 / num_second)
    low, high = (_noncentrality_of_t(statistic, df, p) for p in _tails(confidence))
    return EffectSize(statistic * scale, low * scale, high * scale, COHENS_D)


def cohens_d_z(
    statistic: float, num_pairs: int, confidence: float = CONFIDENCE
) -> EffectSize:
    """Mean of paired differences in standard deviations of these differences.

    Args:
        statistic: t of the paired test [-].
        num_pairs: Number of pairs.
        confidence: Level of the interval.
    """
    df = num_pairs - 1
    scale = 1.0 / math.sqrt(num_pairs)
    low, high = (_noncentrality_of_t(statistic, df, p) for p in _tails(confidence))
    return EffectSize(statistic * scale, low * scale, high * scale, COHENS_D_Z)


def generalised_eta_squared(
    partial: EffectSize, error_share: float, rest_df: float, df2: float
) -> EffectSize:
    """Share of variance an effect explains, differences between people included.

    Unlike the partial share it means the same within and between subjects. Its odds
    are those of the partial share times the error's part of all errors; the limits of
    the two, the second by F, are joined on the scale of logarithms.

    Args:
        partial: Partial eta squared and its interval.
        error_share: Sum of squares of the effect's error over those of all errors, NaN
            where it is not known.
        rest_df: Degrees of freedom of the other errors, one less than participants.
        df2: Degrees of freedom of the effect's error, after a correction.

    Source: Olejnik and Algina (2003), Psychological Methods 8, 434 to 447, all factors
        manipulated; limits joined as in Zou and Donner (2008), Statistics in Medicine
        27, 1693 to 1702, both taken as independent.
    """
    from scipy import stats

    if not math.isfinite(partial.value) or not math.isfinite(error_share):
        return EffectSize()
    rest = 1.0 / error_share - 1.0
    low, high = (
        1.0 / (1.0 + rest / float(stats.f.ppf(probability, rest_df, df2)))
        for probability in reversed(_tails(CONFIDENCE))
    )
    estimate = partial.value, error_share
    return EffectSize(
        value=_share_of_all(*estimate),
        low=_joined_limit(estimate, (partial.low, low), -1.0),
        high=_joined_limit(estimate, (partial.high, high), 1.0),
        kind=GENERALISED_ETA_SQUARED,
    )


def _joined_limit(
    estimate: tuple[float, float], limit: tuple[float, float], sign: float
) -> float:
    """Limit of the generalised share from those of partial share and error's part."""
    (share, part), (share_end, part_end) = estimate, limit
    known = 0.0 < min(share, share_end) <= max(share, share_end) < 1.0
    if not known or sign * (share_end - share) < 0.0:
        # These odds have no logarithm; or F is so small that both limits are below it.
        return _share_of_all(share_end, part_end)
    step = math.hypot(
        math.log(share / (1.0 - share)) - math.log(share_end / (1.0 - share_end)),
        math.log(part) - math.log(part_end),
    )
    odds = share / (1.0 - share) * part * math.exp(sign * step)
    return odds / (1.0 + odds)


def _share_of_all(share: float, error_share: float) -> float:
    return share * error_share / (share * error_share + 1.0 - share)


def cohens_d_av(size: EffectSize, ratio: float) -> EffectSize:
    """Difference of means over the root of the two conditions' mean variance.

    Args:
        size: The same difference in other standard deviations, with its interval.
        ratio: Those standard deviations over the root of the mean variance [-].

    Source: Cumming (2012), Understanding the New Statistics; paired interval of Algina
        and Keselman (2003), Educational and Psychological Measurement 63, 537 to 553.
    """
    low, high = size.low * ratio, size.high * ratio
    return EffectSize(size.value * ratio, low, high, COHENS_D_AV)


def hedges_correction(df: float) -> float:
    """Factor that takes the upward bias from a d, and from its limits; below 1.

    Args:
        df: Degrees of freedom of the standard deviation that d is divided by.

    Source: Hedges (1981), Journal of Educational Statistics 6, 107 to 128; exact.
    """
    if df <= 1.0:
        return 0.0  # d has no mean, and its gamma function no value
    logarithm = math.lgamma(df / 2.0) - math.lgamma((df - 1.0) / 2.0)
    return math.exp(logarithm) / math.sqrt(df / 2.0)


def _tails(confidence: float) -> tuple[float, float]:
    """Lower-tail probabilities of the statistic at the low and the high limit."""
    tail = (1.0 - confidence) / 2.0
    return 1.0 - tail, tail


def _noncentrality_of_f(
    statistic: float, df1: float, df2: float, probability: float
) -> float:
    """Noncentrality under which F stays below the statistic with that probability."""
    from scipy import stats

    if statistic < _SMALL_T**2:
        return 0.0  # the library gives NaN where numbers are denormal
    if statistic > _LARGE_T**2:
        return float(statistic * df1 * stats.chi2.ppf(1.0 - probability, df2) / df2)

    def below(noncentrality: float) -> float:
        if noncentrality == 0.0:
            return float(stats.f.cdf(statistic, df1, df2))
        return float(stats.ncf.cdf(statistic, df1, df2, noncentrality))

    return _solve(below, probability, start=df1 * statistic, lowest=0.0)


def _noncentrality_of_t(statistic: float, df: float, probability: float) -> float:
    """Noncentrality under which t stays below the statistic with that probability."""
    from scipy import stats

    if statistic < 0.0:
        # The library loses digits in the lower half; mirrored they are all there.
        return -_noncentrality_of_t(-statistic, df, 1.0 - probability)
    if statistic < _SMALL_T:
        statistic = 0.0  # the library's power series underflows to NaN below
    if statistic > _LARGE_T:
        spread = stats.chi2.ppf(1.0 - probability, df) / df
        return statistic * math.sqrt(spread)

    def below(noncentrality: float) -> float:
        return float(stats.nct.cdf(statistic, df, noncentrality))

    return _solve(below, probability, start=statistic)


def _solve(
    below: Callable[[float], float],
    probability: float,
    start: float,
    lowest: float = -math.inf,
) -> float:
    """Noncentrality at which `below`, which falls with it, is that probability.

    Args:
        below: P(statistic up to the observed one) at a noncentrality.
        probability: Value to reach.
        start: A noncentrality not far from the answer.
        lowest: Smallest noncentrality there is; the answer where none is small enough.
    """
    from scipy import optimize

    low = high = start
    reach = 2.0 + math.sqrt(abs(start))
    while below(low) < probability:
        if low <= lowest:
            return lowest
        # Stop at zero: across it the library does not compute for a large t.
        floor = 0.0 if low > 0.0 else lowest
        low, reach = max(low - reach, floor), 2.0 * reach
    while below(high) > probability:
        high, reach = high + reach, 2.0 * reach
    return float(optimize.brentq(lambda x: below(x) - probability, low, high))
