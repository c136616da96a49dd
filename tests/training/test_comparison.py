"""Predictors side by side: the same samples, paired intervals, named reasons."""

from __future__ import annotations

import json
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from costeer.intention.features import DISTANCE, full_windows, mirrored
from costeer.intention.predictors.interface import Predictor, Probabilities
from costeer.training.ablation import ablations, variant_of
from costeer.training.bootstrap import AT_RATE
from costeer.training.comparison import (
    Comparison,
    compare_verdicts,
    comparison_facts,
    contender,
)
from costeer.training.evaluate import DEFAULTS, EvaluationParameters
from costeer.training.recordings import Recording, lacking, recording
from tests.training.synthetic import columns, drives

PARAMETERS = DEFAULTS._replace(num_resamples=200)
RECORDINGS = drives(5, num_changes=2)
ROWS = {r.features.tobytes(): r for r in RECORDINGS}


def made(name: str, say: Probabilities, needs: tuple[str, ...] = ()) -> Predictor:
    """A predictor that says nothing before the window is full or without its needs."""

    def probabilities(
        features: NDArray[np.float64], absent: tuple[str, ...]
    ) -> NDArray[np.float64]:
        silent = bool(set(needs) & set(absent))
        said = np.full(len(features), np.nan) if silent else say(features, absent)
        return np.where(full_windows(features, absent), said, np.nan)

    return Predictor(name, name.title(), "made up", needs, probabilities)


def oracle(
    features: NDArray[np.float64], absent: tuple[str, ...]
) -> NDArray[np.float64]:
    """Knows the future of the recordings above."""
    return np.where(ROWS[features.tobytes()].labels.positive, 0.99, 0.01)


def coin(features: NDArray[np.float64], absent: tuple[str, ...]) -> NDArray[np.float64]:
    """Says anything."""
    return np.random.default_rng(len(features)).random(len(features))


def nearness(
    features: NDArray[np.float64], absent: tuple[str, ...]
) -> NDArray[np.float64]:
    """The nearer the line the likelier."""
    return np.asarray(np.exp(-2.0 * features[:, DISTANCE]))


PERFECT, COIN = made("perfect", oracle), made("coin", coin)
NEAR = made("near", nearness, ("distance_to_adjacent_lane",))


def compare(
    predictors: list[Predictor],
    recordings: list[Recording],
    reference: str,
    parameters: EvaluationParameters,
) -> Comparison:
    rows = [contender(predictor, recordings) for predictor in predictors]
    return compare_verdicts(rows, recordings, reference, parameters)


def compared(*predictors: Predictor, reference: str) -> Comparison:
    return compare([*predictors], RECORDINGS, reference, PARAMETERS)


@cache
def both() -> Comparison:
    """All three, beside the coin."""
    return compared(PERFECT, COIN, NEAR, reference="coin")


def test_a_perfect_predictor_has_area_1_and_beats_a_coin() -> None:
    perfect = both().judged[0]
    assert perfect.judgement.facts["samples"]["pr_auc"] == 1.0
    assert perfect.judgement.facts["at_false_rate"]["lead_time_median"] > 2.9
    for score in ("pr_auc", AT_RATE):
        assert perfect.differences[score].verdict == "better"
        assert perfect.differences[score].low > 0.0


def test_the_other_way_round_a_coin_is_worse() -> None:
    turned = compared(PERFECT, COIN, reference="perfect").judged[1]
    straight = both().judged[0].differences["pr_auc"]
    assert turned.differences["pr_auc"].verdict == "worse"
    assert turned.differences["pr_auc"].value == pytest.approx(-straight.value)


def test_a_predictor_against_itself_is_a_tie() -> None:
    twin = COIN._replace(name="twin")
    found = compared(COIN, twin, reference="coin").judged[1].differences
    for score in ("pr_auc", AT_RATE):
        assert found[score] == (0.0, 0.0, 0.0, "tie")


def test_all_rows_stand_on_the_same_samples() -> None:
    def late(
        features: NDArray[np.float64], absent: tuple[str, ...]
    ) -> NDArray[np.float64]:
        return np.where(np.arange(len(features)) < 600, np.nan, coin(features, absent))

    found = compared(NEAR, made("late", late), reference="near").judged
    numbers = {one.judgement.facts["num_samples"] for one in found}
    distances = {one.judgement.facts["kilometres"] for one in found}
    known = sum(int(r.labels.known[600:].sum()) for r in RECORDINGS)
    assert numbers == {known}
    assert len(distances) == 1
    assert found[0].coverage == 1.0
    assert found[1].coverage < 0.9


