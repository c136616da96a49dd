"""A recording checked and made ready for a fit.

A fit takes what `costeer analyse` reads: a trial record, or a table with some of its
columns in SI units.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from costeer.base.described import with_values
from costeer.identification.signals import Drive, Signal
from costeer.loop.inputs import car_of
from costeer.loop.parameters import DT
from costeer.plant.parameters import (
    CARS,
    CarParameters,
    ColumnParameters,
    RoadParameters,
)
from costeer.plant.road import lane_at, lane_centre
from costeer.records.checks import check_time, converted
from costeer.records.columns import COLUMNS_BY_NAME, TrialRecord
from costeer.records.contradictions import contradictions, lanes_of, unwrapped
from costeer.records.plausible import suspicions

Record = TypeVar("Record")

NEEDED = (
    "time",
    "lateral_position",
    "yaw_angle",
    "longitudinal_velocity",
    "steering_wheel_angle",
    "steering_wheel_rate",
    "driver_torque",
)
"""Columns without which there is no fit."""

NEAR = 100.0
"""A leader within this distance ahead is near, as in an event zone [m]."""

_RATE_TOLERANCE = 0.005
_STEP_TOLERANCE = 0.05
_LEAST_TORQUE = 1e-3
_SLOWEST = 5.0


def drive_of(record: TrialRecord, car: str | CarParameters | None = None) -> Drive:
    """Take what a fit needs from a recording.

    Args:
        record: Trial record or table.
        car: That was driven: parameters, a name, or the file of one; None takes the
            record's, else the default car.

    Raises:
        ValueError: If the recording cannot be fitted; it names the value and the way
            out.
        OSError: If the file of the car cannot be read.
    """
    record = record._replace(columns=unwrapped(record.columns)[0])
    signals = _needed(record)
    _check_manual(record)
    _check_sampling(signals["time"])
    _check_values(signals)
    driven, column = vehicle_of(record, car)
    position = signals["lateral_position"]
    road = RoadParameters()
    # The equations take arrays as well as the floats they are annotated with.
    lane = np.asarray(lane_at(road, position))  # type: ignore[arg-type]  # said above
    return Drive(
        lateral_position=position,
        lane=lane,
        lane_offset=position - lane_centre(road, lane),  # type: ignore[arg-type]  # said above
        yaw_angle=signals["yaw_angle"],
        speed=signals["longitudinal_velocity"],
        steering_wheel_angle=signals["steering_wheel_angle"],
        steering_wheel_rate=signals["steering_wheel_rate"],
        driver_torque=signals["driver_torque"],
        head_yaw=_head_yaw(record),
        free=_free(record),
        car=driven,
        column=column,
        dt=DT,
    )


def doubts_of(record: TrialRecord) -> list[str]:
    """What looks wrong in a recording but does not forbid a fit."""
    columns, told = unwrapped(record.columns)
    return [*told, *contradictions(columns, lanes_of(record.metadata))]


def _column(record: TrialRecord, name: str) -> NDArray[Any]:  # Any: of its own kind
    column, values = COLUMNS_BY_NAME[name], np.asanyarray(record.columns[name])
    if column.kind == "float64" and values.dtype.kind in "iub":
        values = values.astype(np.float64)
    return converted(column, values) if column.kind == "float64" else values


def _needed(record: TrialRecord) -> dict[str, Signal]:
    missing = [name for name in NEEDED if name not in record.columns]
    if missing:
        raise ValueError(
            f"the recording has no column {', '.join(missing)}; a fit needs "
            f"{', '.join(NEEDED)} in SI units"
        )
    signals = {name: np.asarray(_column(record, name)) for name in NEEDED}
    for name, values in signals.items():
        gaps = np.flatnonzero(~np.isfinite(values))
        if gaps.size:
            raise ValueError(
                f"column {name} is undefined in {gaps.size} of {values.size} rows, "
                f"first in row {gaps[0]}; a fit needs every sample: cut the recording "
                "to a stretch without gaps"
            )
    return signals


def _check_manual(record: TrialRecord) -> None:
    """Refuse a recording with guidance: the driver's own part cannot be told apart."""
    if "applied_torque" in record.columns:
        applied = np.nan_to_num(np.asarray(_column(record, "applied_torque")))
        largest = float(np.abs(applied).max(initial=0.0))
        if largest > 0.0:
            raise ValueError(
                f"the recording is assisted: applied_torque reaches {largest:.3g} N·m; "
                "fit a recording of manual driving, condition manual"
            )
    strength = record.metadata.get("strength_factor")
    if isinstance(strength, (int, float)) and strength > 0.0:
        raise ValueError(
            f"the recording is assisted: its strength_factor is {strength:g}; fit a "
            "recording of manual driving, condition manual"
        )


