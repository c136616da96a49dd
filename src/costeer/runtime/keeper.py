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
from costeer.runtime.shared import Shared
from costeer.runtime.stream import RecordStream, finish, next_free, record_paths

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

    Raises:
        ValueError: If the name is none for a record.
        OSError: If its folder cannot be written to.
    """

    def __init__(
        self, setup: DriveSetup, record: Path | None, tell: Callable[[str], None]
    ) -> None:
        self._setup = setup
        self._record = record
        self._tell = tell
        self._chosen = first_choice(setup)
        self._recorder: Recorder | None = None
        self._first = (0, 0)
        self._finishing: list[threading.Thread] = []
        self.kept: list[Path] = []
        if record is not None:
            record_paths(record)
            record.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=record.parent):
                pass

    def mark(self, marker: Marker, shared: Shared) -> None:
        """Take a marker: it goes into the record, and begins or ends one."""
        self._chosen = followed(self._chosen, marker)
        if marker.kind == "restarted":
            self._first = (shared.frames.written, shared.trace.written)
            self.finish()
        if marker.kind == "started" and self._recorder is None:
            self._begin(shared)
        if marker.kind not in _NOT_OF_THE_TRIAL and self._recorder is not None:
            self._recorder.mark(marker)
        if marker.kind == "ended":
            self.finish()

    def _begin(self, shared: Shared) -> None:
        """Open the streams of a trial that has just started."""
        if self._record is None:
            return
        try:
            paths = record_paths(next_free(self._record))
            described = drive_metadata(
                chosen_setup(self._setup, self._chosen),
                chosen_parameters(self._setup, self._chosen),
            )
            stream = RecordStream(paths, described, drive_columns(self._setup))
        except (OSError, ValueError) as error:
            self._tell(f"the record cannot be written: {error}")
            return
        self._recorder = Recorder(shared, stream, self._tell, self._first)
        self._recorder.start()

    def finish(self) -> None:
        """Make the record of a trial that is over whole, in a thread of its own."""
        recorder, self._recorder = self._recorder, None
        if recorder is None:
            return
        thread = threading.Thread(target=self._finish, args=(recorder,))
        thread.start()
        self._finishing.append(thread)

    def _finish(self, recorder: Recorder) -> None:
        paths = recorder.stream.paths
        try:
            recorder.stop()
            if finish(paths, recorder.stream.num_rows):
                self.kept.append(paths.record)
        except (OSError, ValueError) as error:
            self._tell(f"{error}; what was driven is in {paths.stream}")

    def close(self) -> None:
        """Finish what is open; returns when every record is whole.

        The shared memory must still be open: the last rows come from there.
        """
        self.finish()
        for thread in self._finishing:
            thread.join()
