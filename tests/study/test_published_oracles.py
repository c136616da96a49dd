"""Statistics of two real studies, against pingouin and statsmodels.

The data state no licence that allows a copy, so they are read in place, from the folder
named by COSTEER_DATA or the nearest `shared/data` above this file.
"""

from __future__ import annotations

import json
import os
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray
from scipy import stats

from costeer.study.anova import FTest, pooled_f_tests
from costeer.study.answers import answer_tests
from costeer.study.contrasts import one_way, two_way
from costeer.study.effects import partial_eta_squared
from costeer.study.ranks import friedman_test
from costeer.study.repeated import repeated_f_test
from costeer.study.ttests import (
    TTest,
    benjamini_hochberg,
    independent_t_test,
    paired_t_test,
)

pytestmark = pytest.mark.slow

# The references are printed with ten significant digits.
PRINTED = 1e-8


def data_folder(name: str) -> Path:
    """Folder of a data set; the test is skipped where it is absent."""
    given = os.environ.get("COSTEER_DATA")
    above = [parent / "shared" / "data" for parent in Path(__file__).resolve().parents]
    for root in [Path(given)] if given else above:
        if (root / name).is_dir():
            return root / name
    pytest.skip(f"no data set {name}: set COSTEER_DATA to the folder that holds it")


def p_value(test: FTest, epsilon: float = 1.0) -> float:
    return float(stats.f.sf(test.statistic, epsilon * test.df1, epsilon * test.df2))


def assert_f(test: FTest, expected: dict[str, float]) -> None:
    found = (test.statistic, test.df1, test.df2, p_value(test))
    assert found == pytest.approx(
        [expected[k] for k in ("F", "df1", "df2", "p")], rel=PRINTED
    )


def assert_t(test: TTest, expected: dict[str, float]) -> None:
    found = (test.statistic, test.p)
    assert found == pytest.approx(
        (expected["t"], expected["p"]), rel=PRINTED, abs=1e-12
    )


@pytest.fixture(scope="module")
def takeovers() -> tuple[pd.DataFrame, dict[str, Any]]:
    folder = data_folder("leeds_takeover")
    reference = json.loads((folder / "reference_stats.json").read_text("utf-8"))
    return pd.read_csv(folder / "takeover_trials.csv"), reference


@pytest.mark.parametrize("measure", ["sdlp", "sd_steer", "max_lat", "rt"])
def test_takeover_study_has_the_published_f(
    takeovers: tuple[pd.DataFrame, dict[str, Any]], measure: str
) -> None:
    trials, reference = takeovers
    cells = trials.groupby(["ppid", "n_back", "ttc_s"])[measure].mean().unstack([1, 2])
    means = cells.sort_index(axis=1).dropna().to_numpy(np.float64)
    expected = reference[measure]
    assert means.shape == (expected["n"], 4)
    effects = two_way("n_back", 2, "ttc_s", 2)
    columns = np.tile(np.arange(4), means.shape[0])
    pooled = pooled_f_tests(means.ravel(), columns, effects)
    within = expected["rm_anova"].values()
    between = expected["between_anova"].values()
    for effect, test, one, other in zip(effects, pooled, within, between, strict=True):
        assert_f(repeated_f_test(means, effect), one)
        assert_f(test, other)


def test_takeover_study_has_the_published_workload_comparisons(
    takeovers: tuple[pd.DataFrame, dict[str, Any]],
) -> None:
    table = pd.read_csv(data_folder("leeds_takeover") / "nasa_tlx.csv")
    for scale, expected in takeovers[1]["nasa_tlx"].items():
        rows = table[table["sub_scale"] == scale]
        scores = rows.pivot(
            index="participant", columns="task", values="converted_score"
        )
        first, second = (
            scores[name].to_numpy(float) for name in expected["conditions"]
        )
        assert_t(paired_t_test(first, second), expected["paired_t"])


def session_scores(scale: str) -> NDArray[np.float64]:
    """Scores of participants with all five sessions, shape (13, 5)."""
    table = pd.read_csv(data_folder("racing_sim_tlx") / "nasa_tlx.csv")
    if scale != "raw_tlx_mean_of_six":
        table = table[table["scale"] == scale]
    scores = table.groupby(["participant", "session"])["score"].mean().unstack()
    return np.asarray(scores.dropna().to_numpy(np.float64))


