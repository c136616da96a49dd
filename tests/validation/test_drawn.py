"""What is drawn for the drivers of a population."""

from __future__ import annotations

import numpy as np

from costeer.base.packing import leaf_names, packed
from costeer.drivers.driver import DriverParameters
from costeer.drivers.population import participant_driver
from costeer.validation.drawn import UNITS, drawn_drivers, spreads

SPEED = 70.0 / 3.6


def test_every_parameter_that_differs_is_listed() -> None:
    values = np.array([packed(participant_driver(1, n, SPEED)) for n in range(1, 30)])
    names = leaf_names(DriverParameters())
    differing = {
        name
        for name, column in zip(names, values.T, strict=True)
        if np.ptp(column) > 0.0
    }
    assert differing == set(UNITS)


def test_a_listed_value_is_the_drivers_own() -> None:
    second = drawn_drivers(1, 2, SPEED)[1]
    driver = participant_driver(1, 2, SPEED)
    assert second["participant"] == 2
    assert second["arm.stiffness"] == driver.arm.stiffness
    assert second["decision.change_duration"] == driver.decision.change_duration


def test_percentiles_rise() -> None:
    for spread in spreads(drawn_drivers(1, 50, SPEED)):
        assert spread.low < spread.median < spread.high
