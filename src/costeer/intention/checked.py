"""What weights say of the check of their bracketed form (`training.bracket_check`)."""

from __future__ import annotations

from typing import Any

from costeer.intention.starts import Band
from costeer.intention.weights import IntentionNetwork

FACT = "bracket"
"""Name of the fact."""

FEWEST_KILOMETRES = 1000.0
"""Shorter checks say too little [km]. Source: assumed; with no wrong verdict on so many
the rate is below 3 in 1000 km (95 %)."""

LARGEST_MARGIN = 0.75
"""Share of the way to a wrong verdict that may have been seen [-]. Source: assumed."""


def passed_band(network: IntentionNetwork) -> Band | None:
    """The band with which these very weights passed; None if they did not."""
    fact: Any = network.facts.get(FACT)  # Any: JSON
    if not isinstance(fact, dict) or fact.get("hash") != network.hash:
        return None
    band = Band(_number(fact, "low"), _number(fact, "high"))
    if not 0.0 <= band.low < 0.5 < band.high <= 1.0 or shortcomings(fact):
        return None
    return band


def shortcomings(fact: dict[str, Any]) -> list[str]:
    """Why a check does not suffice, in words; nothing if it does."""
    driven, wrong, margin = (
        _number(fact, name) for name in ("kilometres", "wrong", "margin")
    )
    told = []
    if not driven >= FEWEST_KILOMETRES:
        told.append(f"{driven:.0f} km are fewer than {FEWEST_KILOMETRES:.0f}")
    if not wrong <= 0.0:
        told.append(f"{wrong:.0f} verdicts were on the wrong side")
    if not margin <= LARGEST_MARGIN:
        told.append(
            f"states went {100.0 * margin:.0f} % of the way to a wrong verdict, more "
            f"than {100.0 * LARGEST_MARGIN:.0f} %"
        )
    return told


def _number(fact: dict[str, Any], name: str) -> float:
    value = fact.get(name)
    return float(value) if isinstance(value, int | float) else float("nan")
