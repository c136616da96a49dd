"""What a trial record holds: its columns, each declared once.

The compiled row (records/row.py), types and units of files (records/arrow.py), what is
empty in manual driving, what the page draws as steps and the table of docs/records.md
follow from `COLUMNS`. Names and signs follow ISO 8855: left is positive, lanes count
from the right, an error is car minus target.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias, get_args

from numpy.typing import NDArray

from costeer.pages import record as shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

Kind: TypeAlias = Literal["float64", "int8", "bool", "string"]

Mirrored: TypeAlias = Literal["same", "flipped", "swapped", "reflected"]
"""What becomes of a column in the mirrored world: it stays, it changes its sign, lanes
0 and 1 change places, a position is reflected at the line between the lanes."""

MANUAL = "manual"
LANE_KEEPING = "lane_keeping"
LANE_CHANGING = "lane_changing"
MODES = (MANUAL, LANE_KEEPING, LANE_CHANGING)

_ASKED = "of crossing_probability: -1 right, +1 left; 0 in older records"

METHOD_PREFIX = "method_"
"""How the names of columns begin that a method adds to those of every record."""

CAR_PREFIX = "car_"
ADDED_PREFIXES = (METHOD_PREFIX, CAR_PREFIX)


class Column(NamedTuple):
    """One column of a trial record.

    Attributes:
        name: Name in memory and in the file.
        unit: SI unit, "-" if there is none; stored in the schema.
        kind: "float64", "int8", "bool" or "string".
        description: What it is.
        source: Dotted place of the number in the loop's sample.
        nullable: Whether a sample may be undefined. Such a column is a masked array
            in memory and has nulls in the file. Floats say NaN instead.
        assisted_only: Whether it says nothing in manual driving, where the guidance
            is computed and has no strength. Floats are NaN there, nullable columns
            null, texts the first label.
        stepped: Whether the page draws it as steps: between two samples the newer
            one holds.
        mirrored: What becomes of it in the mirrored world.
        labels: Of texts, the word for each number of the sample.
        before: What it was in files written before it was declared; None if every
            file has it.

    Example:
        >>> import costeer
        >>> column = costeer.Column(
        ...     name="method_integral",
        ...     unit="m·s",
        ...     kind="float64",
        ...     description="lateral error over time",
        ...     source="method.integral",
        ... )
        >>> column.nullable
        False
    """

    name: str
    unit: str
    kind: Kind
    description: str
    source: str = ""
    nullable: bool = False
    assisted_only: bool = False
    stepped: bool = False
    mirrored: Mirrored = "same"
    labels: tuple[str, ...] = ()
    before: float | None = None


class TrialRecord(NamedTuple):
    """One trial, 60 rows a second; `costeer.Record` is its short name.

    Attributes:
        metadata: The fields of records/metadata.py.
        columns: The arrays of `COLUMNS` by name, shape `(time,)` each, and those of
            `method_columns`.
        method_columns: What the method adds to the columns of every record.

    Example:
        >>> import costeer
        >>> record = costeer.simulate("weak-gentle", length=300, intention="off")
        >>> record
        <costeer record: participant 1, weak-gentle, ibhs, virtual, 912 rows, 15.2 s>
        >>> record.to_frame().attrs["units"]["driver_torque"]
        'N·m'
        >>> figure = record.plot(["lateral_position", "driver_torque"])
    """

    metadata: dict[str, object]
    # Any: the element type differs from column to column.
    columns: dict[str, NDArray[Any]]
    method_columns: tuple[Column, ...] = ()

    def __repr__(self) -> str:
        return shown.line(self.metadata, self.columns)

    def _repr_html_(self) -> str:
        return shown.table(self.metadata, self.columns)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column that costeer or the method declares, "-" for none."""
        declared = {c.name: c.unit for c in (*COLUMNS, *self.method_columns)}
        return {name: declared[name] for name in self.columns if name in declared}

    def to_frame(self) -> DataFrame:
        """The columns as a data frame, its units in `.attrs["units"]`."""
        return shown.frame(self.metadata, self.columns, self.units)

    def plot(self, signals: Sequence[str] | None = None) -> Figure:
        """Signals against time in stacked panels, ready for print.

        Args:
            signals: Names of columns; a usual choice if None.

        Raises:
            ValueError: If the record has no such signal.
        """
        return shown.figure(self.metadata, self.columns, self.units, signals)


