"""Objects of other people: found by a name, loaded, and known by their sources.

A plug-in is named by an entry point of an installed package, by `module:object`, or by
a file, `rival.py` or `rival.py:object`. Its hash covers every file of its own that its
functions reach, so that a record says what ran and machine code is never stale.
"""

from __future__ import annotations

import hashlib
import inspect
import marshal
import sys
import sysconfig
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module, util
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType
from typing import Any, cast

import numpy as np
from numba.core import serialize

_PACKAGE = Path(__file__).parents[1]
_LIBRARY = Path(sysconfig.get_paths()["stdlib"])
_FILES = "costeer_plugin_"


def advertised(group: str) -> dict[str, str]:
    """What installed packages offer in an entry-point group: name to `module:object`.

    Raises:
        ValueError: If two of them have one name.
    """
    found: dict[str, str] = {}
    for point in sorted(entry_points(group=group), key=lambda each: each.value):
        if found.get(point.name, point.value) != point.value:
            raise ValueError(
                f"two plug-ins of {group} are called '{point.name}': "
                f"{found[point.name]} and {point.value}; remove one of them, or name "
                "the one you mean as module:object"
            )
        found[point.name] = point.value
    return found


def is_place(name: str) -> bool:
    """Whether a name says where an object is: `module:object` or a Python file."""
    return ":" in name or name.endswith(".py")


def load_object(place: str, kind: type, usual: str) -> Any:  # Any: of `kind`
    """The object at a place.

    Args:
        place: `module:object`, `file.py` or `file.py:object`.
        kind: Class that it must be of; `object` for whatever is there.
        usual: Name of the object in a file, if the place does not tell.

    Raises:
        ValueError: If nothing of that kind is there; it says what is.
    """
    where, _, name = place.rpartition(":") if ":" in place[2:] else (place, "", "")
    module = _file_module(Path(where)) if where.endswith(".py") else _module(where)
    if not name:
        name = _only_name(module, kind, usual, place)
    found = module
    for part in name.split("."):
        if not hasattr(found, part):
            raise ValueError(f"{where} has no '{name}'; it has {_names(module, kind)}")
        found = getattr(found, part)
    if not isinstance(found, kind):
        raise ValueError(
            f"{place} is a {type(found).__name__}, no {kind.__name__}; {where} has "
            f"{_names(module, kind)}"
        )
    return found


def _names(module: ModuleType, kind: type) -> str:
    """What a module has of a kind, for a message."""
    if kind is object:
        return ", ".join(name for name in vars(module) if not name.startswith("_"))
    names = [name for name, each in vars(module).items() if isinstance(each, kind)]
    return f"the {kind.__name__} {', '.join(names)}" if names else f"no {kind.__name__}"


def _only_name(module: ModuleType, kind: type, usual: str, place: str) -> str:
    """Name of the one object of the kind that a file makes.

    Raises:
        ValueError: If there is none, or several and none has the usual name.
    """
    own = [name for name, each in vars(module).items() if isinstance(each, kind)]
    if usual in own or (len(own) == 1 and kind is not object):
        return usual if usual in own else own[0]
    raise ValueError(
        f"{place} has {_names(module, kind)}; give one of them the name {usual}, or "
        f"say which: {place}:NAME"
    )


def _module(name: str) -> ModuleType:
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        if error.name and name.startswith(error.name):
            raise ValueError(
                f"there is no module '{error.name}' to import; install it, or give "
                "the path of its file"
            ) from error
        raise ValueError(f"{name} needs a module that is not there: {error}") from error


def _file_module(path: Path) -> ModuleType:
    """The module of a file, under a name that is the same in every process.

    The folder of the file becomes importable, as that of a script is.
    """
    if not path.is_file():
        raise ValueError(f"there is no file {path}; give the path of a Python file")
    path = path.resolve()
    name = _FILES + path.stem
    there = sys.modules.get(name)
    if there is not None:
        if there.__file__ == str(path):
            return there
        raise ValueError(
            f"two plug-ins are called {path.stem}: {there.__file__} and {path}; give "
            "one of the files another name"
        )
    spec = util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ValueError(f"{path} is no Python file")
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))
    module = util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        raise ValueError(
            f"{path} cannot be loaded: {type(error).__name__}: {error}"
        ) from error
    return module


def is_interactive(functions: Iterable[Callable[..., Any]]) -> bool:
    """Whether a function was written in a notebook or in the script that runs."""
    return any(function.__module__ == "__main__" for function in functions)


def sources_of(functions: Iterable[Callable[..., Any]]) -> list[Path]:
    """Files outside costeer that functions come from or reach.

    Of an installed plug-in all files of its own package count, of other installed
    packages none.
    """
    waiting = [sys.modules[function.__module__] for function in functions]
    own = {module.__name__.partition(".")[0] for module in waiting}
    found: set[Path] = set()
    while waiting:
        module = waiting.pop()
        file = Path(getattr(module, "__file__", None) or "")
        if file in found or not _is_own(module, file, own):
            continue
        found.add(file)
        waiting += [m for m in map(_owner, vars(module).values()) if m is not None]
    return sorted(found)


def _owner(value: Any) -> ModuleType | None:  # Any: whatever a module holds
    """The module that a value is, or was made in."""
    if isinstance(value, ModuleType):
        return value
    return sys.modules.get(getattr(value, "__module__", None) or "")


def _is_own(module: ModuleType, file: Path, own: set[str]) -> bool:
    """Whether a file is a plug-in's own and not costeer's or a library's."""
    if file.suffix != ".py" or file.is_relative_to(_PACKAGE):
        return False
    installed = "site-packages" in file.parts or "dist-packages" in file.parts
    if installed or file.is_relative_to(_LIBRARY):
        return module.__name__.partition(".")[0] in own
    return True


def source_hash(functions: Iterable[Callable[..., Any]]) -> str:
    """Hash of all that decides what functions from outside costeer compute.

    Their files, the numbers in their modules (they may have been read from elsewhere),
    and what a function that was made by another one holds of it.
    """
    functions = tuple(functions)
    digest = hashlib.sha256()
    for file in sources_of(functions):
        digest.update(file.name.encode())
        digest.update(file.read_bytes())
    for function in functions:
        digest.update(_own_text(function))
        for cell in function.__closure__ or ():
            digest.update(_bytes_of(cell.cell_contents))
        module = sys.modules[function.__module__]
        if not Path(getattr(module, "__file__", None) or "").is_relative_to(_PACKAGE):
            digest.update(_numbers(vars(module)))
    return digest.hexdigest()[:16]


def _own_text(function: Callable[..., Any]) -> bytes:
    """A function as it was written, or as it was translated."""
    try:
        return inspect.getsource(function).encode()
    except (OSError, TypeError):
        return marshal.dumps(function.__code__)


def _numbers(names: Mapping[str, Any]) -> bytes:
    """Numbers, texts and arrays among the values of a module."""
    plain = (int, float, str, np.ndarray)
    parts = [
        name.encode() + _bytes_of(value)
        for name, value in sorted(names.items())
        if isinstance(value, plain) and not name.startswith("__")
    ]
    return b"".join(parts)


def _bytes_of(value: Any) -> bytes:  # Any: whatever a function holds
    if isinstance(value, np.ndarray):
        return value.tobytes() + str(value.shape).encode()
    if isinstance(value, (int, float, str, tuple)) or value is None:
        return repr(value).encode()
    return cast("bytes", cast("Any", serialize).dumps(value))  # Any: Numba's, untyped
