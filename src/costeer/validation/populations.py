"""Which population of virtual drivers is looked at, and what it is called."""

from __future__ import annotations

from costeer.base.described import nearest
from costeer.drivers.population import POPULATIONS, Population


def population_named(name: str) -> Population:
    """The population with this name.

    Raises:
        ValueError: If there is none.
    """
    if name not in POPULATIONS:
        raise ValueError(
            f"population '{name}' is not known{nearest(name, POPULATIONS)}; choose one "
            f"of {', '.join(POPULATIONS)}"
        )
    return POPULATIONS[name]


def population_told(population: Population) -> str:
    """The population in words, as `population 3 (virtual-traffic)`."""
    return f"population {population.version} ({population.name})"
