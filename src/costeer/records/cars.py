"""Columns that say where the other cars of a scenario are."""

from __future__ import annotations

import re

from costeer.records.columns import CAR_PREFIX, Column

CAR_SIGNALS = ("position", "lateral", "velocity")
"""What a record says of each other car, in this order."""

CAR_COLUMN = re.compile(rf"{CAR_PREFIX}(\d+)_({'|'.join(CAR_SIGNALS)})")
"""Name of a column that says where another car is."""


def car_columns(num_cars: int) -> tuple[Column, ...]:
    """Where each of the other cars is; NaN while it is not on the road."""
    said = (
        ("m", "middle of car {} along the road", "same"),
        ("m", "of car {} from the left lane's centre, left positive", "reflected"),
        ("m/s", "velocity of car {} along the road", "same"),
    )
    return tuple(
        Column(
            f"{CAR_PREFIX}{car:02d}_{name}",
            unit,
            "float64",
            text.format(car),
            mirrored=mirrored,  # type: ignore[arg-type]  # one of the words above
        )
        for car in range(1, num_cars + 1)
        for name, (unit, text, mirrored) in zip(CAR_SIGNALS, said, strict=True)
    )
