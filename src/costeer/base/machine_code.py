"""Where compiled code lies: a private folder, in files that are sealed by a checksum.

What is loaded from there is run. So the folder belongs to this user alone, and a file
that was cut short or changed is not believed but made anew.
"""

from __future__ import annotations

import atexit
import hashlib
import io
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import numba.core.caching

from costeer.base import notice

_Files: Any = numba.core.caching.IndexDataCacheFile  # Any: Numba has no types

_SEAL = hashlib.sha256().digest_size
_KEPT_FOLDERS = 3


class SealedFiles(_Files):  # type: ignore[misc]  # as above
    """Numba's files of one function, each ended by the checksum of what it holds."""

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[BinaryIO]:
        with super()._open_for_write(filepath) as file:
            content = io.BytesIO()
            yield content
            written = content.getvalue()
            file.write(written + hashlib.sha256(written).digest())

    def _load_index(self) -> Any:  # Any: Numba's own
        if _is_damaged(Path(self._index_path)):
            return {}
        return super()._load_index()

    def _load_data(self, name: str) -> Any:  # Any: as above
        if _is_damaged(Path(self._data_path(name))):
            raise OSError("damaged")  # Numba takes it as not there
        return super()._load_data(name)


def _is_damaged(file: Path) -> bool:
    """Whether the seal of a file is broken; it is then removed, and that is told."""
    try:
        content = file.read_bytes()
    except OSError:
        return False
    if hashlib.sha256(content[:-_SEAL]).digest() == content[-_SEAL:]:
        return False
    file.unlink(missing_ok=True)
    notice.tell(f"the machine code in {file.parent} was damaged; it is made anew")
    return True


def private_folder(root: Path, name: str) -> Path:
    """A folder that nobody else writes to; a passing one if there can be none.

    Args:
        root: Where folders of other sources lie too; the oldest of them go.
        name: Of the folder.
    """
    folder = root / name
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        reason = _open_to_others(root) or _open_to_others(folder)
        if not (reason or os.access(folder, os.W_OK)):
            reason = "it cannot be written"
        if not reason:
            _forget_old(root, folder)
    except OSError as error:
        reason = str(error.strerror)
    return folder if not reason else _passing_folder(root, reason)


def _open_to_others(folder: Path) -> str:
    """Why others could put their code into a folder; empty if they could not."""
    if os.name != "posix":
        return ""
    about = folder.stat()
    if about.st_uid != os.getuid():
        return "it belongs to somebody else"
    if about.st_mode & stat.S_IWOTH:
        return "everybody may write there"
    return ""


def _passing_folder(root: Path, reason: str) -> Path:
    """A folder of this process alone, gone at its end."""
    folder = Path(tempfile.mkdtemp(prefix="costeer-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    notice.tell(
        f"machine code is not kept: {root}: {reason}; set COSTEER_CACHE to a folder of "
        "yours, or each start compiles anew"
    )
    return folder


def _forget_old(root: Path, current: Path) -> None:
    """Remove all but the newest few folders of earlier sources."""
    others = [f for f in root.iterdir() if f.is_dir() and f != current]
    others.sort(key=lambda folder: folder.stat().st_mtime, reverse=True)
    for folder in others[_KEPT_FOLDERS - 1 :]:
        shutil.rmtree(folder, ignore_errors=True)
