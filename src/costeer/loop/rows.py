"""The row of a sample of the loop: the columns of a record, written out once."""

from __future__ import annotations

import math

from costeer.drivers.driver import DriverNoise
from costeer.loop.step import LoopParameters, Sample, initial_state, sense, step
from costeer.records.columns import COLUMNS
from costeer.records.row import row_writer


def sample_like() -> Sample:
    """A sample of the loop, whose kinds and places are those of all."""
    parameters = LoopParameters()
    state = initial_state(parameters)
    noise = DriverNoise(*([0.0] * len(DriverNoise._fields)))
    measurement = sense(parameters, state)
    _, sample = step(parameters, state, measurement, math.nan, False, noise)
    return sample


ROW_WRITER = row_writer(COLUMNS, sample_like())
"""A column whose place the sample does not have ends the import here."""

fill_row = ROW_WRITER.fill
row_values = ROW_WRITER.values
