"""Modules that were documented under another name: the old name still imports them."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

MOVED = {
    "costeer.loop.arrow": "costeer.records.arrow",
    "costeer.loop.columns": "costeer.records.columns",
    "costeer.loop.linear": "costeer.validation.linear",
    "costeer.loop.plausible": "costeer.records.plausible",
    "costeer.loop.record": "costeer.records.record",
    "costeer.runtime.head": "costeer.devices.head",
    "costeer.runtime.wheels": "costeer.devices.wheels",
    "costeer.study.conditions": "costeer.methods.conditions",
    "costeer.study.jobs": "costeer.scale.jobs",
}
"""Where a module, or a whole room with all that is in it, was and is."""


def new_name(name: str) -> str | None:
    """What a moved module is called now; None if `name` was not moved."""
    for old, new in MOVED.items():
        if name == old or name.startswith(old + "."):
            return new + name.removeprefix(old)
    return None


class _Present(Loader):
    """Gives the module that lies at the new place, which is loaded already."""

    def __init__(self, module: ModuleType) -> None:
        self._module, self._spec = module, module.__spec__

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return self._module

    def exec_module(self, module: ModuleType) -> None:
        module.__spec__ = self._spec  # the import has put the old name there


class _Finder(MetaPathFinder):
    """Finds moved modules by their old names."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,
        target: ModuleType | None = None,
    ) -> ModuleSpec | None:
        name = new_name(fullname)
        if name is None:
            return None
        return ModuleSpec(fullname, _Present(import_module(name)))


def install() -> None:
    """Let the old names be imported."""
    if not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())  # before the search by path
