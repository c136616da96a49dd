"""What a drive of a session has left: its measures, and whether it came to its end."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from costeer.records.record import read_record
from costeer.sessions.plan import Step
from costeer.study.measures import trial_row

# Any, in this file: of JSON.


def measured(record: Path, step: Step) -> tuple[dict[str, Any] | None, str]:
    """Measures of a record, and what to know of it.

    A practice with a criterion that it does not meet is no pass.
    """
    try:
        row = trial_row(read_record(record), step.order or None)
    except (ValueError, OSError) as error:
        return None, f"the record cannot be measured: {error}"
    plain = {name: _plain(value) for name, value in row.items()}
    sdlp = plain.get("sdlp")
    is_criterion = step.kind == "practise" and not math.isnan(step.sdlp_below)
    if is_criterion and not (isinstance(sdlp, float) and sdlp < step.sdlp_below):
        return None, f"SDLP {sdlp} m, not below {step.sdlp_below:g} m: practise again"
    return plain, ""


def _plain(value: Any) -> Any:
    """A value of a row as JSON has it; no number is null."""
    if hasattr(value, "item"):
        value = value.item()
    return None if isinstance(value, float) and value != value else value


def driven_whole(record: Path, step: Step) -> dict[str, Any] | None:
    """Measures of a record whose drive came to its end; None if it did not."""
    try:
        found = read_record(record)
        length = float(found.metadata["configuration"]["road"]["length"])  # type: ignore[index]
        reached = float(found.columns["longitudinal_position"][-1]) >= length - 1.0
    except (ValueError, OSError, KeyError, TypeError):
        return None
    enough = float(found.columns["time"][-1]) >= 60.0 * step.minutes
    if not (reached or (step.kind == "practise" and enough)):
        return None
    return measured(record, step)[0]
