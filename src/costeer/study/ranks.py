"""Tests of ordinal answers by their ranks: Friedman's, then Wilcoxon's for pairs.

Both see each participant's order of the conditions only, so that the steps of a scale
need not be alike. Effect sizes have jackknife intervals over participants.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from numpy.typing import NDArray

from costeer.study.effects import CONFIDENCE, EffectSize

KENDALLS_W = "Kendall's W"
RANK_BISERIAL = "rank-biserial correlation"


class RankTest(NamedTuple):
    """Outcome of a test of ranks; NaN where a reason forbids it.

    Attributes:
        statistic: Friedman's chi squared; Wilcoxon's sum of the ranks of those whose
            first value is the larger [-].
        df: Degrees of freedom [-]; NaN for Wilcoxon's test, which has none.
        p: Two-sided p value [-].
        effect_size: Kendall's W; rank-biserial correlation, positive if the first is
            larger.
        note: Why there is no outcome; empty if there is one.
    """

    statistic: float = math.nan
    df: float = math.nan
    p: float = math.nan
    effect_size: EffectSize = EffectSize()
    note: str = ""


def friedman_test(
    scores: Float[NDArray[np.float64], "participant condition"],
) -> RankTest:
    """Whether participants agree in how they order the conditions; ties count.

    Args:
        scores: One per participant and condition, no gap.

    Returns:
        Chi squared with its approximate p, and Kendall's W.

    Source: Friedman (1937), Journal of the American Statistical Association 32, 675 to
        701; with ties Kendall and Gibbons (1990), Rank Correlation Methods, Sec. 6.
    """
    from scipy import stats

    num_participants, num_conditions = scores.shape
    if num_participants < 2:
        return RankTest(note=f"{num_participants} participant(s) with every cell")
    if num_conditions < 3:
        return RankTest(note="fewer than three conditions; see the signed ranks")
    ranks = stats.rankdata(_levelled(scores), axis=-1)
    if not np.any(np.ptp(ranks, axis=-1)):
        return RankTest(note="everyone answers alike in all conditions")
    agreement = float(_kendalls_w(ranks))
    df = num_conditions - 1.0
    statistic = num_participants * df * agreement
    (low, high), note = _agreement_interval(ranks), ""
    if not math.isfinite(low):
        note = "no interval where everyone agrees or fewer than three answer"
    size = EffectSize(agreement, low, high, KENDALLS_W)
    return RankTest(statistic, df, float(stats.chi2.sf(statistic, df)), size, note)


def wilcoxon_test(
    first: Float[NDArray[np.float64], " participant"],
    second: Float[NDArray[np.float64], " participant"],
) -> RankTest:
    """Signed-rank test of paired values; those without a difference do not count.

    p is exact with ties too: all ways to give signs to the ranks are counted.

    Args:
        first: Values in the first condition, shape (participants,).
        second: Those in the second, of the same participants in the same order.

    Source: Wilcoxon (1945), Biometrics Bulletin 1, 80 to 83; effect size of Kerby
        (2014), Comprehensive Psychology 3, 1.
    """
    if first.size < 2:
        return RankTest(note=f"{first.size} participant(s) with both, 2 needed")
    differences = _levelled(np.stack([first - second, first, second]))[0]
    if not differences.any():
        return RankTest(note="no participant with a difference")
    signed = _signed_ranks(differences)
    statistic = float(signed[signed > 0.0].sum())
    size = float(_rank_biserial(signed))
    low, high = _signed_interval(size, differences)
    return RankTest(
        statistic=statistic,
        p=_exact_p(statistic, np.abs(signed[signed != 0.0])),
        effect_size=EffectSize(size, low, high, RANK_BISERIAL),
    )


def _levelled(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The values without their rounding errors, which would break ties."""
    largest = float(np.max(np.abs(values))) or 1.0
    return np.asarray(np.round(values / largest, 12))


def _kendalls_w(
    ranks: Float[NDArray[np.float64], "*batch participant condition"],
) -> NDArray[np.float64]:
    """Spread of the sums of ranks over the largest that these ranks allow."""
    num_participants, num_conditions = ranks.shape[-2:]
    middle = (num_conditions + 1.0) / 2.0
    spread = np.sum((ranks.sum(axis=-2) - num_participants * middle) ** 2, axis=-1)
    possible = num_participants * np.sum((ranks - middle) ** 2, axis=(-2, -1))
    return np.asarray(spread / np.maximum(possible, 1e-300))


