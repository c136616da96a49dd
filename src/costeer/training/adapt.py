"""`costeer train --adapt`: check recordings, adapt the network, judge it, write facts.

Judged are drivers of whom the network that speaks knows nothing, beside the network
that was started from, on the same samples. The threshold is each network's own, chosen
without the driver who is judged; that of the start is the one it comes with.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from importlib.metadata import version
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import chi2

from costeer.intention.features import WINDOW_LENGTH
from costeer.intention.gru import hidden_size, without
from costeer.intention.predictors.gru import our_probabilities
from costeer.intention.weights import IntentionNetwork, intention_network
from costeer.training import bootstrap
from costeer.training.adaptation import (
    DEFAULTS,
    AdaptationParameters,
    HeldOut,
    adapted,
    held_out,
)
from costeer.training.evaluate import (
    DEFAULTS as EVALUATION,
)
from costeer.training.evaluate import (
    plain,
    sample_scores,
    trigger_counts,
)
from costeer.training.left_out import DRIVERS, Parts, minutes, num_changes, parts
from costeer.training.recordings import Recording
from costeer.training.thresholds import USUAL
from costeer.training.triggers import TriggerCounts, total, trigger_scores
from costeer.training.verdicts import DriverVerdicts, judged_samples, verdicts

SHOWN = ("pr_auc", "log_loss", "false_per_km", "lead_time_median", "missed_share")
"""Scores that are told with intervals and compared with the start."""


class Heard(NamedTuple):
    """What was said of one driver, or block, by something that never met it.

    Attributes:
        verdicts: At each sample.
        counts: Triggers at the threshold that came with the verdicts.
    """

    verdicts: DriverVerdicts
    counts: TriggerCounts


def adapt(
    start: IntentionNetwork,
    recordings: Sequence[Recording],
    seed: int,
    parameters: AdaptationParameters = DEFAULTS,
    progress: Callable[[int], None] = lambda _: None,
) -> IntentionNetwork:
    """Adapt a network to people and judge it on those it was adapted without.

    Args:
        start: To go on from.
        recordings: Of people.
        seed: Of who is dealt to which part and the order of windows.
        parameters: Everything else.
        progress: Told after each network that one more is done, `num_fits` in all.

    Returns:
        With facts: start, seed, threshold, calibration, and the judgement.

    Raises:
        ValueError: If the recordings do not suffice, saying what they hold and what is
            needed.
    """
    check(start, recordings, parameters)
    whole = parts(recordings)
    held = list(held_out(start.weights, whole, seed, parameters, progress))
    one = adapted(start.weights, recordings, seed, parameters)
    progress(1)
    facts = {
        "costeer_version": version("costeer"),
        "seed": seed,
        "hidden_size": hidden_size(start.weights),
        "start": {"hash": start.hash, "source": start.facts.get("source")},
        "steps": one.choice.steps,
        "curve": [list(point) for point in one.choice.curve],
        "calibration": one.choice.calibration._asdict(),
        "threshold": one.choice.threshold,
        "false_per_km_allowed": parameters.false_per_km,
        "adapted_to": _amounts(recordings),
        "drivers": {"training": sorted({r.driver for r in recordings})},
        "left_out": _judgement(start, whole, held, parameters),
    }
    return intention_network(one.weights, plain(facts))


def num_fits(
    recordings: Sequence[Recording], parameters: AdaptationParameters = DEFAULTS
) -> int:
    """Networks that `adapt` makes."""
    return 1 + min(len(parts(recordings).names), parameters.outer_folds)


def check(
    start: IntentionNetwork,
    recordings: Sequence[Recording],
    parameters: AdaptationParameters = DEFAULTS,
) -> None:
    """Refuse what cannot be adapted to.

    Raises:
        ValueError: Naming what there is, what is needed and the way out.
    """
    for absent in {each.absent for each in recordings}:
        without(start.weights.dispensable, absent)
    driven, least = minutes(recordings), parameters.least_minutes
    if driven < least:
        longest = max((len(each.side) for each in recordings), default=0) / 60.0
        raise ValueError(
            f"the recordings hold {driven:.1f} min with verdicts (the longest is "
            f"{longest:.0f} s; the first {WINDOW_LENGTH} samples, 3 s, give none); "
            f"adapting needs at least {least:g} min: record more"
        )
    changes = sum(map(num_changes, recordings))
    if changes < parameters.least_changes:
        raise ValueError(
            f"the recordings hold {changes} lane change{'s' * (changes != 1)} after "
            "3 s of driving; adapting needs at least "
            f"{parameters.least_changes}: record more, or see that the column lane or "
            "crossing tells them"
        )


def _amounts(recordings: Sequence[Recording]) -> dict[str, Any]:
    """How much was learned from."""
    return {
        "drivers": len({each.driver for each in recordings}),
        "recordings": len(recordings),
        "minutes": minutes(recordings),
        "lane_changes": sum(map(num_changes, recordings)),
        "missing_signals": sorted({n for each in recordings for n in each.absent}),
    }


def _judgement(
    start: IntentionNetwork,
    whole: Parts,
    held: Sequence[HeldOut],
    parameters: AdaptationParameters,
) -> dict[str, Any]:
    """Scores of start and adapted networks on those who were left out."""
    before = heard(
        verdicts(partial(our_probabilities, start.weights), whole.recordings),
        float(start.facts.get("threshold", USUAL)),
        parameters,
    )
    after = sorted(
        (each for one in held for each in unmet(one, parameters)),
        key=lambda each: each.verdicts.driver,
    )
    return beside({"start": before, "adapted": after}, whole.kind)


def unmet(one: HeldOut, parameters: AdaptationParameters = DEFAULTS) -> list[Heard]:
    """What an adapted network says of those it was adapted without."""
    said = verdicts(partial(our_probabilities, one.adapted.weights), one.recordings)
    return heard(said, one.adapted.choice.threshold, parameters)


def heard(
    said: Sequence[DriverVerdicts],
    threshold: float,
    parameters: AdaptationParameters = DEFAULTS,
) -> list[Heard]:
    """Verdicts with the triggers that they would make at a threshold."""
    triggers = parameters.triggers._replace(threshold=threshold)
    return [Heard(each, trigger_counts(each, triggers)) for each in said]


def beside(rows: dict[str, list[Heard]], kind: str) -> dict[str, Any]:
    """Scores of several predictors on the same drivers, differences to the first.

    Args:
        rows: What each said, drivers in the same order.
        kind: Of what was left out; intervals are over drivers, never over blocks.
    """
    (first, *_), num = rows, len(next(iter(rows.values())))
    times = bootstrap.resamplings(num, EVALUATION.num_resamples, EVALUATION.seed)
    drawn = {name: _drawn(said, times) for name, said in rows.items()}
    told = bootstrap.intervals_told(
        num, EVALUATION.num_resamples, EVALUATION.seed, kind
    )
    if kind != DRIVERS:
        told["none_because"] = (
            "one driver's blocks of time were left out: nothing is known of others"
        )
    found: dict[str, Any] = {"kind": kind, "intervals": told}
    for name, said in rows.items():
        scores = _scores(said)
        found[name] = scores | {"false_per_km_at_most": _upper_rate(said)}
        if "none_because" in told:
            continue
        found[name]["interval_95"] = _ends(drawn[name])
        if name != first:
            found[name][f"minus_{first}_interval_95"] = _ends(
                {s: drawn[name][s] - drawn[first][s] for s in SHOWN}
            )
    return found


def _scores(said: Sequence[Heard]) -> dict[str, float]:
    """Over all samples, and of the triggers."""
    samples = sample_scores(*judged_samples([each.verdicts for each in said]), 0.5)
    counts = total([each.counts for each in said])
    names = ("prevalence", "pr_auc", "roc_auc", "log_loss", "calibration_error")
    found = {name: samples[name] for name in names} | trigger_scores(counts)
    return found | {"kilometres": counts.kilometres, "hours": counts.hours}


def _drawn(said: Sequence[Heard], times: bootstrap.Times) -> bootstrap.Drawn:
    each = [one.verdicts for one in said]
    return {
        **bootstrap.drawn_samples(each, times, USUAL),
        **bootstrap.drawn_triggers([one.counts for one in said], times),
    }


def _ends(drawn: bootstrap.Drawn) -> dict[str, list[float]]:
    found = {name: bootstrap.interval_95(drawn[name]) for name in SHOWN}
    return {name: list(ends) for name, ends in found.items() if ends is not None}


def _upper_rate(said: Sequence[Heard]) -> float:
    """Rate [1/km] above which so few false triggers would come once in 20 times."""
    counts = total([each.counts for each in said])
    most = float(chi2.ppf(0.95, 2 * (counts.false + 1))) / 2.0
    return most / counts.kilometres if counts.kilometres else np.nan
