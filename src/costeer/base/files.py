"""Files that are there whole or not at all, and folders made for results."""

from __future__ import annotations

import os
import stat
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: Path, durable: bool = False) -> Iterator[Path]:
    """Yield a file beside `path` to write; it takes the place of `path` at the end.

    If the writing fails, `path` is what it was. A process that is killed leaves a file
    whose name begins with that of `path` and ends in `.tmp`.

    Args:
        path: To be there whole or not at all.
        durable: Whether it is on the disk afterwards, also if the power fails.

    Raises:
        OSError: If it cannot be written; it names `path`.
    """
    partial = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    try:
        yield partial
        if durable:
            _synchronise(partial)
        partial.replace(path)
        if durable and os.name == "posix":  # Windows opens no folders
            _synchronise(path.parent)
    except BaseException as error:
        partial.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.errno and not error.filename:
            raise OSError(error.errno, os.strerror(error.errno), str(path)) from error
        raise


def _synchronise(path: Path) -> None:
    """Have the disk take what was written to a file, or a folder's names."""
    descriptor = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


MOST = 4_000_000_000
"""Largest file that is read into memory [bytes]."""


def read_whole(path: Path, most: int = MOST) -> bytes:
    """The content of a file, refused if reading it might never end.

    Args:
        path: Of the file.
        most: Largest size [bytes].

    Raises:
        ValueError: If it is a device, a pipe or a socket, or is too large.
        OSError: If it cannot be read.
    """
    about = path.stat()
    if not (stat.S_ISREG(about.st_mode) or stat.S_ISDIR(about.st_mode)):
        raise ValueError(f"{path} is a device or a pipe; give a file")
    if about.st_size > most:
        raise ValueError(
            f"{path} has {about.st_size / 1e6:.4g} MB, at most {most / 1e6:.4g} MB are "
            "read; give a smaller file"
        )
    return path.read_bytes()


def write_text(path: Path, text: str) -> None:
    """Write a text file, whole or not at all, with the same bytes on every system."""
    with replacing(path) as partial:
        partial.write_text(text, encoding="utf-8", newline="\n")


def try_writing(path: Path) -> None:
    """Find out before minutes of work whether a file can be written.

    Raises:
        OSError: If it cannot.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    probe = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    probe.touch()
    probe.unlink()


def prepare_folder(
    folder: Path, mark: str, kind: str, left: Collection[str] = ()
) -> None:
    """Make a folder for results, and refuse one before minutes of work.

    Args:
        folder: New, empty, or with earlier results of the kind.
        mark: Name of the file that only a folder with such results has.
        kind: Of the results, in words.
        left: Other names that a process which was killed may have left.

    Raises:
        ValueError: If it is a file, or holds other things.
        OSError: If it cannot be written.
    """
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is a file; give a new or empty folder")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _refuse_foreign(folder, mark, kind, left)
        try_writing(folder / mark)
    except OSError as error:
        raise OSError(
            f"cannot write in {folder}: {error.strerror}; choose another folder"
        ) from error


def _refuse_foreign(folder: Path, mark: str, kind: str, left: Collection[str]) -> None:
    """Refuse to spread results over a folder that holds something else."""
    if (folder / mark).exists():
        return
    foreign = [
        path.name
        for path in folder.iterdir()
        if path.name not in left
        and not (path.name.startswith(mark) and path.suffix == ".tmp")
        and not (path.is_dir() and not any(path.iterdir()))
    ]
    if foreign:
        raise ValueError(
            f"{folder} is not empty and holds no {kind} (it holds {min(foreign)}); "
            "choose a new or empty folder"
        )
