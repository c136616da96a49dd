"""Results whose numbers are set by hand."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from costeer.comparison.measures import COLUMNS
from costeer.comparison.results import Failure, Results

Given = Mapping[str, Sequence[float]]
"""Values of the drivers by method."""


def results(
    given: Given | Mapping[tuple[str, str], Given],
    measure: str = "sdlp",
    failures: Sequence[Failure] = (),
) -> Results:
    """Results with one measure, on one road or by road and mistake."""
    cells = given if isinstance(next(iter(given)), tuple) else {("road", "none"): given}
    values = {}
    for (scenario, mistake), methods in cells.items():
        for method, numbers in methods.items():
            table = np.full((len(numbers), len(COLUMNS)), math.nan)
            table[:, COLUMNS.index(measure)] = numbers
            values[scenario, mistake, method] = table
    names = list(dict.fromkeys(key[2] for key in values))
    roads = list(dict.fromkeys(key[0] for key in values))
    return Results(
        configuration={"participants": len(table)},
        methods=tuple(names),
        scenarios=tuple(roads),
        mistakes=tuple(dict.fromkeys(key[1] for key in values)),
        values=values,
        disputes={},
        failures=tuple(failures),
        faults={},
        left_out=(),
        num_missing=0,
    )
