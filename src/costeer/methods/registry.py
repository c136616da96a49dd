"""Methods by name."""

from __future__ import annotations

from costeer.methods.ibhs import IBHS
from costeer.methods.interface import Method
from costeer.methods.manual import MANUAL

METHODS: dict[str, Method] = {method.name: method for method in (IBHS, MANUAL)}


def method_named(name: str) -> Method:
    """Return the method called `name`.

    Raises:
        ValueError: If there is none of that name.
    """
    if name not in METHODS:
        known = ", ".join(METHODS)
        raise ValueError(f"method '{name}' is not known; choose one of {known}")
    return METHODS[name]
