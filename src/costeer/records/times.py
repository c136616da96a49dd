"""Times as other programs write them, in seconds; and how even they must be."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Seconds = NDArray[np.float64]

LONGEST_STEP = 0.25
"""Largest time between two samples [s]; longer ones cannot be bridged. Source:
assumed, a seventh of the period at the 0.6 Hz of the reversal rate."""

_WORDS = ("time", "stamp", "zeit", "sec", "clock", "date", "temps", "時")


def seconds(values: NDArray[Any]) -> tuple[Seconds | NDArray[Any], str]:
    """Times in seconds, and how they were read; numbers stay as they are.

    Moments, durations and their texts count from the first row.

    Args:
        values: As a table holds them, shape `(time,)`.

    Returns:
        The times, and a note; the values themselves if they are no times.
    """
    kind = np.ma.getdata(values).dtype.kind
    if kind == "U":
        values, told = _from_text(values)
        kind = values.dtype.kind
        if kind in "fU":
            return values, told
    if kind not in "mM":
        return values, ""
    what = "moments" if kind == "M" else "durations"
    known = values[~np.isnat(values)]
    if not known.size:
        return np.full(values.shape, np.nan), ""
    passed = (values - known[0]) / np.timedelta64(1, "ns")
    return passed / 1e9, f"time holds {what}: read as seconds since the first row"


def _from_text(values: NDArray[np.str_]) -> tuple[NDArray[Any], str]:
    """Numbers, moments or durations in a column of text; itself if it has none."""
    import pandas as pd

    texts = pd.Series(np.ma.getdata(values)).str.strip().replace("", None)
    told = "time holds decimal commas"
    ways: tuple[Callable[[], Any], ...] = (  # Any: of many types
        lambda: pd.to_numeric(texts.str.replace(",", ".")).to_numpy(np.float64),
        lambda: pd.to_datetime(texts, format="ISO8601", utc=True),
        lambda: pd.to_timedelta(texts),
        lambda: pd.to_datetime(texts, format="mixed", dayfirst=True, utc=True),
    )
    for way in ways:
        try:
            found = way()
        except (ValueError, TypeError, OverflowError, AttributeError):
            continue
        if isinstance(found, np.ndarray):
            return found, told
        plain = found.dt.tz_localize(None) if hasattr(found.dtype, "tz") else found
        # Not in the unit that pandas chose: it differs from version to version.
        return plain.to_numpy(plain.dtype).astype(f"{plain.dtype.kind}8[ns]"), ""
    return values, ""


def likely_times(columns: Mapping[str, NDArray[Any]]) -> list[str]:
    """Columns that may be the time, by their names or their values."""
    return [name for name, values in columns.items() if _may_be_time(name, values)]


def no_time(columns: Mapping[str, NDArray[Any]]) -> str:
    """Say that there is no time, and which columns it may be."""
    near = likely_times(columns)
    named = near[0] if near else "t"
    likely = f"; it may be {' or '.join(near[:3])}" if near else ""
    return (
        f"there is no column 'time' [s]{likely}; rename yours (on the command line, "
        f"for example, --rename {_quoted(named)}=time); there are {', '.join(columns)}"
    )


def _quoted(name: str) -> str:
    return f"'{name}'" if " " in name else name


def _may_be_time(name: str, values: NDArray[Any]) -> bool:
    """Whether a column has the name of a time, or nothing but rising numbers."""
    if name.lower() == "t" or any(word in name.lower() for word in _WORDS):
        return True
    kind = values.dtype.kind
    if kind in "mM":
        return True
    if kind not in "fiu" or "position" in name or len(values) < 3:
        return False
    return bool((np.diff(np.asarray(values, np.float64)) > 0.0).all())


Columns = Mapping[str, NDArray[Any]]  # Any: of any type


def without_repeated(columns: Columns) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Columns without the rows whose time equals that of the row before, and a note."""
    time = np.asarray(columns["time"], np.float64)
    kept = np.concatenate([[True], np.diff(time) != 0.0])[: len(time)]
    dropped = np.flatnonzero(~kept)
    if not dropped.size:
        return dict(columns), []
    told = (
        f"{dropped.size} rows repeat the time of the row before, first row "
        f"{dropped[0]}: left out"
    )
    return {name: values[kept] for name, values in columns.items()}, [told]


def check_steps(steps: Iterable[float], ways_out: str) -> None:
    """Refuse a time between two samples that cannot be bridged.

    Args:
        steps: Between samples [s].
        ways_out: What to do about it.

    Raises:
        ValueError: Naming the longest.
    """
    found = np.asarray(list(steps))
    if found.size and found.max() > LONGEST_STEP:
        row = int(found.argmax())
        raise ValueError(
            f"{found[row]:g} s pass between rows {row} and {row + 1}, at most "
            f"{LONGEST_STEP:g} s can be bridged; {ways_out}"
        )
