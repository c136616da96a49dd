"""From a stretch of a source to recordings: one run for each side with a lane.

On a road of more than two lanes the network runs once per side (spec section 1.1). So
a stretch gives up to two recordings. In the run to the right the side is -1 all the
time and the distance is that to the right boundary of the lane the car is in; the run
to the left is its mirror. A run lasts as long as there is a lane on its side, and ends
with the crossing into the last one. Labels know of all crossings of the stretch; meant
are in each run those to its side, so that none is missed twice.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.intention.features import (
    ADJACENT_LEFT,
    ADJACENT_RIGHT,
    FEATURES,
    WINDOW_LENGTH,
    feature_series,
)
from costeer.training.labels import Labels, labels
from costeer.training.recordings import Recording
from costeer.training.resample import (
    Grid,
    Series,
    delayed,
    grid,
    held,
    sample_at,
)

_DISTANCE = "distance_to_adjacent_lane"
_LANE_JUMP = 1.0  # m from row to row: no car, but the distance at a crossing
_NAMES = {ADJACENT_RIGHT: "right", ADJACENT_LEFT: "left"}


class Crossing(NamedTuple):
    """The centre of a car comes into another lane.

    Attributes:
        time: When [s].
        side: -1 to the right, +1 to the left.
    """

    time: float
    side: int


class Stretch(NamedTuple):
    """One uninterrupted drive at the rate of its source, in the car's own signs.

    Attributes:
        driver: Whatever must not be split between training and test.
        name: For messages.
        time: Evenly spaced, `(row,)` [s].
        signals: Those of Eq. (1) that the source has, by name, in SI units, left
            positive, `(row,)` each; the distance is not among them.
        to_left: From the car's centre to the left boundary of the lane it is in,
            `(row,)` [m]; None if the source has no boundaries.
        to_right: To the right one.
        lane_left: Whether there is a lane to the left, `(row,)`; None: always.
        lane_right: To the right.
        crossings: Of lane boundaries, in order.
        keeps_lane: Whether it is known that none comes within 3 s after the last row.
        notes: What the reader should know.
    """

    driver: str
    name: str
    time: Series
    signals: Mapping[str, Series]
    to_left: Series | None = None
    to_right: Series | None = None
    lane_left: NDArray[np.bool_] | None = None
    lane_right: NDArray[np.bool_] | None = None
    crossings: Sequence[Crossing] = ()
    keeps_lane: bool = False
    notes: tuple[str, ...] = ()


def both_runs(stretch: Stretch) -> list[Recording]:
    """The runs to the right and to the left; those without a full window are left out.

    Raises:
        ValueError: If the rows are not evenly spaced, or a signal has another name or
            length.
    """
    _check(stretch)
    if len(stretch.time) < 2:
        return []
    samples = grid(stretch.name, stretch.time)
    return [
        run
        for side in (ADJACENT_RIGHT, ADJACENT_LEFT)
        for run in _runs(stretch, samples, side)
    ]


def cut(
    stretch: Stretch,
    good: NDArray[np.bool_],
    fresh: NDArray[np.bool_] | None = None,
) -> list[Stretch]:
    """The parts of a stretch that may be used, each a stretch of its own.

    Args:
        stretch: The whole.
        good: Rows that may be used, `(row,)`.
        fresh: Rows with which a part begins although the row before is good.
    """
    rows = pieces(good, fresh)
    return [
        part(stretch, each, f"{stretch.name}/{k}" if len(rows) > 1 else stretch.name)
        for k, each in enumerate(rows)
    ]


def pieces(
    good: NDArray[np.bool_], fresh: NDArray[np.bool_] | None = None
) -> list[slice]:
    """Runs of good rows, split before fresh ones, as slices in order."""
    starts = np.zeros(len(good), bool) if fresh is None else fresh
    key = np.where(good, np.cumsum(starts), -1)
    edges = np.flatnonzero(np.diff(key, prepend=-1, append=-1))
    return [slice(int(a), int(b)) for a, b in itertools.pairwise(edges) if good[a]]


def part(stretch: Stretch, rows: slice, name: str) -> Stretch:
    """Some rows of a stretch, with the crossings among them."""
    time = stretch.time[rows]
    return stretch._replace(
        name=name,
        time=time,
        signals={key: values[rows] for key, values in stretch.signals.items()},
        to_left=None if stretch.to_left is None else stretch.to_left[rows],
        to_right=None if stretch.to_right is None else stretch.to_right[rows],
        lane_left=None if stretch.lane_left is None else stretch.lane_left[rows],
        lane_right=None if stretch.lane_right is None else stretch.lane_right[rows],
        crossings=[c for c in stretch.crossings if time[0] < c.time <= time[-1]],
        keeps_lane=stretch.keeps_lane and rows.stop == len(stretch.time),
    )


def _check(stretch: Stretch) -> None:
    allowed = [name for name in FEATURES if name != _DISTANCE]
    for name, values in stretch.signals.items():
        if name not in allowed:
            raise ValueError(
                f"{stretch.name}: there is no signal '{name}'; give "
                f"{', '.join(allowed)}; distances are to_left and to_right"
            )
        if len(values) != len(stretch.time):
            raise ValueError(
                f"{stretch.name}: {name} has {len(values)} rows and time "
                f"{len(stretch.time)}; give as many"
            )


def _runs(stretch: Stretch, samples: Grid, side: int) -> list[Recording]:
    """Recordings of one side."""
    crossing = _crossing_samples(stretch, samples)
    whole = Recording(
        driver=stretch.driver,
        name=f"{stretch.name}:{_NAMES[side]}",
        features=_features(stretch, samples, side),
        side=np.full(len(crossing), side, np.int8),
        crossing=crossing,
        intended=np.where(crossing == side, crossing, 0).astype(np.int8),
        labels=_labels(stretch, crossing, side),
        notes=(late_note(samples.period), *stretch.notes),
        absent=_absent(stretch),
    )
    lane = stretch.lane_right if side == ADJACENT_RIGHT else stretch.lane_left
    there = np.ones(len(stretch.time), bool) if lane is None else lane
    rows = pieces(held(samples, there) | (crossing == side))
    long = [each for each in rows if each.stop - each.start >= WINDOW_LENGTH]
    return [
        _sliced(whole, each, "" if len(rows) == 1 else f"/{k}")
        for k, each in enumerate(long)
    ]


def late_note(period: float) -> str:
    """What resampling costs."""
    return (
        f"signals are {period:.2g} s late (straight lines from row to row of the "
        "source, without a look ahead); crossings are not"
    )


def _crossing_samples(stretch: Stretch, samples: Grid) -> NDArray[np.int8]:
    """Side of each crossing at the first sample in the new lane, else 0."""
    found = np.zeros(len(samples.latest), np.int8)
    for crossing in stretch.crossings:
        place = sample_at(samples, crossing.time)
        if 0 <= place < len(found):
            found[place] = crossing.side
    return found


def _features(stretch: Stretch, samples: Grid, side: int) -> Series:
    """Signals facing right, `(time, feature)`; NaN where the source has none."""
    nothing = np.full(len(samples.latest), np.nan)
    columns = dict.fromkeys(FEATURES, nothing) | {
        name: delayed(samples, values, np.zeros(len(values), bool))
        for name, values in stretch.signals.items()
    }
    distance = stretch.to_right if side == ADJACENT_RIGHT else stretch.to_left
    if distance is not None:
        jumps = np.abs(np.diff(distance, prepend=distance[:1])) > _LANE_JUMP
        columns[_DISTANCE] = delayed(samples, distance, jumps)
    return feature_series(columns, np.full(len(nothing), side, np.int8))


def _labels(stretch: Stretch, crossing: NDArray[np.int8], side: int) -> Labels:
    found = labels(crossing, np.full(len(crossing), side, np.int8))
    if not stretch.keeps_lane:
        return found
    return Labels(positive=found.positive, known=np.ones(len(crossing), bool))


def _absent(stretch: Stretch) -> tuple[str, ...]:
    has = set(stretch.signals)
    if stretch.to_right is not None:
        has.add(_DISTANCE)
    return tuple(name for name in FEATURES if name not in has)


def _sliced(whole: Recording, rows: slice, mark: str) -> Recording:
    return Recording(
        driver=whole.driver,
        name=whole.name + mark,
        features=whole.features[rows],
        side=whole.side[rows],
        crossing=whole.crossing[rows],
        intended=whole.intended[rows],
        labels=Labels(*(each[rows] for each in whole.labels)),
        notes=whole.notes,
        absent=whole.absent,
    )
