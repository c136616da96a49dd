"""Measures of driving from records, data frames or plain arrays."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from costeer.api.recordings import File, Recorded, noted, warn_of
from costeer.base.described import nearest
from costeer.study import reversals
from costeer.study.analysis import analyse
from costeer.study.definitions import MeasureParameters
from costeer.study.sampling import evened, sampling

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from pandas import DataFrame


def measures(
    recording: Recorded | File, *, lane_width: float = 3.5, **thresholds: float
) -> DataFrame:
    """Measures of driving, or why they are missing.

    Args:
        recording: A record, its file, a data frame or a mapping of arrays: `time` [s]
            and any other column of a record, in SI units. A column `sequence` tells
            separate stretches apart.
        lane_width: Of both lanes [m].
        **thresholds: Any other field of `study.definitions.MeasureParameters`.

    Returns:
        A row for each measure, with value, unit and reason (empty where there is a
        value); of several stretches, by stretch and measure. What should be known
        before the numbers are trusted stands in `.attrs["notes"]`; what looks wrong,
        or was assumed of a file, is a `costeer.ReadingWarning` too.

    Raises:
        ValueError: If there is no `time`, a column holds what it cannot, or a
            threshold is not known.
        OSError: If a file cannot be read.

    Example:
        >>> import costeer, numpy as np
        >>> time = np.arange(0, 60, 1 / 60)
        >>> found = costeer.measures(
        ...     {"time": time, "steering_wheel_angle": 0.1 * np.sin(time)}
        ... )
        >>> float(round(found.value["swrr"], 1))
        19.0
        >>> found.reason["sdlp"]
        'needs the columns lateral_position, yaw_angle, not recorded'
    """
    import pandas as pd

    known = MeasureParameters._fields
    for name in thresholds:
        if name not in known:
            raise ValueError(
                f"there is no threshold '{name}'{nearest(name, known)}; choose "
                f"from {', '.join(known)}"
            )
    chosen = MeasureParameters(lane_width=lane_width, **thresholds)
    record, told = noted(recording)
    parts = analyse(record, parameters=chosen)
    warn_of(dict.fromkeys([*told, *(each for p in parts for each in p.doubts)]), 2)
    tables = {
        part.sequence: pd.DataFrame.from_dict(
            {name: each._asdict() for name, each in part.measures.items()},
            orient="index",
        ).rename_axis("measure")
        for part in parts
    }
    if len(parts) == 1:
        (table,) = tables.values()
    else:
        table = pd.concat(tables, names=["sequence"])
    table.attrs["notes"] = sorted({*told, *(n for part in parts for n in part.notes)})
    return table


def sdlp(lateral_position: ArrayLike, lane_keeping: ArrayLike | None = None) -> float:
    """Standard deviation of the lane position [m], Eq. (12), Sec. III-F.

    About its one mean, with n - 1.

    Args:
        lateral_position: From the lane's centre or any other line [m].
        lane_keeping: Which samples count; all if None.

    Raises:
        ValueError: If fewer than two samples count or one of them is not finite.

    Example:
        >>> import costeer
        >>> round(costeer.sdlp([0.1, -0.1, 0.2, -0.2, 9.0], [1, 1, 1, 1, 0]), 4)
        0.1826
    """
    position = np.asarray(lateral_position, np.float64).ravel()
    if lane_keeping is not None:
        position = position[np.asarray(lane_keeping, bool).ravel()]
    if position.size < 2 or not np.isfinite(position).all():
        raise ValueError(
            f"{int(np.isfinite(position).sum())} of {position.size} lateral positions "
            "are finite; give 2 or more, and say in lane_keeping which ones count"
        )
    return float(np.std(position, ddof=1))


def steering_wheel_reversal_rate(
    time_or_rate: ArrayLike,
    steering_wheel_angle: ArrayLike,
    *,
    gap: float = math.radians(3.0),
    cutoff: float = 0.6,
) -> float:
    """Steering-wheel reversals per minute [1/min], as Markkula and Engström (2006).

    Args:
        time_or_rate: Time of each sample [s], or samples per second [Hz].
        steering_wheel_angle: Of one stretch of driving [rad].
        gap: That a reversal exceeds [rad].
        cutoff: Of the low-pass before counting [Hz]; 0 for none.

    Raises:
        ValueError: If the signal is too short, too slow, not finite, or has gaps.

    Example:
        >>> import costeer, numpy as np
        >>> angle = 0.1 * np.sin(np.arange(0, 60, 1 / 60))
        >>> round(costeer.steering_wheel_reversal_rate(60, angle), 1)
        19.0
    """
    angle = np.asarray(steering_wheel_angle, np.float64).ravel()
    time = np.asarray(time_or_rate, np.float64)
    if time.ndim == 0:
        time = np.arange(angle.size) / float(time)
    if time.shape != angle.shape or not np.isfinite(angle).all():
        raise ValueError(
            f"{int(np.isfinite(angle).sum())} of {angle.size} angles are finite, with "
            f"{time.size} times; give a finite angle for each time"
        )
    found = sampling(time)
    even = evened({"time": time, "steering_wheel_angle": angle}, found)
    measure = reversals.steering_wheel_reversal_rate(
        [even["steering_wheel_angle"]],
        found.rate,
        MeasureParameters(reversal_angle=gap, reversal_cutoff=cutoff),
    )
    if measure.reason:
        raise ValueError(f"no reversal rate: {measure.reason}")
    return measure.value
