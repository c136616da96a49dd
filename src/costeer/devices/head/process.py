"""The process that follows the head and tells another one where it points."""

from __future__ import annotations

import multiprocessing
import signal
import time
from collections.abc import Callable
from typing import Protocol

from costeer.devices.head.calibration import HeadCalibration, calibrated
from costeer.devices.head.registry import open_head
from costeer.devices.head.source import (
    NOTHING_SEEN,
    HeadLost,
    HeadReading,
    HeadSink,
    HeadSource,
    held,
)

RETRY_AFTER = 0.5
"""Pause before a tracker that is gone is opened again [s]."""


class Stop(Protocol):
    """An event that ends the process, as `multiprocessing.Event`."""

    def is_set(self) -> bool:
        """Whether to stop."""
        ...

    def wait(self, timeout: float) -> bool:
        """Wait until it is set, or `timeout` [s]; return whether to stop."""
        ...


def run_head_process(
    calibration: HeadCalibration,
    sink: HeadSink,
    stopped: Stop,
    lose: Callable[[bool], object] = bool,
) -> None:
    """Follow the head until told to stop or the parent is gone.

    A tracker that is lost is told as not valid and opened again; a video file starts
    again from its beginning. The reader of the sink must still look at the time of a
    reading (`source.aged`): a camera that hangs tells nothing.

    Args:
        calibration: Which tracker, and how its angle becomes the head's yaw.
        sink: Takes each reading.
        stopped: Set by another process to end this one.
        lose: Is told whether the tracker itself is lost.

    Raises:
        ValueError: If the calibration does not fit the tracker.
        ModuleNotFoundError: If the extra that the tracker needs is not installed.
    """
    if multiprocessing.parent_process() is not None:
        for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # the parent says when to stop
            if number := getattr(signal, name, None):
                signal.signal(number, signal.SIG_IGN)
    last = NOTHING_SEEN
    while _goes_on(stopped):
        try:
            source = open_head(calibration.tracker)
        except HeadLost:
            lose(True)
            last = _tell_lost(sink, last)
            stopped.wait(RETRY_AFTER)
            continue
        lose(False)
        last = _follow(source, calibration, sink, stopped, last)
        if _goes_on(stopped):
            last = _tell_lost(sink, last)
            stopped.wait(RETRY_AFTER)


def _goes_on(stopped: Stop) -> bool:
    """Whether neither the event is set nor the parent has died."""
    parent = multiprocessing.parent_process()
    return not stopped.is_set() and (parent is None or parent.is_alive())


def _follow(
    source: HeadSource,
    calibration: HeadCalibration,
    sink: HeadSink,
    stopped: Stop,
    last: HeadReading,
) -> HeadReading:
    """Tell every reading until the tracker is lost; return the last one."""
    try:
        while _goes_on(stopped):
            last = held(last, calibrated(calibration, source.read()))
            sink.put(*last)
    except HeadLost:
        pass
    finally:
        source.close()
    return last


def _tell_lost(sink: HeadSink, last: HeadReading) -> HeadReading:
    """Tell that nothing is seen now; the last angle is held."""
    sink.put(time.perf_counter(), last.head_yaw, False)
    return last
