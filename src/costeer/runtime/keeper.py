"""Which trial is recorded where, from its start to its Parquet file."""

from __future__ import annotations

import tempfile
import threading
from collections.abc import Callable
from pathlib import Path

from costeer.runtime.choices import (
    chosen_parameters,
    chosen_setup,
    first_choice,
    followed,
)
from costeer.runtime.markers import Marker
from costeer.runtime.recorder import Recorder, drive_metadata
from costeer.runtime.setup import DriveSetup, drive_columns
from costeer.runtime.shared import Rows, Shared
from costeer.runtime.stream import (
    RecordPaths,
    RecordStream,
    finish,
    next_free,
    record_paths,
    rescue,
)

_NOT_OF_THE_TRIAL = ("error", "restarted")
"""Kinds of markers that say nothing of what was driven."""


class Keeper:
    """Begins a record when a trial starts and makes it whole when it is over.

    A record's description says what held when its trial started: what was chosen
    before, in the trial before perhaps, is part of it. Finishing takes seconds, so it
    has a thread of its own.

    Args:
        setup: Of the drive.
        record: File of the first trial; the next get a number. None keeps nothing.
        tell: Is told what could not be kept.
        halt: Is told why nothing is recorded now, and "" once it is again.

    Raises:
        ValueError: If the name is none for a record.
        OSError: If its folder cannot be written to.
    """

    def __init__(
        self,
        setup: DriveSetup,
        record: Path | None,
        tell: Callable[[str], None],
        halt: Callable[[str], None] = lambda reason: None,
    ) -> None:
        self._setup = setup
        self._record = record
        self._tell = tell
        self._halt = halt
        self._chosen = first_choice(setup)
        self._recorder: Recorder | None = None
        self._first = Rows()
        self._is_halted = False
        self._finishing: list[threading.Thread] = []
        self._early: list[Marker] | None = None
        self.kept: list[Path] = []
        self.unkept: list[str] = []
        if record is not None:
            record_paths(record)
            record.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=record.parent):
                pass

    def mark(self, marker: Marker, shared: Shared, rows: Rows) -> None:
        """Take a marker: it goes into the record, and begins or ends one.

        Args:
            marker: What happened.
            shared: Memory of the drive.
            rows: Before which it happened; this process may hear of it later.
        """
        self._chosen = followed(self._chosen, marker)
        if marker.kind == "restarted":
            self._first = rows
            self.finish(rows)
        if marker.kind == "started" and self._recorder is None and self._record:
            self._early = []
            self.retry(shared)
        if marker.kind not in _NOT_OF_THE_TRIAL:
            self._keep(marker)
        if marker.kind == "ended":
            self.finish()

    def _keep(self, marker: Marker) -> None:
        """Put a marker into the record, or aside for one that could not begin yet."""
        if self._recorder is not None:
            self._recorder.mark(marker)
        elif self._early is not None:
            self._early.append(marker)

    def retry(self, shared: Shared) -> None:
        """Begin the record of a trial that has started, if it has not begun yet."""
        if self._record is None or self._early is None:
            return
        try:
            stream = self._opened(self._record)
        except (OSError, ValueError) as error:
            if not self._is_halted:
                self._is_halted = True
                self._halt(f"the record cannot be written: {error}")
            return
        if self._is_halted:
            self._is_halted = False
            self._halt("")
        self._recorder = Recorder(shared, stream, self._halt, self._first)
        for marker in self._early:
            self._recorder.mark(marker)
        self._early = None
        self._recorder.start()

    def _opened(self, record: Path) -> RecordStream:
        """The streams of a trial that has just started.

        Raises:
            OSError: If they cannot be written.
        """
        described = drive_metadata(
            chosen_setup(self._setup, self._chosen),
            chosen_parameters(self._setup, self._chosen),
        )
        paths = record_paths(next_free(record))
        return RecordStream(paths, described, drive_columns(self._setup))

    def finish(self, until: Rows | None = None) -> None:
        """Make the record of a trial that is over whole, in a thread of its own.

        Args:
            until: Where the next trial begins; None if none does.
        """
        if self._early is not None:
            self._early = None
            self._lose("nothing of a trial could be recorded")
        if self._is_halted:
            self._is_halted = False
            self._halt("")
        recorder, self._recorder = self._recorder, None
        if recorder is None:
            return
        thread = threading.Thread(target=self._finish, args=(recorder, until))
        thread.start()
        self._finishing.append(thread)

    def _finish(self, recorder: Recorder, until: Rows | None) -> None:
        paths = recorder.stream.paths
        try:
            recorder.stop(until)
            if finish(paths, recorder.stream.num_rows):
                self.kept.append(paths.record)
        except (OSError, ValueError) as error:
            missing = recorder.stream.missing
            self._lose(f"{error}; {_left(paths)}" + (f"; {missing}" if missing else ""))

    def _lose(self, text: str) -> None:
        """Say what was not kept, now and at the end of the drive."""
        self.unkept.append(text)
        self._tell(text)

    def close(self) -> None:
        """Finish what is open; returns when every record is whole.

        The shared memory must still be open: the last rows come from there.
        """
        self.finish()
        for thread in self._finishing:
            thread.join()


def _left(paths: RecordPaths) -> str:
    """What there is of a record that could not be made whole."""
    if paths.stream.exists():
        return f"what was driven is in {paths.stream}; {rescue(paths)}"
    return f"{paths.stream} is gone, and what was driven with it"