@pytest.mark.parametrize(
    "scale",
    [
        "mental",
        "physical",
        "temporal",
        "performance",
        "effort",
        "frustration",
        "raw_tlx_mean_of_six",
    ],
)
def test_racing_study_has_the_reference_statistics(scale: str) -> None:
    scores = session_scores(scale)
    file = data_folder("racing_sim_tlx") / "reference_stats.json"
    expected = json.loads(file.read_text("utf-8"))[scale]
    assert scores.shape == (expected["n"], 5)
    (effect,) = one_way("session", 5)
    within, published = repeated_f_test(scores, effect), expected["rm_anova"]
    assert_f(within, published)
    assert within.epsilon == pytest.approx(published["eps_gg"], rel=PRINTED)
    corrected = p_value(within, within.epsilon)
    assert corrected == pytest.approx(published["p_gg"], rel=PRINTED)
    assert within.huynh_feldt == pytest.approx(published["eps_hf"], rel=PRINTED)
    size = partial_eta_squared(within.statistic, within.df1, within.df2)
    assert size.value == pytest.approx(published["partial_eta2"], rel=PRINTED)
    columns = np.tile(np.arange(5), scores.shape[0])
    assert_f(
        pooled_f_tests(scores.ravel(), columns, (effect,))[0], expected["between_anova"]
    )
    assert_pairs(scores, expected)
    friedman = friedman_test(scores)
    published = expected["friedman"]
    assert (friedman.statistic, friedman.p) == pytest.approx(
        (published["chi2"], published["p"]), rel=PRINTED
    )


def test_answers_of_the_takeover_study_are_tested_scale_by_scale(
    takeovers: tuple[pd.DataFrame, dict[str, Any]],
) -> None:
    table = pd.read_csv(data_folder("leeds_takeover") / "nasa_tlx.csv")
    answers = table.rename(
        columns={"task": "condition", "sub_scale": "item", "converted_score": "value"}
    )
    found = answer_tests(answers, ("N-back", "No N-back"), reference="No N-back")
    for scale, expected in takeovers[1]["nasa_tlx"].items():
        (row,) = (row for row in found.pairs if row[:2] == (scale, "within"))
        assert (row.mean_first, row.mean_second) == pytest.approx(
            expected["mean"], rel=PRINTED
        )
        paired = expected["paired_t"]
        assert (row.statistic, row.p) == pytest.approx(
            (paired["t"], paired["p"]), rel=PRINTED
        )
        (test,) = (row for row in found.tests if row[:2] == (scale, "within"))
        assert (test.n, test.statistic) == (41, pytest.approx(paired["t"] ** 2))


def test_the_driver_who_left_the_racing_study_is_named() -> None:
    answers = pd.read_csv(data_folder("racing_sim_tlx") / "nasa_tlx.csv").rename(
        columns={"session": "condition", "scale": "item", "score": "value"}
    )
    file = data_folder("racing_sim_tlx") / "reference_stats.json"
    reference = json.loads(file.read_text("utf-8"))
    found = answer_tests(answers, tuple("12345"), None, total="raw_tlx_mean_of_six")
    for scale, expected in reference.items():
        if scale in ("versions", "note"):
            continue
        tests = {row.analysis: row for row in found.tests if row.measure == scale}
        assert tests["friedman"].statistic == pytest.approx(
            expected["friedman"]["chi2"], rel=PRINTED
        )
        assert tests["within"].p_corrected == pytest.approx(
            expected["rm_anova"]["p_gg"], rel=PRINTED
        )
        assert (tests["within"].n, tests["mixed"].n) == (13, 14)
        assert "left out: P14 (no 4, 5)" in tests["friedman"].note
        dropped = [row[1:3] for row in found.dropped if row.measure == scale]
        assert dropped == [("P14", "4"), ("P14", "5")]


def assert_pairs(scores: NDArray[np.float64], expected: dict[str, Any]) -> None:
    pairs = list(combinations(scores.T, 2))
    paired = [paired_t_test(first, second) for first, second in pairs]
    for test, one in zip(paired, expected["paired_t"], strict=True):
        assert_t(test, one)
    corrected = benjamini_hochberg([test.p for test in paired])
    reference = [one["p_bh"] for one in expected["paired_t"]]
    assert corrected == pytest.approx(reference, rel=PRINTED)
    for (first, second), one in zip(pairs, expected["independent_t"], strict=True):
        assert_t(independent_t_test(first, second), one)
