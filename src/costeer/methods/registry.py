"""Methods by name: costeer's own, those of installed packages, and files."""

from __future__ import annotations

from typing import Any, TypeAlias

from costeer.base.registry import Registry
from costeer.methods.checked import checked_method
from costeer.methods.ibhs import IBHS
from costeer.methods.interface import Method
from costeer.methods.manual import MANUAL
from costeer.methods.rivals import RIVALS

AnyMethod: TypeAlias = Method[Any, Any]  # Any: parameters and state are its own

METHODS: dict[str, AnyMethod] = {each.name: each for each in (IBHS, MANUAL, *RIVALS)}
"""Methods that need no place to be found; a script may add its own."""

method_named = Registry[AnyMethod](
    what="method",
    group="costeer.methods",
    own=METHODS,
    kind=Method,
    checked=checked_method,
).named
