"""Objects of other people: found by a name and loaded.

A plug-in is named by an entry point of an installed package, by `module:object`, or by
a file, `rival.py` or `rival.py:object`. What its functions compute, so that a record
says what ran and machine code is never stale, is told by `sources`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from importlib import import_module, util
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import Any

from costeer.base.sources import (
    PlugInLoader,
    check_unedited,
    imported_names,
    is_installed,
)

_FILES = "costeer_plugin_"


def advertised(group: str) -> dict[str, str]:
    """What installed packages offer in an entry-point group: name to `module:object`.

    Raises:
        ValueError: If two of them have one name.
    """
    found: dict[str, str] = {}
    for point in _points(group, tuple(sys.path)):
        place = _place_of(point)
        if found.get(point.name, place) != place:
            raise ValueError(
                f"two plug-ins of {group} are called '{point.name}': "
                f"{found[point.name]} and {place}; remove one of them, or name "
                "the one you mean as module:object"
            )
        found[point.name] = place
    return found


@lru_cache(maxsize=64)
def _points(group: str, path: tuple[str, ...]) -> tuple[EntryPoint, ...]:
    """Entry points of a group on a search path; looking for them takes 20 ms."""
    return tuple(sorted(entry_points(group=group), key=lambda each: each.value))


def _place_of(point: EntryPoint) -> str:
    """`module:object` of an entry point, without the extras that may follow."""
    return point.value.partition("[")[0].replace(" ", "")


def refuse_twin(group: str, name: str) -> None:
    """Refuse a name of costeer's own that an installed package has taken as well.

    Raises:
        ValueError: Naming both.
    """
    for point in _points(group, tuple(sys.path)):
        if point.name != name:
            continue
        raise ValueError(
            f"two plug-ins of {group} are called '{name}': costeer's own and "
            f"{_place_of(point)}; remove that package, or have it offer another name"
        )


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
    """The module of a name.

    Raises:
        ValueError: If there is none or it cannot be loaded.
    """
    if not all(part.isidentifier() for part in name.split(".")):
        raise ValueError(
            f"{name!r} is no name of a module; give module:object or a Python file"
        )
    try:
        with _kept_sources():
            module = import_module(name)
    except _TwinError:
        raise
    except (Exception, SystemExit) as error:  # whatever somebody else's code raises
        missing = error.name if isinstance(error, ModuleNotFoundError) else None
        if missing and f"{name}.".startswith(f"{missing}."):
            raise ValueError(
                f"there is no module '{missing}' to import; install it, or give "
                "the path of its file"
            ) from error
        raise _broken(name, error) from error
    check_unedited(module)
    return module


def _broken(place: object, error: BaseException) -> ValueError:
    told = " ".join(str(error).split())
    return ValueError(f"{place} cannot be loaded: {type(error).__name__}: {told}")


def _file_module(path: Path) -> ModuleType:
    """The module of a file, under a name that is the same in every process.

    The folder of the file becomes importable, as that of a script is.

    Raises:
        ValueError: If it is not there, cannot be loaded, or was edited since it was.
    """
    if not path.is_file():
        raise ValueError(f"there is no file {path}; give the path of a Python file")
    path = path.resolve()
    name = _FILES + path.stem
    module = sys.modules.get(name)
    if module is None:
        module = _loaded(name, path)
    elif module.__file__ != str(path):
        raise ValueError(
            f"two plug-ins are called {path.stem}: {module.__file__} and {path}; give "
            "one of the files another name"
        )
    check_unedited(module)
    return module


def _loaded(name: str, path: Path) -> ModuleType:
    """`_file_module`, loaded.

    Raises:
        ValueError: If it cannot be.
    """
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))
    loader = _Loader(name, str(path))
    spec = ModuleSpec(name, loader, origin=str(path))
    spec.has_location = True
    module = util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        with _kept_sources():
            loader.exec_module(module)
    except (Exception, SystemExit) as error:  # whatever somebody else's code raises
        del sys.modules[name]
        if isinstance(error, _TwinError):
            raise
        raise _broken(path, error) from error
    return module


class _TwinError(ValueError):
    """Two files could be meant by an import."""


class _Loader(PlugInLoader):
    """Loads a file that imports no file of its own folder that is hidden by another."""

    def get_code(self, fullname: str) -> Any:
        code = super().get_code(fullname)
        if "." not in fullname and not self.is_package(fullname):
            for top in {n.partition(".")[0] for n in imported_names(self.source)}:
                _check_neighbour(Path(self.path), top)
        return code


def _check_neighbour(path: Path, name: str) -> None:
    """Refuse an import that gives another file than the one that lies beside.

    Raises:
        _TwinError: Naming both.
    """
    beside = [path.parent / f"{name}.py", path.parent / name / "__init__.py"]
    there = [file for file in beside if file.is_file()]
    if not there:
        return
    spec = getattr(sys.modules.get(name), "__spec__", None) or PathFinder.find_spec(
        name
    )
    found = Path((spec and spec.origin) or "what is built in").resolve()
    if found not in there:
        raise _TwinError(
            f"{path} imports {name}, but there are two of that name: {there[0]} and "
            f"{found}, which Python takes; give {there[0].name} another name"
        )


class _Finder:
    """Finds modules as Python does, and has their sources kept."""

    @staticmethod
    def find_spec(
        name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        spec = PathFinder.find_spec(name, path, target)
        loader = None if spec is None else spec.loader
        if spec is None or type(loader) is not SourceFileLoader:
            return spec
        if not is_installed(Path(loader.path)):
            spec.loader = _Loader(name, loader.path)
        return spec


@contextmanager
def _kept_sources() -> Iterator[None]:
    """Keep the bytes of what is imported, as they were when it was."""
    finder: Any = _Finder()  # Any: typeshed wants what only old Pythons called
    usual: list[Any] = sys.meta_path
    before = usual.index(PathFinder) if PathFinder in usual else len(usual)
    usual.insert(before, finder)
    try:
        yield
    finally:
        usual.remove(finder)