def _number(
    name: str, unit: str, description: str, source: str, mirrored: Mirrored = "same"
) -> Column:
    return Column(name, unit, "float64", description, source, mirrored=mirrored)


def _measured(
    name: str, unit: str, description: str, mirrored: Mirrored = "same"
) -> Column:
    return _number(name, unit, description, f"measurement.{name}", mirrored)


def _code(
    name: str, description: str, source: str, mirrored: Mirrored = "same"
) -> Column:
    column = Column(name, "-", "int8", description, source, mirrored=mirrored)
    return column._replace(stepped=True)


def _guidance(
    name: str, unit: str, description: str, source: str, mirrored: Mirrored = "same"
) -> Column:
    column = _number(name, unit, description, f"signals.{source}", mirrored)
    return column._replace(assisted_only=True)


COLUMNS: tuple[Column, ...] = (
    _number("time", "s", "time since the start of the trial", "time"),
    _measured("longitudinal_position", "m", "centre of gravity along the road"),
    _measured(
        "lateral_position",
        "m",
        "from the left lane's centre, left positive",
        "reflected",
    ),
    _code(
        "lane",
        "lane of the centre of gravity, from the right: 0, 1 ...",
        "measurement.lane",
        "swapped",
    ),
    Column(
        "target_lane",
        "-",
        "int8",
        "lane the guidance steers to; null in manual",
        "signals.target.lane",
        nullable=True,
        assisted_only=True,
        stepped=True,
        mirrored="swapped",
    ),
    _measured("yaw_angle", "rad", "heading against the road", "flipped"),
    _measured("yaw_rate", "rad/s", "time derivative of the yaw angle", "flipped"),
    _measured("longitudinal_velocity", "m/s", "along the car's axis"),
    _measured("longitudinal_acceleration", "m/s²", "along the car's axis"),
    _measured(
        "lateral_velocity",
        "m/s",
        "across the car's axis, centre of gravity",
        "flipped",
    ),
    _measured("lateral_acceleration", "m/s²", "across the car's axis", "flipped"),
    _measured("steering_wheel_angle", "rad", "steering-wheel angle", "flipped"),
    _measured("steering_wheel_rate", "rad/s", "its time derivative", "flipped"),
    _measured("driver_torque", "N·m", "torque of the driver at the wheel", "flipped"),
    _guidance(
        "estimated_driver_torque",
        "N·m",
        "tau'_dr of Eq. (5)",
        "guidance.estimated_driver_torque",
        "flipped",
    ),
    _guidance(
        "instructed_torque",
        "N·m",
        "guidance before the gain, Eq. (4)",
        "guidance.instructed_torque",
        "flipped",
    ),
    _number(
        "applied_torque",
        "N·m",
        "guidance the motor gives, Eq. (6)",
        "motor_torque",
        "flipped",
    ),
    _guidance(
        "haptic_gain", "-", "K_h of Eqs. (10) and (11), in [0, 1]", "haptic_gain"
    ),
    _measured("head_yaw", "-", "head yaw normalised to [-1, 1]", "flipped"),
    _measured("distance_to_adjacent_lane", "m", "to the boundary of the adjacent lane"),
    _guidance(
        "lateral_error",
        "m",
        "error at the preview point",
        "preview.lateral_error",
        "flipped",
    ),
    _guidance(
        "heading_error_rate",
        "rad/s",
        "yaw rate minus that of the path",
        "preview.heading_error_rate",
        "flipped",
    ),
    _guidance(
        "guidance_pseudo_work",
        "W",
        "W_hapi of Eq. (7)",
        "consistency.guidance_pseudo_work",
    ),
    _guidance(
        "driver_pseudo_work",
        "W",
        "W_dr of Eq. (8)",
        "consistency.driver_pseudo_work",
    ),
    _guidance(
        "torque_agreement",
        "N²·m²",
        "S_c of Eq. (9)",
        "consistency.torque_agreement",
    ),
    Column(
        "consistent",
        "-",
        "bool",
        "verdict of Table III; null in manual, and without a haptic gain",
        "signals.consistency.consistent",
        nullable=True,
        assisted_only=True,
        stepped=True,
    ),
    _number(
        "crossing_probability",
        "-",
        "of crossing within 3 s; NaN: no verdict; where the metadata's network_form is "
        "bracket only its side of 0.5 is exact",
        "request.crossing_probability",
    ),
    Column(
        "intention",
        "-",
        "bool",
        "debounced trigger of a lane change",
        "signals.intention",
        stepped=True,
    ),
    Column(
        "mode",
        "-",
        "string",
        "manual, lane_keeping or lane_changing",
        "signals.target.mode",
        assisted_only=True,
        stepped=True,
        labels=MODES,
    ),
    _code(
        "event",
        "0, or the number of the overtaking event the car is in",
        "events.event",
    ),
    _code(
        "driver_intention",
        "-1 right, 0 none, +1 left; null for people",
        "action.intention",
        "flipped",
    )._replace(nullable=True),
    _number("lead_distance", "m", "to the car to overtake, or NaN", "lead.distance"),
    _number("lead_velocity", "m/s", "of the leader; NaN without one", "lead.velocity"),
    _code(
        "lead_lane", "lane of the leader; null without one", "lead.lane", "swapped"
    )._replace(nullable=True),
    _guidance(
        "target_lateral_position",
        "m",
        "of the path at the car",
        "target.lateral_position",
        "reflected",
    ),
    Column(
        "head_yaw_valid",
        "-",
        "bool",
        "whether the head was tracked",
        "measurement.head_yaw_valid",
        stepped=True,
    ),
    _number(
        "accelerator", "-", "pedal position in [0, 1]", "action.pedals.accelerator"
    ),
    _number("brake", "-", "pedal position in [0, 1]", "action.pedals.brake"),
    Column(
        "torque_fault",
        "-",
        "int8",
        "of the torque asked for: 0 none, 1 not finite, 2 over the limit; contained",
        "torque_fault",
        stepped=True,
        before=0.0,
    ),
    _measured(
        "road_curvature", "1/m", "of the left lane's centre at the car", "flipped"
    )._replace(before=0.0),
    Column(
        "contact",
        "-",
        "int8",
        "0, or what the car touches: 1 rumble strip, 2 barrier, 3 another car",
        "events.contact",
        stepped=True,
        before=0.0,
    ),
    _code(
        "driver_indicator",
        "set by the driver: -1 right, 0 off, +1 left",
        "action.indicator",
        "flipped",
    )._replace(before=0.0),
    _code("crossing_side", _ASKED, "request.side", "flipped")._replace(before=0.0),
)

