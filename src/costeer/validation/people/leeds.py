"""First steering correction of a heading error (set `leeds_steering_onset`).

Goodridge, Mole, Billington, Markkula and Wilkie (2022), JEP:HPP 48(1), 64: a line
appears whose direction differs by 1 or 2 deg, at 8 m/s. One row per trial; what counts
here is a driver's median. Trials that the authors mark as early (a movement within
0.15 s, which the line cannot have caused) are kept, as in the medians they print.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.validation.people.findings import Values
from costeer.validation.people.folder import Columns, groups, read_table, table_path

HEADINGS = (1.0, 2.0)
"""Heading errors of the experiment [deg]."""

Rows = NDArray[np.intp]

_COLUMNS = Columns(numbers=("heading", "FirstSteeringTime", "peakSWA", "pNum"))


class Corrections(NamedTuple):
    """Medians of the drivers at one heading error.

    Attributes:
        onset: Of the steering, shape `(driver,)` [s].
        peak: Largest steering-wheel angle, shape `(driver,)` [deg].
    """

    onset: Values
    peak: Values


def corrections(folder: Path | None, heading: Real) -> Corrections:
    """Medians of each driver; empty if the set is absent.

    Args:
        folder: With the sets.
        heading: Error, 1 or 2 [deg].

    Raises:
        ValueError: If the table cannot be read.
    """
    path = table_path(folder, "leeds_steering_onset")
    if path is None:
        return Corrections(np.empty(0), np.empty(0))
    table = read_table(path, _COLUMNS)
    here = np.flatnonzero(table["heading"] == heading)
    drivers = [here[rows] for rows in groups(table["pNum"][here])]
    return Corrections(
        onset=_medians(table["FirstSteeringTime"], drivers),
        peak=_medians(np.abs(table["peakSWA"]), drivers),
    )


def _medians(values: Values, drivers: list[Rows]) -> Values:
    """Median of each driver's rows, shape `(driver,)`."""
    return np.array([np.nanmedian(values[rows]) for rows in drivers])
