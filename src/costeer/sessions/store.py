"""The memory of a study with people: one SQLite file, written before pages are told.

WAL and `synchronous=FULL`: what `transaction` has left is on the disk, also after a
power cut. Times are wall clock in UTC and the monotonic clock, so that a clock that is
set in the middle is seen.
"""

from __future__ import annotations

import json
import sqlite3
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

# Any, in this file: values of rows.
STORE_FILE = "session.sqlite"
"""Name of the file in the folder of a study."""

VERSION = 1
"""Of the tables."""

_TABLES = """
CREATE TABLE IF NOT EXISTS plans (
  version INTEGER PRIMARY KEY, hash TEXT NOT NULL, text TEXT NOT NULL,
  utc TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS scenarios (
  version INTEGER NOT NULL, name TEXT NOT NULL, text TEXT NOT NULL,
  PRIMARY KEY (version, name));
CREATE TABLE IF NOT EXISTS participants (
  participant TEXT PRIMARY KEY, slot INTEGER NOT NULL, plan INTEGER NOT NULL,
  language TEXT NOT NULL, status TEXT NOT NULL, reason TEXT NOT NULL DEFAULT '',
  utc TEXT NOT NULL, monotonic REAL NOT NULL);
CREATE TABLE IF NOT EXISTS steps (
  participant TEXT NOT NULL, step TEXT NOT NULL, state TEXT NOT NULL,
  reason TEXT NOT NULL DEFAULT '', utc TEXT NOT NULL, monotonic REAL NOT NULL,
  PRIMARY KEY (participant, step));
CREATE TABLE IF NOT EXISTS answers (
  participant TEXT NOT NULL, step TEXT NOT NULL, condition TEXT NOT NULL,
  instrument TEXT NOT NULL, version TEXT NOT NULL, language TEXT NOT NULL,
  item TEXT NOT NULL, value TEXT NOT NULL, utc TEXT NOT NULL, monotonic REAL NOT NULL,
  PRIMARY KEY (participant, step, item));
CREATE TABLE IF NOT EXISTS attempts (
  participant TEXT NOT NULL, step TEXT NOT NULL, attempt INTEGER NOT NULL,
  kind TEXT NOT NULL, condition TEXT NOT NULL, "order" INTEGER NOT NULL,
  state TEXT NOT NULL, record TEXT NOT NULL DEFAULT '', reason TEXT NOT NULL DEFAULT '',
  excluded INTEGER NOT NULL DEFAULT 0, facts TEXT NOT NULL DEFAULT '{}',
  measures TEXT NOT NULL DEFAULT '{}', started TEXT NOT NULL,
  ended TEXT NOT NULL DEFAULT '', monotonic REAL NOT NULL,
  PRIMARY KEY (participant, step, attempt));
CREATE TABLE IF NOT EXISTS events (
  number INTEGER PRIMARY KEY, participant TEXT NOT NULL, step TEXT NOT NULL,
  kind TEXT NOT NULL, text TEXT NOT NULL, data TEXT NOT NULL, utc TEXT NOT NULL,
  monotonic REAL NOT NULL);
CREATE TABLE IF NOT EXISTS withdrawn (number INTEGER PRIMARY KEY);
"""

OF_PEOPLE = ("steps", "answers", "attempts", "events", "participants")
"""Tables with rows of participants."""


_WAY_OUT = (
    "put a copy of it back; without one the drives in records/ are still whole, and "
    "costeer report reads that folder by itself"
)


class StoreError(OSError):
    """What was to be kept could not be written; nothing of it was."""


class Moment(NamedTuple):
    """Now, by both clocks.

    Attributes:
        utc: Wall clock, ISO 8601 with milliseconds.
        monotonic: That never goes back [s].
    """

    utc: str
    monotonic: float


def now() -> Moment:
    """This moment."""
    told = datetime.now(UTC).isoformat(timespec="milliseconds")
    return Moment(told.replace("+00:00", "Z"), round(time.monotonic(), 3))


def seconds_of(utc: str) -> float:
    """A moment of the wall clock as seconds since 1970.

    Raises:
        ValueError: If it is none.
    """
    return datetime.fromisoformat(utc.replace("Z", "+00:00")).timestamp()


def utc_of(seconds: float) -> str:
    """Seconds since 1970 as a moment of the wall clock, with milliseconds."""
    told = datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds")
    return told.replace("+00:00", "Z")


Row = dict[str, Any]


