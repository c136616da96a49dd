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
