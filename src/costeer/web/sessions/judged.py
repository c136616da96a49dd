"""What a drive of a session has left: its measures, and whether it came to its end."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from costeer.records.record import read_record, read_stream
from costeer.sessions.plan import Step
from costeer.study.measures import trial_row
from costeer.study.people import ended_by

# Any, in this file: of JSON.
LOOK_EVERY = 3.0
"""Time between two looks at how a practice is driven [s]."""


def measured(
    record: Path, step: Step, is_waived: bool = False
) -> tuple[dict[str, Any] | None, str]:
    """Measures of a record, and what to know of it.

    A practice that a collision cut short is no pass, nor is one that does not meet its
    criterion.

    Args:
        record: File of a drive that came to its end.
        step: That was driven.
        is_waived: Whether a practice counts whatever it was like: the criterion was
            met when the participant ended it, or the experimenter ended it.
    """
    try:
        found = read_record(record)
        row = trial_row(found, step.order or None)
    except (ValueError, OSError) as error:
        return None, f"the record cannot be measured: {error}"
    plain = {name: _plain(value) for name, value in row.items()}
    has_hit = ended_by(found.metadata) == "collision"
    told = "it ended with a collision" if has_hit else ""
    if step.kind != "practise":
        return plain, told
    is_short = float(found.columns["time"][-1]) < 60.0 * step.minutes
    if told and is_short and not is_waived:
        return None, f"{told} too early: practise again"
    if meets(step, sdlp := plain.get("sdlp")):
        return plain, told
    missed = f"SDLP {_told(sdlp)}, not below {step.sdlp_below:g} m"
    return (plain, missed) if is_waived else (None, f"{missed}: practise again")


def meets(step: Step, sdlp: object) -> bool:
    """Whether a practice meets the criterion of its step, if there is one."""
    if math.isnan(step.sdlp_below):
        return True
    return isinstance(sdlp, float) and sdlp < step.sdlp_below


def _told(sdlp: object) -> str:
    return f"{sdlp:.2f} m" if isinstance(sdlp, float) else "cannot be told"


def _plain(value: Any) -> Any:
    """A value of a row as JSON has it; no number is null."""
    if hasattr(value, "item"):
        value = value.item()
    return None if isinstance(value, float) and value != value else value


def driven_whole(record: Path, step: Step) -> dict[str, Any] | None:
    """Measures of a record whose drive came to its end; None if it did not.

    A collision that ends the drive is an end of a trial, too: a scenario may be there
    to see whether it comes to one.
    """
    try:
        found = read_record(record)
        length = float(found.metadata["configuration"]["road"]["length"])  # type: ignore[index]
        reached = float(found.columns["longitudinal_position"][-1]) >= length - 1.0
        has_hit = ended_by(found.metadata) == "collision"
    except (ValueError, OSError, KeyError, TypeError):
        return None
    enough = float(found.columns["time"][-1]) >= 60.0 * step.minutes
    if not (reached or has_hit or (step.kind == "practise" and enough)):
        return None
    return measured(record, step)[0]


class LiveCriterion:
    """Whether a practice meets its criterion while it is driven.

    Args:
        step: Whose criterion it is.
        stream: File that the drive writes.
        clock: Never goes back [s].
    """

    def __init__(
        self, step: Step, stream: Path, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._step, self._stream, self._clock = step, stream, clock
        self._looked = -math.inf
        self._thread: threading.Thread | None = None
        self.sdlp: float | None = None

    @property
    def is_met(self) -> bool:
        """Whether it was at the last look."""
        return meets(self._step, self.sdlp)

    def told(self) -> dict[str, Any]:
        """The criterion for pages; looks again if the last look is long ago."""
        is_idle = self._thread is None or not self._thread.is_alive()
        if is_idle and self._clock() - self._looked >= LOOK_EVERY:
            self._looked = self._clock()
            self._thread = threading.Thread(target=self.look, daemon=True)
            self._thread.start()
        below = self._step.sdlp_below
        return {"sdlp": self.sdlp, "below": below, "met": self.is_met}

    def look(self) -> None:
        """Measure what has been driven so far."""
        try:
            value = _plain(trial_row(read_stream(self._stream))["sdlp"])
        except (ValueError, OSError):
            return  # nothing is written yet, or the record is being made whole
        self.sdlp = value if isinstance(value, float) else None
