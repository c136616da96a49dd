"""Colours of the conditions: strength is a hue, duration a shade of it."""

from __future__ import annotations

from costeer.methods.conditions import condition
from costeer.pages.style import STRENGTH_COLOURS

_DURATION_SHADES = {
    "strong": {"rapid": "#00456B", "normal": "#0072B2", "gentle": "#62B0DE"},
    "weak": {"rapid": "#8C3B00", "normal": "#D55E00", "gentle": "#F4A06A"},
}


def condition_colour(name: str) -> str:
    """Return the colour of a condition, the same in every figure."""
    strength, duration = condition(name).strength, condition(name).duration
    if not duration:
        return STRENGTH_COLOURS[strength]
    return _DURATION_SHADES[strength][duration]
