"""Numbers and verdicts as the validation report writes them."""

from __future__ import annotations

import math

from costeer.base.array import Real
from costeer.pages.numerals import NOTHING, number
from costeer.validation.people.findings import (
    RealComparison,
    is_target,
    missed_by,
    value,
)
from costeer.validation.people.findings import met as met_by

MET = "met"
MISSED = "missed"
REPORTED = "reported"
ELSEWHERE = "another domain"
NOT_KNOWN = "no value"

_DIGITS = 3
_MOST_DECIMALS = 4


def short(quantity: Real, digits: int = _DIGITS) -> str:
    """So many significant digits without a power of ten; a dash if undefined."""
    if not math.isfinite(quantity):
        return NOTHING
    if quantity == 0.0:
        return "0"
    size = int(f"{quantity:.{digits - 1}e}".partition("e")[2])
    return number(quantity, min(max(0, digits - 1 - size), _MOST_DECIMALS))


def span(low: Real, high: Real) -> str:
    """Return `3 to 10`; a dash if an end is undefined."""
    if not (math.isfinite(low) and math.isfinite(high)):
        return NOTHING
    return f"{_plain(low)} to {_plain(high)}"


def _plain(limit: Real) -> str:
    """A limit as it was given, without zeros at its end."""
    return f"{limit:g}".replace("-", "\u2212")


def real_verdict(comparison: RealComparison) -> str:
    """Return met, missed, reported, another domain or no value."""
    if not math.isfinite(value(comparison)):
        return NOT_KNOWN
    if comparison.elsewhere:
        return ELSEWHERE
    if not is_target(comparison):
        return REPORTED
    return MET if met_by(comparison) else MISSED


def real_verdict_told(comparison: RealComparison) -> str:
    """The verdict, with how much is missed."""
    verdict = real_verdict(comparison)
    if verdict != MISSED:
        return verdict
    return f"missed by {short(missed_by(comparison), 2)}"
