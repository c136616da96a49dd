"""How a car drifts in its lane: spread, correlation time and spectrum.

Windows of 20 s at 10 Hz without a lane change, of `r3_driving` (lane lines seen by an
instrumented car, only above 15 m/s) and `ngsim_i80_following` (vehicles filmed from a
roof, dense traffic at 5 to 12 m/s). The place in an NGSIM picture is some decimetres
wrong in a way that changes slowly with the place on the road, so that filtering does
not remove it; it adds to the drift there.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.base.array import Real
from costeer.records.columns import TrialRecord
from costeer.study.definitions import Flags, runs
from costeer.study.measures import parameters_of
from costeer.study.segments import Segments, segment
from costeer.validation.people.findings import Values
from costeer.validation.people.folder import Columns, groups, read_table, table_path

RATE = 10.0
"""Samples per second of the recordings of people [Hz]."""

WINDOW_SAMPLES = 200
"""Length of a window, 20 s."""

FAST_BAND = (0.1, 0.5)
"""Drift faster than slow wander, slower than what cars can hardly do [Hz]."""

HIGHEST_FREQUENCY = 1.0
"""End of the spectra that are kept [Hz]."""

LEAST_SPEED = 15.0
"""Slower stretches of `r3_driving` are no highway [m/s]."""

_KEEPING = 1.0  # of the set's column `decision`
_CLEAR_OF_CHANGE = 5.0  # s
_JUMP = 0.3  # m between two samples: the lane lines were confused
_RECORD_RATE = 60.0
_NONE: Values = np.empty((0, WINDOW_SAMPLES))
_R3 = Columns(numbers=("t", "v", "deviation", "decision"), texts=("scenario",))
_NGSIM = Columns(numbers=("time", "local_x"), texts=("pair_id",))


class Drift(NamedTuple):
    """What windows of lane keeping show, shapes `(window,)`.

    Attributes:
        deviation: Standard deviation in a window [m].
        correlation_time: First lag with an autocorrelation below 1/e [s].
        fast: Root mean square of what is between 0.1 and 0.5 Hz [m].
        density: Power spectral density, shape `(window, frequency)` [m²/Hz].
    """

    deviation: Values
    correlation_time: Values
    fast: Values
    density: Values


def frequencies() -> Values:
    """Frequencies of the spectra, without zero, up to 1 Hz, shape `(frequency,)`."""
    every = np.fft.rfftfreq(WINDOW_SAMPLES, 1.0 / RATE)[1:]
    return np.asarray(every[every <= HIGHEST_FREQUENCY + 1e-9])


def drift(windows: Values) -> Drift:
    """Spread, correlation time and spectrum of each window.

    Args:
        windows: Lateral position, shape `(window, 200)` [m].
    """
    density = power_density(windows)
    steps = frequencies()
    low, high = FAST_BAND
    band = (steps >= low - 1e-9) & (steps <= high + 1e-9)
    return Drift(
        deviation=windows.std(axis=1, ddof=1),
        correlation_time=np.array([correlation_time(each) for each in windows]),
        fast=np.sqrt(density[:, band].sum(axis=1) * steps[0]),
        density=density,
    )


def power_density(windows: Values) -> Values:
    """One-sided power spectral density with a Hann window [m²/Hz].

    Args:
        windows: Shape `(window, 200)` [m]; their means are taken off.

    Returns:
        Shape `(window, frequency)`, of `frequencies()`.
    """
    taper = np.hanning(WINDOW_SAMPLES)
    centred = windows - windows.mean(axis=1, keepdims=True)
    power = np.abs(np.fft.rfft(centred * taper, axis=1)) ** 2
    scaled = 2.0 * power / (RATE * np.square(taper).sum())
    return np.asarray(scaled[:, 1 : 1 + frequencies().size])


def correlation_time(window: Values) -> Real:
    """First lag at which the autocorrelation is below 1/e [s]; NaN if it stands still.

    Args:
        window: Lateral position, shape `(time,)` [m].
    """
    centred = window - window.mean()
    if not np.any(centred):
        return float("nan")
    lags = np.correlate(centred, centred, "full")[centred.size - 1 :]
    return float(np.argmax(lags < lags[0] / np.e) / RATE)


def cut(position: Values, good: Flags) -> Values:
    """Windows of 20 s from the stretches in which a flag holds.

    Args:
        position: At 10 Hz, shape `(time,)` [m].
        good: Samples that may be used, shape `(time,)`.

    Returns:
        Shape `(window, 200)`.
    """
    stretches = [position[rows] for rows in runs(good & np.isfinite(position))]
    whole = [each[: each.size // WINDOW_SAMPLES * WINDOW_SAMPLES] for each in stretches]
    return np.concatenate([np.empty(0), *whole]).reshape(-1, WINDOW_SAMPLES)


def highway_windows(folder: Path | None) -> Values:
    """Windows of the instrumented car; none if the set is absent.

    Args:
        folder: With the sets.

    Raises:
        ValueError: If the table cannot be read.
    """
    path = table_path(folder, "r3_driving")
    if path is None:
        return _NONE
    table = read_table(path, _R3)
    found = []
    for rows in groups(table["scenario"]):
        position, time = table["deviation"][rows], table["t"][rows]
        keeping = table["decision"][rows] == _KEEPING
        good = keeping & (table["v"][rows] > LEAST_SPEED)
        jumps = np.abs(np.diff(position, prepend=position[:1])) > _JUMP
        found.append(cut(position, good & ~_near(time, jumps | ~keeping)))
    return np.concatenate([_NONE, *found])


def _near(time: Values, flags: Flags) -> NDArray[np.bool_]:
    """Samples within 5 s of a flagged one."""
    near = np.zeros(time.size, bool)
    for rows in runs(flags):
        first, last = time[rows.start], time[rows.stop - 1]
        near |= (time > first - _CLEAR_OF_CHANGE) & (time < last + _CLEAR_OF_CHANGE)
    return near


def following_windows(folder: Path | None) -> Values:
    """Windows of the filmed vehicles; none if the set is absent.

    Args:
        folder: With the sets.

    Raises:
        ValueError: If the table cannot be read.
    """
    path = table_path(folder, "ngsim_i80_following")
    if path is None:
        return _NONE
    table = read_table(path, _NGSIM)
    return _cut_each(table["local_x"][rows] for rows in groups(table["pair_id"]))


def record_windows(record: TrialRecord) -> Values:
    """The same windows of a trial: its lane keeping as the study's measures cut it."""
    segments = segment(record.columns, parameters_of(record))
    if not isinstance(segments, Segments):
        return _NONE
    position = np.asarray(record.columns["lateral_position"])
    every = round(_RECORD_RATE / RATE)
    return _cut_each(position[rows][::every] for rows in segments.lane_keeping)


def _cut_each(stretches: Iterable[Values]) -> Values:
    """Windows of stretches of which every sample may be used."""
    found = [cut(each, np.ones(each.size, bool)) for each in stretches]
    return np.concatenate([_NONE, *found])