def _agreement_interval(ranks: NDArray[np.float64]) -> tuple[float, float]:
    """Limits of Kendall's W of many such participants; NaN where there are none.

    That W is the mean rank correlation between two participants. W of n participants
    is larger by (1 - W) / n on average.
    """
    num = ranks.shape[0]
    agreement = _kendalls_w(ranks)
    if num < 3 or agreement > 1.0 - 1e-12:
        return math.nan, math.nan
    others = _kendalls_w(ranks[_all_but_one(num)])
    correlation = float(num * agreement - 1.0) / (num - 1.0)
    correlations = ((num - 1.0) * others - 1.0) / (num - 2.0)
    low, high = _interval(correlation, correlations, 1.0 - 1e-4)
    return max(low, 0.0), max(high, float(agreement))


def _signed_ranks(
    differences: Float[NDArray[np.float64], "*batch participant"],
) -> NDArray[np.float64]:
    """Ranks of what differs, by size, with the sign of the difference; else 0."""
    from scipy import stats

    alike = np.sum(differences == 0.0, axis=-1, keepdims=True)
    ranks = stats.rankdata(np.abs(differences), axis=-1) - alike
    return np.asarray(np.sign(differences) * ranks)


def _rank_biserial(
    signed: Float[NDArray[np.float64], "*batch participant"],
) -> NDArray[np.float64]:
    total = np.sum(np.abs(signed), axis=-1)
    return np.asarray(signed.sum(axis=-1) / np.maximum(total, 1e-300))


def _signed_interval(
    size: float, differences: NDArray[np.float64]
) -> tuple[float, float]:
    """Limits of the rank-biserial correlation.

    Where all differences have one sign, its lower limit is that of the share of
    participants with that sign (Clopper and Pearson 1934), from -1 to 1.
    """
    num = np.count_nonzero(differences)
    if abs(size) > 1.0 - 1e-12:
        share = ((1.0 - CONFIDENCE) / 2.0) ** (1.0 / num)
        low = 2.0 * share - 1.0
        return (low, 1.0) if size > 0.0 else (-1.0, -low)
    others = _rank_biserial(_signed_ranks(differences[_all_but_one(differences.size)]))
    return _interval(size, others, 1.0 - 2.0 / (num * (num + 1.0)))


def _exact_p(statistic: float, ranks: NDArray[np.float64]) -> float:
    """Twice the smaller tail of the sum of ranks, each in it or not with even odds."""
    doubled = np.rint(2.0 * ranks).astype(int)  # tied ranks end in halves
    odds = np.zeros(doubled.sum() + 1)
    odds[0] = 1.0
    for rank in doubled.tolist():
        moved = np.concatenate([np.zeros(rank), odds[:-rank]])
        odds = (odds + moved) / 2.0
    place = round(2.0 * statistic)
    tail = min(odds[: place + 1].sum(), odds[place:].sum())
    return float(min(1.0, 2.0 * tail))


def _interval(
    estimate: float, without_one: NDArray[np.float64], largest: float
) -> tuple[float, float]:
    """Jackknife interval of a correlation on Fisher's scale.

    Args:
        estimate: Of all participants [-].
        without_one: Of all but one, for each of them in turn [-].
        largest: What stands in for 1, which that scale does not have [-].

    Source: Arvesen (1969), Annals of Mathematical Statistics 40, 2076 to 2100.
    """
    from scipy import stats

    num = without_one.size
    whole = np.arctanh(np.clip(estimate, -largest, largest))
    parts = np.arctanh(np.clip(without_one, -largest, largest))
    pseudo_values = num * whole - (num - 1) * parts
    quantile = stats.t.ppf((1.0 + CONFIDENCE) / 2.0, num - 1)
    half = quantile * pseudo_values.std(ddof=1) / math.sqrt(num)
    middle = pseudo_values.mean()
    return float(np.tanh(middle - half)), float(np.tanh(middle + half))


def _all_but_one(num: int) -> NDArray[np.intp]:
    """Indices of everyone but the first, but the second, ...: shape (num, num - 1)."""
    return np.nonzero(~np.eye(num, dtype=bool))[1].reshape(num, num - 1)
