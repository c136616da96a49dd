"""Statistics of made-up data, against values that `pingouin_values.py` stored."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from costeer.study.anova import FTest
from costeer.study.contrasts import Effect, one_way, two_way
from costeer.study.outcome import EffectRow
from costeer.study.repeated import repeated_f_test
from costeer.study.rows import About, effect_row
from costeer.study.ttests import benjamini_hochberg, paired_t_test

STORED: dict[str, Any] = json.loads(
    Path(__file__).with_name("pingouin.json").read_text("utf-8")
)

# Two programs on the same doubles: sums of some dozen squares.
SAME = 1e-9


def row_of(means: list[list[float]], effect: Effect) -> EffectRow:
    test: FTest = repeated_f_test(np.array(means), effect)
    return effect_row(About("made up", "within", len(means), ""), effect.name, test)


def test_one_way_is_that_of_pingouin() -> None:
    expected = STORED["one_way"]
    row = row_of(expected["means"], one_way("condition", 7)[0])
    found = (row.statistic, row.p, row.p_corrected, row.epsilon)
    assert found == pytest.approx(
        [expected[name] for name in ("F", "p", "p_gg", "eps_gg")], rel=SAME
    )
    assert row.epsilon_huynh_feldt == pytest.approx(expected["eps_hf"], rel=SAME)
    assert row.effect_size == pytest.approx(expected["np2"], rel=SAME)
    assert row.generalised_eta_squared == pytest.approx(expected["ng2"], rel=SAME)


@pytest.mark.parametrize("which", range(3))
def test_two_way_is_that_of_pingouin(which: int) -> None:
    stored = STORED["two_way"]
    row = row_of(stored["means"], two_way("a", 2, "b", 3)[which])
    found = {
        "F": row.statistic,
        "p_gg": row.p_corrected,
        "eps_gg": row.epsilon,
        "eps_hf": row.epsilon_huynh_feldt,
        "ng2": row.generalised_eta_squared,
    }
    expected = {name: stored[name][which] for name in found}
    assert found == pytest.approx(expected, rel=SAME)


def test_pairs_are_those_of_pingouin() -> None:
    means, expected = np.array(STORED["one_way"]["means"]), STORED["pairs"]
    tests = [paired_t_test(means[:, 0], other) for other in means.T[1:]]
    found = {
        "T": [test.statistic for test in tests],
        "p": [test.p for test in tests],
        "p_bh": list(benjamini_hochberg([test.p for test in tests])),
        "cohen": [test.d_av.value for test in tests],
        "cohen_dz": [test.effect_size.value for test in tests],
    }
    for name, values in found.items():
        assert values == pytest.approx(expected[name], rel=SAME), name
