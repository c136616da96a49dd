"""Numbers as text, the same in every sentence, table and caption of a report."""

from __future__ import annotations

import math

MINUS = "\u2212"
NOTHING = "–"


def number(value: float, digits: int) -> str:
    """Return a number with so many decimals; a dash if it is undefined."""
    if not math.isfinite(value):
        return NOTHING
    text = f"{value:.{digits}f}"
    if float(text) == 0.0:
        text = text.removeprefix("-")
    return text.replace("-", MINUS)


def signed(value: float, digits: int) -> str:
    """Return a difference with its sign; a dash if it is undefined."""
    text = number(value, digits)
    if text == NOTHING or text.startswith(MINUS):
        return text
    return f"+{text}" if float(text) > 0.0 else text


def interval(low: float, high: float, digits: int) -> str:
    """Return `[low, high]`; nothing if an end is undefined."""
    if not (math.isfinite(low) and math.isfinite(high)):
        return ""
    return f"[{number(low, digits)}, {number(high, digits)}]"


def count(value: float) -> str:
    """Return a whole number; a dash if it is undefined."""
    return number(value, 0)


def p_value(p: float) -> str:
    """Return `0.012`, or `<0.001` where three decimals would be zero."""
    if not math.isfinite(p):
        return NOTHING
    return "<0.001" if p < 0.001 else f"{p:.3f}"


def degrees_of_freedom(df: float) -> str:
    """Return whole degrees of freedom as such, others with two decimals."""
    if not math.isfinite(df):
        return NOTHING
    return f"{df:.0f}" if abs(df - round(df)) < 1e-9 else f"{df:.2f}"


def percent(part: float, whole: float) -> str:
    """Return a share as a percentage; a dash without a whole."""
    if not (math.isfinite(part) and math.isfinite(whole)) or whole == 0.0:
        return NOTHING
    return f"{number(100.0 * part / whole, 1)} %"


def listed(words: list[str] | tuple[str, ...]) -> str:
    """Return `a`, `a and b` or `a, b and c`."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def plural(amount: int, singular: str, many: str = "") -> str:
    """Return `1 driver` or `2 drivers`; `many` where an s does not do."""
    return f"{amount} {singular if amount == 1 else many or singular + 's'}"
