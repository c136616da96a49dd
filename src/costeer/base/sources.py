"""What decides what the functions of a plug-in compute: its files, its numbers.

The bytes of a file count as they were when its module was loaded: what a file holds by
now says nothing about the code that runs.
"""

from __future__ import annotations

import ast
import copyreg
import hashlib
import inspect
import sys
import sysconfig
from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache, partial
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any, TypeAlias

import numpy as np

# Any, in this file: whatever somebody else's modules and functions hold.
Names: TypeAlias = Mapping[str, Any]
"""What a module holds, by name."""

_PACKAGE = Path(__file__).parents[1]
_LIBRARY = Path(sysconfig.get_paths()["stdlib"])
_PLAIN = (bool, int, float, complex, str, bytes, np.generic, type(None))
_sources: dict[str, tuple[Any, bytes]] = {}


class PlugInLoader(SourceFileLoader):
    """Loads a module from its file, never from `__pycache__`, and keeps what it read.

    Python takes a compiled file for current if time, in seconds, and size agree.
    """

    def get_code(self, fullname: str) -> CodeType:
        """Compile the file as it is now."""
        self.source = self.get_data(self.path)
        _sources[fullname] = (self, self.source)
        code: CodeType = self.source_to_code(self.source, self.path)
        return code


def plain(function: Any) -> tuple[FunctionType, tuple[Any, ...]]:
    """The `def` behind something that can be called, and the data it is bound to.

    Args:
        function: A function, a partial, a bound method, or an object with `__call__`.

    Raises:
        ValueError: If no Python function is behind it.
    """
    if isinstance(function, FunctionType):
        return function, ()
    inner: Any = None
    held: tuple[Any, ...] = ()
    if isinstance(function, partial):
        inner, held = function.func, (function.args, function.keywords)
    elif isinstance(function, MethodType):
        inner, held = function.__func__, (function.__self__,)
    elif not isinstance(function, type):
        inner = getattr(function, "py_func", getattr(function, "__wrapped__", None))
        if inner is None and isinstance(type(function).__call__, FunctionType):
            inner, held = type(function).__call__, (function,)
    if inner is None:
        raise ValueError(
            f"{function!r} is a {type(function).__name__}, no Python function; write "
            "it as a def in a file"
        )
    found, more = plain(inner)
    return found, more + held


def is_interactive(functions: Iterable[Callable[..., Any]]) -> bool:
    """Whether a function was written in a notebook or in the script that runs."""
    found = [plain(function)[0].__globals__ for function in functions]
    return any(n.get("__name__") == "__main__" or not _file(n).name for n in found)


def source_hash(functions: Iterable[Callable[..., Any]]) -> str:
    """Hash of all that decides what functions from outside costeer compute.

    The files that they come from or reach, the numbers in those modules (they may have
    been read from elsewhere), and what a function is bound to or closes over. Of an
    installed plug-in all files of its own package count, of other packages none.

    Raises:
        ValueError: If one is no Python function, is bound to something that cannot be
            hashed, or is not in its file any more.
    """
    functions = tuple(functions)
    reader = _Reader([plain(function)[0].__globals__ for function in functions])
    for function in functions:
        reader.add_function(function)
    reader.add_modules()
    return reader.digest.hexdigest()[:16]


def check_unedited(module: ModuleType) -> None:
    """Refuse a module if a file of its own has changed since it was loaded.

    Files of installed packages are not looked at: they are many, and stay as they are.

    Raises:
        ValueError: Naming the file.
    """
    if is_installed(_file(vars(module))):
        return
    reader = _Reader([vars(module)])
    reader.add_module(vars(module))
    reader.add_modules()
    for names in reader.modules:
        file = _file(names)
        if file.is_file() and file.read_bytes() != _source(names):
            raise _edited(names)


def imported_names(source: bytes) -> list[str]:
    """Dotted names of the modules that a file imports, anywhere in it."""
    return list(_imported(source))


