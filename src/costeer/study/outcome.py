"""The tables of the statistics: what their columns mean.

An undefined number is NaN here and an empty cell in a file; `note` then says why.
"""

from __future__ import annotations

from typing import NamedTuple

PUBLISHED = "published"
"""Analysis as the paper prints it: values pooled, each counted as independent."""

WITHIN = "within"
"""Analysis within subjects, on participants' means."""

MIXED = "mixed"
"""Within subjects too, by a mixed model: where a participant lacks a cell."""

FRIEDMAN = "friedman"
"""Friedman's test of the ranks of ordinal answers."""

WILCOXON = "wilcoxon"
"""Wilcoxon's signed-rank test of two conditions, likewise."""


class EffectRow(NamedTuple):
    """A row of `tests.csv`: one effect on one measure.

    Attributes:
        measure: As in `trials.csv` or `lane_changes.csv`; an item of a questionnaire.
        analysis: `published`, `within` or `mixed`; of answers also `friedman`.
        effect: `condition`, `strength`, `change_duration` or
            `strength:change_duration`.
        statistic: F; chi squared of Friedman's test [-].
        df1: Degrees of freedom of the effect, before the correction [-].
        df2: Degrees of freedom of the error, before the correction [-].
        epsilon: Greenhouse-Geisser factor on both [-]; 1 where it has no place.
        p: p value before the correction [-].
        p_corrected: p value with `epsilon`, the one to read [-].
        mark: Significance mark of `p_corrected`.
        effect_size: Estimate [-].
        effect_size_low: Lower end of its 95 % interval [-].
        effect_size_high: Upper end of it [-].
        effect_size_kind: Which effect size it is.
        n: Number of values (published) or participants (within, mixed).
        note: Reason for a gap, design, and who was left out.
        epsilon_huynh_feldt: Huynh-Feldt factor on both, less strict than `epsilon` [-].
        p_huynh_feldt: p value with it [-].
        generalised_eta_squared: Estimate [-]; none in a mixed model and of ranks.
        generalised_eta_squared_low: Lower end of its 95 % interval [-].
        generalised_eta_squared_high: Upper end of it [-].
    """

    measure: str
    analysis: str
    effect: str
    statistic: float
    df1: float
    df2: float
    epsilon: float
    p: float
    p_corrected: float
    mark: str
    effect_size: float
    effect_size_low: float
    effect_size_high: float
    effect_size_kind: str
    n: int
    note: str
    epsilon_huynh_feldt: float
    p_huynh_feldt: float
    generalised_eta_squared: float
    generalised_eta_squared_low: float
    generalised_eta_squared_high: float


class PairRow(NamedTuple):
    """A row of `pairs.csv`: two conditions or strengths compared.

    Attributes:
        measure: As in `trials.csv` or `lane_changes.csv`.
        analysis: `published` or `within`; of answers also `wilcoxon`.
        first: A condition or strength.
        second: The one it is compared with.
        mean_first: Mean of the values compared, in the measure's unit.
        mean_second: The same of the second.
        mean_difference: First minus second, in the measure's unit.
        low: Lower end of its 95 % interval.
        high: Upper end of it.
        statistic: t; Wilcoxon's sum of the ranks in favour of the first [-].
        df: Degrees of freedom [-].
        p: p value before the correction [-].
        p_corrected: p value after Benjamini-Hochberg over the pairs of this measure and
            analysis, six conditions or three strengths [-].
        mark: Significance mark of `p_corrected`.
        effect_size: Estimate [-].
        effect_size_low: Lower end of its 95 % interval [-].
        effect_size_high: Upper end of it [-].
        effect_size_kind: Which effect size it is.
        n_first: Number of values (published) or participants (within) of the first.
        n_second: The same of the second.
        note: Reason for a gap, and who was left out.
        d_av: Difference over the root of the mean variance of the two [-].
        d_av_low: Lower end of its 95 % interval [-].
        d_av_high: Upper end of it [-].
        hedges_correction: Factor that takes the bias of small samples from `d_av`, from
            a d or d_z, and from their intervals [-].
    """

    measure: str
    analysis: str
    first: str
    second: str
    mean_first: float
    mean_second: float
    mean_difference: float
    low: float
    high: float
    statistic: float
    df: float
    p: float
    p_corrected: float
    mark: str
    effect_size: float
    effect_size_low: float
    effect_size_high: float
    effect_size_kind: str
    n_first: int
    n_second: int
    note: str
    d_av: float
    d_av_low: float
    d_av_high: float
    hedges_correction: float


class SummaryRow(NamedTuple):
    """A row of `summaries.csv`: one measure at one level of a factor.

    Attributes:
        measure: As in `trials.csv` or `lane_changes.csv`.
        analysis: `published` (all values) or `within` (participants' means).
        factor: `condition` or `strength`.
        level: Name of the condition or strength.
        n: Number of values or participants.
        mean: In the measure's unit.
        sd: Standard deviation, ddof 1, in the measure's unit.
        low: Lower end of the 95 % t interval of the mean.
        high: Upper end of it.
        note: Reason for a gap.
    """

    measure: str
    analysis: str
    factor: str
    level: str
    n: int
    mean: float
    sd: float
    low: float
    high: float
    note: str


class DroppedRow(NamedTuple):
    """A row of `dropped.csv`: data that a test could not use.

    Attributes:
        measure: As in `trials.csv` or `lane_changes.csv`.
        participant: Who; `all` for everyone.
        cell: Condition, and the index of the lane change if it is one.
        reason: What was missing, and which tests do without it.
    """

    measure: str
    participant: str
    cell: str
    reason: str


class StudyTests(NamedTuple):
    """All statistics of a study.

    Attributes:
        tests: F tests.
        pairs: Comparisons of two conditions or strengths.
        summaries: Means with intervals.
        dropped: Data that could not be used.
    """

    tests: tuple[EffectRow, ...]
    pairs: tuple[PairRow, ...]
    summaries: tuple[SummaryRow, ...]
    dropped: tuple[DroppedRow, ...]
