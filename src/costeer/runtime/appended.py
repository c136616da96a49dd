"""A file that grows by whole pieces; what cannot be written waits in memory.

A disk that is full takes a part of a piece and leaves a file that nobody can read past
that point. Here the part is taken back, and the piece is tried again later.
"""

from __future__ import annotations

import os
from contextlib import suppress
from io import FileIO
from pathlib import Path


class AppendedFile:
    """A new file; give it to a writer that calls `write`, then `flush` each piece.

    Args:
        path: Where it lies; there must be none.

    Raises:
        OSError: If it cannot be made.
    """

    closed = False

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file = FileIO(path, "x+")
        self._length = 0
        self._waiting = bytearray()

    @property
    def is_whole(self) -> bool:
        """Whether nothing waits to be written."""
        return not self._waiting

    def write(self, piece: bytes) -> int:
        """Take bytes; they are in memory until `flush`."""
        self._waiting += piece
        return len(piece)

    def tell(self) -> int:
        """Where the next piece will stand [bytes]."""
        return self._length + len(self._waiting)

    def flush(self) -> None:
        """Write what waits, all of it or nothing; a file that was deleted comes back.

        Raises:
            OSError: If it cannot be written; it names the file, and all still waits.
        """
        try:
            if not self._is_there():
                self._come_back()
            if self._waiting:
                append(self._file, self._length, self._waiting)
        except OSError as error:
            with suppress(OSError):
                self._file.truncate(self._length)
            reason = os.strerror(error.errno or 0)
            raise OSError(error.errno, reason, str(self.path)) from error
        self._length += len(self._waiting)
        self._waiting.clear()

    def _is_there(self) -> bool:
        """Whether the name still leads to this file."""
        try:
            return os.path.samestat(self.path.stat(), os.fstat(self._file.fileno()))
        except FileNotFoundError:
            return False

    def _come_back(self) -> None:
        """Write anew what somebody has deleted while it was open."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        anew = FileIO(self.path, "x+")
        try:
            self._file.seek(0)
            append(anew, 0, self._file.read(self._length))
        except OSError:
            anew.close()
            self.path.unlink(missing_ok=True)
            raise
        self._file.close()
        self._file = anew

    def close(self) -> None:
        """Let the file go as it is; what waits is lost."""
        self._file.close()


def append(file: FileIO, place: int, piece: bytes | bytearray) -> None:
    """Write a piece at a place, in as many parts as the system takes it.

    Raises:
        OSError: If not all of it can be written.
    """
    file.seek(place)
    with memoryview(piece) as rest:
        done = 0
        while done < len(rest):
            done += file.write(rest[done:]) or 0