@lru_cache(maxsize=256)
def _imported(source: bytes) -> tuple[str, ...]:
    found: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {each.name for each in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found |= {node.module}
            found |= {f"{node.module}.{each.name}" for each in node.names}
    return tuple(sorted(found))


def _edited(names: Names) -> ValueError:
    return ValueError(
        f"{names['__file__']} was edited since it was loaded; load it anew "
        "(importlib.reload), or start Python again"
    )


def _names_of(module: object) -> Names:
    """What the module of a name holds; nothing if there is none."""
    found = sys.modules.get(module) if isinstance(module, str) else None
    return {} if found is None else vars(found)


def _found(dotted: str) -> Any:
    """What `from module import name` gives, if the module is there."""
    module, _, name = dotted.rpartition(".")
    return _names_of(module).get(name)


def _is_among(value: Any, shared: list[Any]) -> bool:
    """Whether a table was imported: it counts, and may change, where it was made."""
    tables = isinstance(value, (list, dict, set))
    return tables and any(value is each for each in shared)


def _file(names: Names) -> Path:
    """File of a module; without a name if it has none."""
    return Path(names.get("__file__") or "")


def _loader(names: Names) -> Any:
    spec = names.get("__spec__")
    return names.get("__loader__") if spec is None else spec.loader


def _source(names: Names) -> bytes:
    """What a module was made of; of one that others loaded, as it is first seen."""
    name, loader = str(names.get("__name__")), _loader(names)
    kept = _sources.get(name)
    if kept is None or kept[0] is not loader:  # as after importlib.reload
        kept = _sources[name] = (loader, _file(names).read_bytes())
    return kept[1]


def is_installed(file: Path) -> bool:
    """Whether a file is costeer's, Python's or of an installed package."""
    libraries = file.is_relative_to(_LIBRARY) or file.is_relative_to(_PACKAGE)
    return libraries or bool({"site-packages", "dist-packages"} & set(file.parts))


def _gist(code: CodeType) -> tuple[Any, ...]:
    """What a function does, without where it stands."""
    constants = tuple(
        _gist(each) if isinstance(each, CodeType) else (type(each).__name__, each)
        for each in code.co_consts
    )
    return code.co_qualname, code.co_code, code.co_names, code.co_varnames, constants


@lru_cache(maxsize=256)
def _gists(source: bytes) -> frozenset[tuple[Any, ...]]:
    """Of all functions in a file."""
    try:
        waiting = [compile(source, "", "exec", dont_inherit=True)]
    except (SyntaxError, ValueError):  # not what was loaded
        return frozenset()
    found = set()
    while waiting:
        code = waiting.pop()
        found.add(_gist(code))
        waiting += [each for each in code.co_consts if isinstance(each, CodeType)]
    return frozenset(found)


def _is_in_its_file(function: FunctionType) -> bool:
    return function.__code__.co_filename == function.__globals__.get("__file__")


def _check_loaded(function: FunctionType) -> None:
    """Refuse a function that its file does not hold any more.

    Loaders of others, as that of pytest, change what they load: they are trusted.

    Raises:
        ValueError: Naming the file.
    """
    names = function.__globals__
    loader = _loader(names)
    usual = type(loader) is SourceFileLoader or isinstance(loader, PlugInLoader)
    if not usual or not _is_in_its_file(function):
        return
    if _gist(function.__code__) not in _gists(_source(names)):
        raise _edited(names)


def _used(code: CodeType) -> set[str]:
    """Names that a function, or one within it, takes from elsewhere."""
    inner = [_used(each) for each in code.co_consts if isinstance(each, CodeType)]
    return set(code.co_names).union(*inner)


def _place_in_file(code: CodeType) -> bytes:
    """Which function of its file it is; two lambdas may share a line."""
    place = f"{code.co_qualname}:{code.co_firstlineno}".encode()
    return place + code.co_code if code.co_name == "<lambda>" else place


def _text(function: FunctionType) -> bytes:
    """A function as it was written, or what it does."""
    ours = Path(function.__code__.co_filename).is_relative_to(_PACKAGE)
    return _text_of_ours(function) if ours else _written(function)


@lru_cache(maxsize=256)
def _text_of_ours(function: FunctionType) -> bytes:
    """What does not change while Python runs."""
    return _written(function)


def _written(function: FunctionType) -> bytes:
    try:
        return inspect.getsource(function).encode()
    except (OSError, TypeError):
        return repr(_gist(function.__code__)).encode()


class _Reader:
    """Goes through functions, and all of a plug-in's own that they reach."""

    def __init__(self, roots: Iterable[Names]) -> None:
        self.digest = hashlib.sha256()
        self.modules: list[Names] = []
        self._own = {str(names.get("__name__")).partition(".")[0] for names in roots}
        self._functions: list[FunctionType] = []
        self._within: set[int] = set()

    def is_own(self, names: Names) -> bool:
        """Whether a module is a plug-in's own, and not costeer's or a library's."""
        file = _file(names)
        if file.suffix != ".py" or file.is_relative_to(_PACKAGE):
            return False
        return not is_installed(file) or (
            str(names.get("__name__")).partition(".")[0] in self._own
        )

    def add_module(self, names: Names) -> None:
        """Note a module that is reached, if it is the plug-in's own."""
        known = any(names is each for each in self.modules)
        if not known and self.is_own(names):
            self.modules.append(names)

    def add_modules(self) -> None:
        """Count files and numbers of all modules that are reached, and reach others."""
        for names in self.modules:  # grows
            source = _source(names)
            self.digest.update(_file(names).name.encode() + source)
            imported = () if is_installed(_file(names)) else _imported(source)
            for name in imported:
                self.add_module(_names_of(name))
            shared = [_found(name) for name in imported]
            for name, value in sorted(names.items()):
                if not name.startswith(("__", "@")) and not _is_among(value, shared):
                    self.add_global(name, value)

    def add_global(self, name: str, value: Any) -> None:
        """Count what a module holds: data; functions and classes stand in the file."""
        if isinstance(value, FunctionType) and _file(value.__globals__).name:
            _check_loaded(value)
            self.add_module(value.__globals__)
        elif isinstance(value, FunctionType):  # of a notebook
            self.add_function(value)
        elif isinstance(value, ModuleType):
            self.add_module(vars(value))
        else:
            self.digest.update(name.encode())
            self.add_value(value, strict=False)

    def add_function(self, given: Any) -> None:
        """Count a function, what it is bound to, closes over and reaches."""
        function, held = plain(given)
        for value in held:
            self.add_value(value)
        if any(function is each for each in self._functions):
            return
        self._functions.append(function)
        names, code = function.__globals__, function.__code__
        if self.is_own(names):
            _check_loaded(function)
            self.add_module(names)
        in_file = self.is_own(names) and _is_in_its_file(function)
        self.digest.update(_place_in_file(code) if in_file else _text(function))
        for cell in function.__closure__ or ():
            self.add_value(cell.cell_contents)
        self.add_value([function.__defaults__, function.__kwdefaults__])
        if not _file(names).name:
            for name in sorted(_used(code) & names.keys()):
                self.add_global(name, names[name])

    def add_value(self, value: Any, strict: bool = True) -> None:
        """Count data.

        Raises:
            ValueError: If it cannot be hashed, and must be.
        """
        if isinstance(value, _PLAIN):
            self.digest.update(f"{type(value).__name__} {value!r};".encode())
        elif isinstance(value, np.ndarray) and value.dtype != object:
            self.digest.update(f"{value.dtype}{value.shape}".encode())
            self.digest.update(np.asarray(value).tobytes())
            if isinstance(value, np.ma.MaskedArray):
                self.digest.update(np.ma.getmaskarray(value).tobytes())
        elif id(value) not in self._within:
            self._within.add(id(value))
            self._add_whole(value, strict)
            self._within.discard(id(value))

    def _add_whole(self, value: Any, strict: bool) -> None:
        """`add_value` of what has parts."""
        if isinstance(value, (tuple, list, dict)):
            self.digest.update(f"{len(value)}[".encode())
            for part in value.items() if isinstance(value, dict) else value:
                self.add_value(part, strict)
        elif isinstance(value, (set, frozenset)):
            self.add_value(sorted(map(repr, value)))
        elif isinstance(value, type):
            self.digest.update(value.__qualname__.encode())
            self.add_module(_names_of(value.__module__))
        elif isinstance(value, ModuleType):
            self.add_module(vars(value))
        elif isinstance(value, (FunctionType, partial, MethodType)):
            self.add_function(value) if strict else None
        elif strict and hasattr(value, "py_func"):  # of Numba
            self.add_function(value)
        elif strict:
            self._add_object(value)
        else:
            self.add_module(_names_of(getattr(value, "__module__", None)))
            if self.is_own(_names_of(type(value).__module__)):
                self.add_value(getattr(value, "__dict__", None), strict)

    def _add_object(self, value: Any) -> None:
        """Count an object by what pickle would keep of it.

        Raises:
            ValueError: If it cannot be told.
        """
        try:
            reduce = copyreg.dispatch_table.get(type(value))
            reduced: Any = reduce(value) if reduce else value.__reduce_ex__(4)
        except Exception as error:  # whatever somebody else's code raises
            raise ValueError(
                f"a {type(value).__name__} cannot be hashed, so no record could say "
                f"what ran: {error}; keep numbers, texts, lists and arrays"
            ) from error
        if isinstance(reduced, str):
            self.digest.update(reduced.encode())
            return
        self.add_value(type(value))
        for part in reduced[1:]:
            self.add_value(list(part) if hasattr(part, "__next__") else part)
