"""What a trial record holds: its columns with units, and its metadata.

A simulated and a human trial leave the same record. Names and signs follow ISO 8855:
left is positive, lanes count from the right, an error is car minus target.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

MANUAL = "manual"
LANE_KEEPING = "lane_keeping"
LANE_CHANGING = "lane_changing"
MODES = (MANUAL, LANE_KEEPING, LANE_CHANGING)

METHOD_PREFIX = "method_"
"""With what the names of columns begin that a method adds."""


class Column(NamedTuple):
    """One column of a trial record.

    Attributes:
        name: Name in memory and in the file.
        unit: SI unit, "-" if there is none; stored in the schema.
        kind: "float64", "int8", "bool" or "string".
        description: What it is.
        nullable: Whether a sample may be undefined. Such a column is a masked array
            in memory and has nulls in the file. Floats say NaN instead.
    """

    name: str
    unit: str
    kind: str
    description: str
    nullable: bool = False


class TrialRecord(NamedTuple):
    """One trial, 60 rows a second.

    Attributes:
        metadata: The fields of `METADATA_FIELDS`.
        columns: The arrays of `COLUMNS` by name, shape `(time,)` each.
    """

    metadata: dict[str, object]
    # Any: the element type differs from column to column.
    columns: dict[str, NDArray[Any]]


METADATA_FIELDS: tuple[str, ...] = (
    "version",
    "seed",
    "participant",
    "condition",
    "strength_factor",
    "change_duration",
    "method",
    "car",
    "speed",
    "driver",
    "intention_model_hash",
    "inconsistency_threshold",
    "replan_gain",
    "torque_limit",
    "configuration",
    "configuration_hash",
    "driver_torque_source",
    "git_revision",
)


def _number(name: str, unit: str, description: str) -> Column:
    return Column(name=name, unit=unit, kind="float64", description=description)


def _count(name: str, description: str, nullable: bool = False) -> Column:
    return Column(
        name=name, unit="-", kind="int8", description=description, nullable=nullable
    )


def _flag(name: str, description: str, nullable: bool = False) -> Column:
    return Column(
        name=name, unit="-", kind="bool", description=description, nullable=nullable
    )


COLUMNS: tuple[Column, ...] = (
    _number("time", "s", "time since the start of the trial"),
    _number("longitudinal_position", "m", "centre of gravity along the road"),
    _number("lateral_position", "m", "from the left lane's centre, left positive"),
    _count("lane", "lane of the centre of gravity: 0 right, 1 left"),
    _count("target_lane", "lane the guidance steers to; null in manual", True),
    _number("yaw_angle", "rad", "heading against the road"),
    _number("yaw_rate", "rad/s", "time derivative of the yaw angle"),
    _number("longitudinal_velocity", "m/s", "along the car's axis"),
    _number("longitudinal_acceleration", "m/s²", "along the car's axis"),
    _number("lateral_velocity", "m/s", "across the car's axis, centre of gravity"),
    _number("lateral_acceleration", "m/s²", "across the car's axis"),
    _number("steering_wheel_angle", "rad", "steering-wheel angle"),
    _number("steering_wheel_rate", "rad/s", "its time derivative"),
    _number("driver_torque", "N·m", "torque of the driver at the wheel"),
    _number("estimated_driver_torque", "N·m", "tau'_dr of Eq. (5)"),
    _number("instructed_torque", "N·m", "guidance before the gain, Eq. (4)"),
    _number("applied_torque", "N·m", "guidance the motor gives, Eq. (6)"),
    _number("haptic_gain", "-", "K_h of Eqs. (10) and (11), in [0, 1]"),
    _number("head_yaw", "-", "head yaw normalised to [-1, 1]"),
    _number("distance_to_adjacent_lane", "m", "to the boundary of the adjacent lane"),
    _number("lateral_error", "m", "error at the preview point"),
    _number("heading_error_rate", "rad/s", "yaw rate minus that of the path"),
    _number("guidance_pseudo_work", "W", "W_hapi of Eq. (7)"),
    _number("driver_pseudo_work", "W", "W_dr of Eq. (8)"),
    _number("torque_agreement", "N²·m²", "S_c of Eq. (9)"),
    _flag("consistent", "verdict of Table III; null in manual", True),
    _number("crossing_probability", "-", "of crossing within 3 s; NaN: no verdict"),
    _flag("intention", "debounced trigger of a lane change"),
    Column("mode", "-", "string", "manual, lane_keeping or lane_changing"),
    _count("event", "0, or the number of the overtaking event the car is in"),
    _count("driver_intention", "-1 right, 0 none, +1 left; null for people", True),
    _number("lead_distance", "m", "to the leader; NaN without one"),
    _number("lead_velocity", "m/s", "of the leader; NaN without one"),
    _count("lead_lane", "lane of the leader; null without one", True),
    _number("target_lateral_position", "m", "of the path at the car"),
    _flag("head_yaw_valid", "whether the head was tracked"),
    _number("accelerator", "-", "pedal position in [0, 1]"),
    _number("brake", "-", "pedal position in [0, 1]"),
)

COLUMN_NAMES: tuple[str, ...] = tuple(column.name for column in COLUMNS)
COLUMNS_BY_NAME: dict[str, Column] = {column.name: column for column in COLUMNS}

_ACCEPTED_KINDS = {"float64": "f", "int8": "iu", "bool": "b", "string": "U"}


def validated(record: TrialRecord) -> TrialRecord:
    """The record with every column in the type of its kind, in the order of `COLUMNS`.

    Raises:
        ValueError: If a column or metadata field is missing or unknown, the lengths
            differ, a kind is wrong, a value is undefined where it may not be, or
            time is not finite and increasing.
    """
    _check_names("column", record.columns, COLUMN_NAMES, extra_allowed=False)
    _check_names("metadata field", record.metadata, METADATA_FIELDS, extra_allowed=True)
    columns = {
        column.name: converted(column, record.columns[column.name])
        for column in COLUMNS
    }
    _check_lengths(columns)
    check_time(columns["time"])
    return TrialRecord(metadata=record.metadata, columns=columns)


def converted(column: Column, values: NDArray[Any]) -> NDArray[Any]:
    """One column in the type of its kind; nullable ones as masked arrays.

    Raises:
        ValueError: If the values are of another kind, out of range or undefined.
    """
    values = np.asanyarray(values)
    if values.ndim != 1:
        raise ValueError(
            f"column {column.name!r} has {values.ndim} dimensions; give one value "
            "per row"
        )
    if values.dtype.kind == "U" and column.kind != "string":
        raise ValueError(text_told(column.name, values))
    if values.dtype.kind not in _ACCEPTED_KINDS[column.kind]:
        raise ValueError(
            f"column {column.name!r} holds {values.dtype}, expected {column.kind}; "
            "undefined integers and flags are masked arrays, not NaN"
        )
    _check_range(column, values)
    return _masked_or_plain(column, values)


def text_told(name: str, values: NDArray[np.str_]) -> str:
    """Say which cell of a column of numbers holds text."""
    row = next((i for i, text in enumerate(values) if not _is_number(text)), 0)
    return (
        f"column {name!r} is {str(values[row])!r} in row {row}, expected a number with "
        "a decimal point; mend that cell, or leave it empty if nothing is known"
    )


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _check_range(column: Column, values: NDArray[Any]) -> None:
    defined = values.compressed() if isinstance(values, np.ma.MaskedArray) else values
    if column.kind == "int8" and values.dtype != np.int8 and defined.size:
        low, high = int(defined.min()), int(defined.max())
        if low < -128 or high > 127:
            raise ValueError(
                f"column {column.name!r} ranges from {low} to {high}; int8 holds "
                "-128 to 127"
            )


def _masked_or_plain(column: Column, values: NDArray[Any]) -> NDArray[Any]:
    dtype: Any = str if column.kind == "string" else column.kind  # numpy's DTypeLike
    if column.nullable:
        return np.ma.MaskedArray(
            np.ma.getdata(values).astype(dtype), mask=np.ma.getmaskarray(values)
        )
    if np.ma.is_masked(values):
        raise ValueError(
            f"column {column.name!r} has undefined samples; it must be defined "
            "throughout"
        )
    return np.ma.getdata(values).astype(dtype, copy=False)


def check_time(time: NDArray[np.float64]) -> None:
    """Refuse times that are not finite or do not increase.

    Args:
        time: Sample times [s], shape `(time,)`.

    Raises:
        ValueError: Naming the first row at fault.
    """
    if not np.isfinite(time).all():
        row = int(np.flatnonzero(~np.isfinite(time))[0])
        raise ValueError(f"time is {time[row]} in row {row}; every time must be finite")
    falling = np.flatnonzero(np.diff(time) <= 0)
    if falling.size:
        row = int(falling[0]) + 1
        raise ValueError(
            f"time does not increase in row {row}: {time[row - 1]} s, then "
            f"{time[row]} s; sort the rows or split the recording"
        )


def _check_lengths(columns: dict[str, NDArray[Any]]) -> None:
    num_rows = len(columns["time"])
    if num_rows == 0:
        raise ValueError("a trial record needs at least one row; it has none")
    uneven = {k: len(v) for k, v in columns.items() if len(v) != num_rows}
    if uneven:
        name, length = next(iter(uneven.items()))
        raise ValueError(
            f"column {name!r} has {length} rows, 'time' has {num_rows}; all columns "
            "of a record are equally long"
        )


def _check_names(
    what: str, given: dict[str, Any], wanted: tuple[str, ...], extra_allowed: bool
) -> None:
    missing = [name for name in wanted if name not in given]
    if missing:
        raise ValueError(f"missing {what}s: {', '.join(missing)}")
    extra = [name for name in given if name not in wanted]
    if extra and not extra_allowed:
        raise ValueError(
            f"unknown {what}s: {', '.join(extra)}; a trial record has "
            f"{', '.join(wanted)}"
        )