COLUMN_NAMES: tuple[str, ...] = tuple(column.name for column in COLUMNS)
COLUMNS_BY_NAME: dict[str, Column] = {column.name: column for column in COLUMNS}


def with_method_columns(added: Sequence[Column]) -> tuple[Column, ...]:
    """The columns of every record and those that a method or a scenario adds.

    Args:
        added: Their names begin with `method_` or `car_`.

    Raises:
        ValueError: If a column cannot be one of a method, saying which and why.
    """
    for place, column in enumerate(added):
        fault = _fault_of(column, {other.name for other in added[:place]})
        if fault:
            raise ValueError(f"column {column.name!r} of the method {fault}")
    return (*COLUMNS, *added)


def _fault_of(column: Column, before: set[str]) -> str | None:
    """What is wrong with a column that a method adds; None if nothing is."""
    if not column.name.startswith(ADDED_PREFIXES) or not column.name.isidentifier():
        return (
            f"must be named {METHOD_PREFIX!r} and then letters, digits or underscores, "
            f"such as {METHOD_PREFIX + 'integral'!r}"
        )
    if column.name in before:
        return "is declared twice; give each a name of its own"
    for field, choice in (("kind", get_args(Kind)), ("mirrored", get_args(Mirrored))):
        given = getattr(column, field)
        if given not in choice:
            return f"has {field} {given!r}; choose from {', '.join(choice)}"
    if (column.kind == "string") != bool(column.labels):
        return "needs labels if it is a string, and has none if it is not"
    return None
