"""What the report of a judgement is made of."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.pages.style import INK
from costeer.training.assessment import Assessment, shown
from costeer.training.comparison import Judged
from costeer.training.operating import best_place


class Material(NamedTuple):
    """A judgement with its origin.

    Attributes:
        assessment: All that was found.
        facts: The same for JSON.
        source: What was judged on, in words.
        network: What the network's file says of its training; empty if unknown.
    """

    assessment: Assessment
    facts: dict[str, Any]  # Any: JSON
    source: str
    network: dict[str, Any]  # Any: JSON


class Look(NamedTuple):
    """How a predictor is drawn, the same in every figure.

    Attributes:
        colour: Of line and marks.
        line: Offset and dashes, which tell it from the others without colour.
        width: Of the line [pt].
    """

    colour: str
    line: tuple[float, tuple[float, ...]]
    width: float


_SOLID: tuple[float, tuple[float, ...]] = (0.0, ())
_OTHERS = (
    ("#D55E00", (0.0, (5.0, 1.5))),
    ("#0072B2", (0.0, (1.2, 1.2))),
    ("#009E73", (0.0, (6.0, 1.5, 1.2, 1.5))),
    ("#CC79A7", (0.0, (3.0, 1.2))),
    ("#E69F00", (0.0, (8.0, 2.0))),
    ("#56B4E9", (0.0, (4.0, 1.2, 1.2, 1.2, 1.2, 1.2))),
)


def looks(material: Material) -> dict[str, Look]:
    """The look of each predictor by name: the judged one in ink, solid and wide."""
    found = {material.assessment.judged.name: Look(INK, _SOLID, 1.6)}
    for one in shown(material.assessment):
        if one.name not in found:
            colour, dashes = _OTHERS[(len(found) - 1) % len(_OTHERS)]
            found[one.name] = Look(colour, dashes, 1.0)
    return found


def rate(material: Material) -> float:
    """False triggers a kilometre at which lead times are compared [1/km]."""
    return float(material.facts["false_per_km_allowed"])


def leads_at_rate(one: Judged) -> NDArray[np.float64]:
    """Lead of each crossing at the best threshold that keeps to the rate [s].

    Returns:
        0 if missed; empty if no threshold keeps to the rate, `(crossing,)`.
    """
    place = place_at_rate(one)
    operating = one.judgement.operating
    return np.empty(0) if place is None else operating.leads[place]


def place_at_rate(one: Judged) -> int | None:
    """Place of that threshold; None if there is none."""
    allowed = float(one.judgement.facts["false_per_km_allowed"])
    return best_place(one.judgement.operating, allowed)