class Store:
    """The open file of a study; one process at a time, any thread.

    Args:
        path: Of the file; made if it is not there.

    Raises:
        ValueError: If it is no store of costeer's.
        StoreError: If it cannot be opened.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._lock = threading.RLock()
        try:
            self._file = sqlite3.connect(
                path, isolation_level=None, check_same_thread=False, timeout=5.0
            )
            self._file.row_factory = sqlite3.Row
            for setting in (
                "journal_mode=WAL",
                "synchronous=FULL",
                "secure_delete=ON",
                "foreign_keys=ON",
            ):
                self._file.execute(f"PRAGMA {setting}")
            self._check_version()
            self._check_whole()
            self._file.executescript(_TABLES)
            self._file.execute(f"PRAGMA user_version={VERSION}")
        except sqlite3.DatabaseError as error:
            if isinstance(error, sqlite3.OperationalError):
                raise StoreError(f"{path} cannot be opened: {error}") from error
            raise ValueError(
                f"{path} is no store of a study: {error}; {_WAY_OUT}"
            ) from error

    def _check_version(self) -> None:
        """Refuse a file of another version or kind.

        Raises:
            ValueError: If it is one.
        """
        (found,) = self._file.execute("PRAGMA user_version").fetchone()
        (tables,) = self._file.execute("SELECT count(*) FROM sqlite_master").fetchone()
        if tables and found != VERSION:
            raise ValueError(
                f"{self.path} is of version {found}; this costeer reads {VERSION}"
            )

    def _check_whole(self) -> None:
        """Refuse a file that is damaged before anything is written into it.

        Raises:
            ValueError: If it is.
        """
        (found,) = self._file.execute("PRAGMA quick_check(1)").fetchone()
        if found != "ok":
            told = " ".join(str(found).split())
            raise ValueError(f"{self.path} is damaged: {told}; {_WAY_OUT}")

    def close(self) -> None:
        """Close the file."""
        with self._lock:
            self._file.close()

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """All that is written within is kept, or nothing.

        Raises:
            StoreError: If it cannot be kept, as on a full disk.
        """
        with self._lock:
            try:
                self._file.execute("BEGIN IMMEDIATE")
                yield
                self._file.execute("COMMIT")
            except sqlite3.Error as error:
                self._undo()
                raise StoreError(
                    f"{self.path} cannot be written: {error}; nothing was lost, free "
                    "some space and go on"
                ) from error
            except BaseException:
                self._undo()
                raise

    def _undo(self) -> None:
        if self._file.in_transaction:
            self._file.execute("ROLLBACK")

    def rows(self, query: str, *values: Any) -> list[Row]:
        """What a query finds.

        Raises:
            StoreError: If the file cannot be read.
        """
        with self._lock:
            try:
                return [dict(row) for row in self._file.execute(query, values)]
            except sqlite3.Error as error:
                raise StoreError(f"{self.path} cannot be read: {error}") from error

    @property
    def changes(self) -> int:
        """Rows changed since it was opened: what was read holds while it stays."""
        return self._file.total_changes

    def put(self, table: str, row: Mapping[str, Any]) -> None:
        """Write a row, within a transaction; one with the same key is changed.

        A changed row keeps its place: `ORDER BY rowid` is the order in which rows came,
        whatever was done to the clock.
        """
        names = ", ".join(f'"{name}"' for name in row)
        marks = ", ".join("?" * len(row))
        changed = ", ".join(f'"{name}" = excluded."{name}"' for name in row)
        self._file.execute(
            f"INSERT INTO {table} ({names}) VALUES ({marks}) "
            f"ON CONFLICT DO UPDATE SET {changed}",
            tuple(map(_kept, row.values())),
        )

    def run(self, command: str, *values: Any) -> None:
        """Change rows, within a transaction."""
        self._file.execute(command, values)

    def tell(
        self,
        kind: str,
        text: str = "",
        participant: str = "",
        step: str = "",
        data: Mapping[str, Any] | None = None,
    ) -> None:
        """Write an event with the time, within a transaction."""
        self.put(
            "events",
            {
                "participant": participant,
                "step": step,
                "kind": kind,
                "text": text,
                "data": dict(data or {}),
                **now()._asdict(),
            },
        )

    def forget(self, participant: str) -> None:
        """Delete every row of a participant, and the pages they stood on.

        Raises:
            StoreError: If that cannot be done.
        """
        with self.transaction():
            for table in OF_PEOPLE:
                self.run(f"DELETE FROM {table} WHERE participant = ?", participant)
            self.run("INSERT INTO withdrawn DEFAULT VALUES")
        with self._lock:
            try:
                self._file.execute("VACUUM")
                self._file.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            except sqlite3.Error as error:
                raise StoreError(
                    f"{self.path}: the rows are deleted, but free pages may still hold "
                    f"them: {error}; free some space and run it again"
                ) from error


def refuse_lost_store(folder: Path) -> None:
    """Refuse a study whose drives are there and whose store is not.

    Begun anew, it would know nothing of who took part.

    Args:
        folder: Of the study.

    Raises:
        ValueError: Saying how many drives there are, and the way out.
    """
    file = folder / STORE_FILE
    parts = [file, file.with_name(f"{STORE_FILE}-wal")]
    if any(part.exists() and (part.is_dir() or part.stat().st_size) for part in parts):
        return
    rooms = ("records", "practice", "aborted")
    drives = [each for room in rooms for each in (folder / room).glob("*.parquet")]
    drives = [each for each in drives if not each.name.endswith(".wheel.parquet")]
    if drives:
        what = "empty" if file.exists() else "missing"
        lie = "drive lies" if len(drives) == 1 else "drives lie"
        raise ValueError(
            f"{file} is {what}, but {len(drives)} {lie} in the folder; {_WAY_OUT}; or "
            "begin another study in a new folder"
        )


def _kept(value: Any) -> Any:
    """A value as SQLite takes it; lists and mappings as JSON."""
    if isinstance(value, dict | list | tuple):
        return json.dumps(value, ensure_ascii=False, sort_keys=True)
    return value
