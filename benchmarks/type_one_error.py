"""How often a test finds an effect that is not there: as published and within subjects.

    python -m benchmarks.type_one_error [--studies N] [--seed N]

Draws studies of 12 participants, 7 conditions and 8 lane changes in which no condition
has an effect on average, and prints the share of them in which p is below 0.05, the
share that it should be. Half a minute.
"""

from __future__ import annotations

import argparse
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from costeer.study.anova import FTest, pooled_f_tests
from costeer.study.contrasts import one_way
from costeer.study.repeated import repeated_f_test

PARTICIPANTS, CONDITIONS, CHANGES = 12, 7, 8
LEVEL = 0.05
TESTS = ("published", "uncorrected", "within", "huynh-feldt")
PAIRS = ("published pairs", "within pairs")


class Drivers(NamedTuple):
    """How participants differ, in standard deviations between lane changes of one.

    Attributes:
        person: Between participants, in all conditions alike.
        reaction: Of what each condition does to each participant.
        guidance: Of what guidance, whichever it is, does to each participant.
    """

    person: float
    reaction: float
    guidance: float


ROWS = (
    Drivers(1.0, 0.0, 0.0),
    Drivers(1.0, 0.25, 0.0),
    Drivers(1.0, 0.5, 0.0),
    Drivers(1.0, 1.0, 0.0),
    Drivers(1.0, 0.25, 1.0),
)


def simulated(drivers: Drivers, num_studies: int, seed: int) -> NDArray[np.float64]:
    """Lane changes, shape (studies, participants, conditions, changes)."""
    rng = np.random.default_rng(seed)
    shape = (num_studies, PARTICIPANTS, CONDITIONS, CHANGES)
    assisted = np.arange(CONDITIONS) > 0
    return np.asarray(
        rng.normal(size=shape)
        + drivers.person * rng.normal(size=(*shape[:2], 1, 1))
        + drivers.reaction * rng.normal(size=(*shape[:3], 1))
        + drivers.guidance * rng.normal(size=(*shape[:2], 1, 1)) * assisted[:, None]
    )


def false_alarms(drivers: Drivers, num_studies: int, seed: int) -> dict[str, float]:
    """Share of studies with p below 0.05, by test.

    Of the pairs, which are corrected by Benjamini-Hochberg, any of the six with the
    first condition counts.

    Args:
        drivers: How they differ.
        num_studies: How many are drawn.
        seed: Of the data.
    """
    values = simulated(drivers, num_studies, seed)
    (effect,) = one_way("condition", CONDITIONS)
    cells = np.tile(np.repeat(np.arange(CONDITIONS), CHANGES), PARTICIPANTS)
    pooled = [pooled_f_tests(each.ravel(), cells, (effect,))[0] for each in values]
    means = values.mean(axis=3)
    within = [repeated_f_test(each, effect) for each in means]
    by_condition = np.moveaxis(values, 2, 1).reshape(num_studies, CONDITIONS, -1)
    first, others = by_condition[:, :1], by_condition[:, 1:]
    paired = stats.ttest_rel(means[:, :, 1:], means[:, :, :1], axis=1)
    p_values = {
        "published": _p_values(pooled, [test.epsilon for test in pooled]),
        "uncorrected": _p_values(within, [1.0] * num_studies),
        "within": _p_values(within, [test.epsilon for test in within]),
        "huynh-feldt": _p_values(within, [test.huynh_feldt for test in within]),
        "published pairs": _smallest(stats.ttest_ind(others, first, axis=2).pvalue),
        "within pairs": _smallest(np.asarray(paired.pvalue)),
    }
    return {name: float(np.mean(p < LEVEL)) for name, p in p_values.items()}


def _p_values(tests: list[FTest], epsilons: list[float]) -> NDArray[np.float64]:
    statistic, df1, df2 = np.array([test[:3] for test in tests]).T
    epsilon = np.array(epsilons)
    return np.asarray(stats.f.sf(statistic, epsilon * df1, epsilon * df2))


def _smallest(p: NDArray[np.float64]) -> NDArray[np.float64]:
    """The smallest of the corrected p values of each study."""
    return np.asarray(stats.false_discovery_control(p, axis=1).min(axis=1))


def main() -> None:
    """Print a row per kind of drivers."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--studies", type=int, default=4000)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    error = (LEVEL * (1.0 - LEVEL) / arguments.studies) ** 0.5
    print(
        f"{arguments.studies} studies a row; 0.05 has a standard error of {error:.4f}"
    )
    names = (*Drivers._fields, *TESTS, *PAIRS)
    print("  ".join(names))
    for drivers in ROWS:
        found = false_alarms(drivers, arguments.studies, arguments.seed)
        shown = [f"{value:g}" for value in drivers]
        shown += [f"{found[name]:.3f}" for name in (*TESTS, *PAIRS)]
        cells = zip(shown, names, strict=True)
        print("  ".join(cell.rjust(len(name)) for cell, name in cells), flush=True)


if __name__ == "__main__":
    main()
