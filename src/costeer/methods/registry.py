"""Methods by name: costeer's own, those of installed packages, and files."""

from __future__ import annotations

import difflib
from typing import Any, TypeAlias

from costeer.base.plugins import advertised, is_place, load_object, refuse_twin
from costeer.methods.checked import checked_method
from costeer.methods.ibhs import IBHS
from costeer.methods.interface import Method
from costeer.methods.manual import MANUAL
from costeer.methods.rivals import RIVALS

AnyMethod: TypeAlias = Method[Any, Any]  # Any: parameters and state are its own

ENTRY_POINTS = "costeer.methods"
"""Group of entry points under which an installed package offers its methods."""

METHODS: dict[str, AnyMethod] = {each.name: each for each in (IBHS, MANUAL, *RIVALS)}
"""Methods that need no place to be found; a script may add its own."""


def method_named(method: str | AnyMethod) -> AnyMethod:
    """The method that is meant.

    Args:
        method: A name of `METHODS` or of an installed plug-in, `module:object`,
            `file.py`, `file.py:object`, or the method itself.

    Raises:
        ValueError: If there is none, two have the name, or it cannot be run.
    """
    if not isinstance(method, str):
        return _known(method)
    if method in METHODS:
        refuse_twin(ENTRY_POINTS, method)
        return checked_method(METHODS[method])
    if is_place(method):
        return _loaded(method)
    offered = advertised(ENTRY_POINTS)
    if method in offered:
        return _loaded(offered[method])
    known = [*METHODS, *offered]
    near = difflib.get_close_matches(method, known, n=1)
    guess = f" (did you mean {near[0]}?)" if near else ""
    raise ValueError(
        f"method '{method}' is not known{guess}; choose one of {', '.join(known)}, or "
        "give yours as module:object or as a Python file"
    )


def _loaded(place: str) -> AnyMethod:
    return _known(load_object(place, Method, "METHOD"))


def _known(method: AnyMethod) -> AnyMethod:
    """The method, if it can be run and does not bear the name of another.

    Raises:
        ValueError: If not.
    """
    checked = checked_method(method)
    named = METHODS.get(checked.name, checked)
    if named != checked:
        raise ValueError(
            f"two methods are called '{checked.name}': {checked.source} and "
            f"{named.source}; give yours another name"
        )
    return checked