def _check_sampling(time: Signal) -> None:
    check_time(time)
    if time.size < 2:
        raise ValueError(f"the recording has {time.size} rows; a fit needs minutes")
    steps = np.diff(time)
    rate = 1.0 / float(steps.mean())
    if abs(rate * DT - 1.0) > _RATE_TOLERANCE:
        raise ValueError(
            f"the recording has {rate:.4g} rows a second, a fit needs {1.0 / DT:g}; "
            "interpolate it to that rate, or mend the column time if it is not in "
            "seconds"
        )
    worst = int(np.abs(steps - DT).argmax())
    if abs(steps[worst] - DT) > _STEP_TOLERANCE * DT:
        raise ValueError(
            f"{steps[worst]:.4g} s pass between rows {worst} and {worst + 1}, a fit "
            f"needs even steps of {DT:.4g} s; interpolate, or cut the recording there"
        )


def _check_values(signals: dict[str, Signal]) -> None:
    for each in suspicions(signals):
        raise ValueError(
            f"{each.words}; multiply it by {each.factor:.6g} before the fit (on the "
            f"command line: --scale {each.column}={each.factor:.6g})"
        )
    largest = float(np.abs(signals["driver_torque"]).max())
    if largest < _LEAST_TORQUE:
        raise ValueError(
            f"driver_torque stays within {largest:.3g} N·m: the hands are off the "
            "wheel, or the torque was not measured; fit a recording with both"
        )
    slowest = float(signals["longitudinal_velocity"].min())
    if slowest < _SLOWEST:
        raise ValueError(
            f"longitudinal_velocity falls to {slowest * 3.6:.3g} km/h; a fit needs "
            f"driving at {_SLOWEST * 3.6:g} km/h or more throughout: cut the recording"
        )


def vehicle_of(
    record: TrialRecord, car: str | CarParameters | None = None
) -> tuple[CarParameters, ColumnParameters]:
    """Car and steering column of a recording.

    Args:
        record: A trial record says both with every parameter; of a table the column
            is the usual one.
        car: As in `drive_of`; it goes before the record's.

    Raises:
        ValueError: If there is no such car, or a parameter of the record is not known.
        OSError: If the file of the car cannot be read.
    """
    told = record.metadata.get("configuration")
    known = told if isinstance(told, Mapping) else {}
    column = _recorded(ColumnParameters(), known.get("column"))
    if car is None and "car" in known:
        return _recorded(CarParameters(), known["car"]), column
    if not isinstance(car, CarParameters):
        name = car or str(record.metadata.get("car") or "default")
        found = car_of(name)
        car = CARS[found] if isinstance(found, str) else found
    return car, column


def _recorded(usual: Record, told: object) -> Record:
    """Parameters as a record tells them; the usual ones where it does not."""
    if not isinstance(told, Mapping):
        return usual
    return with_values(usual, told)


def _head_yaw(record: TrialRecord) -> Signal | None:
    """Head yaw, the last one seen where the tracker lost it; None if there is none."""
    if "head_yaw" not in record.columns:
        return None
    yaw = np.asarray(_column(record, "head_yaw"))
    seen = np.isfinite(yaw)
    if not seen.any():
        return None
    last = np.maximum.accumulate(np.where(seen, np.arange(yaw.size), 0))
    return np.asarray(np.nan_to_num(yaw[last]))


def _free(record: TrialRecord) -> NDArray[np.bool_] | None:
    """Rows outside event zones, or without a leader near; None if it is not known."""
    if "event" in record.columns:
        event = np.ma.filled(np.ma.asarray(record.columns["event"]), 0)
        return np.asarray(np.nan_to_num(np.asarray(event, np.float64)) == 0.0)
    if "lead_distance" in record.columns:
        gap = np.asarray(_column(record, "lead_distance"))
        with np.errstate(invalid="ignore"):
            near = (gap > 0.0) & (gap <= NEAR)
        return np.asarray(~near)
    return None
