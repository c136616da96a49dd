"""Makes pingouin.json: what pingouin, which no test imports, says of made-up data.

    python -m pip install pingouin==0.7.0
    python tests/study/pingouin_values.py

In an environment of its own: pingouin is under the GPL and brings a dozen packages.
The data are drawn with seed 1 and stored beside the values.
"""

from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pingouin

FILE = Path(__file__).with_name("pingouin.json")
SEED = 1


def main() -> None:
    """Draw the data and write them with pingouin's values."""
    rng = np.random.default_rng(SEED)
    mixing = rng.normal(size=(7, 7)) * [3.0, 2.0, 1.0, 1.0, 0.5, 0.5, 0.5]
    one = np.round(rng.normal(size=(12, 7)) @ mixing.T + np.arange(7), 3)
    two = np.round(rng.normal(size=(9, 6)) @ mixing[:6, :6].T + np.arange(6), 3)
    scores = np.clip(np.round(rng.normal(5.0, 2.0, (13, 5)) + np.arange(5)), 0, 10)
    found = {
        "pingouin": pingouin.__version__,
        "seed": SEED,
        "one_way": {"means": one.tolist(), **_one_way(one)},
        "two_way": {"means": two.tolist(), **_two_way(two)},
        "ranks": {"scores": scores.tolist(), **_ranks(scores)},
        "pairs": _pairs(one),
    }
    FILE.write_text(json.dumps(found, indent=1) + "\n", "utf-8")


def _long(means: np.ndarray[Any, Any]) -> pd.DataFrame:
    who, cell = np.indices(means.shape)
    return pd.DataFrame(
        {"y": means.ravel(), "who": who.ravel(), "c": cell.ravel()}
    ).assign(a=lambda frame: frame["c"] // 3, b=lambda frame: frame["c"] % 3)


def _one_way(means: np.ndarray[Any, Any]) -> dict[str, float]:
    frame = _long(means)
    words = {"dv": "y", "within": "c", "subject": "who"}
    (row,) = pingouin.rm_anova(frame, **words, correction=True).to_dict("records")
    partial = pingouin.rm_anova(frame, **words, effsize="np2")["np2"]
    return {
        "F": row["F"],
        "p": row["p_unc"],
        "p_gg": row["p_GG_corr"],
        "eps_gg": row["eps"],
        "eps_hf": float(pingouin.epsilon(frame, **words, correction="hf")),
        "ng2": row["ng2"],
        "np2": float(partial.iloc[0]),
    }


def _two_way(means: np.ndarray[Any, Any]) -> dict[str, Any]:
    frame = _long(means)
    words = {"dv": "y", "subject": "who"}
    table = pingouin.rm_anova(frame, **words, within=["a", "b"])
    factors = (["a"], ["b"], ["a", "b"])
    return {
        "F": table["F"].tolist(),
        "p_gg": table["p_GG_corr"].tolist(),
        "eps_gg": table["eps"].tolist(),
        "eps_hf": [
            float(pingouin.epsilon(frame, **words, within=each, correction="hf"))
            for each in factors
        ],
        "ng2": table["ng2"].tolist(),
    }


def _ranks(scores: np.ndarray[Any, Any]) -> dict[str, Any]:
    (friedman,) = pingouin.friedman(pd.DataFrame(scores)).to_dict("records")
    pairs = [
        pingouin.wilcoxon(one, other).to_dict("records")[0]
        for one, other in combinations(scores.T, 2)
    ]
    return {
        "W": friedman["W"],
        "Q": friedman["Q"],
        "p": friedman["p_unc"],
        "W_val": [float(pair["W_val"]) for pair in pairs],
        "RBC": [float(pair["RBC"]) for pair in pairs],
    }


def _pairs(means: np.ndarray[Any, Any]) -> dict[str, Any]:
    """Paired comparisons of the first column with every other one."""
    others = means.T[1:]
    tests = [
        pingouin.ttest(means[:, 0], other, paired=True).to_dict("records")[0]
        for other in others
    ]
    p = [float(test["p_val"]) for test in tests]
    sizes = {
        kind: [
            float(
                pingouin.compute_effsize(means[:, 0], other, paired=True, eftype=kind)
            )
            for other in others
        ]
        for kind in ("cohen", "cohen_dz")
    }
    return {
        "T": [float(test["T"]) for test in tests],
        "p": p,
        "p_bh": pingouin.multicomp(p, method="fdr_bh")[1].tolist(),
        **sizes,
    }


if __name__ == "__main__":
    main()
