"""How a test becomes a row: p values, effect size, correction and mark added."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from costeer.study.anova import FTest
from costeer.study.effects import (
    EffectSize,
    generalised_eta_squared,
    hedges_correction,
    partial_eta_squared,
)
from costeer.study.outcome import EffectRow, PairRow
from costeer.study.ranks import RankTest
from costeer.study.ttests import TTest, benjamini_hochberg, significance_mark


class PairTest(NamedTuple):
    """A pair of levels and the test between them.

    Attributes:
        first: A condition or strength.
        second: The one it is compared with.
        test: Outcome.
        n_first: Number of values or participants of the first.
        n_second: The same of the second.
        note: Who was left out.
    """

    first: str
    second: str
    test: TTest
    n_first: int
    n_second: int
    note: str = ""


class About(NamedTuple):
    """What a test is about.

    Attributes:
        measure: Name of the measure.
        analysis: As in `tests.csv`.
        n: Number of values or participants.
        note: Design, and who was left out.
    """

    measure: str
    analysis: str
    n: int
    note: str


def effect_row(about: About, effect: str, test: FTest) -> EffectRow:
    """Return the row of an F test."""
    df1, df2 = test.epsilon * test.df1, test.epsilon * test.df2
    p_corrected = _p_value(test, test.epsilon)
    known = math.isfinite(test.statistic)
    size = partial_eta_squared(test.statistic, df1, df2) if known else EffectSize()
    generalised = generalised_eta_squared(
        size, test.error_share, test.df2 / test.df1, df2
    )
    return EffectRow(
        measure=about.measure,
        analysis=about.analysis,
        effect=effect,
        statistic=test.statistic,
        df1=test.df1,
        df2=test.df2,
        epsilon=test.epsilon,
        p=_p_value(test, 1.0),
        p_corrected=p_corrected,
        mark=significance_mark(p_corrected),
        effect_size=size.value,
        effect_size_low=size.low,
        effect_size_high=size.high,
        effect_size_kind=size.kind,
        n=about.n,
        note=joined(test.note, about.note),
        epsilon_huynh_feldt=test.huynh_feldt,
        p_huynh_feldt=_p_value(test, test.huynh_feldt),
        generalised_eta_squared=generalised.value,
        generalised_eta_squared_low=generalised.low,
        generalised_eta_squared_high=generalised.high,
    )


def _p_value(test: FTest, epsilon: float) -> float:
    """The p value of F with both degrees of freedom times epsilon."""
    from scipy import stats

    return float(stats.f.sf(test.statistic, epsilon * test.df1, epsilon * test.df2))


def pair_rows(
    measure: str, analysis: str, comparisons: Sequence[PairTest]
) -> tuple[PairRow, ...]:
    """Return the rows of a family of pairs, corrected over the family."""
    corrected = benjamini_hochberg([each.test.p for each in comparisons])
    return tuple(
        _pair_row((measure, analysis), comparison, p_corrected)
        for comparison, p_corrected in zip(comparisons, corrected, strict=True)
    )


def _pair_row(
    names: tuple[str, str], comparison: PairTest, p_corrected: float
) -> PairRow:
    test = comparison.test
    return PairRow(
        *names,
        first=comparison.first,
        second=comparison.second,
        mean_first=test.mean_first,
        mean_second=test.mean_second,
        mean_difference=test.mean_first - test.mean_second,
        low=test.low,
        high=test.high,
        statistic=test.statistic,
        df=test.df,
        p=test.p,
        p_corrected=p_corrected,
        mark=significance_mark(p_corrected),
        effect_size=test.effect_size.value,
        effect_size_low=test.effect_size.low,
        effect_size_high=test.effect_size.high,
        effect_size_kind=test.effect_size.kind,
        n_first=comparison.n_first,
        n_second=comparison.n_second,
        note=joined(test.note, comparison.note),
        d_av=test.d_av.value,
        d_av_low=test.d_av.low,
        d_av_high=test.d_av.high,
        hedges_correction=hedges_correction(test.df),
    )


def friedman_row(about: About, effect: str, test: RankTest) -> EffectRow:
    """Return the row of Friedman's test: no second df, no correction."""
    size = test.effect_size
    return EffectRow(
        measure=about.measure,
        analysis=about.analysis,
        effect=effect,
        statistic=test.statistic,
        df1=test.df,
        df2=math.nan,
        epsilon=1.0,
        p=test.p,
        p_corrected=test.p,
        mark=significance_mark(test.p),
        effect_size=size.value,
        effect_size_low=size.low,
        effect_size_high=size.high,
        effect_size_kind=size.kind,
        n=about.n,
        note=joined("chi squared of ranks", test.note, about.note),
        epsilon_huynh_feldt=1.0,
        p_huynh_feldt=test.p,
        generalised_eta_squared=math.nan,
        generalised_eta_squared_low=math.nan,
        generalised_eta_squared_high=math.nan,
    )


def joined(*notes: str) -> str:
    """Return the notes that say something, as one."""
    return "; ".join(note for note in notes if note)
