"""Quantities as words on the command line."""

from __future__ import annotations

import typer


def parse_speed(text: str | float) -> float:
    """Return a speed [m/s] from `19.4` (m/s), `19.4m/s` or `70km/h`.

    Raises:
        typer.BadParameter: If it is none of these.
    """
    if isinstance(text, float):
        return text
    word = text.replace(" ", "")
    try:
        if word.endswith("km/h"):
            return float(word.removesuffix("km/h")) / 3.6
        return float(word.removesuffix("m/s"))
    except ValueError:
        raise typer.BadParameter(
            f"{text!r} is not a speed; give metres per second, as 19.4, or 70km/h."
        ) from None


def parse_length(text: str | float) -> float:
    """Return a length [m] from `3000` (m), `3000m` or `3km`.

    Raises:
        typer.BadParameter: If it is none of these.
    """
    if isinstance(text, float):
        return text
    word = text.replace(" ", "")
    try:
        if word.endswith("km"):
            return float(word.removesuffix("km")) * 1000.0
        return float(word.removesuffix("m"))
    except ValueError:
        raise typer.BadParameter(
            f"{text!r} is not a length; give metres, as 3000, or 3km."
        ) from None


def parse_width(text: str | float) -> float:
    """Return the width of a figure [mm] from `88` (mm), `88mm`, `8.8cm` or `3.5in`.

    Raises:
        typer.BadParameter: If it is none of these.
    """
    if isinstance(text, float):
        return text
    word = text.replace(" ", "")
    endings = {"mm": 1.0, "cm": 10.0, "in": 25.4, "": 1.0}
    ending = next(each for each in endings if word.endswith(each))
    try:
        return float(word.removesuffix(ending)) * endings[ending]
    except ValueError:
        raise typer.BadParameter(
            f"{text!r} is not a width; give millimetres, as 88mm."
        ) from None
