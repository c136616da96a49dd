"""What a method adds to a record is kept in its file, with all that is said of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from costeer.records.columns import Column, TrialRecord
from costeer.records.record import read_record, read_recording, write_record
from tests.study.synthetic import synthetic_record

INTEGRAL = Column(
    "method_integral",
    "m·s",
    "float64",
    "of the lateral error",
    "method.integral",
    mirrored="flipped",
)
PHASE = Column(
    "method_phase",
    "-",
    "string",
    "what the method is at",
    "method.phase",
    assisted_only=True,
    stepped=True,
    labels=("waiting", "steering"),
)
SIDE = Column(
    "method_side", "-", "int8", "-1 or 1", "method.side", nullable=True, stepped=True
)


@pytest.fixture(scope="module")
def record() -> TrialRecord:
    plain = synthetic_record("weak-normal", length=900.0)
    rows = len(plain.columns["time"])
    steering = np.arange(rows) % 7 > 3
    added = {
        "method_integral": np.linspace(-1.0, 1.0, rows),
        "method_phase": np.where(steering, "steering", "waiting"),
        "method_side": np.ma.MaskedArray(np.ones(rows, np.int8), mask=~steering),
    }
    return TrialRecord(plain.metadata, plain.columns | added, (INTEGRAL, PHASE, SIDE))


@pytest.fixture
def path(record: TrialRecord, tmp_path: Path) -> Path:
    write_record(tmp_path / "t.parquet", record)
    return tmp_path / "t.parquet"


def test_values_and_declarations_are_read_back(path: Path, record: TrialRecord) -> None:
    for found in (read_record(path), read_recording(path)):
        assert found.method_columns == (INTEGRAL, PHASE, SIDE)
        assert list(found.columns)[-3:] == [c.name for c in found.method_columns]
        for column in found.method_columns:
            kept, got = record.columns[column.name], found.columns[column.name]
            np.testing.assert_array_equal(
                np.ma.getmaskarray(kept), np.ma.getmaskarray(got)
            )
            assert (
                np.ma.filled(kept[kept == kept]).tolist() == np.ma.filled(got).tolist()
            )


def test_any_program_can_see_unit_description_and_steps(path: Path) -> None:
    schema = pq.read_schema(path)
    integral = schema.field("method_integral").metadata
    assert integral[b"unit"] == "m·s".encode()
    assert integral[b"description"] == b"of the lateral error"
    assert integral[b"stepped"] == b"false"
    assert schema.field("method_phase").metadata[b"stepped"] == b"true"


def test_a_column_of_the_method_can_be_read_alone(path: Path) -> None:
    some = read_record(path, ["method_side", "lane"])
    assert list(some.columns) == ["time", "lane", "method_side"]
    assert some.method_columns == (SIDE,)


def test_a_column_that_this_method_does_not_have_is_named(path: Path) -> None:
    with pytest.raises(ValueError, match="lacks the columns method_speed"):
        read_record(path, ["method_speed"])


def test_a_column_that_nobody_declared_is_not_written(
    record: TrialRecord, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match="unknown columns: method_phase"):
        write_record(tmp_path / "t", record._replace(method_columns=(INTEGRAL, SIDE)))


def test_a_label_that_nobody_declared_is_not_written(
    record: TrialRecord, tmp_path: Path
) -> None:
    phase = np.full(len(record.columns["time"]), "parking")
    columns = record.columns | {"method_phase": phase}
    with pytest.raises(
        ValueError, match="method_phase is 'parking' in row 0, expected"
    ):
        write_record(tmp_path / "t", record._replace(columns=columns))


def appended(path: Path, name: str, values: pa.Array) -> None:
    pq.write_table(pq.read_table(path).append_column(name, values), path)


def test_an_unknown_column_in_a_file_is_refused(path: Path) -> None:
    rows = pq.read_metadata(path).num_rows
    appended(path, "pedal", pa.array([0.0] * rows))
    for names in (None, ["lane"]):
        with pytest.raises(ValueError, match=r"t\.parquet: unknown columns: pedal"):
            read_record(path, names)


def test_a_column_that_another_program_added_for_a_method_is_read(path: Path) -> None:
    rows = pq.read_metadata(path).num_rows
    appended(path, "method_heat", pa.array([20.0] * rows))
    found = read_record(path)
    assert found.method_columns[-1][:4] == ("method_heat", "-", "float64", "")
    assert set(found.columns["method_heat"]) == {20.0}


def test_a_method_s_column_of_a_type_that_records_do_not_have_is_refused(
    path: Path,
) -> None:
    rows = pq.read_metadata(path).num_rows
    appended(path, "method_day", pa.array([0] * rows, pa.date32()))
    with pytest.raises(ValueError, match=r"'method_day' holds date32.*; a method's"):
        read_record(path)
