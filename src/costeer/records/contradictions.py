"""Columns that contradict each other: signs, units, the lane that is measured from.

Each column by itself may look right. A car that points to the left moves to the left,
and its speed is that of its position; what says otherwise has another sign or unit.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees, pi, radians
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from costeer.records.plausible import suspicions

Series = NDArray[np.float64]
# Any: the element type differs from column to column.
Columns = Mapping[str, NDArray[Any]]

_LAG = 0.5  # [s] over which changes are compared; rounding hardly matters then
_CORRELATION = 0.5
_SLOWEST = 1.0  # [m/s]
_OTHER_SPEEDS = {"km/h": 1.0 / 3.6, "mph": 0.44704}
_SPEED_TOLERANCE, _SPEED_GAP = 0.08, 1.3
_DEGREES = (degrees(1.0) / 2.0, degrees(1.0) * 2.0)
_LARGEST_RATIO = 600.0  # [m]: steering ratio times wheelbase of no vehicle


class Lanes(NamedTuple):
    """The lanes that a record was driven on; if it does not say, those of the paper.

    Attributes:
        width: Of each lane [m]. Source: the paper's simulator.
        number: Of this direction [-]. Source: as above.
    """

    width: float = 3.5
    number: int = 2


PAPERS = Lanes()
_WIDEST, _MOST = 20.0, 20  # what is believed of a record


class Fit(NamedTuple):
    """One signal as a multiple of another.

    Attributes:
        factor: Of the line of least squares through the origin; 0 if nothing moves.
        correlation: In [-1, 1].
    """

    factor: float
    correlation: float


def lanes_of(metadata: Mapping[str, object]) -> Lanes:
    """The lanes of a record's road: as it was driven on, else of its scenario."""
    configuration, scenario = metadata.get("configuration"), metadata.get("scenario")
    driven = _road(configuration)
    said = _road(scenario)
    width = driven.get("lane_width", said.get("lane_width"))
    count = driven.get("num_lanes", said.get("lanes"))
    return Lanes(
        width=float(width) if _is_within(width, 0.5, _WIDEST) else PAPERS.width,
        number=int(count) if _is_within(count, 1.0, _MOST) else PAPERS.number,
    )


# Any, in these two: a part of a description.
def _road(told: Any) -> Mapping[str, Any]:
    road = told.get("road") if isinstance(told, Mapping) else None
    return road if isinstance(road, Mapping) else {}


def _is_within(value: Any, low: float, high: float) -> bool:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return bool(number and low <= value <= high)


def contradictions(columns: Columns, lanes: Lanes = PAPERS) -> list[str]:
    """What columns say against each other, and how to mend it.

    Args:
        columns: Of a record or table, shape `(time,)` each.
        lanes: Of its road.
    """
    told = {each.column: each.factor for each in suspicions(columns)}
    known = {
        name: np.ma.filled(values.astype(np.float64), np.nan) * told.get(name, 1.0)
        for name, values in columns.items()
        if values.dtype.kind in "fiub"
    }
    if len(known.get("time", ())) < 3:
        return []
    return [
        *_speed(known),
        *_yaw(known, lanes),
        *_steering(known),
        *_rates(known),
        *_lanes(known, lanes),
    ]


