"""Quantities as words on the command line."""

from __future__ import annotations

import typer


def parse_speed(text: str | float) -> float:
    """Return a speed [m/s] from `19.4` (m/s), `19.4m/s` or `70km/h`.

    Raises:
        typer.BadParameter: If it is none of these.
    """
    told = "a speed; give metres per second, as 19.4, or 70km/h."
    return _parsed(text, {"km/h": (1.0, 3.6), "m/s": (1.0, 1.0)}, told)


def parse_length(text: str | float) -> float:
    """Return a length [m] from `3000` (m), `3000m` or `3km`.

    Raises:
        typer.BadParameter: If it is none of these.
    """
    told = "a length; give metres, as 3000, or 3km."
    return _parsed(text, {"km": (1000.0, 1.0), "m": (1.0, 1.0)}, told)


def parse_width(text: str | float) -> float:
    """Return the width of a figure [mm] from `88` (mm), `88mm`, `8.8cm` or `3.5in`.

    Raises:
        typer.BadParameter: If it is none of these.
    """
    told = "a width; give millimetres, as 88mm."
    return _parsed(text, {"mm": (1.0, 1.0), "cm": (10.0, 1.0), "in": (25.4, 1.0)}, told)


def _parsed(
    text: str | float, units: dict[str, tuple[float, float]], told: str
) -> float:
    """A number times its unit's size, a fraction: 3.6 km/h are 1 m/s exactly.

    Raises:
        typer.BadParameter: If it is none, saying what `told` does.
    """
    if isinstance(text, float):
        return text
    word = text.replace(" ", "")
    unit = next((each for each in units if word.endswith(each)), "")
    times, over = units.get(unit, (1.0, 1.0))
    try:
        return float(word.removesuffix(unit)) * times / over
    except ValueError:
        raise typer.BadParameter(f"{text!r} is not {told}") from None
