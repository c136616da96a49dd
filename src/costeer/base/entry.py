"""Compiled entry points and where their machine code is kept.

Numba's own cache looks only at the file of the entry function, so that an edit to an
equation it calls would go unseen. Here the cache folder bears a hash of all of
the sources that compiled code is made of: any edit there makes a new folder
(tests/base/test_entry.py).
"""

from __future__ import annotations

import hashlib
import os
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import event
from numba.core.caching import FunctionCache

from costeer.base.machine_code import SealedFiles, private_folder
from costeer.base.notice import Compilations
from costeer.base.packing import layout_of
from costeer.base.sources import is_interactive
from costeer.base.sources import source_hash as plugin_hash

Function = TypeVar("Function", bound=Callable[..., Any])
_settings = cast("Any", numba.config)  # Any: Numba sets its attributes at import


class _Listener(event.Listener):
    """Passes on when Numba begins to compile, and when it is done."""

    def __init__(self) -> None:
        self._compilations = Compilations()

    def on_start(self, event: Any) -> None:
        self._compilations.begin()

    def on_end(self, event: Any) -> None:
        self._compilations.end()


_register: Any = event.register  # Numba has no types
_register("numba:compile", _Listener())

COMPILED_ROOMS = (
    "base",
    "records",
    "plant",
    "sensing",
    "intention",
    "controller",
    "methods",
    "drivers",
    "loop",
)
"""Rooms whose functions end up in machine code."""


def source_hash(package: Path) -> str:
    """Return a hash of every Python file of the compiled rooms, in path order."""
    digest = hashlib.sha256()
    files = [file for room in COMPILED_ROOMS for file in (package / room).rglob("*.py")]
    for file in sorted(files):
        digest.update(str(file.relative_to(package)).encode())
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


@cache
def cache_folder() -> Path:
    """Return the folder for machine code: COSTEER_CACHE, else the user's cache."""
    home = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    root = Path(os.environ.get("COSTEER_CACHE") or Path(home) / "costeer") / "numba"
    return private_folder(root, source_hash(Path(__file__).parents[1]))


_SETTING = threading.Lock()


@contextmanager
def _machine_code_in(folder: Path) -> Iterator[None]:
    """Let Numba look for the machine code of what is made meanwhile in a folder.

    It takes the folder from a setting of the whole process: one thread at a time.
    """
    with _SETTING:
        before = _settings.CACHE_DIR
        _settings.CACHE_DIR = str(folder)
        try:
            yield
        finally:
            _settings.CACHE_DIR = before


def _kept(dispatcher: Any, kept: FunctionCache) -> Any:  # Any: Numba has no types
    """A compiled function whose machine code is kept in sealed files."""
    files = cast("Any", kept)
    usual = files._cache_file
    sealed: Any = SealedFiles
    files._cache_file = sealed(
        usual._cache_path,
        usual._index_name.removesuffix(".nbi"),
        usual._source_stamp,
    )
    dispatcher._cache = files
    return dispatcher


def entry_for(parts: Iterable[Callable[..., Any]], function: Function) -> Function:
    """Compile a function that closes over functions of a plug-in.

    Its machine code lies in a folder of the plug-in's own, which bears a hash of all
    its sources. What was written in a notebook is compiled anew in each process.

    Args:
        parts: Functions of the plug-in.
        function: Calls them; its closure holds them.
    """
    parts = tuple(parts)
    # Any: Numba does not tell of its dispatchers' cache.
    dispatcher: Any = numba.njit(nogil=True, error_model="numpy")(function)
    if is_interactive(parts):
        return cast("Function", dispatcher)
    with _machine_code_in(cache_folder() / plugin_hash(parts)):
        _kept(dispatcher, cast("Any", _ClosureCache)(function))
    return cast("Function", dispatcher)


class _ClosureCache(FunctionCache):
    """Numba's cache, keyed without what the closure holds: the folder's name says it.

    Numba's own key would pickle the functions in the closure and never be found again.
    Only how its tuples lie packed is not said by sources: two methods may share a step.
    Nor is the name of a module, which machine code holds: a file may be imported, too.
    """

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        digest = hashlib.sha256(self._py_func.__code__.co_code)
        for cell in self._py_func.__closure__ or ():
            held = cell.cell_contents
            digest.update(str(_homes(held)).encode())
            if isinstance(held, tuple):
                digest.update(str(layout_of(held)).encode())
        return sig, codegen.magic_tuple(), digest.hexdigest()


def _homes(value: Any) -> list[str]:  # Any: a function, or a tuple of numbers
    """Names of the modules that a function, or the classes of nested tuples, are of."""
    if not isinstance(value, tuple):
        return [str(getattr(value, "__module__", None))]
    inner = [home for part in value for home in _homes(part)]
    return [type(value).__module__, *inner]


def entry(function: Function) -> Function:
    """Compile a function that Python calls; its machine code is cached on disk.

    The compiled function releases the global interpreter lock, so threads run trials
    side by side.
    """
    dispatcher = numba.njit(nogil=True, error_model="numpy")(function)
    with _machine_code_in(cache_folder()):
        return cast("Function", _kept(dispatcher, cast("Any", FunctionCache)(function)))


@cache
def simulation_source() -> str:
    """Return a hash of all files that decide what a simulated trial is.

    The version alone would let a study be finished with other equations than it was
    begun with, after an edit in a checkout.
    """
    package = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for room in (*COMPILED_ROOMS, "scenarios"):
        for file in sorted((package / room).rglob("*")):
            if file.is_file() and file.suffix != ".pyc":
                digest.update(file.relative_to(package).as_posix().encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()[:16]