def unwrapped(columns: Columns) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Columns with the yaw angle in -pi to pi where it runs from 0 to 2 pi."""
    found = dict(columns)
    yaw = found.get("yaw_angle")
    if yaw is None or yaw.dtype.kind != "f" or not np.isfinite(yaw).any():
        return found, []
    low, high = float(np.nanmin(yaw)), float(np.nanmax(yaw))
    jumps = bool((np.abs(np.diff(yaw[np.isfinite(yaw)])) > pi).any())
    if not (low >= 0.0 and pi < high <= 2.0 * pi + 0.01 and (jumps or low > pi)):
        return found, []
    found["yaw_angle"] = (yaw + pi) % (2.0 * pi) - pi
    return found, ["yaw_angle runs from 0 to 2 pi: taken as -pi to pi"]


def _speed(known: Mapping[str, Series]) -> list[str]:
    names = ("longitudinal_velocity", "longitudinal_position")
    if not known.keys() >= {*names}:
        return []
    speed = _median(known[names[0]])
    driven = _median(_rate(known, names[1]))
    if not (speed > _SLOWEST and driven > _SLOWEST):
        return []
    ratio = speed / driven
    said = f"{names[0]} says {speed:.4g} m/s, {names[1]} {driven:.3g} m/s"
    for unit, factor in _OTHER_SPEEDS.items():
        if abs(ratio * factor - 1.0) < _SPEED_TOLERANCE:
            return [f"{said}: the first looks like {unit}; {_scaled(names[0], factor)}"]
    if 1.0 / _SPEED_GAP < ratio < _SPEED_GAP:
        return []
    return [f"{said}: one of them is not in SI units"]


def _yaw(known: Mapping[str, Series], lanes: Lanes) -> list[str]:
    if not known.keys() >= {"lateral_position", "yaw_angle"}:
        return []
    moved = _rate(known, "lateral_position")
    moved = np.where(np.abs(moved) * _LAG > lanes.width / 2.0, np.nan, moved)
    speed = known.get("longitudinal_velocity", np.ones_like(known["time"]))
    fit = _fit(_mean(known, speed * known["yaw_angle"]), moved)
    if fit.correlation < -_CORRELATION:
        return [_signs("yaw_angle", "lateral_position")]
    small = 1.0 / _DEGREES[1] < fit.factor < 1.0 / _DEGREES[0]
    if fit.correlation > _CORRELATION and small and "longitudinal_velocity" in known:
        return [_degrees("yaw_angle")]
    return []


def _steering(known: Mapping[str, Series]) -> list[str]:
    names = {"steering_wheel_angle", "longitudinal_velocity"}
    if not known.keys() >= names or not known.keys() & {"yaw_rate", "yaw_angle"}:
        return []
    turned = _rate(known, "yaw_angle") if "yaw_angle" in known else None
    if turned is None:
        turned = _mean(known, known["yaw_rate"])
    asked = known["steering_wheel_angle"] * known["longitudinal_velocity"]
    fit = _fit(turned, _mean(known, asked))
    if fit.correlation < -_CORRELATION:
        turning = "yaw_angle" if "yaw_angle" in known else "yaw_rate"
        return [_signs("steering_wheel_angle", turning)]
    if fit.correlation > _CORRELATION and fit.factor > _LARGEST_RATIO:
        return [_degrees("steering_wheel_angle")]
    return []


def _rates(known: Mapping[str, Series]) -> list[str]:
    """Recorded rates against the change of what they are the rates of."""
    found = []
    for rate, angle in (
        ("steering_wheel_rate", "steering_wheel_angle"),
        ("yaw_rate", "yaw_angle"),
    ):
        if not known.keys() >= {rate, angle}:
            continue
        fit = _fit(_rate(known, angle), _mean(known, known[rate]))
        if fit.correlation < -_CORRELATION:
            found.append(_signs(rate, angle))
        elif fit.correlation > _CORRELATION and _DEGREES[0] < fit.factor < _DEGREES[1]:
            found.append(_degrees(rate))
    return found


def _lanes(known: Mapping[str, Series], lanes: Lanes) -> list[str]:
    if "lateral_position" not in known:
        return []
    position = known["lateral_position"]
    steps = np.abs(np.diff(position))
    jumps = np.flatnonzero(steps > lanes.width / 2.0)
    if jumps.size:
        row = int(jumps[0])
        return [
            f"lateral_position jumps by {steps[row]:.3g} m in row {row + 1}: is it "
            "measured from the centre of the lane driven in? It counts from the left "
            "lane's centre, else no lane change is found (on the "
            "command line: --join-lanes)"
        ]
    if "lane" not in known:
        return []
    with np.errstate(invalid="ignore"):
        from_left = np.clip(np.ceil(-position / lanes.width - 0.5), 0, lanes.number - 1)
    wrong = np.isfinite(position) & np.isin(known["lane"], range(lanes.number))
    wrong &= known["lane"] != lanes.number - 1 - from_left
    if wrong.sum() * 20 < wrong.size:
        return []
    return [
        f"lane and lateral_position contradict each other in {wrong.sum()} rows, first "
        f"in row {int(np.flatnonzero(wrong)[0])}: the position counts from the left "
        f"lane's centre, left positive, lanes from the right (0 right, "
        f"{lanes.number - 1} left)"
    ]


def joined(columns: Columns, lanes: Lanes = PAPERS) -> dict[str, NDArray[Any]]:
    """Columns with a position from one line, where it was from each lane's centre.

    It begins in the left lane, unless `lane` says another one.

    Args:
        columns: Of a record or table, shape `(time,)` each.
        lanes: Of its road.
    """
    found = dict(columns)
    position = np.asarray(found["lateral_position"], np.float64)
    steps = np.diff(position, prepend=position[:1])
    jumps = np.where(np.abs(steps) > lanes.width / 2.0, steps, 0.0)
    jumped = np.round(jumps / lanes.width) * lanes.width
    last = lanes.number - 1
    first = np.ma.getdata(found["lane"])[0] if "lane" in found else last
    from_left = last - int(first) if first in range(last) else 0
    found["lateral_position"] = position - np.cumsum(jumped) - lanes.width * from_left
    return found


def _lag(known: Mapping[str, Series]) -> int:
    time = known["time"]
    step = float(np.median(np.diff(time)))
    return min(max(1, round(_LAG / step)) if step > 0.0 else 1, len(time) - 1)


def _rate(known: Mapping[str, Series], name: str) -> Series:
    """Change per second over the lag, one value a row that has a row so much later."""
    lag, values, time = _lag(known), known[name], known["time"]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray((values[lag:] - values[:-lag]) / (time[lag:] - time[:-lag]))


def _mean(known: Mapping[str, Series], values: Series) -> Series:
    """Mean over the lag, on the same rows as `_rate`."""
    lag = _lag(known)
    middle = (values[1:] + values[:-1]) / 2.0
    windows = np.lib.stride_tricks.sliding_window_view(middle, lag)
    return np.asarray(windows.mean(axis=1))


def _fit(basis: Series, values: Series) -> Fit:
    good = np.isfinite(basis) & np.isfinite(values)
    one, other = basis[good], values[good]
    if one.size < 3 or np.ptp(one) < 1e-9 or np.ptp(other) < 1e-9:
        return Fit(0.0, 0.0)
    factor = float(one @ other / (one @ one))
    return Fit(factor, float(np.corrcoef(one, other)[0, 1]))


def _median(values: Series) -> float:
    finite = values[np.isfinite(values)]
    return float(np.median(finite)) if finite.size else 0.0


def _scaled(name: str, factor: float) -> str:
    return (
        f"if so, multiply it by {factor:.6g} (on the command line: "
        f"--scale {name}={factor:.6g})"
    )


def _degrees(name: str) -> str:
    return f"{name} looks like degrees; {_scaled(name, radians(1.0))}"


def _signs(one: str, other: str) -> str:
    return (
        f"{one} and {other} contradict each other in sign; left is positive: flip the "
        f"one that is not (on the command line: --scale {one}=-1 or --scale "
        f"{other}=-1)"
    )
