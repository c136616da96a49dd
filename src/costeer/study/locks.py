"""Who may work in a study's folder: one process alone, or one for each shard.

The locks are the kernel's, so that a killed owner holds nothing. A shard takes its own
lock while it holds that of the folder for a moment; who works alone keeps the folder's
and looks whether a shard has one.
"""

from __future__ import annotations

import os
import re
import socket
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from costeer.base.files import prepare_folder
from costeer.scale.shard import Shard

LOCK_FILE = ".lock"
_SHARD_LOCK = re.compile(r"\.lock-(\d+)-of-(\d+)")
_START = 30.0
"""How long a shard waits for others that begin [s]."""


@contextmanager
def held_folder(
    path: Path, mark: str, kind: str, shard: Shard, begin: Callable[[bool], object]
) -> Iterator[None]:
    """Hold a folder for results, or a shard of it, new or begun before.

    Args:
        path: Made if it is not there.
        mark: Name of the file that only a folder with such results has.
        kind: Of the results, in words.
        shard: To hold; others may work on the other shards meanwhile.
        begin: Writes what the folder is, or sees that it is the same; called with
            whether no other process is at work.

    Raises:
        ValueError: If the folder holds other things, or another process works in it.
        OSError: If it cannot be written.
    """
    if shard.total == 1:
        prepare_folder(path, mark, kind, (LOCK_FILE,))
        with locked(path):
            begin(True)
            yield
        return
    locks = [shard_lock(path, Shard(n + 1, shard.total)) for n in range(shard.total)]
    if path.is_dir() or not path.exists():
        path.mkdir(parents=True, exist_ok=True)
    else:
        prepare_folder(path, mark, kind)  # refuses it
    with ExitStack() as held:
        # Many begin at once, so each prepares the folder while it holds it.
        with beginning_shard(path, shard) as alone:
            left = (LOCK_FILE, *(each.name for each in locks))
            prepare_folder(path, mark, kind, left)
            held.enter_context(locked_shard(path, shard))
            begin(alone)
        yield


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold the folder against all other processes.

    Raises:
        ValueError: If another process holds it, or one of its shards.
    """
    with _held(path / LOCK_FILE, path, 0.0):
        for shard in held_shards(path):
            raise ValueError(
                f"{path} is in use by shard {shard.number}/{shard.total} "
                f"({_owner(shard_lock(path, shard))}); wait until all shards have "
                "ended, then run costeer merge"
            )
        yield


@contextmanager
def locked_shard(path: Path, shard: Shard) -> Iterator[None]:
    """Hold one shard of the folder; call it within `beginning_shard`.

    Raises:
        ValueError: If another process holds the shard.
    """
    with _held(shard_lock(path, shard), path, 0.0):
        yield


@contextmanager
def beginning_shard(path: Path, shard: Shard) -> Iterator[bool]:
    """Hold the folder for the moment in which a shard begins.

    Yields:
        Whether no other shard is at work.

    Raises:
        ValueError: If a process works in it alone, or shards of another number do.
    """
    with _held(path / LOCK_FILE, path, _START, removed=False):
        others = held_shards(path)
        wrong = [each for each in others if each.total != shard.total]
        if wrong:
            raise ValueError(
                f"{path} is in use by shard {wrong[0].number}/{wrong[0].total}; all "
                f"shards at work need the same number, and this one is "
                f"{shard.number}/{shard.total}"
            )
        try:
            yield not others
        except ValueError:  # it is no folder of ours
            (path / LOCK_FILE).unlink(missing_ok=True)
            raise


def held_shards(path: Path) -> list[Shard]:
    """The shards that a process holds; locks that a killed one left are removed."""
    found = []
    for file in sorted(path.glob(f"{LOCK_FILE}-*-of-*")):
        match = _SHARD_LOCK.fullmatch(file.name)
        if match is None:
            continue
        lock = FileLock(file, thread_local=False)
        try:
            lock.acquire(timeout=0)
        except Timeout:
            found.append(Shard(int(match[1]), int(match[2])))
            continue
        with suppress(OSError):
            file.unlink()
        lock.release()
    return found


def shard_lock(path: Path, shard: Shard) -> Path:
    """The file of a shard's lock."""
    return path / f"{LOCK_FILE}-{shard.number}-of-{shard.total}"


@contextmanager
def _held(
    file: Path, path: Path, patience: float, removed: bool = True
) -> Iterator[None]:
    """Hold a lock; its file stays if others may wait for it, or each gets its own."""
    owner = _owner(file)
    lock = FileLock(file, thread_local=False)
    try:
        lock.acquire(timeout=patience)
    except Timeout:
        raise ValueError(
            f"{path} is in use by another costeer ({owner}); wait until it has "
            "ended, or choose another folder"
        ) from None
    except NotImplementedError:
        raise ValueError(
            f"the file system of {path} has no locks; choose a folder on another, or "
            "have it mounted with locks"
        ) from None
    try:
        with suppress(OSError):  # Windows lets nobody write to a locked file
            file.write_text(f"process {os.getpid()} on {socket.gethostname()}")
        yield
    finally:
        with suppress(OSError):  # Windows removes it only once it is released
            if removed:
                file.unlink()
        lock.release()


def _owner(file: Path) -> str:
    with suppress(OSError, UnicodeDecodeError):
        return file.read_text() or "a process that just started"
    return "a process that just started"
