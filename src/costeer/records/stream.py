"""The sound part of an Arrow stream: what a drive leaves, cut off or damaged.

Arrow trusts the offsets that a file tells; a wrong one leads outside the memory. So
each batch is checked in full before anything is taken from it, and what follows the
first damage is left.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.ipc

from costeer.records.arrow import METADATA_KEY, batch_checksum

CHECKSUM_KEY = b"crc32"
"""Where a stream keeps the checksum of a batch."""

_STEP_TOLERANCE = 0.01  # of a step; times are rounded far less
_END = 16  # [bytes] that a stream may have after its last batch


class Stream(NamedTuple):
    """What can be read of an Arrow stream.

    Attributes:
        batches: All that are whole.
        beside: What lies beside each of them.
        damage: What is wrong with what follows them; empty if nothing is, or the
            stream was just cut off.
        checked: Whether each batch has a checksum.
    """

    batches: list[pa.RecordBatch]
    beside: list[dict[bytes, bytes]]
    damage: str = ""
    checked: bool = False


def sound_batches(content: bytes) -> Stream:
    """All batches of an Arrow stream before the first that is damaged.

    Args:
        content: Of the file.
    """
    stream, source, end, largest = Stream([], []), pa.BufferReader(content), 0, 0
    fault, told = "", 0
    try:
        reader = pa.ipc.open_stream(source)
        while not fault:
            batch, custom = reader.read_next_batch_with_custom_metadata()
            beside = dict(custom or {})
            fault = _fault(batch, beside, stream.batches)
            if not fault:
                stream.batches.append(batch)
                stream.beside.append(beside)
                told += CHECKSUM_KEY in beside
                largest, end = max(largest, source.tell() - end), source.tell()
    except StopIteration:
        fault = "what follows is no batch" if len(content) > end + _END else ""
    except Exception:  # whatever a damaged or half written batch makes Arrow raise
        fault = "it cannot be read" if len(content) > end + 2 * largest else ""
    return stream._replace(
        damage=_told(fault, stream.batches), checked=told == len(stream.batches) > 0
    )


def _told(fault: str, batches: list[pa.RecordBatch]) -> str:
    if not fault or not batches:
        return fault
    rows = sum(batch.num_rows for batch in batches)
    return (
        f"batch {len(batches) + 1} of the stream is damaged: {fault}; the {rows} rows "
        "before it are kept, what follows is left out"
    )


def _fault(
    batch: pa.RecordBatch, beside: dict[bytes, bytes], before: list[pa.RecordBatch]
) -> str:
    """What is wrong with a batch; empty if nothing."""
    try:
        batch.validate(full=True)
    except (pa.ArrowException, ValueError) as error:
        return (str(error).splitlines() or ["it is invalid"])[0]
    checksum = beside.get(CHECKSUM_KEY)
    if checksum is not None and checksum != str(batch_checksum(batch)).encode():
        return "its checksum does not fit its numbers"
    if METADATA_KEY in (batch.schema.metadata or {}):
        return _time_fault(batch, before, even=checksum is None)
    return ""


def _time_fault(batch: pa.RecordBatch, before: list[pa.RecordBatch], even: bool) -> str:
    """What is wrong with the times of a trial's rows; empty if nothing.

    They go up; in even steps too, unless a checksum says that the numbers are those
    that were written: a drive leaves out what could not be recorded, and marks it.
    """
    driven = [each for each in before if each.num_rows][-1:]
    parts = [_time(each) for each in (*driven, batch)]
    time = np.concatenate(parts)
    steps = np.diff(time)
    if not np.isfinite(time).all():
        return "a time is not finite"
    if steps.size == 0:
        return ""
    step = np.median(np.diff(parts[0])) if driven and len(parts[0]) > 1 else steps[0]
    uneven = ~(np.abs(steps - step) <= _STEP_TOLERANCE * step)
    wrong = np.flatnonzero(uneven if even else ~(steps > 0.0))
    if step <= 0.0 or wrong.size:
        row = int(wrong[0]) if wrong.size else 0
        return f"after {time[row]:.6g} s follows {time[row + 1]:.6g} s"
    return ""


def _time(batch: pa.RecordBatch) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    column = batch.column("time")
    if column.type != pa.float64() or column.null_count:
        return np.full(batch.num_rows, np.nan)
    return np.asarray(column.to_numpy(), np.float64)