def test_who_lacks_a_signal_is_listed_with_the_reason() -> None:
    blind = [lacking(r, ("distance_to_adjacent_lane",)) for r in RECORDINGS]
    found = compare([NEAR, COIN], blind, "near", PARAMETERS)
    (excluded,) = found.excluded
    assert excluded.name == "near"
    assert "distance_to_adjacent_lane" in excluded.reason
    assert found.reference == ""
    assert found.judged[0].differences == {}


def test_who_says_nothing_is_listed_and_spoils_no_other_row() -> None:
    mute = made("mute", lambda f, _: np.full(len(f), np.nan))
    found = compared(COIN, mute, reference="coin")
    assert [one.name for one in found.judged] == ["coin"]
    assert "no verdict on any sample" in found.excluded[0].reason


def test_nobody_able_is_an_error() -> None:
    mute = made("mute", lambda f, _: np.full(len(f), np.nan))
    with pytest.raises(ValueError, match="no predictor can judge"):
        compared(mute, reference="mute")


def test_no_common_sample_is_an_error() -> None:
    def half(first: bool) -> Probabilities:
        def say(
            features: NDArray[np.float64], absent: tuple[str, ...]
        ) -> NDArray[np.float64]:
            early = np.arange(len(features)) < len(features) / 2
            return np.where(early == first, 0.5, np.nan)

        return say

    rows = (made("early", half(True)), made("late", half(False)))
    with pytest.raises(ValueError, match="compare fewer"):
        compared(*rows, reference="early")


def test_one_driver_gives_no_verdict() -> None:
    found = compare([PERFECT, COIN], RECORDINGS[:1], "coin", PARAMETERS)
    assert found.judged[0].differences["pr_auc"].verdict == "unknown"


@pytest.mark.slow
def test_the_same_seed_gives_the_same_table_as_json_without_nan() -> None:
    again = compared(PERFECT, COIN, NEAR, reference="coin")
    text = json.dumps(comparison_facts(both()), allow_nan=False)
    assert text == json.dumps(comparison_facts(again), allow_nan=False)
    other = compare([PERFECT, COIN], RECORDINGS, "coin", PARAMETERS._replace(seed=2))
    first = both().judged[1].judgement.facts["interval_95"]
    assert other.judged[1].judgement.facts["interval_95"] != first


@pytest.mark.slow
def test_mirrored_drives_give_the_same_table() -> None:
    def straight(seed: int) -> Recording:
        return recording("a", f"drive {seed}", columns(seed, num_changes=2))

    def reflected(seed: int) -> Recording:
        turned = columns(seed, num_changes=2)
        for name in ("head_yaw", "steering_wheel_angle", "yaw_angle"):
            turned[name] = -turned[name]
        turned["lane"] = (1 - turned["lane"]).astype(np.int8)
        return recording("a", f"drive {seed}", turned)

    tables = [
        comparison_facts(compare([NEAR, COIN], drives_of, "near", PARAMETERS))
        for drives_of in ([straight(1), straight(2)], [reflected(1), reflected(2)])
    ]
    assert tables[0] == tables[1]


@pytest.mark.slow
def test_ablations_take_signals_away_in_turn() -> None:
    def counts_signals(
        features: NDArray[np.float64], absent: tuple[str, ...]
    ) -> NDArray[np.float64]:
        # The fewer signals, the less of the truth shows.
        share = 1.0 - len(absent) / 6.0
        return share * oracle(features, ()) + (1.0 - share) * coin(features, ())

    found = ablations(made("mine", counts_signals), RECORDINGS, PARAMETERS)
    titles = [one.title for one in found.judged]
    assert titles[:3] == ["all signals", "no head", "no wheel"]
    assert "head only" in titles
    areas = {o.name: o.judgement.facts["samples"]["pr_auc"] for o in found.judged}
    assert areas["full"] == 1.0
    assert areas["head"] < areas["no-head"]
    assert found.judged[-1].differences["pr_auc"].verdict == "worse"


@pytest.mark.slow
def test_what_is_lacking_anyway_is_not_taken_away_twice() -> None:
    blind = [lacking(r, ("head_yaw",)) for r in RECORDINGS]
    found = ablations(COIN, blind, PARAMETERS)
    names = [one.name for one in found.judged]
    assert names == ["full", "no-wheel", "motion-without-place", "head"]


def test_variants_are_known_by_what_they_lack() -> None:
    assert variant_of(()) == "full"
    assert variant_of(("steering_wheel_angle", "head_yaw")) == "motion"
    assert variant_of(("yaw_angle",)) is None


def test_the_mirror_of_a_mirror_is_the_drive() -> None:
    features = RECORDINGS[0].features
    np.testing.assert_array_equal(mirrored(mirrored(features)), features)
